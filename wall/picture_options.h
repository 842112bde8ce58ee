/* The part of the command line that says what pictures of a wall show and where they go: patterns, overlay,
 * video, remaking. A child of the parsers of the verbs that draw walls. */
#ifndef GW_WALL_PICTURE_OPTIONS_H
#define GW_WALL_PICTURE_OPTIONS_H

#include "base/status.h"
#include "wall/pattern.h"

#include <argp.h>

typedef struct gw_picture_options {
    gw_error *error;         /* where the parser leaves its sentence; set before parsing */
    gw_pattern_kind pattern; /* instead of the scene */
    int overlay, codes;      /* drawn over the pictures; an overlay has the codes, too */
    const char *video;       /* file, or NULL */
    double rate;             /* frames a second of the video; 0: as the frames' step says, else 30 */
    const char *remake;      /* side-car of the picture to make again, or NULL */
} gw_picture_options;

extern const struct argp gw_picture_argp; /* its input is a gw_picture_options */

#endif
