/* The side-car of a picture of the wall: wall-NNNN.json beside wall-NNNN.png, with all that the picture was
 * made from, so that --remake makes it again, bit for bit: the wall's tiles, the scene's file and hash, every
 * setting, the frame's state. Reading is for hostile files: every length is bounded, every number checked.
 * Rank 0 writes; launcher and ranks read. */
#ifndef GW_WALL_SIDE_CAR_H
#define GW_WALL_SIDE_CAR_H

#include "base/hash.h"
#include "base/image.h"
#include "base/settings.h"
#include "base/status.h"
#include "build/scene.h"
#include "render/features.h"
#include "render/frame_state.h"
#include "wall/pattern.h"
#include "wall/site.h"

#include <stdint.h>

typedef struct gw_side_car {
    gw_site site;
    gw_settings settings;
    gw_frame_state state;
    gw_pattern_kind pattern; /* then there is no scene */
    gw_features force_effects, forbid_effects;
    char *scene;     /* path, absolute; NULL: the embedded demo scene */
    char *animation; /* as --animation, or NULL */
    char scene_hash[33], image_hash[33];
} gw_side_car;

/* What a picture has beside what the run has. */
typedef struct gw_side_car_picture {
    const gw_site *site;
    const gw_settings *settings;
    const gw_frame_state *state;
    gw_pattern_kind pattern;
    gw_features force_effects, forbid_effects;
    const char *scene, *animation; /* as on the command line */
    const char *scene_hash;        /* 32 digits, or NULL */
    gw_hash image;                 /* of the tiles' own pixels, without overlay */
    const int *missing;            /* [tile_count], 1 where a tile is missing */
    int overlay, codes;            /* what was drawn over them */
} gw_side_car_picture;

gw_code gw_side_car_write(const char *path, const gw_side_car_picture *picture, gw_error *error);

/* Free with gw_side_car_finish(), also after an error. */
gw_code gw_side_car_read(const char *path, gw_side_car *out, gw_error *error);
void gw_side_car_finish(gw_side_car *side_car);

/* GW_BAD_INPUT when the scene is not the one that the picture was made from. */
gw_code gw_side_car_check_scene(const gw_side_car *side_car, const gw_scene *scene, gw_error *error);

#endif
