/* Prints docs/settings.md: `make docs`. */
#include "base/settings_page.h"

#include <stdio.h>
#include <stdlib.h>

int main(void) {
    char *page = gw_settings_page();
    if (!page || fputs(page, stdout) == EOF || fflush(stdout) != 0) {
        fprintf(stderr, "write_settings: the page cannot be written\n");
        free(page);
        return 1;
    }
    free(page);
    return 0;
}
