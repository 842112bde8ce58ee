#include "wall/present_image.h"

#include <inttypes.h>

gw_code gw_present_image_create(const uint32_t size[2], gw_present_image *out, gw_error *error) {
    out->size[0] = size[0];
    out->size[1] = size[1];
    glCreateTextures(GL_TEXTURE_2D, 1, &out->texture);
    glTextureStorage2D(out->texture, 1, GL_RGBA8, (GLsizei)size[0], (GLsizei)size[1]);
    glTextureParameteri(out->texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTextureParameteri(out->texture, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTextureParameteri(out->texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTextureParameteri(out->texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glCreateFramebuffers(1, &out->framebuffer);
    glNamedFramebufferTexture(out->framebuffer, GL_COLOR_ATTACHMENT0, out->texture, 0);
    gw_code code = gw_gl_check("making a picture for a window", error);
    if (!code &&
        glCheckNamedFramebufferStatus(out->framebuffer, GL_READ_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        code = gw_fail(error, GW_MACHINE,
                       "the driver cannot copy pictures of %" PRIu32 "x%" PRIu32 " px to a window", size[0],
                       size[1]);
    if (code)
        gw_present_image_finish(out);
    return code;
}

void gw_present_image_finish(gw_present_image *image) {
    glDeleteFramebuffers(1, &image->framebuffer);
    glDeleteTextures(1, &image->texture);
    *image = (gw_present_image){0};
}

void gw_present_image_write(const gw_present_image *image, const uint8_t *rgba) {
    glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTextureSubImage2D(image->texture, 0, 0, 0, (GLsizei)image->size[0], (GLsizei)image->size[1], GL_RGBA,
                        GL_UNSIGNED_BYTE, rgba);
}

void gw_present_image_copy(const gw_present_image *image, const gw_present_place *place,
                           const uint32_t window[2]) {
    const int same = place->width == image->size[0] && place->height == image->size[1];
    /* GL counts rows from the bottom. */
    const GLint top = (GLint)window[1] - place->y;
    glMemoryBarrier(GL_FRAMEBUFFER_BARRIER_BIT);
    glBlitNamedFramebuffer(image->framebuffer, 0, 0, 0, (GLint)image->size[0], (GLint)image->size[1],
                           place->x, top, place->x + (GLint)place->width, top - (GLint)place->height,
                           GL_COLOR_BUFFER_BIT, same ? GL_NEAREST : GL_LINEAR);
}
