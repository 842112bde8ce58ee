/* The import child: reads one model file with assimp under limits of time and memory and writes it to
 * standard output. Nothing here is trusted by the parent; a crash or a hang costs only this process. */
#include "build/import.h"

#include "base/memory.h"
#include "build/gltf.h"
#include "build/gltf_material.h"
#include "build/import_internal.h"
#include "build/import_stream.h"

#include <assimp/cfileio.h>
#include <assimp/cimport.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

enum { MAXIMUM_LOG_NOTES = 8, LOG_NOTE_SIZE = 300 };

/* Warnings of assimp, which tell what it left out. */
typedef struct log_notes {
    char texts[MAXIMUM_LOG_NOTES][LOG_NOTE_SIZE];
    int count, more;
} log_notes;

static void set_limits(double seconds, uint64_t memory) {
    const struct rlimit none = {0, 0};
    const struct rlimit time = {(rlim_t)seconds + 1, (rlim_t)seconds + 2};
    setrlimit(RLIMIT_CORE, &none);
    setrlimit(RLIMIT_CPU, &time);
#if !defined(__SANITIZE_ADDRESS__) &&                                                                        \
    !defined(__SANITIZE_THREAD__) /* a sanitizer's shadow needs all of the address space */
    const struct rlimit space = {memory, memory};
    setrlimit(RLIMIT_AS, &space);
#else
    (void)memory;
#endif
}

/* Warnings of assimp about what is carried here all the same. */
static int is_known(const char *text) {
    static const char *const beginnings[] = {"OBJ: unexpected illumination model",
                                             "OBJ: No object detected to attach"};
    for (size_t i = 0; i < sizeof beginnings / sizeof *beginnings; i++)
        if (strncmp(text, beginnings[i], strlen(beginnings[i])) == 0)
            return 1;
    return 0;
}

/* Keeps warnings and errors: "Warn,  T0: text" or "Error, T0: text". */
static void keep_log_line(const char *line, char *user) {
    log_notes *notes = (log_notes *)(void *)user;
    if (strncmp(line, "Warn", 4) != 0 && strncmp(line, "Error", 5) != 0)
        return;
    const char *text = strstr(line, ": ");
    text = text ? text + 2 : line;
    const int length = (int)strcspn(text, "\n");
    if (is_known(text))
        return;
    for (int i = 0; i < notes->count; i++)
        if (strncmp(notes->texts[i], text, (size_t)length) == 0)
            return;
    if (notes->count == MAXIMUM_LOG_NOTES)
        notes->more++;
    else
        snprintf(notes->texts[notes->count++], LOG_NOTE_SIZE, "%.*s", length, text);
}

static gw_code add_log_notes(const log_notes *log, gw_source_model *model, gw_error *error) {
    gw_code code = GW_OK;
    for (int i = 0; code == GW_OK && i < log->count; i++)
        code = gw_scene_note(model->scene, error, "importer: %s", log->texts[i]);
    if (code == GW_OK && log->more)
        code = gw_scene_note(model->scene, error, "importer: %d more warnings", log->more);
    return code;
}

static gw_code list_texcoord_sets(const gw_gltf *gltf, gw_import_files *files, gw_error *error) {
    const json_t *materials = json_object_get(gltf->root, "materials");
    files->texcoord_set_count = json_array_size(materials);
    gw_code code = gw_allocate((void **)&files->texcoord_sets, files->texcoord_set_count,
                               sizeof *files->texcoord_sets, "sets of texture coordinates", error);
    for (size_t i = 0; code == GW_OK && i < files->texcoord_set_count; i++)
        gw_gltf_texcoord_sets(json_array_get(materials, i), files->texcoord_sets[i]);
    return code;
}

/* glTF: marks the materials, and what moves, so that their places in the file's lists survive assimp. */
static gw_code mark_gltf(gw_import_files *files, gw_error *error) {
    gw_gltf gltf;
    gw_bytes marked;
    gw_code code = gw_gltf_open(files->main.data, files->main.size, files->folder, &gltf, error);
    if (code != GW_OK)
        return code;
    files->promised_triangles = gw_gltf_promised_triangles(&gltf);
    code = list_texcoord_sets(&gltf, files, error);
    if (code == GW_OK)
        code = gw_gltf_mark(&gltf, &marked, error);
    gw_gltf_close(&gltf);
    if (code != GW_OK)
        return code;
    gw_bytes_finish(&files->main);
    files->main = marked;
    return GW_OK;
}

/* Reads, expands, checks and marks the main file. */
static gw_code load_main(const char *path, gw_model_format format, int packed, uint64_t memory,
                         gw_import_files *files, gw_error *error) {
    files->limit = (size_t)(memory / 2);
    gw_code code = gw_file_read(path, files->limit, &files->main, error);
    if (code != GW_OK)
        return code;
    if (packed) {
        gw_bytes expanded = {0};
        code = gw_gunzip(files->main.data, files->main.size, (size_t)(memory / 4), "the gzip data", &expanded,
                         error);
        gw_bytes_finish(&files->main);
        files->main = expanded;
    }
    if (code == GW_OK && files->main.size == 0)
        return gw_fail(error, GW_BAD_INPUT, "the file is empty");
    if (code == GW_OK)
        code = gw_import_precheck(format, files->main.data, files->main.size, error);
    if (code == GW_OK && format == GW_FORMAT_GLTF)
        code = mark_gltf(files, error);
    files->main_name = gw_copy_text(path);
    if (code == GW_OK && !files->main_name)
        code = gw_fail(error, GW_MACHINE, "out of memory for a file name");
    if (code == GW_OK && packed)
        files->main_name[strlen(files->main_name) - 3] = '\0'; /* ".gz" */
    return code;
}

static gw_code fail_import(const gw_import_files *files, uint64_t memory, gw_error *error) {
    const char *text = aiGetErrorString();
    if (strstr(text, "bad_alloc") || strstr(text, "length_error"))
        return gw_fail(error, GW_BAD_INPUT,
                       "it needs more than the %llu MiB of memory that the importer may use",
                       (unsigned long long)(memory >> 20));
    if (files->missing)
        return gw_fail(error, GW_BAD_INPUT, "it cannot be read: %s (the file '%s' could not be opened)", text,
                       files->missing);
    return gw_fail(error, GW_BAD_INPUT, "it cannot be read: %s", *text ? text : "no reason was given");
}

/* assimp leaves out triangles with indices out of range and only warns: they are counted as what they are. */
static void count_lost_triangles(const gw_import_files *files, const struct aiScene *read,
                                 gw_source_model *model) {
    uint64_t present = 0;
    for (unsigned i = 0; i < read->mNumMeshes; i++)
        for (unsigned f = 0; f < read->mMeshes[i]->mNumFaces; f++)
            present += read->mMeshes[i]->mFaces[f].mNumIndices == 3;
    if (files->promised_triangles > present)
        model->scene->dropped.bad_index += files->promised_triangles - present;
}

/* assimp's identical-vertex step is left out: gw_scene_finish merges vertices exactly. */
static gw_code import(gw_import_files *files, gw_model_format format, uint64_t memory, gw_source_model *model,
                      gw_error *error) {
    log_notes notes = {.count = 0};
    struct aiFileIO io = gw_import_file_io(files);
    struct aiLogStream stream = {.callback = keep_log_line, .user = (char *)&notes};
    struct aiPropertyStore *properties = aiCreatePropertyStore();
    if (!properties)
        return gw_fail(error, GW_MACHINE, "out of memory for the importer");
    aiSetImportPropertyInteger(properties, AI_CONFIG_IMPORT_NO_SKELETON_MESHES, 1);
    aiAttachLogStream(&stream);
    const struct aiScene *read =
        aiImportFileExWithProperties(files->main_name, aiProcess_Triangulate, &io, properties);
    gw_code code = GW_OK;
    if (!read || !read->mRootNode)
        code = fail_import(files, memory, error);
    else
        code = gw_import_convert(read, format, files, model, error);
    if (code == GW_OK)
        count_lost_triangles(files, read, model);
    if (code == GW_OK && files->missing)
        code = gw_scene_note(model->scene, error, "the file '%s' that the model names could not be opened%s",
                             files->missing, files->missing_count > 1 ? ", nor could others" : "");
    if (code == GW_OK)
        code = add_log_notes(&notes, model, error);
    aiReleaseImport(read);
    aiDetachAllLogStreams();
    aiReleasePropertyStore(properties);
    return code;
}

static gw_code run(const char *path, uint64_t memory, FILE *output, gw_error *error) {
    gw_model_format format;
    int packed;
    if (!gw_model_format_of(path, &format, &packed))
        return gw_fail(error, GW_BAD_INPUT, "its format is not known");
    char *folder = gw_path_folder(path);
    if (!folder)
        return gw_fail(error, GW_MACHINE, "out of memory for a file name");
    gw_import_files files = {.folder = folder};
    gw_source_model *model = NULL;
    gw_code code = gw_source_model_create(&model, error);
    if (code == GW_OK)
        code = load_main(path, format, packed, memory, &files, error);
    if (code == GW_OK)
        code = import(&files, format, memory, model, error);
    if (code == GW_OK)
        code = gw_model_stream_write(output, model, error);
    gw_source_model_destroy(&model);
    gw_bytes_finish(&files.main);
    free(files.main_name);
    free(files.texcoord_sets);
    free(files.missing);
    free(folder);
    return code;
}

int gw_import_child(int argc, char **argv) {
    gw_error error = {0};
    if (argc != 4) {
        fprintf(
            stderr,
            "error: import-child takes FILE SECONDS BYTES and is meant to be started by Gazewall itself\n");
        return GW_BAD_INPUT;
    }
    prctl(PR_SET_PDEATHSIG, SIGKILL); /* an importer must not outlive the one who asked */
    const uint64_t memory = strtoull(argv[3], NULL, 10);
    set_limits(strtod(argv[2], NULL), memory);
    FILE *output = fdopen(dup(STDOUT_FILENO), "wb");
    if (!output ||
        dup2(STDERR_FILENO, STDOUT_FILENO) < 0) { /* what assimp prints must not get into the stream */
        fprintf(stderr, "error: standard output cannot be used: %s\n", strerror(errno));
        return GW_MACHINE;
    }
    gw_code code = run(argv[1], memory, output, &error);
    fclose(output);
    if (code != GW_OK)
        fprintf(stderr, "error: %s\n", error.text);
    return code;
}
