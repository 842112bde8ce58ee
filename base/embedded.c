#include "base/embedded.h"

#include <stdlib.h>
#include <string.h>

static int compare_name(const void *key, const void *element) {
    return strcmp(key, ((const gw_embedded_file *)element)->name);
}

const gw_embedded_file *gw_embedded_find(const char *name) {
    return bsearch(name, gw_embedded_files, gw_embedded_count, sizeof gw_embedded_files[0], compare_name);
}
