/* Host tool of the build: turns files into one C source that base/embedded.h looks up by name.
 *   embed_files OUTPUT.c FILE...
 * Names in the table are the paths as given (from the repository root), sorted, so that the output does not
 * depend on the order of a wildcard. Runs at build time only. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int by_name(const void *a, const void *b) {
    return strcmp(*(char *const *)a, *(char *const *)b);
}

/* Writes one array; returns its size or -1. A zero byte follows the data so that text can be used in place.
 */
static long write_array(FILE *output, const char *path, int index) {
    FILE *input = fopen(path, "rb");
    if (!input) {
        return -1;
    }
    long size = 0;
    fprintf(output, "static const unsigned char file_%d[] = {", index);
    for (int byte = fgetc(input); byte != EOF; byte = fgetc(input)) {
        fprintf(output, "%s%d,", size % 24 == 0 ? "\n" : "", byte);
        size++;
    }
    fprintf(output, "\n0};\n");
    int broken = ferror(input);
    fclose(input);
    return broken ? -1 : size;
}

int main(int argc, char **argv) {
    if (argc < 2) {
        fprintf(stderr, "usage: embed_files OUTPUT.c FILE...\n");
        return 2;
    }
    int count = argc - 2;
    char **names = argv + 2;
    qsort(names, (size_t)count, sizeof *names, by_name);
    long *sizes = calloc((size_t)count + 1, sizeof *sizes);
    FILE *output = fopen(argv[1], "w");
    if (!sizes || !output) {
        fprintf(stderr, "embed_files: %s cannot be written\n", argv[1]);
        return 1;
    }
    fprintf(output, "/* Made by shaders/embed_files.c. */\n#include \"base/embedded.h\"\n\n");
    for (int i = 0; i < count; i++) {
        sizes[i] = write_array(output, names[i], i);
        if (sizes[i] < 0) {
            fprintf(stderr, "embed_files: %s cannot be read\n", names[i]);
            fclose(output);
            remove(argv[1]);
            return 1;
        }
    }
    fprintf(output, "\nconst gw_embedded_file gw_embedded_files[] = {\n");
    for (int i = 0; i < count; i++) {
        fprintf(output, "    {\"%s\", file_%d, %ldu},\n", names[i], i, sizes[i]);
    }
    fprintf(output, "    {0, 0, 0}};\nconst size_t gw_embedded_count = %d;\n", count);
    free(sizes);
    if (fclose(output) != 0) {
        fprintf(stderr, "embed_files: %s cannot be written\n", argv[1]);
        remove(argv[1]);
        return 1;
    }
    return 0;
}
