/* A checked scene: what the importer made of a model file, a YAML scene or the demo scene, ready for the
 * octree.
 *
 * All numbers are finite, all indices in range, no triangle is degenerate after rebasing. Positions are
 * rebased: in double precision about the scene's centre and scaled by a power of two, so that the longest
 * side of the bounding box is in [1,2) and every coordinate in [-1,1]; scene metres = rebased * 2^exponent +
 * centre. Triangles are in canonical order (Morton code of the centroid, then content), so a triangle's id
 * does not depend on the order in the file. Owned by whoever called the import; read-only afterwards; any
 * thread may read. */
#ifndef GW_BUILD_SCENE_H
#define GW_BUILD_SCENE_H

#include "base/hash.h"
#include "base/image.h"
#include "base/log.h"
#include "base/status.h"

#include <stddef.h>
#include <stdint.h>

struct gw_animation;

typedef enum gw_alpha_mode { GW_ALPHA_OPAQUE, GW_ALPHA_MASK, GW_ALPHA_BLEND } gw_alpha_mode;
typedef enum gw_wrap { GW_WRAP_REPEAT, GW_WRAP_CLAMP, GW_WRAP_MIRROR } gw_wrap;

typedef struct gw_material {
    char name[64];
    float base_color[4]; /* linear, 0..1; alpha last */
    float metalness;     /* 0..1 */
    float roughness;     /* perceptual, 0..1 */
    float emissive[3];   /* linear radiance factor, >= 0 */
    gw_alpha_mode alpha_mode;
    float alpha_cutoff; /* for GW_ALPHA_MASK */
    int32_t two_sided;
    int32_t base_color_texture; /* index into textures, -1 for none */
} gw_material;

/* Pictures that a material may name. Those up to GW_MAP_SHOWN_COUNT are shown; of the thickness the mean is
 * used; specular-glossiness is converted together with the base colour, and maps that stand alone are joined.
 */
typedef enum gw_map {
    GW_MAP_BASE_COLOR, /* sRGB; the only one that gw_material holds */
    GW_MAP_NORMAL,
    GW_MAP_METALLIC_ROUGHNESS,  /* green: roughness, blue: metalness */
    GW_MAP_OCCLUSION,           /* red */
    GW_MAP_EMISSIVE,            /* sRGB */
    GW_MAP_TRANSMISSION,        /* red */
    GW_MAP_CLEARCOAT,           /* red */
    GW_MAP_CLEARCOAT_ROUGHNESS, /* green */
    GW_MAP_CLEARCOAT_NORMAL,
    GW_MAP_SHEEN_COLOR,     /* sRGB */
    GW_MAP_SHEEN_ROUGHNESS, /* in files: alpha; here: red */
    GW_MAP_SPECULAR,        /* in files: alpha; here: red */
    GW_MAP_SPECULAR_COLOR,  /* sRGB */
    GW_MAP_SHOWN_COUNT,
    GW_MAP_SPECULAR_GLOSSINESS = GW_MAP_SHOWN_COUNT, /* sRGB specular colour; alpha: glossiness */
    GW_MAP_THICKNESS,                                /* green */
    GW_MAP_ROUGHNESS_ALONE,                          /* of MTL, become metallic-roughness: brightness */
    GW_MAP_METALNESS_ALONE,
    GW_MAP_COUNT
} gw_map;

/* A picture that a material reads besides its base colour. */
typedef struct gw_texture_use {
    int32_t texture;    /* index into textures, -1 for none */
    int32_t coordinate; /* 0: texcoords, 1: second_texcoords of the scene */
    float to_uv[2][3];  /* uv of the picture = to_uv * (u, v, 1) */
} gw_texture_use;

/* What a material has beyond gw_material: the core maps and the material extensions of glTF 2.0. Factors of
 * what is absent stand at the values that change nothing (gw_material_extension_none()). With a map, the
 * factors of the same name here go with it, and those of gw_material are these times the map's mean: what
 * shows no map (voxels) shows the mean. Numbers only, no padding: compared and hashed as bytes. */
typedef struct gw_material_extension {
    gw_texture_use normal; /* linear; tangent space, green up */
    float normal_scale;
    gw_texture_use metallic_roughness;    /* linear */
    float metalness, roughness;           /* 0..1, with that map only */
    gw_texture_use occlusion;             /* linear */
    float occlusion_strength;             /* 0..1 */
    gw_texture_use emissive_map;          /* sRGB */
    float emissive[3];                    /* >= 0, with that map only */
    int32_t unlit;                        /* base colour is what is seen */
    float ior;                            /* >= 1, default 1.5 */
    float specular, specular_color[3];    /* 0..1; >= 0: factors of the dielectric reflection at 0 degrees */
    float transmission;                   /* 0..1: share of what is not reflected that goes through */
    gw_texture_use transmission_map;      /* linear; as all maps below it is multiplied by its factor */
    float thickness;                      /* 0: a thin sheet; > 0: the surface bounds a volume */
    float attenuation_color[3];           /* what is left of white light after attenuation_distance, > 0..1 */
    float attenuation_distance;           /* scene metres; 0: nothing is absorbed */
    float clearcoat, clearcoat_roughness; /* 0..1 */
    gw_texture_use clearcoat_map, clearcoat_roughness_map; /* linear */
    gw_texture_use clearcoat_normal;                       /* as normal */
    float clearcoat_normal_scale;
    float sheen_color[3], sheen_roughness; /* linear, 0..1 */
    gw_texture_use sheen_color_map;        /* sRGB */
    gw_texture_use sheen_roughness_map;    /* linear */
    gw_texture_use specular_map;           /* linear */
    gw_texture_use specular_color_map;     /* sRGB */
} gw_material_extension;

typedef struct gw_texture {
    char name[256];
    gw_image image; /* sRGB-encoded colour, straight alpha; or linear data, as its users say */
    gw_wrap wrap_u, wrap_v;
    int32_t nearest; /* 1: its texels are shown as squares where they are enlarged */
} gw_texture;

typedef enum gw_light_kind {
    GW_LIGHT_DIRECTIONAL,
    GW_LIGHT_POINT,
    GW_LIGHT_SPOT,
    GW_LIGHT_RECTANGLE,
    GW_LIGHT_KINDS
} gw_light_kind;
/* Fields that are not of a light's kind are 0. */
typedef struct gw_light {
    gw_light_kind kind;
    double vector[3];  /* directional: unit direction in which the light travels; others: position (of the
                          rectangle's middle) in scene metres */
    float color[3];    /* linear; directional: irradiance on a facing surface; others: the same at 1 m, on the
                          axis of a spot, far from a rectangle as if it were a point in its middle */
    float axis[3];     /* spot: unit direction in which it shines */
    float cone[2];     /* spot: half-angles, rad: it is whole within the first, none beyond the second;
                          0 <= first < second <= pi/2 */
    float range;       /* point, spot: metres at which it ends, 0: nowhere (KHR_lights_punctual) */
    float extent;      /* directional: half-angle of its disc, rad, below pi/2; point, spot: radius of its
                          sphere, m; 0: hard shadows */
    float sides[2][3]; /* rectangle: its sides, m; it shines along sides[0] x sides[1] */
} gw_light;

/* A picture of all directions, as render/environment.h lies it round the scene. */
typedef struct gw_environment {
    gw_image rgbe;  /* as build/radiance_hdr.h, twice as wide as high; no bytes: there is none */
    float scale;    /* radiance of a picture's unit */
    float rotation; /* rad, to the right about y */
} gw_environment;

typedef struct gw_viewpoint {
    char name[64];
    double eye[3], look_at[3]; /* scene metres */
    double up[3];              /* not parallel to the view */
    double fov;                /* vertical, deg, 1..170 */
} gw_viewpoint;

/* A camera path: eye and look-at by time (seconds, rising), smooth between keys (render/camera.h). */
typedef struct gw_camera_key {
    double time;
    double eye[3], look_at[3];
} gw_camera_key;

typedef struct gw_camera_path {
    char name[64];
    double fov;       /* vertical, deg, 1..170 */
    size_t key_count; /* at least 2 */
    gw_camera_key *keys;
} gw_camera_path;

/* How scene space (metres, y up, right-handed) is placed in wall space (mm):
 * FIT_BEHIND_WALL: scaled so that the bounding box fits the wall's width and height and pushed behind the
 * wall; VIEWPOINT: the neutral viewer stands at viewpoint 0 and looks along it, `scale` wall mm per scene mm;
 * MATRIX: wall_mm = matrix * scene_m, a similarity (rotation, uniform scale, translation). */
typedef enum gw_placement_kind {
    GW_PLACE_FIT_BEHIND_WALL,
    GW_PLACE_VIEWPOINT,
    GW_PLACE_MATRIX
} gw_placement_kind;
typedef struct gw_placement {
    gw_placement_kind kind;
    double scale;        /* VIEWPOINT: > 0, default 1 */
    double matrix[3][4]; /* MATRIX: rows; [row][3] in mm */
} gw_placement;

/* Triangles that the import dropped, by reason, each under the first that fits: GW_ROW(field, words). The
 * field is the key in reports, the words follow a number.
 * repeated_vertex: two corners are one vertex or the same point; zero_area: three points on one line,
 * exactly, in the file's own precision; outlier: gw_scene_drop_outliers; collapsed: became one of these two
 * by rebasing to float; duplicate: equal in everything to a triangle that stays, and not blended, so that no
 * ray could tell; those that a closed surface needs to be closed stay (scene_duplicates.h). */
/* clang-format off */
#define GW_DROPPED_TABLE(GW_ROW)                                                                                      \
    GW_ROW(non_finite, "with a position that is not finite")                                                           \
    GW_ROW(bad_index, "with an index out of range")                                                                    \
    GW_ROW(repeated_vertex, "with a repeated vertex")                                                                  \
    GW_ROW(zero_area, "without area")                                                                                  \
    GW_ROW(outlier, "far outside the scene")                                                                           \
    GW_ROW(collapsed, "collapsed by rounding")                                                                         \
    GW_ROW(duplicate, "equal to another")                                                                              \
    GW_ROW(not_triangle, "points and lines")
/* clang-format on */

typedef struct gw_dropped {
#define GW_DROPPED_FIELD(field, words) uint64_t field;
    GW_DROPPED_TABLE(GW_DROPPED_FIELD)
#undef GW_DROPPED_FIELD
} gw_dropped;

typedef struct gw_dropped_row {
    const char *name, *words;
    size_t offset; /* of the field in gw_dropped */
} gw_dropped_row;

extern const gw_dropped_row gw_dropped_rows[];
extern const size_t gw_dropped_row_count;

uint64_t gw_dropped_by(const gw_dropped *dropped, const gw_dropped_row *row);
uint64_t gw_dropped_total(const gw_dropped *dropped);
void gw_dropped_add(gw_dropped *sum, const gw_dropped *part);

typedef struct gw_scene {
    char *path;   /* of the file the user named; "demo" for the embedded one */
    gw_hash hash; /* of everything below that reaches a pixel */

    uint32_t vertex_count;
    float *positions; /* [vertex_count][3], rebased */
    float *normals;   /* [vertex_count][3] unit shading normals; a zero vector means: use the geometric one */
    float *texcoords; /* [vertex_count][2], v downwards (row 0 of the image is v = 0); zero where there are
                         none */
    float *second_texcoords; /* as texcoords; NULL when no material reads them */
    uint32_t *tangents;      /* [vertex_count] build/tangent.h; NULL when no material reads any */
    uint8_t *colors;         /* [vertex_count][4] linear factor 0..255, NULL when no vertex has one */
    uint32_t *welded;        /* [vertex_count] id of the position: equal for bit-equal rebased positions,
                                0..welded_count-1 */
    uint32_t welded_count;

    uint32_t triangle_count;
    uint32_t (*triangles)[3]; /* vertex indices, canonical order */
    uint32_t *material_of;    /* [triangle_count] */

    /* What moves, NULL when nothing does. Positions and normals above are those at time 0, and so are the
     * order of triangles and what is welded: a welded vertex stays one at any time. */
    struct gw_animation *animation;

    uint32_t material_count, texture_count, light_count, viewpoint_count, path_count;
    gw_material *materials;
    gw_material_extension *extensions; /* [material_count], NULL when no material has any */
    gw_texture *textures;
    gw_light *lights;
    gw_environment environment;
    gw_viewpoint *viewpoints;
    gw_camera_path *paths;
    float ambient[3];    /* linear irradiance from everywhere */
    float background[3]; /* linear radiance where no surface is */
    gw_placement placement;

    double centre[3];    /* scene metres */
    int32_t exponent;    /* scene metres = rebased * 2^exponent + centre */
    double bounds[2][3]; /* least and greatest corner, scene metres */

    double outlier_extents; /* in: the setting of this name; 0 keeps all */
    gw_dropped dropped;
    /* What the importer decided because the file did not say, and what it could not carry ("no light: ...",
     * "KHR_materials_sheen: ignored"), one line each, for inspect and the report. */
    size_t note_count;
    char **notes;
} gw_scene;

void gw_scene_destroy(gw_scene **scene);

/* Of a rectangle, m^2. */
double gw_light_area(const gw_light *light);

/* Nothing beyond gw_material. */
gw_material_extension gw_material_extension_none(void);
/* What is wrong with the i-th extension of a scene, in words; NULL when nothing is. */
const char *gw_material_extension_fault(const gw_scene *scene, uint32_t i);
/* Where an extension keeps a map's use; NULL for those that it has none of. */
gw_texture_use *gw_texture_use_of(gw_material_extension *extension, gw_map map);
/* Gives the scene extensions that change nothing, if it has none yet. */
gw_code gw_scene_extend_materials(gw_scene *scene, gw_error *error);

/* Appends a note (printf form). */
gw_code gw_scene_note(gw_scene *scene, gw_error *error, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Finishes a scene whose file-side arrays are filled: `world` positions in scene metres as double
 * [vertex_count][3]; checks, drops, rebases, merges equal vertices, welds, sorts into canonical order,
 * hashes. normals, texcoords and colors may be NULL (none); positions and welded are made here. The arrays
 * are replaced: vertices stand in order of first use, each triangle starts with its least corner, so nothing
 * depends on the order in the file. On failure the scene is still destroyable. GW_BAD_INPUT when nothing is
 * left to draw. */
gw_code gw_scene_finish(gw_scene *scene, const double *world, gw_error *error);

/* Takes the hash again after lights, viewpoints or placement of a finished scene were changed. */
void gw_scene_rehash(gw_scene *scene);

#endif
