/* A scene's environment on the GPU. Belongs to the thread of its GL device. */
#ifndef GW_RENDER_ENVIRONMENT_TEXTURES_H
#define GW_RENDER_ENVIRONMENT_TEXTURES_H

#include "base/gl.h"
#include "render/environment.h"

typedef struct gw_environment_textures {
    GLuint seen;     /* radiance by direction, with mip levels; 0 where there is no environment */
    GLuint blurred;  /* array of what gw_environment_blur() makes of what no light has taken */
    uint32_t height; /* of the first, texels */
    float rotation;  /* turns, 0..1 */
    float mean[3];   /* irradiance over pi of what no light has taken, over all directions */
    uint64_t bytes;  /* on the GPU */
} gw_environment_textures;

/* Nothing is made for a scene without environment. lights, with room for GW_MAXIMUM_ENVIRONMENT_LIGHTS: what
 * gw_environment_cut() takes out. */
gw_code gw_environment_textures_init(const gw_scene *scene, uint32_t most_lights, gw_light *lights,
                                     uint32_t *light_count, gw_environment_textures *out, gw_error *error);
/* To texture units unit and unit + 1. */
void gw_environment_textures_bind(const gw_environment_textures *textures, GLuint unit);
void gw_environment_textures_finish(gw_environment_textures *textures);

#endif
