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
    int codes;               /* draw frame codes */
} gw_picture_options;

extern const struct argp gw_picture_argp; /* its input is a gw_picture_options */

#endif
