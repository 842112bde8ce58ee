/* Radiance pictures (.hdr, .pic: RGBE, flat or run-length coded), as Ward, "Real Pixels", Graphics Gems II,
 * 1991, and the program's later run-length form have them. Reads untrusted bytes; any thread. */
#ifndef GW_BUILD_RADIANCE_HDR_H
#define GW_BUILD_RADIANCE_HDR_H

#include "base/image.h"
#include "base/status.h"

#include <stddef.h>

enum { GW_HDR_MAXIMUM_SIDE = 8192 };

/* Four bytes a pixel: red, green and blue with one exponent, value = (byte) 2^(exponent - 136), 0 where the
 * exponent is 0; rows from the top, the scene's EXPOSURE already divided out of *exposure. On failure *out is
 * empty. */
gw_code gw_hdr_decode(const void *bytes, size_t size, gw_image *out, double *exposure, gw_error *error);

#endif
