/* What the flights found, computed from their rows: targets hit or missed, relevance, where the
 * bytes went and the error came from. */
#ifndef REPORT_FINDINGS_H
#define REPORT_FINDINGS_H

#include "report_page.h"

#include <stdio.h>

/* Writes the findings as HTML (`html` 1) or Markdown. Targets need content->paper; what the flights
 * do not tell is left out. */
void report_findings(FILE *out, const report_content *content, int html);

#endif
