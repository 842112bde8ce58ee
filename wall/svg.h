/* What drawings in SVG share. Any thread. */
#ifndef GW_WALL_SVG_H
#define GW_WALL_SVG_H

#include <stdio.h>

/* <text> at (x, y) with these attributes; what would be markup in the text is escaped. */
void gw_svg_text(FILE *svg, double x, double y, const char *attributes, const char *text);

#endif
