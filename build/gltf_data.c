#include "build/gltf_data.h"

#include "base/memory.h"
#include "build/model_path.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const size_t maximum_buffer = (size_t)2 << 30;
static const size_t maximum_elements = (size_t)1 << 28;
static const size_t maximum_zeros = (size_t)1 << 24; /* elements that no byte of the file stands for */

enum { BYTE = 5120, UNSIGNED_BYTE, SHORT, UNSIGNED_SHORT, UNSIGNED_INT = 5125, FLOAT };

gw_code gw_gltf_data_open(const gw_gltf *gltf, const char *folder, gw_gltf_data *data, gw_error *error) {
    *data = (gw_gltf_data){.gltf = gltf, .folder = folder};
    data->buffer_count = json_array_size(json_object_get(gltf->root, "buffers"));
    return gw_allocate((void **)&data->buffers, data->buffer_count, sizeof *data->buffers, "glTF buffers",
                       error);
}

void gw_gltf_data_close(gw_gltf_data *data) {
    for (size_t i = 0; data->buffers && i < data->buffer_count; i++)
        gw_bytes_finish(&data->buffers[i]);
    free(data->buffers);
    *data = (gw_gltf_data){0};
}

static const json_t *entry(const gw_gltf *gltf, const char *list, size_t index) {
    return json_array_get(json_object_get(gltf->root, list), index);
}

/* A whole number of an object, `missing` when it has none; gw_gltf_open has checked sign and size. */
static size_t size_of(const json_t *object, const char *key, size_t missing) {
    const json_t *value = json_object_get(object, key);
    return json_is_integer(value) && json_integer_value(value) >= 0 ? (size_t)json_integer_value(value)
                                                                    : missing;
}

size_t gw_gltf_count(const gw_gltf *gltf, size_t accessor) {
    return size_of(entry(gltf, "accessors", accessor), "count", 0);
}

/* --- buffers --- */

static int digit_of(char letter) {
    if (letter >= 'A' && letter <= 'Z')
        return letter - 'A';
    if (letter >= 'a' && letter <= 'z')
        return letter - 'a' + 26;
    if (letter >= '0' && letter <= '9')
        return letter - '0' + 52;
    return letter == '+' ? 62 : letter == '/' ? 63 : -1;
}

/* "data:...;base64,TEXT". Ends at the first letter that is not base64's. kind: buffer or image. */
static gw_code decode_uri(const char *uri, const char *kind, size_t index, gw_bytes *out, gw_error *error) {
    const char *comma = strchr(uri, ',');
    if (!comma || comma - uri < 7 || strncmp(comma - 7, ";base64", 7) != 0)
        return gw_fail(error, GW_BAD_INPUT, "glTF %s %zu: its data: text is not base64", kind, index);
    const char *text = comma + 1;
    const size_t length = strlen(text);
    gw_code code = gw_allocate((void **)&out->data, length / 4 * 3 + 4, 1, "glTF data", error);
    uint32_t bits = 0;
    for (size_t i = 0; code == GW_OK && i < length && digit_of(text[i]) >= 0; i++) {
        bits = bits << 6 | (uint32_t)digit_of(text[i]);
        if (i % 4 > 0) /* 6, 12, 18 and 24 bits are there; whole bytes leave */
            out->data[out->size++] = (uint8_t)(bits >> (i % 4 == 1 ? 4 : i % 4 == 2 ? 2 : 0));
    }
    return code;
}

static gw_code read_file(const gw_gltf_data *data, const char *uri, gw_bytes *out, gw_error *error) {
    char *name = gw_copy_text(uri), *path = NULL;
    if (!name)
        return gw_fail(error, GW_MACHINE, "out of memory for a file name");
    gw_uri_decode(name);
    gw_code code = gw_model_path(data->folder, name, &path, error);
    if (code == GW_OK)
        code = gw_file_read(path, maximum_buffer, out, error);
    free(path);
    free(name);
    return code;
}

/* The bytes of a buffer: *begin stays valid while data is open. */
static gw_code buffer_bytes(gw_gltf_data *data, size_t index, const uint8_t **begin, size_t *size,
                            gw_error *error) {
    if (index >= data->buffer_count)
        return gw_fail(error, GW_BAD_INPUT, "glTF: there is no buffer %zu", index);
    const char *uri = json_string_value(json_object_get(entry(data->gltf, "buffers", index), "uri"));
    gw_bytes *bytes = &data->buffers[index];
    gw_code code = GW_OK;
    if (!uri && index == 0 && data->gltf->chunk) {
        *begin = data->gltf->chunk;
        *size = data->gltf->chunk_size;
        return GW_OK;
    }
    if (!bytes->data && uri && strncmp(uri, "data:", 5) == 0)
        code = decode_uri(uri, "buffer", index, bytes, error);
    else if (!bytes->data && uri && data->folder)
        code = read_file(data, uri, bytes, error);
    else if (!bytes->data)
        code = gw_fail(error, GW_BAD_INPUT, "glTF buffer %zu names no file that can be read", index);
    *begin = bytes->data;
    *size = bytes->size;
    return code;
}

/* --- pictures --- */

const char *gw_gltf_image_file(const gw_gltf *gltf, size_t image) {
    const char *uri = json_string_value(json_object_get(entry(gltf, "images", image), "uri"));
    return uri && strncmp(uri, "data:", 5) != 0 ? uri : NULL;
}

gw_code gw_gltf_image_bytes(gw_gltf_data *data, size_t image, gw_bytes *out, gw_error *error) {
    const json_t *object = entry(data->gltf, "images", image);
    const char *uri = json_string_value(json_object_get(object, "uri"));
    *out = (gw_bytes){0};
    if (uri)
        return decode_uri(uri, "image", image, out, error);
    const size_t view_index = size_of(object, "bufferView", SIZE_MAX);
    const json_t *view = entry(data->gltf, "bufferViews", view_index);
    if (!view)
        return gw_fail(error, GW_BAD_INPUT, "glTF image %zu names neither a file nor a bufferView", image);
    const uint8_t *bytes = NULL;
    size_t size = 0;
    gw_code code = buffer_bytes(data, size_of(view, "buffer", SIZE_MAX), &bytes, &size, error);
    if (code != GW_OK)
        return code;
    const size_t begin = size_of(view, "byteOffset", 0), length = size_of(view, "byteLength", 0);
    if (begin > size || length > size - begin)
        return gw_fail(error, GW_BAD_INPUT, "glTF image %zu reaches beyond its buffer of %zu bytes", image,
                       size);
    code = gw_allocate((void **)&out->data, length + 1, 1, "embedded texture", error);
    if (code == GW_OK) {
        memcpy(out->data, bytes + begin, length);
        out->size = length;
    }
    return code;
}

/* --- accessors --- */

static size_t bytes_of(size_t kind) {
    return kind <= UNSIGNED_BYTE ? 1 : kind <= UNSIGNED_SHORT ? 2 : 4;
}

static size_t components_of(const char *type) {
    static const struct {
        const char *name;
        size_t count;
    } types[] = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};
    for (size_t i = 0; type && i < sizeof types / sizeof *types; i++)
        if (strcmp(type, types[i].name) == 0)
            return types[i].count;
    return 0;
}

/* Rows of `row` bytes that an object with a bufferView and a byteOffset describes. */
typedef struct rows {
    const uint8_t *first;
    size_t stride;
} rows;

/* GW_OK with first == NULL when the object names no view: all is zero then. */
static gw_code find_rows(gw_gltf_data *data, const json_t *object, size_t count, size_t row, const char *what,
                         rows *out, gw_error *error) {
    const size_t view_index = size_of(object, "bufferView", SIZE_MAX);
    *out = (rows){0};
    if (view_index == SIZE_MAX || count == 0)
        return GW_OK;
    const json_t *view = entry(data->gltf, "bufferViews", view_index);
    const uint8_t *bytes = NULL;
    size_t size = 0;
    gw_code code = buffer_bytes(data, size_of(view, "buffer", SIZE_MAX), &bytes, &size, error);
    if (code != GW_OK)
        return code;
    const size_t stride = size_of(view, "byteStride", 0) ? size_of(view, "byteStride", 0) : row;
    const size_t begin = size_of(view, "byteOffset", 0), inner = size_of(object, "byteOffset", 0);
    if (begin > size || inner > size - begin || row > size - begin - inner ||
        count - 1 > (size - begin - inner - row) / stride)
        return gw_fail(error, GW_BAD_INPUT, "glTF: %s reach beyond their buffer of %zu bytes", what, size);
    *out = (rows){bytes + begin + inner, stride};
    return GW_OK;
}

static uint32_t read_integer(const uint8_t *at, size_t kind) {
    const size_t bytes = bytes_of(kind);
    uint32_t value = 0;
    for (size_t i = 0; i < bytes; i++)
        value |= (uint32_t)at[i] << (8 * i);
    return value;
}

static float read_number(const uint8_t *at, size_t kind, int normalized) {
    const uint32_t bits = read_integer(at, kind);
    float value;
    switch (kind) {
    case BYTE:
        return normalized ? fmaxf((float)(int8_t)bits / 127.0f, -1.0f) : (float)(int8_t)bits;
    case UNSIGNED_BYTE:
        return normalized ? (float)bits / 255.0f : (float)bits;
    case SHORT:
        return normalized ? fmaxf((float)(int16_t)bits / 32767.0f, -1.0f) : (float)(int16_t)bits;
    case UNSIGNED_SHORT:
        return normalized ? (float)bits / 65535.0f : (float)bits;
    case UNSIGNED_INT:
        return (float)bits;
    default:
        memcpy(&value, &bits, sizeof value);
        return value;
    }
}

/* How elements are turned into 32-bit words: integers as they are, numbers as float bits. */
typedef struct reading {
    size_t accessor, components, count, kind;
    int normalized, integers;
    const char *what;
    uint32_t *words; /* [count][components] */
} reading;

static void read_row(const reading *job, const uint8_t *from, uint32_t *to) {
    for (size_t k = 0; k < job->components; k++) {
        const uint8_t *at = from + k * bytes_of(job->kind);
        const float number = job->integers ? 0.0f : read_number(at, job->kind, job->normalized);
        if (job->integers)
            to[k] = read_integer(at, job->kind);
        else
            memcpy(&to[k], &number, sizeof number);
    }
}

/* Elements that replace those of the view. */
static gw_code read_sparse(gw_gltf_data *data, const json_t *sparse, const reading *job, gw_error *error) {
    const json_t *indices = json_object_get(sparse, "indices");
    const size_t count = size_of(sparse, "count", 0), kind = size_of(indices, "componentType", 0);
    rows index_rows = {0}, value_rows = {0};
    if (kind != UNSIGNED_BYTE && kind != UNSIGNED_SHORT && kind != UNSIGNED_INT)
        return gw_fail(error, GW_BAD_INPUT, "glTF accessor %zu: its sparse indices have type %zu",
                       job->accessor, kind);
    gw_code code = find_rows(data, indices, count, bytes_of(kind), "sparse indices", &index_rows, error);
    if (code == GW_OK)
        code = find_rows(data, json_object_get(sparse, "values"), count,
                         bytes_of(job->kind) * job->components, "sparse values", &value_rows, error);
    if (code == GW_OK && count > 0 && (!index_rows.first || !value_rows.first))
        code = gw_fail(error, GW_BAD_INPUT, "glTF accessor %zu: its sparse part names no bufferView",
                       job->accessor);
    for (size_t i = 0; code == GW_OK && i < count; i++) {
        const size_t target = read_integer(index_rows.first + i * index_rows.stride, kind);
        if (target >= job->count)
            return gw_fail(error, GW_BAD_INPUT, "glTF accessor %zu: sparse index %zu is not below %zu",
                           job->accessor, target, job->count);
        read_row(job, value_rows.first + i * value_rows.stride, job->words + target * job->components);
    }
    return code;
}

static gw_code check_type(const json_t *accessor, reading *job, gw_error *error) {
    const char *type = json_string_value(json_object_get(accessor, "type"));
    job->count = size_of(accessor, "count", 0);
    job->kind = size_of(accessor, "componentType", 0);
    job->normalized = json_is_true(json_object_get(accessor, "normalized"));
    if (!accessor || components_of(type) != job->components)
        return gw_fail(error, GW_BAD_INPUT,
                       "glTF accessor %zu (%s) has %s elements instead of %zu numbers each", job->accessor,
                       job->what, type ? type : "no", job->components);
    if (job->kind < BYTE || job->kind > FLOAT || job->kind == UNSIGNED_INT - 1 ||
        (job->integers && job->kind == FLOAT))
        return gw_fail(error, GW_BAD_INPUT, "glTF accessor %zu (%s) has componentType %zu", job->accessor,
                       job->what, job->kind);
    if (job->count > (json_object_get(accessor, "bufferView") ? maximum_elements : maximum_zeros))
        return gw_fail(error, GW_BAD_INPUT, "glTF accessor %zu (%s) has %zu elements, more than can be",
                       job->accessor, job->what, job->count);
    return GW_OK;
}

static gw_code read_words(gw_gltf_data *data, reading *job, gw_error *error) {
    const json_t *accessor = entry(data->gltf, "accessors", job->accessor);
    const json_t *sparse = json_object_get(accessor, "sparse");
    rows from = {0};
    gw_code code = check_type(accessor, job, error);
    if (code == GW_OK)
        code = find_rows(data, accessor, job->count, bytes_of(job->kind) * job->components, job->what, &from,
                         error);
    if (code == GW_OK)
        code = gw_allocate((void **)&job->words, job->count, job->components * sizeof *job->words, job->what,
                           error);
    for (size_t i = 0; code == GW_OK && from.first && i < job->count; i++)
        read_row(job, from.first + i * from.stride, job->words + i * job->components);
    if (code == GW_OK && sparse)
        code = read_sparse(data, sparse, job, error);
    if (code != GW_OK) {
        free(job->words);
        job->words = NULL;
    }
    return code;
}

gw_code gw_gltf_integers(gw_gltf_data *data, size_t accessor, size_t components, const char *what,
                         uint32_t **out, size_t *count, gw_error *error) {
    reading job = {.accessor = accessor, .components = components, .integers = 1, .what = what};
    gw_code code = read_words(data, &job, error);
    *out = job.words;
    *count = code == GW_OK ? job.count : 0;
    return code;
}

gw_code gw_gltf_numbers(gw_gltf_data *data, size_t accessor, size_t components, const char *what, float **out,
                        size_t *count, gw_error *error) {
    reading job = {.accessor = accessor, .components = components, .what = what};
    gw_code code = read_words(data, &job, error);
    *out = (float *)(void *)job.words;
    *count = code == GW_OK ? job.count : 0;
    for (size_t i = 0; i < *count * components; i++)
        if (!isfinite((*out)[i])) {
            free(*out);
            *out = NULL;
            *count = 0;
            return gw_fail(error, GW_BAD_INPUT, "glTF accessor %zu (%s): number %zu is not finite", accessor,
                           what, i);
        }
    return code;
}
