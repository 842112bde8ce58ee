/* The numbers behind a glTF file's accessors: buffers (the BIN chunk, data: URIs, files beside the model) and
 * the accessors in them, every component type, interleaved and sparse. Reads untrusted bytes: nothing is read
 * outside a buffer, whatever the JSON says. Any thread. */
#ifndef GW_BUILD_GLTF_DATA_H
#define GW_BUILD_GLTF_DATA_H

#include "base/file.h"
#include "base/status.h"
#include "build/gltf.h"

#include <stddef.h>
#include <stdint.h>

/* Buffers are read when they are first asked for. */
typedef struct gw_gltf_data {
    const gw_gltf *gltf;
    const char *folder; /* where buffer files are; NULL: they are not looked for */
    gw_bytes *buffers;  /* [buffer_count] */
    size_t buffer_count;
} gw_gltf_data;

/* gltf and folder must outlive *data. */
gw_code gw_gltf_data_open(const gw_gltf *gltf, const char *folder, gw_gltf_data *data, gw_error *error);
void gw_gltf_data_close(gw_gltf_data *data);

/* The file that a picture is in, as the JSON spells it, or NULL when its bytes are in the glTF file or its
 * buffers: then gw_gltf_image_bytes() copies them (still packed as PNG or JPEG). */
const char *gw_gltf_image_file(const gw_gltf *gltf, size_t image);
gw_code gw_gltf_image_bytes(gw_gltf_data *data, size_t image, gw_bytes *out, gw_error *error);

/* Elements of an accessor; 0 when there is no such accessor. */
size_t gw_gltf_count(const gw_gltf *gltf, size_t accessor);

/* All numbers of an accessor, `components` to the element (its type must have so many), as
 * [count][components]; normalised integers become -1..1 or 0..1. All are finite. what names it in messages.
 * free(*out). */
gw_code gw_gltf_numbers(gw_gltf_data *data, size_t accessor, size_t components, const char *what, float **out,
                        size_t *count, gw_error *error);

/* The same for whole numbers without normalisation (joints). */
gw_code gw_gltf_integers(gw_gltf_data *data, size_t accessor, size_t components, const char *what,
                         uint32_t **out, size_t *count, gw_error *error);

#endif
