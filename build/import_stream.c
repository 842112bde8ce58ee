#include "build/import_stream.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the stream copies little-endian memory");

static const char stream_magic[8] = {'G', 'W', 'M', 'O', 'D', 'E', 'L', '\n'};
enum { STREAM_VERSION = 5, MAXIMUM_TEXT = 4096, TRAILER = 0x0a444e45 /* "END\n" */ };
enum {
    HAS_NORMALS = 1,
    HAS_TEXCOORDS = 2,
    HAS_COLORS = 4,
    WANTS_NORMALS = 8,
    HAS_SECOND_TEXCOORDS = 16,
    HAS_EXTENSIONS = 32,
    HAS_TANGENTS = 64,
    ALL_FLAGS = 127
};

/* --- writing: the same walk is done twice, first only to count --- */

typedef struct writer {
    FILE *file; /* NULL: count only */
    uint64_t size;
    int failed;
} writer;

static void put(writer *to, const void *data, size_t size) {
    to->size += size;
    if (to->file && size > 0 && fwrite(data, 1, size, to->file) != size)
        to->failed = 1;
}

static void put_u32(writer *to, uint32_t value) {
    put(to, &value, sizeof value);
}

static void put_u64(writer *to, uint64_t value) {
    put(to, &value, sizeof value);
}

static void put_text(writer *to, const char *text) {
    size_t length = text ? strlen(text) : 0;
    if (length > MAXIMUM_TEXT)
        length = MAXIMUM_TEXT;
    put_u32(to, (uint32_t)length);
    put(to, text, length);
}

static void put_geometry(writer *to, const gw_source_model *model) {
    const gw_scene *scene = model->scene;
    const size_t vertices = scene->vertex_count, triangles = scene->triangle_count;
    put_u32(to, scene->vertex_count);
    put_u32(to, scene->triangle_count);
    put_u32(to, (scene->normals ? HAS_NORMALS : 0u) | (scene->texcoords ? HAS_TEXCOORDS : 0u) |
                    (scene->colors ? HAS_COLORS : 0u) | (model->wants_normals ? WANTS_NORMALS : 0u) |
                    (scene->second_texcoords ? HAS_SECOND_TEXCOORDS : 0u) |
                    (scene->extensions ? HAS_EXTENSIONS : 0u) | (scene->tangents ? HAS_TANGENTS : 0u));
    put_u64(to, scene->dropped.bad_index);
    put_u64(to, scene->dropped.not_triangle);
    put(to, model->world, vertices * 3 * sizeof(double));
    if (scene->normals)
        put(to, scene->normals, vertices * 3 * sizeof(float));
    if (scene->texcoords)
        put(to, scene->texcoords, vertices * 2 * sizeof(float));
    if (scene->second_texcoords)
        put(to, scene->second_texcoords, vertices * 2 * sizeof(float));
    if (scene->tangents)
        put(to, scene->tangents, vertices * sizeof *scene->tangents);
    if (scene->colors)
        put(to, scene->colors, vertices * 4);
    put(to, scene->triangles, triangles * sizeof *scene->triangles);
    put(to, scene->material_of, triangles * sizeof *scene->material_of);
}

static void put_materials(writer *to, const gw_source_model *model) {
    put_u32(to, model->scene->material_count);
    for (uint32_t i = 0; i < model->scene->material_count; i++) {
        const gw_material *material = &model->scene->materials[i];
        const gw_material_source *source = &model->material_sources[i];
        put_text(to, material->name);
        put(to, material->base_color, sizeof material->base_color);
        put(to, &material->metalness, sizeof material->metalness);
        put(to, &material->roughness, sizeof material->roughness);
        put(to, material->emissive, sizeof material->emissive);
        put(to, &material->alpha_cutoff, sizeof material->alpha_cutoff);
        put_u32(to, (uint32_t)material->alpha_mode);
        put_u32(to, (uint32_t)material->two_sided);
        put_u32(to, (uint32_t)source->file_index);
        put(to, source->maps, sizeof source->maps);
        put_u32(to, (uint32_t)source->alpha_from_texture);
        put_u32(to, (uint32_t)source->normal_may_be_height);
        put(to, &source->exponent, sizeof source->exponent);
    }
    if (model->scene->extensions)
        put(to, model->scene->extensions, model->scene->material_count * sizeof(gw_material_extension));
}

static void put_sources(writer *to, const gw_source_model *model) {
    put_u32(to, model->source_count);
    for (uint32_t i = 0; i < model->source_count; i++) {
        const gw_texture_source *source = &model->sources[i];
        put_text(to, source->path);
        put_text(to, source->alpha_path);
        put_u32(to, (uint32_t)source->wrap_u);
        put_u32(to, (uint32_t)source->wrap_v);
        put_u32(to, source->raw_width);
        put_u32(to, source->raw_height);
        put_u64(to, source->size);
        put(to, source->bytes, source->size);
    }
}

static void put_rest(writer *to, const gw_scene *scene) {
    put_u32(to, scene->light_count);
    for (uint32_t i = 0; i < scene->light_count; i++) {
        put_u32(to, (uint32_t)scene->lights[i].kind);
        const gw_light *light = &scene->lights[i];
        put(to, light->vector, sizeof light->vector);
        put(to, light->color, sizeof light->color);
        put(to, light->axis, sizeof light->axis);
        put(to, light->cone, sizeof light->cone);
        put(to, &light->range, sizeof light->range);
    }
    put_u32(to, scene->viewpoint_count);
    for (uint32_t i = 0; i < scene->viewpoint_count; i++) {
        const gw_viewpoint *view = &scene->viewpoints[i];
        put_text(to, view->name);
        put(to, view->eye, sizeof view->eye);
        put(to, view->look_at, sizeof view->look_at);
        put(to, view->up, sizeof view->up);
        put(to, &view->fov, sizeof view->fov);
    }
    put_u32(to, (uint32_t)scene->note_count);
    for (size_t i = 0; i < scene->note_count; i++)
        put_text(to, scene->notes[i]);
}

static void put_spans(writer *to, const gw_source_model *model) {
    put_u32(to, model->span_count);
    put(to, model->spans, model->span_count * sizeof *model->spans);
}

static void put_model(writer *to, const gw_source_model *model, uint64_t total) {
    put(to, stream_magic, sizeof stream_magic);
    put_u32(to, STREAM_VERSION);
    put_u32(to, 0);
    put_u64(to, total);
    put_geometry(to, model);
    put_materials(to, model);
    put_sources(to, model);
    put_rest(to, model->scene);
    put_spans(to, model);
    put_u32(to, TRAILER);
}

gw_code gw_model_stream_write(FILE *file, const gw_source_model *model, gw_error *error) {
    writer counter = {0}, to = {.file = file};
    put_model(&counter, model, 0);
    put_model(&to, model, counter.size);
    if (to.failed || fflush(file) != 0)
        return gw_fail(error, GW_NO_OUTPUT,
                       "the imported model could not be handed over: the reader has gone");
    return GW_OK;
}

/* --- reading: a cursor that fails once and then yields zeros --- */

typedef struct reader {
    const uint8_t *data;
    size_t size, at;
    const char *fault; /* what was wrong first, NULL while all is well */
    gw_error *error;   /* for failures of memory */
    gw_code code;
} reader;

static void reject(reader *from, const char *fault) {
    if (!from->fault)
        from->fault = fault;
}

static void get(reader *from, void *out, size_t size) {
    if (!from->fault && size > from->size - from->at)
        reject(from, "it ends too early");
    if (from->fault) {
        memset(out, 0, size);
        return;
    }
    memcpy(out, from->data + from->at, size);
    from->at += size;
}

static uint32_t get_u32(reader *from) {
    uint32_t value;
    get(from, &value, sizeof value);
    return value;
}

static uint64_t get_u64(reader *from) {
    uint64_t value;
    get(from, &value, sizeof value);
    return value;
}

static uint32_t get_choice(reader *from, uint32_t count) {
    uint32_t value = get_u32(from);
    if (value >= count) {
        reject(from, "a choice is out of range");
        return 0;
    }
    return value;
}

/* A number of things of at least `least` bytes each, all of which must still follow. */
static uint32_t get_count(reader *from, size_t least) {
    uint32_t count = get_u32(from);
    if (!from->fault && count > (from->size - from->at) / least)
        reject(from, "a count is larger than what follows");
    return from->fault ? 0 : count;
}

static void *new_array(reader *from, size_t count, size_t row) {
    void *array = NULL;
    if (from->fault)
        return NULL;
    gw_code code = gw_allocate(&array, count, row, "imported model", from->error);
    if (code != GW_OK) {
        from->code = code;
        reject(from, "memory ran out");
    }
    return array;
}

/* count rows in one piece. */
static void *get_array(reader *from, size_t count, size_t row) {
    if (!from->fault && count > (from->size - from->at) / row)
        reject(from, "an array is larger than what follows");
    void *array = new_array(from, count, row);
    if (array)
        get(from, array, count * row);
    return array;
}

/* An owned text. */
static char *get_text(reader *from) {
    uint32_t length = get_count(from, 1);
    if (length > MAXIMUM_TEXT)
        reject(from, "a text is too long");
    char *text = new_array(from, (size_t)length + 1, 1);
    if (text)
        get(from, text, length);
    if (text && memchr(text, 0, length))
        reject(from, "a text holds a zero byte");
    return text;
}

static void get_name(reader *from, char *name, size_t size) {
    char *text = get_text(from);
    snprintf(name, size, "%s", text ? text : "");
    free(text);
}

static void get_floats(reader *from, float *values, size_t count, float minimum, float maximum) {
    get(from, values, count * sizeof *values);
    for (size_t i = 0; i < count; i++)
        if (!(values[i] >= minimum && values[i] <= maximum)) {
            values[i] = minimum;
            reject(from, "a number is out of range");
        }
}

static void get_doubles(reader *from, double *values, size_t count) {
    get(from, values, count * sizeof *values);
    for (size_t i = 0; i < count; i++)
        if (!isfinite(values[i]))
            reject(from, "a number is not finite");
}

/* Returns the flags. */
static uint32_t get_geometry(reader *from, gw_source_model *model) {
    gw_scene *scene = model->scene;
    const uint32_t vertices = get_count(from, 3 * sizeof(double));
    const uint32_t triangles = get_count(from, 4 * sizeof(uint32_t));
    const uint32_t flags = get_choice(from, ALL_FLAGS + 1);
    scene->dropped.bad_index = get_u64(from);
    scene->dropped.not_triangle = get_u64(from);
    model->world = get_array(from, vertices, 3 * sizeof(double));
    if (flags & HAS_NORMALS)
        scene->normals = get_array(from, vertices, 3 * sizeof(float));
    if (flags & HAS_TEXCOORDS)
        scene->texcoords = get_array(from, vertices, 2 * sizeof(float));
    if (flags & HAS_SECOND_TEXCOORDS)
        scene->second_texcoords = get_array(from, vertices, 2 * sizeof(float));
    if (flags & HAS_TANGENTS)
        scene->tangents = get_array(from, vertices, sizeof *scene->tangents);
    if (flags & HAS_COLORS)
        scene->colors = get_array(from, vertices, 4);
    scene->triangles = get_array(from, triangles, sizeof *scene->triangles);
    scene->material_of = get_array(from, triangles, sizeof *scene->material_of);
    model->wants_normals = (flags & WANTS_NORMALS) != 0;
    scene->vertex_count = from->fault ? 0 : vertices;
    scene->triangle_count = from->fault ? 0 : triangles;
    return flags;
}

/* Of formats that the child reads alone; they name no maps yet. */
static void get_extensions(reader *from, gw_scene *scene, uint32_t count) {
    scene->extensions = get_array(from, count, sizeof *scene->extensions);
    for (uint32_t i = 0; i < count && !from->fault; i++)
        if (gw_material_extension_fault(scene, i))
            reject(from, "a material's extension is out of range");
}

static void get_materials(reader *from, gw_source_model *model, uint32_t flags) {
    const uint32_t count = get_count(from, 64 + GW_MAP_COUNT * 4);
    model->scene->materials = new_array(from, count, sizeof *model->scene->materials);
    model->material_sources = new_array(from, count, sizeof *model->material_sources);
    for (uint32_t i = 0; i < count && !from->fault; i++) {
        gw_material *material = &model->scene->materials[i];
        gw_material_source *source = &model->material_sources[i];
        *source = gw_material_source_none();
        get_name(from, material->name, sizeof material->name);
        get_floats(from, material->base_color, 4, 0.0f, 1.0f);
        get_floats(from, &material->metalness, 1, 0.0f, 1.0f);
        get_floats(from, &material->roughness, 1, 0.0f, 1.0f);
        get_floats(from, material->emissive, 3, 0.0f, 1e30f);
        get_floats(from, &material->alpha_cutoff, 1, 0.0f, 1e30f);
        material->alpha_mode = (gw_alpha_mode)get_choice(from, GW_ALPHA_BLEND + 1);
        material->two_sided = (int32_t)get_choice(from, 2);
        material->base_color_texture = -1;
        get(from, &source->file_index, sizeof source->file_index);
        get(from, source->maps, sizeof source->maps);
        source->alpha_from_texture = (int32_t)get_choice(from, 2);
        source->normal_may_be_height = (int32_t)get_choice(from, 2);
        get_floats(from, &source->exponent, 1, 0.0f, 1e30f);
    }
    if (flags & HAS_EXTENSIONS)
        get_extensions(from, model->scene, count);
    model->scene->material_count = from->fault ? 0 : count;
}

static void get_sources(reader *from, gw_source_model *model) {
    const uint32_t count = get_count(from, 32);
    model->sources = new_array(from, count, sizeof *model->sources);
    for (uint32_t i = 0; i < count && !from->fault; i++) {
        gw_texture_source *source = &model->sources[i];
        model->source_count = i + 1;
        source->image = -1;
        source->path = get_text(from);
        source->alpha_path = get_text(from);
        source->wrap_u = (gw_wrap)get_choice(from, GW_WRAP_MIRROR + 1);
        source->wrap_v = (gw_wrap)get_choice(from, GW_WRAP_MIRROR + 1);
        source->raw_width = get_u32(from);
        source->raw_height = get_u32(from);
        source->size = get_u64(from);
        source->bytes = get_array(from, source->size, 1);
        if (source->raw_width > 0 &&
            (source->raw_width > GW_IMAGE_MAXIMUM_SIDE || source->raw_height > GW_IMAGE_MAXIMUM_SIDE ||
             source->size != (uint64_t)source->raw_width * source->raw_height * 4))
            reject(from, "a raw texture has the wrong size");
    }
}

static void check_source_indices(reader *from, const gw_source_model *model) {
    for (uint32_t i = 0; i < model->scene->material_count && !from->fault; i++) {
        const int32_t *maps = model->material_sources[i].maps;
        for (int map = 0; map < GW_MAP_COUNT; map++)
            if (maps[map] < -1 || maps[map] >= (int64_t)model->source_count)
                reject(from, "a material names a texture that is not there");
    }
}

static void get_lights(reader *from, gw_scene *scene) {
    const uint32_t count = get_count(from, 64);
    scene->lights = new_array(from, count, sizeof *scene->lights);
    for (uint32_t i = 0; i < count && !from->fault; i++) {
        gw_light *light = &scene->lights[i];
        light->kind = (gw_light_kind)get_choice(from, GW_LIGHT_SPOT + 1);
        get_doubles(from, light->vector, 3);
        get_floats(from, light->color, 3, 0.0f, 1e30f);
        get_floats(from, light->axis, 3, -1.0f, 1.0f);
        get_floats(from, light->cone, 2, 0.0f, 1.5707964f);
        get_floats(from, &light->range, 1, 0.0f, 1e30f);
        if (light->kind == GW_LIGHT_SPOT && !(light->cone[0] < light->cone[1]))
            reject(from, "a spot light's cones are no cones");
    }
    scene->light_count = from->fault ? 0 : count;
}

static void get_viewpoints(reader *from, gw_scene *scene) {
    const uint32_t count = get_count(from, 84);
    scene->viewpoints = new_array(from, count, sizeof *scene->viewpoints);
    for (uint32_t i = 0; i < count && !from->fault; i++) {
        gw_viewpoint *view = &scene->viewpoints[i];
        get_name(from, view->name, sizeof view->name);
        get_doubles(from, view->eye, 3);
        get_doubles(from, view->look_at, 3);
        get_doubles(from, view->up, 3);
        get_doubles(from, &view->fov, 1);
        if (!(view->fov >= 1.0 && view->fov <= 170.0))
            reject(from, "a viewpoint's opening angle is out of range");
    }
    scene->viewpoint_count = from->fault ? 0 : count;
}

static void get_notes(reader *from, gw_scene *scene) {
    const uint32_t count = get_count(from, 4);
    for (uint32_t i = 0; i < count && !from->fault; i++) {
        char *text = get_text(from);
        if (text && gw_scene_note(scene, from->error, "%s", text) != GW_OK) {
            from->code = GW_MACHINE;
            reject(from, "memory ran out");
        }
        free(text);
    }
}

/* Spans stand in the order of their vertices and do not overlap. */
static void get_spans(reader *from, gw_source_model *model) {
    const uint32_t count = get_count(from, sizeof *model->spans);
    model->spans = get_array(from, count, sizeof *model->spans);
    uint64_t end = 0;
    for (uint32_t i = 0; i < count && !from->fault; i++) {
        const gw_vertex_span *span = &model->spans[i];
        if (span->first < end || (uint64_t)span->first + span->count > model->scene->vertex_count)
            reject(from, "a span of vertices is out of range");
        end = (uint64_t)span->first + span->count;
    }
    model->span_count = from->fault ? 0 : count;
}

uint64_t gw_model_stream_size(const void *header) {
    const uint8_t *bytes = header;
    uint64_t size;
    uint32_t version;
    memcpy(&version, bytes + sizeof stream_magic, sizeof version);
    memcpy(&size, bytes + 16, sizeof size);
    return memcmp(bytes, stream_magic, sizeof stream_magic) == 0 && version == STREAM_VERSION ? size : 0;
}

gw_code gw_model_stream_read(const void *data, size_t size, gw_source_model **out, gw_error *error) {
    *out = NULL;
    if (size < GW_MODEL_STREAM_HEADER || gw_model_stream_size(data) != size)
        return gw_fail(error, GW_BAD_INPUT, "the importer's answer is cut or is not a model (%zu bytes)",
                       size);
    gw_source_model *model = NULL;
    gw_code code = gw_source_model_create(&model, error);
    if (code != GW_OK)
        return code;
    reader from = {
        .data = data, .size = size, .at = GW_MODEL_STREAM_HEADER, .error = error, .code = GW_BAD_INPUT};
    const uint32_t flags = get_geometry(&from, model);
    get_materials(&from, model, flags);
    get_sources(&from, model);
    check_source_indices(&from, model);
    get_lights(&from, model->scene);
    get_viewpoints(&from, model->scene);
    get_notes(&from, model->scene);
    get_spans(&from, model);
    if (get_u32(&from) != TRAILER || from.at != from.size)
        reject(&from, "it does not end where it should");
    if (from.fault) {
        gw_source_model_destroy(&model);
        if (from.code != GW_BAD_INPUT)
            return from.code; /* memory: the text is there already */
        return gw_fail(error, GW_BAD_INPUT, "the importer's answer is damaged at byte %zu: %s", from.at,
                       from.fault);
    }
    *out = model;
    return GW_OK;
}
