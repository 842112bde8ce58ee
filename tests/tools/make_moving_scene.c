/* Writes configs/scenes/moving.gltf anew: make_moving_scene FILE. A scene of 4 s in which everything happens
 * that can move: a box on a cubic path that turns, a tube that three joints bend, a bead that is a point at
 * time 0 and jumps to its size, a smaller box that rides on the first, and a floor that stays. All numbers
 * are made by formula. */
#include "base/file.h"
#include "base/portable_math.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAXIMUM_BYTES = 1 << 18, MAXIMUM_PARTS = 64, AROUND = 16, RINGS = 25, JOINTS = 3 };

/* The binary buffer, with a view and an accessor for every part of it. */
typedef struct buffer {
    uint8_t bytes[MAXIMUM_BYTES];
    size_t size;
    struct {
        size_t offset, size, count;
        int component;
        const char *type;
        char bounds[160];
    } parts[MAXIMUM_PARTS];
    int part_count;
} buffer;

static int add(buffer *to, const void *data, size_t count, size_t row, int component, const char *type) {
    if (to->size + count * row + 4 > MAXIMUM_BYTES || to->part_count == MAXIMUM_PARTS)
        abort();
    const int part = to->part_count++;
    to->parts[part].offset = to->size;
    to->parts[part].size = count * row;
    to->parts[part].count = count;
    to->parts[part].component = component;
    to->parts[part].type = type;
    memcpy(to->bytes + to->size, data, count * row);
    to->size = (to->size + count * row + 3) & ~(size_t)3;
    return part;
}

static int add_floats(buffer *to, const float *values, size_t count, size_t width) {
    static const char *const types[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
    return add(to, values, count, width * sizeof *values, 5126, width == 16 ? "MAT4" : types[width]);
}

/* Positions and times say where they lie. */
static int add_bounded(buffer *to, const float *values, size_t count, size_t width) {
    const int part = add_floats(to, values, count, width);
    float low[3] = {0}, high[3] = {0};
    for (size_t k = 0; k < width; k++)
        low[k] = high[k] = values[k];
    for (size_t i = 0; i < count * width; i++) {
        low[i % width] = values[i] < low[i % width] ? values[i] : low[i % width];
        high[i % width] = values[i] > high[i % width] ? values[i] : high[i % width];
    }
    if (width == 1)
        snprintf(to->parts[part].bounds, sizeof to->parts[part].bounds, ", \"min\": [%.9g], \"max\": [%.9g]",
                 (double)low[0], (double)high[0]);
    else
        snprintf(to->parts[part].bounds, sizeof to->parts[part].bounds,
                 ", \"min\": [%.9g, %.9g, %.9g], \"max\": [%.9g, %.9g, %.9g]", (double)low[0], (double)low[1],
                 (double)low[2], (double)high[0], (double)high[1], (double)high[2]);
    return part;
}

/* --- meshes: accessors of positions, normals and indices stand one after the other --- */

static int add_box(buffer *to) {
    float positions[24][3], normals[24][3];
    uint16_t indices[36];
    for (int side = 0; side < 6; side++) {
        const int axis = side / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
        const float sign = side % 2 ? 1.0f : -1.0f;
        for (int corner = 0; corner < 4; corner++) {
            float *p = positions[side * 4 + corner], *n = normals[side * 4 + corner];
            p[axis] = sign;
            p[u] = corner & 1 ? 1.0f : -1.0f;
            p[v] = corner & 2 ? 1.0f : -1.0f;
            n[axis] = sign;
            n[u] = n[v] = 0.0f;
        }
        static const int outward[2][6] = {{0, 2, 1, 1, 2, 3}, {0, 1, 2, 1, 3, 2}};
        for (int k = 0; k < 6; k++)
            indices[side * 6 + k] = (uint16_t)(side * 4 + outward[side % 2][k]);
    }
    const int first = add_bounded(to, positions[0], 24, 3);
    add_floats(to, normals[0], 24, 3);
    add(to, indices, 36, sizeof *indices, 5123, "SCALAR");
    return first;
}

static int add_floor(buffer *to) {
    static const float positions[4][3] = {{-3, 0, -2}, {3, 0, -2}, {-3, 0, 2}, {3, 0, 2}};
    static const float normals[4][3] = {{0, 1, 0}, {0, 1, 0}, {0, 1, 0}, {0, 1, 0}};
    static const uint16_t indices[6] = {0, 2, 1, 1, 2, 3};
    const int first = add_bounded(to, positions[0], 4, 3);
    add_floats(to, normals[0], 4, 3);
    add(to, indices, 6, sizeof *indices, 5123, "SCALAR");
    return first;
}

/* A tube of height 2 along y with joints at heights 0, 2/3 and 4/3; weights go from joint to joint over a
 * third of a section. Joints and weights follow the indices. */
static int add_tube(buffer *to) {
    static float positions[RINGS * AROUND][3], normals[RINGS * AROUND][3], weights[RINGS * AROUND][4];
    static uint8_t joints[RINGS * AROUND][4];
    static uint16_t indices[(RINGS - 1) * AROUND * 6];
    size_t count = 0;
    for (int ring = 0; ring < RINGS; ring++)
        for (int i = 0; i < AROUND; i++) {
            const int v = ring * AROUND + i;
            const double angle = 2.0 * GW_PI * i / AROUND, height = 2.0 * ring / (RINGS - 1);
            const double section = height * 1.5; /* 0..3 */
            const int joint = section >= 2.0 ? 2 : section >= 1.0 ? 1 : 0;
            double share = (section - joint - 0.8) / 0.4; /* of the next joint, from 0.8 to 1.2 */
            share = share < 0.0 ? 0.0 : share;
            positions[v][0] = (float)(0.25 * gw_cos(angle));
            positions[v][1] = (float)height;
            positions[v][2] = (float)(0.25 * gw_sin(angle));
            normals[v][0] = (float)gw_cos(angle);
            normals[v][2] = (float)gw_sin(angle);
            if (section - joint < 0.2 && joint > 0) {
                joints[v][0] = (uint8_t)(joint - 1);
                joints[v][1] = (uint8_t)joint;
                share = (section - joint + 0.2) / 0.4;
            } else {
                joints[v][0] = (uint8_t)joint;
                joints[v][1] = (uint8_t)(joint < JOINTS - 1 ? joint + 1 : joint);
                share = joint < JOINTS - 1 ? share : 0.0;
            }
            weights[v][0] = (float)(1.0 - share);
            weights[v][1] = (float)share;
        }
    for (int ring = 0; ring + 1 < RINGS; ring++)
        for (int i = 0; i < AROUND; i++) {
            const int a = ring * AROUND + i, b = ring * AROUND + (i + 1) % AROUND;
            const int corners[6] = {a, a + AROUND, b, b, a + AROUND, b + AROUND};
            for (int k = 0; k < 6; k++)
                indices[count++] = (uint16_t)corners[k];
        }
    const int first = add_bounded(to, positions[0], RINGS * AROUND, 3);
    add_floats(to, normals[0], RINGS * AROUND, 3);
    add(to, indices, count, sizeof *indices, 5123, "SCALAR");
    add(to, joints, RINGS * AROUND, 4, 5121, "VEC4");
    add_floats(to, weights[0], RINGS * AROUND, 4);
    return first;
}

static int add_inverse_binds(buffer *to) {
    float columns[JOINTS][16] = {{0}};
    for (int j = 0; j < JOINTS; j++) {
        for (int i = 0; i < 4; i++)
            columns[j][i * 5] = 1.0f;
        columns[j][13] = (float)(-2.0 * j / 3.0);
    }
    return add_floats(to, columns[0], JOINTS, 16);
}

/* --- motions --- */

/* Four quarters of a turn about y, and back at the start. */
static int add_turns(buffer *to) {
    float values[5][4] = {{0}};
    for (int key = 0; key < 5; key++) {
        values[key][1] = (float)gw_sin(0.25 * GW_PI * key);
        values[key][3] = (float)gw_cos(0.25 * GW_PI * key);
    }
    return add_floats(to, values[0], 5, 4);
}

/* Bends by up to 50 degrees about z, to and fro. */
static int add_bends(buffer *to) {
    static const double degrees[5] = {0, 50, 0, -50, 0};
    float values[5][4] = {{0}};
    for (int key = 0; key < 5; key++) {
        values[key][2] = (float)gw_sin(degrees[key] * GW_PI / 360.0);
        values[key][3] = (float)gw_cos(degrees[key] * GW_PI / 360.0);
    }
    return add_floats(to, values[0], 5, 4);
}

/* A circle of radius 1 about (-1, 0.6, 0) as a cubic curve: tangent in, value, tangent out. */
static int add_circle(buffer *to) {
    float values[5][3][3] = {{{0}}};
    for (int key = 0; key < 5; key++) {
        const double angle = 0.5 * GW_PI * key, speed = 0.5 * GW_PI;
        for (int side = 0; side < 3; side += 2) {
            values[key][side][0] = (float)(-speed * gw_sin(angle));
            values[key][side][2] = (float)(speed * gw_cos(angle));
        }
        values[key][1][0] = (float)(gw_cos(angle) - 1.0);
        values[key][1][1] = 0.6f;
        values[key][1][2] = (float)gw_sin(angle);
    }
    return add_floats(to, values[0][0], 15, 3);
}

/* --- the text --- */

static void put_base64(FILE *file, const buffer *from) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < from->size; i += 3) {
        uint32_t bits = 0;
        const size_t left = from->size - i < 3 ? from->size - i : 3;
        for (size_t k = 0; k < 3; k++)
            bits = bits << 8 | (k < left ? from->bytes[i + k] : 0u);
        for (size_t k = 0; k < 4; k++)
            fputc(k <= left ? digits[bits >> (18 - 6 * k) & 63] : '=', file);
    }
}

static void put_buffer(FILE *file, const buffer *from) {
    fprintf(file, "\"accessors\": [\n");
    for (int i = 0; i < from->part_count; i++)
        fprintf(file, "  {\"bufferView\": %d, \"componentType\": %d, \"count\": %zu, \"type\": \"%s\"%s}%s\n",
                i, from->parts[i].component, from->parts[i].count, from->parts[i].type, from->parts[i].bounds,
                i + 1 < from->part_count ? "," : "");
    fprintf(file, "],\n\"bufferViews\": [\n");
    for (int i = 0; i < from->part_count; i++)
        fprintf(file, "  {\"buffer\": 0, \"byteOffset\": %zu, \"byteLength\": %zu}%s\n",
                from->parts[i].offset, from->parts[i].size, i + 1 < from->part_count ? "," : "");
    fprintf(file, "],\n\"buffers\": [{\"byteLength\": %zu, \"uri\": \"data:application/octet-stream;base64,",
            from->size);
    put_base64(file, from);
    fprintf(file, "\"}]\n");
}

static void put_mesh(FILE *file, const char *name, int first, int skinned, int material, const char *end) {
    char joints[64] = "";
    if (skinned)
        snprintf(joints, sizeof joints, ", \"JOINTS_0\": %d, \"WEIGHTS_0\": %d", first + 3, first + 4);
    fprintf(file,
            "  {\"name\": \"%s\", \"primitives\": [{\"attributes\": {\"POSITION\": %d, \"NORMAL\": %d%s}, "
            "\"indices\": %d, \"material\": %d}]}%s\n",
            name, first, first + 1, joints, first + 2, material, end);
}

static const char nodes[] =
    "\"nodes\": [\n"
    "  {\"name\": \"floor\", \"mesh\": 0},\n"
    "  {\"name\": \"box\", \"mesh\": 1, \"translation\": [0, 0.6, 0], \"scale\": [0.4, 0.4, 0.4], "
    "\"children\": [2]},\n"
    "  {\"name\": \"rider\", \"mesh\": 1, \"translation\": [0, 1.5, 0], \"scale\": [0.5, 0.5, 0.5]},\n"
    "  {\"name\": \"tube\", \"mesh\": 2, \"skin\": 0},\n"
    "  {\"name\": \"root\", \"translation\": [1.4, 0, 0], \"children\": [5]},\n"
    "  {\"name\": \"middle\", \"translation\": [0, 0.66666667, 0], \"children\": [6]},\n"
    "  {\"name\": \"tip\", \"translation\": [0, 0.66666667, 0]},\n"
    "  {\"name\": \"bead\", \"mesh\": 1, \"translation\": [0.2, 1.6, 0.8], \"scale\": [0, 0, 0]}\n"
    "],\n"
    "\"scenes\": [{\"nodes\": [0, 1, 3, 4, 7]}],\n"
    "\"scene\": 0,\n"
    "\"materials\": [\n"
    "  {\"name\": \"grey\", \"pbrMetallicRoughness\": {\"baseColorFactor\": [0.45, 0.45, 0.42, 1], "
    "\"metallicFactor\": 0, \"roughnessFactor\": 0.9}},\n"
    "  {\"name\": \"red\", \"pbrMetallicRoughness\": {\"baseColorFactor\": [0.7, 0.12, 0.08, 1], "
    "\"metallicFactor\": 0, \"roughnessFactor\": 0.5}},\n"
    "  {\"name\": \"blue\", \"doubleSided\": true, \"pbrMetallicRoughness\": {\"baseColorFactor\": "
    "[0.1, 0.3, 0.7, 1], \"metallicFactor\": 0, \"roughnessFactor\": 0.4}}\n"
    "],\n";

static void put_channel(FILE *file, int sampler, int node, const char *path, const char *end) {
    fprintf(file, "    {\"sampler\": %d, \"target\": {\"node\": %d, \"path\": \"%s\"}}%s\n", sampler, node,
            path, end);
}

static void put_sampler(FILE *file, int times, int values, const char *curve, const char *end) {
    fprintf(file, "    {\"input\": %d, \"output\": %d, \"interpolation\": \"%s\"}%s\n", times, values, curve,
            end);
}

static void put_scene(FILE *file, buffer *data) {
    static const float times[5] = {0, 1, 2, 3, 4}, jumps[3] = {0, 1, 3};
    static const float sizes[3][3] = {{0, 0, 0}, {0.2f, 0.2f, 0.2f}, {0.1f, 0.1f, 0.1f}};
    const int floor = add_floor(data), box = add_box(data), tube = add_tube(data);
    const int binds = add_inverse_binds(data), clock = add_bounded(data, times, 5, 1);
    const int jump_clock = add_bounded(data, jumps, 3, 1), turns = add_turns(data), bends = add_bends(data);
    const int circle = add_circle(data), jump_sizes = add_floats(data, sizes[0], 3, 3);
    fprintf(file, "{\"asset\": {\"version\": \"2.0\", \"generator\": \"Gazewall make_moving_scene\"},\n");
    fputs(nodes, file);
    fprintf(file, "\"meshes\": [\n");
    put_mesh(file, "floor", floor, 0, 0, ",");
    put_mesh(file, "box", box, 0, 1, ",");
    put_mesh(file, "tube", tube, 1, 2, "");
    fprintf(file, "],\n\"skins\": [{\"joints\": [4, 5, 6], \"inverseBindMatrices\": %d}],\n", binds);
    fprintf(file, "\"animations\": [{\"name\": \"all together\",\n  \"channels\": [\n");
    put_channel(file, 0, 1, "rotation", ",");
    put_channel(file, 1, 1, "translation", ",");
    put_channel(file, 2, 5, "rotation", ",");
    put_channel(file, 2, 6, "rotation", ",");
    put_channel(file, 3, 7, "scale", "],");
    fprintf(file, "  \"samplers\": [\n");
    put_sampler(file, clock, turns, "LINEAR", ",");
    put_sampler(file, clock, circle, "CUBICSPLINE", ",");
    put_sampler(file, clock, bends, "LINEAR", ",");
    put_sampler(file, jump_clock, jump_sizes, "STEP", "]}],");
    put_buffer(file, data);
    fprintf(file, "}\n");
}

int main(int argc, char **argv) {
    static buffer data;
    gw_error error = {0};
    char *text = NULL;
    size_t size = 0;
    FILE *file = argc == 2 ? open_memstream(&text, &size) : NULL;
    if (!file) {
        fprintf(stderr, "usage: make_moving_scene FILE.gltf\n");
        return GW_BAD_INPUT;
    }
    put_scene(file, &data);
    fclose(file);
    gw_code code = gw_file_write(argv[1], text, size, &error);
    if (code != GW_OK)
        fprintf(stderr, "make_moving_scene: %s\n", error.text);
    free(text);
    return (int)code;
}
