/* Materials of KHR_materials_pbrSpecularGlossiness as metallic-roughness ones, by the conversion that the
 * Khronos group published with the extension (examples/convert-between-workflows): the metalness is solved
 * for at which a dielectric of 4 % and a metal together have the brightness of both colours. Any thread. */
#ifndef GW_BUILD_SPECULAR_GLOSSINESS_H
#define GW_BUILD_SPECULAR_GLOSSINESS_H

#include "base/image.h"
#include "base/status.h"

/* diffuse, specular: linear, 0..1; base: linear. Returns the metalness. */
float gw_specular_to_metal(const float diffuse[3], const float specular[3], float base[3]);

/* The same for pictures, sRGB-encoded colours: diffuse (alpha kept; NULL: white) times diffuse_factor, and
 * specular with glossiness in alpha (NULL: white) times factor (glossiness last). Makes a base colour and a
 * metallic-roughness picture (green: roughness, blue: metalness) of the size of the first that is given. */
gw_code gw_specular_pictures(const gw_image *diffuse, const float diffuse_factor[3], const gw_image *specular,
                             const float factor[4], gw_image *base, gw_image *metallic_roughness,
                             gw_error *error);

#endif
