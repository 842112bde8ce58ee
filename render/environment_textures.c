/* See environment_textures.h. */
#include "render/environment_textures.h"

#include "base/memory.h"
#include "base/portable_math.h"
#include "build/gpu_types.h"
#include "shaders/common/frame.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Wider pictures are halved: 4096 columns are finer than 0.1 degrees. Lights are looked for at 0.7 degrees.
 */
enum { MOST_SEEN_WIDTH = 4096, MOST_CUT_WIDTH = 512 };

static GLuint create_texture(GLenum target) {
    GLuint texture = 0;
    glCreateTextures(target, 1, &texture);
    glTextureParameteri(texture, GL_TEXTURE_WRAP_S, GL_REPEAT);
    glTextureParameteri(texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    return texture;
}

/* Uploads the map and its halves; it is 1 x 1 then. */
static gw_code upload_seen(gw_radiance_map *map, gw_environment_textures *out, gw_error *error) {
    GLsizei levels = 1;
    while (map->width >> levels)
        ++levels;
    out->height = map->height;
    out->seen = create_texture(GL_TEXTURE_2D);
    glTextureParameteri(out->seen, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTextureStorage2D(out->seen, levels, GL_RGB9_E5, (GLsizei)map->width, (GLsizei)map->height);
    for (GLint level = 0; level < levels; ++level) {
        glTextureSubImage2D(out->seen, level, 0, 0, (GLsizei)map->width, (GLsizei)map->height, GL_RGB,
                            GL_FLOAT, map->texels);
        out->bytes += (uint64_t)map->width * map->height * 4;
        gw_radiance_map_halve(map);
    }
    return gw_gl_check("uploading the environment", error);
}

static gw_code upload_blurred(const gw_radiance_map *map, gw_environment_textures *out, gw_error *error) {
    const GLsizei width = GW_ENVIRONMENT_WIDTH, height = GW_ENVIRONMENT_WIDTH / 2;
    float *texels = NULL;
    double mean[3];
    gw_radiance_map_mean(map, mean);
    for (int i = 0; i < 3; ++i)
        out->mean[i] = (float)mean[i];
    gw_code code =
        gw_allocate((void **)&texels, (size_t)GW_ENVIRONMENT_LAYERS * GW_ENVIRONMENT_WIDTH,
                    GW_ENVIRONMENT_WIDTH / 2 * 4 * sizeof(float), "the blurred environment", error);
    if (!code)
        code = gw_environment_blur(map, texels, error);
    if (!code) {
        out->blurred = create_texture(GL_TEXTURE_2D_ARRAY);
        glTextureParameteri(out->blurred, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        glTextureStorage3D(out->blurred, 1, GL_RGBA32F, width, height, GW_ENVIRONMENT_LAYERS);
        glTextureSubImage3D(out->blurred, 0, 0, 0, 0, width, height, GW_ENVIRONMENT_LAYERS, GL_RGBA, GL_FLOAT,
                            texels);
        out->bytes += (uint64_t)GW_ENVIRONMENT_LAYERS * GW_ENVIRONMENT_WIDTH * GW_ENVIRONMENT_WIDTH / 2 * 16;
        code = gw_gl_check("uploading the blurred environment", error);
    }
    free(texels);
    return code;
}

gw_code gw_environment_textures_init(const gw_scene *scene, uint32_t most_lights, gw_light *lights,
                                     uint32_t *light_count, gw_environment_textures *out, gw_error *error) {
    const gw_environment *environment = &scene->environment;
    gw_radiance_map seen = {0}, cut = {0};
    memset(out, 0, sizeof *out);
    *light_count = 0;
    if (!environment->rgbe.rgba)
        return GW_OK;
    const double turns = (double)environment->rotation / (2.0 * GW_PI);
    out->rotation = (float)(turns - floor(turns));
    gw_code code = gw_radiance_map_decode(environment, MOST_SEEN_WIDTH, &seen, error);
    if (!code)
        code = upload_seen(&seen, out, error);
    if (!code)
        code = gw_radiance_map_decode(environment, MOST_CUT_WIDTH, &cut, error);
    if (!code)
        code =
            gw_environment_cut(&cut, (double)environment->rotation, most_lights, lights, light_count, error);
    if (!code)
        code = upload_blurred(&cut, out, error);
    gw_radiance_map_finish(&seen);
    gw_radiance_map_finish(&cut);
    if (code)
        gw_environment_textures_finish(out);
    return code;
}

void gw_environment_textures_bind(const gw_environment_textures *textures, GLuint unit) {
    if (!textures->seen)
        return;
    glBindTextureUnit(unit, textures->seen);
    glBindTextureUnit(unit + 1, textures->blurred);
}

void gw_environment_textures_finish(gw_environment_textures *textures) {
    const GLuint names[2] = {textures->seen, textures->blurred};
    glDeleteTextures(2, names);
    memset(textures, 0, sizeof *textures);
}
