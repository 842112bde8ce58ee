#include "build/yaml_environment.h"

#include "base/file.h"
#include "base/portable_math.h"
#include "build/radiance_hdr.h"

#include <stdlib.h>

enum { MAXIMUM_FILE = 512 << 20 };

static gw_code load_picture(const char *path, gw_environment *out, gw_error *error) {
    gw_bytes bytes = {0};
    double exposure = 1.0;
    if (gw_path_has_extension(path, ".exr"))
        return gw_fail(error, GW_BAD_INPUT, "OpenEXR pictures are not read: convert it to Radiance (.hdr)");
    gw_code code = gw_file_read(path, MAXIMUM_FILE, &bytes, error);
    if (code == GW_OK)
        code = gw_hdr_decode(bytes.data, bytes.size, &out->rgbe, &exposure, error);
    gw_bytes_finish(&bytes);
    if (code == GW_OK && out->rgbe.width != 2 * out->rgbe.height)
        code = gw_fail(error, GW_BAD_INPUT,
                       "it is %u x %u pixels: a picture of all directions is twice as wide as high",
                       out->rgbe.width, out->rgbe.height);
    out->scale = (float)(out->scale / exposure);
    return code;
}

gw_code gw_yaml_read_environment(const gw_yaml_node *node, const char *path, gw_environment *out,
                                 gw_error *error) {
    static const char *const keys[] = {"file", "intensity", "rotation"};
    double intensity = 1.0, rotation = 0.0;
    gw_code code = gw_yaml_expect(node, GW_YAML_MAP, "environment", error);
    if (code == GW_OK)
        code = gw_yaml_check_keys(node, keys, sizeof keys / sizeof *keys, error);
    const gw_yaml_node *strength = gw_yaml_find(node, "intensity"), *turn = gw_yaml_find(node, "rotation");
    const char *name =
        code == GW_OK && gw_yaml_find(node, "file") ? gw_yaml_text(gw_yaml_find(node, "file")) : NULL;
    if (code == GW_OK && !name)
        code = gw_yaml_fail(node, error, "key 'file' is missing: the name of a Radiance picture (.hdr)");
    if (code == GW_OK && strength)
        code = gw_yaml_number(strength, "intensity", 0.0, 1e6, &intensity, error);
    if (code == GW_OK && turn)
        code = gw_yaml_number(turn, "rotation", -360.0, 360.0, &rotation, error);
    if (code != GW_OK)
        return code;
    char *folder = gw_path_folder(path), *file = folder ? gw_path_join(folder, name) : NULL;
    out->scale = (float)intensity;
    out->rotation = (float)(rotation * GW_PI / 180.0);
    code =
        file ? load_picture(file, out, error) : gw_fail(error, GW_MACHINE, "out of memory for a file name");
    if (code != GW_OK)
        gw_context(error, "environment '%s'", name);
    free(file);
    free(folder);
    return code;
}
