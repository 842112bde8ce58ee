/* Which files a model may name: those in its own folder and below, and in its parent folder and below
 * ("../textures"). Any thread. */
#ifndef GW_BUILD_MODEL_PATH_H
#define GW_BUILD_MODEL_PATH_H

#include "base/status.h"

/* folder + name as a path; backslashes become slashes. GW_BAD_INPUT when name is absolute or climbs further
 * up. Free *out. */
gw_code gw_model_path(const char *folder, const char *name, char **out, gw_error *error);

/* Decodes %20 and its like in place (file names in glTF are URIs). */
void gw_uri_decode(char *text);

#endif
