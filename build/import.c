#include "build/import.h"

#include "base/memory.h"
#include "build/demo_scene.h"
#include "build/gltf.h"
#include "build/gltf_animation.h"
#include "build/import_internal.h"
#include "build/import_stream.h"
#include "build/yaml_scene.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const double crease_degrees = 60.0;
static const size_t maximum_gltf_file = (size_t)2 << 30;

static const struct {
    const char *extension;
    gw_model_format format;
} formats[] = {
    {".gltf", GW_FORMAT_GLTF}, {".glb", GW_FORMAT_GLTF}, {".obj", GW_FORMAT_OBJ},
    {".ply", GW_FORMAT_PLY},   {".stl", GW_FORMAT_STL},  {".off", GW_FORMAT_OFF},
};

int gw_model_format_of(const char *path, gw_model_format *format, int *packed) {
    char *plain = gw_copy_text(path);
    int found = 0;
    if (!plain)
        return 0;
    *packed = gw_path_has_extension(plain, ".gz");
    if (*packed)
        plain[strlen(plain) - 3] = '\0';
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
        if (gw_path_has_extension(plain, formats[i].extension)) {
            *format = formats[i].format;
            found = 1;
        }
    free(plain);
    return found && !(*packed && *format == GW_FORMAT_GLTF);
}

const char *gw_model_format_name(gw_model_format format) {
    static const char *const names[] = {"glTF", "OBJ", "PLY", "STL", "OFF"};
    return names[format];
}

double gw_import_time_limit(const gw_import_options *options) {
    return options->time_limit > 0.0 ? options->time_limit : 120.0;
}

uint64_t gw_import_memory_limit(const gw_import_options *options) {
    return options->memory_limit > 0 ? options->memory_limit : (uint64_t)4 << 30;
}

/* What can be said about a file before anything is started. */
static gw_code check_file(const char *path, gw_model_format *format, gw_error *error) {
    struct stat status;
    int packed;
    if (stat(path, &status) != 0)
        return gw_fail(error, GW_BAD_INPUT, "%s: the file cannot be opened: %s", path, strerror(errno));
    if (S_ISDIR(status.st_mode))
        return gw_fail(error, GW_BAD_INPUT, "%s: this is a folder; name the model file in it", path);
    if (!S_ISREG(status.st_mode))
        return gw_fail(error, GW_BAD_INPUT, "%s: this is not a regular file", path);
    if (!gw_model_format_of(path, format, &packed))
        return gw_fail(
            error, GW_BAD_INPUT,
            "%s: the format is not known by this name; known are .gltf, .glb, .obj, .ply, .stl, .off, "
            ".obj.gz, .ply.gz, .stl.gz, .off.gz, and .yaml for a scene",
            path);
    if (status.st_size == 0)
        return gw_fail(error, GW_BAD_INPUT, "%s: the file is empty", path);
    if (!gw_file_exists(path))
        return gw_fail(error, GW_BAD_INPUT, "%s: the file cannot be read: permission denied", path);
    return GW_OK;
}

/* The JSON of a glTF file, checked; *bytes must outlive *gltf. */
static gw_code open_gltf(const char *path, const char *folder, gw_bytes *bytes, gw_gltf *gltf,
                         gw_error *error) {
    gw_code code = gw_file_read(path, maximum_gltf_file, bytes, error);
    if (code == GW_OK)
        code = gw_import_precheck(GW_FORMAT_GLTF, bytes->data, bytes->size, error);
    if (code == GW_OK)
        code = gw_gltf_open(bytes->data, bytes->size, folder, gltf, error);
    if (code == GW_OK) /* before the child runs: a required extension decides whether it can help at all */
        code = gw_gltf_check_extensions(gltf, NULL, error);
    return code;
}

static gw_code read_child(const char *path, const gw_import_options *options, gw_source_model **out,
                          gw_error *error) {
    gw_bytes stream = {0};
    gw_code code = gw_import_spawn(path, options, &stream, error);
    if (code == GW_OK)
        code = gw_model_stream_read(stream.data, stream.size, out, error);
    gw_bytes_finish(&stream);
    return code;
}

static gw_code make_normals(gw_source_model *model, const gw_log *log, gw_error *error) {
    if (!model->wants_normals)
        return GW_OK;
    gw_log_progress(log, "making smooth normals", 0.0);
    gw_code code = gw_source_model_smooth_normals(model, crease_degrees, error);
    if (code == GW_OK)
        code = gw_scene_note(model->scene, error,
                             "no shading normals in the file: smooth ones are made, with creases at %g "
                             "degrees",
                             crease_degrees);
    return code;
}

/* What the child cannot carry of a glTF file. */
static gw_code complete_gltf(const gw_gltf *gltf, const char *folder, const gw_import_options *options,
                             gw_source_model *model, gw_error *error) {
    gw_code code = gw_gltf_apply(gltf, folder, model, error);
    if (code == GW_OK)
        code = gw_gltf_check_extensions(gltf, model, error);
    if (code == GW_OK)
        code = gw_gltf_animate(gltf, folder, options->animation, model, error);
    return code;
}

static gw_code import_checked(const char *path, gw_model_format format, const gw_import_options *options,
                              gw_source_model **model, gw_error *error) {
    gw_bytes bytes = {0};
    gw_gltf gltf = {0};
    char *folder = gw_path_folder(path);
    gw_code code = folder ? GW_OK : gw_fail(error, GW_MACHINE, "out of memory for a file name");
    if (code == GW_OK && format == GW_FORMAT_GLTF)
        code = open_gltf(path, folder, &bytes, &gltf, error);
    if (code == GW_OK)
        code = read_child(path, options, model, error);
    if (code == GW_OK && gltf.root)
        code = complete_gltf(&gltf, folder, options, *model, error);
    if (code == GW_OK)
        code = gw_import_textures(*model, path, options->log, error);
    if (code == GW_OK)
        code = make_normals(*model, options->log, error);
    gw_gltf_close(&gltf);
    gw_bytes_finish(&bytes);
    free(folder);
    return code;
}

gw_code gw_import_model(const char *path, const gw_import_options *options, gw_source_model **out,
                        gw_error *error) {
    gw_model_format format;
    gw_source_model *model = NULL;
    *out = NULL;
    gw_code code = check_file(path, &format, error);
    if (code != GW_OK)
        return code;
    code = import_checked(path, format, options, &model, error);
    if (code != GW_OK) {
        gw_source_model_destroy(&model);
        return error && strncmp(error->text, path, strlen(path)) == 0 ? code : gw_context(error, "%s", path);
    }
    gw_source_model_drop_sources(model);
    *out = model;
    return GW_OK;
}

gw_code gw_import_note_units(gw_scene *scene, const char *path, gw_error *error) {
    gw_model_format format;
    int packed;
    if (!gw_model_format_of(path, &format, &packed) || format == GW_FORMAT_GLTF)
        return GW_OK;
    return gw_scene_note(scene, error,
                         "%s: %s files name no unit and no up axis: metres and y up are assumed",
                         gw_path_name(path), gw_model_format_name(format));
}

gw_code gw_import_finish(gw_source_model **model, const char *path, const gw_import_options *options,
                         gw_scene **out, gw_error *error) {
    gw_scene *scene = (*model)->scene;
    scene->outlier_extents = options->outlier_extents;
    gw_log_progress(options->log, "checking and sorting triangles", 0.0);
    scene->path = gw_copy_text(path);
    gw_code code = scene->path ? gw_scene_finish(scene, (*model)->world, error)
                               : gw_fail(error, GW_MACHINE, "out of memory for a file name");
    if (code == GW_OK) {
        *out = scene;
        (*model)->scene = NULL;
    }
    gw_source_model_destroy(model);
    gw_log_progress(options->log, "checking and sorting triangles", 1.0);
    return code;
}

static gw_code import_bare_model(const char *path, const gw_import_options *options, gw_scene **out,
                                 gw_error *error) {
    gw_source_model *model = NULL;
    gw_scene *scene = NULL;
    gw_code code = gw_import_model(path, options, &model, error);
    if (code != GW_OK)
        return code;
    model->scene->placement = (gw_placement){.kind = GW_PLACE_FIT_BEHIND_WALL, .scale = 1.0};
    const gw_scene_given given = {.lights = model->scene->light_count > 0};
    code = gw_import_note_units(model->scene, path, error);
    if (code == GW_OK)
        code = gw_import_finish(&model, path, options, &scene, error);
    if (code == GW_OK)
        code = gw_scene_defaults(scene, &given, error);
    gw_source_model_destroy(&model);
    if (code != GW_OK) {
        gw_scene_destroy(&scene);
        return gw_context(error, "%s", path);
    }
    *out = scene;
    return GW_OK;
}

static gw_code import_any(const char *path, const gw_import_options *options, gw_scene **out,
                          gw_error *error) {
    if (!path || strcmp(path, "demo") == 0)
        return gw_demo_scene(out, error);
    if (gw_path_has_extension(path, ".yaml") || gw_path_has_extension(path, ".yml"))
        return gw_yaml_scene_load(path, options, out, error);
    return import_bare_model(path, options, out, error);
}

/* A choice that only a scene which moves can follow. */
static int names_one(const char *animation) {
    return animation && strcmp(animation, "none") != 0 && strcmp(animation, "all") != 0;
}

gw_code gw_import(const char *path, const gw_import_options *options, gw_scene **out, gw_error *error) {
    static const gw_import_options no_options = {0};
    gw_error spare = {0};
    *out = NULL;
    if (!options)
        options = &no_options;
    if (!error)
        error = &spare;
    gw_code code = import_any(path, options, out, error);
    if (code == GW_OK && !(*out)->animation && names_one(options->animation)) {
        gw_scene_destroy(out);
        code = gw_fail(error, GW_BAD_INPUT, "%s: nothing in it moves, so no animation '%.60s' can play",
                       path ? path : "demo", options->animation);
    }
    return code;
}
