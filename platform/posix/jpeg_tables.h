/* The tables that all bare images share: annex K of ITU-T T.81. */
#ifndef JPEG_TABLES_H
#define JPEG_TABLES_H

#include <stdio.h>

#include <jpeglib.h>

/* Gives the decoder quantisation tables (K.1, K.2 scaled for quality 1..100) and Huffman tables
 * (K.3 to K.6), because the stream of a bare image has none. */
void jpeg_tables_set(j_decompress_ptr jpeg, int quality);

#endif
