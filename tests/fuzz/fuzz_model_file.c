/* libFuzzer: make fuzz ONLY=model_file
 * What looks at a model file before the importer's library does, and what reads its material file beside it.
 * The first byte says which format the rest is. */
#include "build/import_internal.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const gw_model_format formats[] = {GW_FORMAT_OBJ, GW_FORMAT_PLY, GW_FORMAT_STL, GW_FORMAT_OFF};
    gw_error error = {0};
    gw_import_files files = {0};
    if (size == 0)
        return 0;
    gw_code code = gw_import_precheck(formats[data[0] % 4], data + 1, size - 1, &error);
    if ((code == GW_OK) != (error.text[0] == '\0'))
        abort();
    gw_import_mtl_scan(data + 1, size - 1, &files);
    return 0;
}
