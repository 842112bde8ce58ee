/* The files that assimp may open: the main file from memory, others only in and round the model's folder. */
#include "build/import_internal.h"

#include "base/memory.h"
#include "build/model_path.h"

#include <assimp/cfileio.h>
#include <stdlib.h>
#include <string.h>

typedef struct open_file {
    struct aiFile interface; /* first, so that its address is the file's */
    gw_bytes owned;          /* empty for the main file */
    const uint8_t *data;
    size_t size, at;
} open_file;

static size_t read_items(struct aiFile *file, char *out, size_t size, size_t count) {
    open_file *self = (open_file *)(void *)file;
    if (size == 0)
        return 0;
    size_t whole = (self->size - self->at) / size;
    whole = whole < count ? whole : count;
    memcpy(out, self->data + self->at, whole * size);
    self->at += whole * size;
    return whole;
}

static size_t refuse_write(struct aiFile *file, const char *data, size_t size, size_t count) {
    (void)file, (void)data, (void)size, (void)count;
    return 0;
}

static size_t tell(struct aiFile *file) {
    return ((open_file *)(void *)file)->at;
}

static size_t whole_size(struct aiFile *file) {
    return ((open_file *)(void *)file)->size;
}

static aiReturn seek(struct aiFile *file, size_t offset, enum aiOrigin origin) {
    open_file *self = (open_file *)(void *)file;
    const size_t base = origin == aiOrigin_SET ? 0 : origin == aiOrigin_CUR ? self->at : self->size;
    const size_t target =
        base + offset; /* an offset that stands for a negative number wraps round as it should */
    if (target > self->size)
        return aiReturn_FAILURE;
    self->at = target;
    return aiReturn_SUCCESS;
}

static void flush(struct aiFile *file) {
    (void)file;
}

/* The name without the model's folder, which assimp puts in front. */
static const char *relative_name(const gw_import_files *files, const char *path) {
    const size_t length = strlen(files->folder);
    if (strncmp(path, files->folder, length) == 0 && path[length] == '/')
        return path + length + 1;
    if (strncmp(path, "./", 2) == 0)
        return path + 2;
    return path;
}

static gw_code read_other(gw_import_files *files, const char *path, gw_bytes *out, gw_error *error) {
    char *allowed = NULL;
    char *name = gw_copy_text(relative_name(files, path));
    if (!name)
        return gw_fail(error, GW_MACHINE, "out of memory for a file name");
    gw_code code = gw_model_path(files->folder, name, &allowed, error);
    if (code == GW_OK && !gw_file_exists(allowed)) { /* names in glTF are URIs */
        free(allowed);
        allowed = NULL;
        gw_uri_decode(name);
        code = gw_model_path(files->folder, name, &allowed, error);
    }
    if (code == GW_OK)
        code = gw_file_read(allowed, files->limit, out, error);
    free(allowed);
    free(name);
    return code;
}

static struct aiFile *open_path(struct aiFileIO *io, const char *path, const char *mode) {
    gw_import_files *files = (gw_import_files *)(void *)io->UserData;
    gw_error error = {0};
    if (!strchr(mode, 'r'))
        return NULL;
    open_file *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    if (strcmp(path, files->main_name) == 0) {
        self->data = files->main.data;
        self->size = files->main.size;
    } else if (read_other(files, path, &self->owned, &error) == GW_OK && self->owned.size > 0) {
        self->data = self->owned.data;
        self->size = self->owned.size;
        if (gw_path_has_extension(path, ".mtl"))
            gw_import_mtl_scan(self->data, self->size, files);
    } else {
        if (!files->missing)
            files->missing = gw_copy_text(relative_name(files, path));
        files->missing_count++;
        gw_bytes_finish(&self->owned);
        free(self);
        return NULL;
    }
    self->interface = (struct aiFile){.ReadProc = read_items,
                                      .WriteProc = refuse_write,
                                      .TellProc = tell,
                                      .FileSizeProc = whole_size,
                                      .SeekProc = seek,
                                      .FlushProc = flush};
    return &self->interface;
}

static void close_file(struct aiFileIO *io, struct aiFile *file) {
    open_file *self = (open_file *)(void *)file;
    (void)io;
    if (self)
        gw_bytes_finish(&self->owned);
    free(self);
}

struct aiFileIO gw_import_file_io(gw_import_files *files) {
    return (struct aiFileIO){.OpenProc = open_path, .CloseProc = close_file, .UserData = (char *)files};
}
