/* What a pack says of itself, in the letters of the small font (common3d/c3d_text.h): for programs
 * that show it over their picture. */
#ifndef SIM_ABOUT_H
#define SIM_ABOUT_H

#include "../../client/farfield.h"

/* What desc.about has to ask for. */
#define SIM_ABOUT_SHOWN (FF_ABOUT_BIT(FF_ABOUT_NAME) | FF_ABOUT_BIT(FF_ABOUT_ATTRIBUTION))

/* Name and attribution, each from a new line on, lines of at most `columns` that end with \n, at
 * most `lines`: how many there are; 0 while nothing is known. Letters with marks lose them, dashes
 * and quotation marks of all kinds are the plain ones, letters of other scripts are '?'. */
unsigned sim_about_lines(ff_client *client, unsigned columns, unsigned lines, char *text,
                         size_t room);

#endif
