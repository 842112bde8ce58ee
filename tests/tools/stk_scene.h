/* A track of SuperTuxKart, flattened: scene.xml and the library nodes that it places, as models and instances
 * of them in right-handed metres with y up. Reads untrusted files. Any thread. */
#ifndef GW_TESTS_TOOLS_STK_SCENE_H
#define GW_TESTS_TOOLS_STK_SCENE_H

#include "base/status.h"
#include "tests/tools/stk_mesh.h"

#include <stddef.h>
#include <stdint.h>

/* A mesh file, read once. folder: where it lies, the first place to look for its textures. */
typedef struct stk_model {
    char *folder, *path;
    stk_mesh mesh;
} stk_model;

/* Rows of an affine matrix for column vectors. */
typedef struct stk_matrix {
    double m[3][4];
} stk_matrix;

typedef struct stk_instance {
    uint32_t model;
    stk_matrix matrix;
} stk_instance;

/* A lamp. The game's falloff is 20 energy / (1 + d^2), so 20 energy is its intensity. */
typedef struct stk_light {
    double position[3];
    float color[3]; /* 0..1 */
    float intensity;
} stk_light;

typedef struct stk_scene {
    char *data, *track; /* folders: of the game's data, of the track in it */
    stk_model *models;
    stk_instance *instances;
    stk_light *lights;
    size_t model_count, model_capacity, instance_count, instance_capacity, light_count, light_capacity;
    double sun_direction[3]; /* in which it shines; not of unit length */
    float sun_color[3];      /* 0..1; zero: no sun */
} stk_scene;

/* data: the folder with tracks/, library/ and textures/. Parts that are only there for the physics are left
 * out; both ways of driving ("if") are taken; of a group of levels of detail, the finest. */
gw_code stk_scene_read(const char *data, const char *track, stk_scene *out, gw_error *error);
void stk_scene_finish(stk_scene *scene);

/* Folder + plain name as a path; GW_BAD_INPUT when the name is empty or could lead out of the folder. */
gw_code stk_path(const char *folder, const char *name, char **out, gw_error *error);

#endif
