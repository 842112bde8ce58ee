#include "wall/svg.h"

void gw_svg_text(FILE *svg, double x, double y, const char *attributes, const char *text) {
    fprintf(svg, "<text x=\"%.1f\" y=\"%.1f\" %s>", x, y, attributes);
    for (const char *c = text; *c; c++)
        if (*c == '<')
            fputs("&lt;", svg);
        else if (*c == '&')
            fputs("&amp;", svg);
        else if ((unsigned char)*c < ' ')
            fputc(' ', svg); /* not allowed in XML */
        else
            fputc(*c, svg);
    fputs("</text>\n", svg);
}
