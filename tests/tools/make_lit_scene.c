/* Writes the example of lights anew: make_lit_scene FOLDER. lit.gltf and lit.bin are a floor with a wall, a
 * ball of glass, a ball of polished metal, a block and a panel that glows; lit-sky.hdr is an evening sky with
 * a sun, by formula. */
#include "base/file.h"
#include "base/portable_math.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_POINTS = 8192, MOST_INDICES = 32768, MESHES = 5, AROUND = 72, RINGS = 36, SKY = 128 };

typedef struct mesh {
    uint32_t first_point, points, first_index, indices;
    int smooth; /* its points have normals */
    float low[3], high[3];
} mesh;

static float points[MOST_POINTS][3], normals[MOST_POINTS][3]; /* normals: 0 but of smooth meshes */
static uint16_t indices[MOST_INDICES];                        /* from each mesh's first point */
static mesh meshes[MESHES];
static uint32_t point_count, index_count;

static uint16_t add_point(mesh *m, double x, double y, double z) {
    const float p[3] = {(float)x, (float)y, (float)z};
    if (point_count == MOST_POINTS)
        abort();
    for (int i = 0; i < 3; ++i) {
        m->low[i] = m->points == 0 ? p[i] : fminf(m->low[i], p[i]);
        m->high[i] = m->points == 0 ? p[i] : fmaxf(m->high[i], p[i]);
    }
    memcpy(points[point_count++], p, sizeof p);
    return (uint16_t)m->points++;
}

static void add_triangle(mesh *m, uint16_t a, uint16_t b, uint16_t c) {
    if (index_count + 3 > MOST_INDICES)
        abort();
    indices[index_count++] = a;
    indices[index_count++] = b;
    indices[index_count++] = c;
    m->indices += 3;
}

/* Seen from where u, v turn to the left. */
static void add_quad(mesh *m, const double at[3], const double u[3], const double v[3]) {
    uint16_t corner[4];
    for (int k = 0; k < 4; ++k) {
        const int along = k == 1 || k == 2, up = k >= 2;
        corner[k] = add_point(m, at[0] + along * u[0] + up * v[0], at[1] + along * u[1] + up * v[1],
                              at[2] + along * u[2] + up * v[2]);
    }
    add_triangle(m, corner[0], corner[1], corner[2]);
    add_triangle(m, corner[0], corner[2], corner[3]);
}

static void add_ball(mesh *m, double x, double y, double z, double radius) {
    const uint16_t top = add_point(m, x, y + radius, z), bottom = add_point(m, x, y - radius, z);
    for (int ring = 1; ring < RINGS; ++ring)
        for (int k = 0; k < AROUND; ++k) {
            const double down = GW_PI * ring / RINGS, turn = 2.0 * GW_PI * k / AROUND;
            add_point(m, x + radius * gw_sin(down) * gw_cos(turn), y + radius * gw_cos(down),
                      z - radius * gw_sin(down) * gw_sin(turn));
        }
    m->smooth = 1;
    for (uint32_t i = m->first_point; i < point_count; ++i) {
        const double out[3] = {points[i][0] - x, points[i][1] - y, points[i][2] - z};
        const double length = sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2]);
        for (int axis = 0; axis < 3; ++axis)
            normals[i][axis] = (float)(out[axis] / length);
    }
    for (int ring = 0; ring < RINGS; ++ring)
        for (int k = 0; k < AROUND; ++k) {
            const int next = (k + 1) % AROUND, above = 2 + (ring - 1) * AROUND, below = above + AROUND;
            if (ring > 0)
                add_triangle(m, (uint16_t)(above + k), (uint16_t)(ring + 1 < RINGS ? below + k : bottom),
                             (uint16_t)(above + next));
            if (ring + 1 < RINGS)
                add_triangle(m, (uint16_t)(ring > 0 ? above + next : top), (uint16_t)(below + k),
                             (uint16_t)(below + next));
        }
}

static void add_block(mesh *m, const double low[3], const double size[3]) {
    for (int axis = 0; axis < 3; ++axis)
        for (int far = 0; far < 2; ++far) {
            double at[3], u[3] = {0}, v[3] = {0};
            memcpy(at, low, sizeof at);
            at[axis] += far ? size[axis] : 0.0;
            u[(axis + (far ? 1 : 2)) % 3] = size[(axis + (far ? 1 : 2)) % 3];
            v[(axis + (far ? 2 : 1)) % 3] = size[(axis + (far ? 2 : 1)) % 3];
            add_quad(m, at, u, v);
        }
}

static void make_meshes(void) {
    for (int i = 0; i < MESHES; ++i) {
        mesh *m = &meshes[i];
        m->first_point = point_count;
        m->first_index = index_count;
        if (i == 0) {
            add_quad(m, (const double[]){-9, 0, 3}, (const double[]){18, 0, 0}, (const double[]){0, 0, -12});
            add_quad(m, (const double[]){-3, 0, -2}, (const double[]){6, 0, 0}, (const double[]){0, 1.4, 0});
        } else if (i == 1) {
            add_ball(m, -0.15, 0.4, 0.5, 0.4);
        } else if (i == 2) {
            add_ball(m, 0.95, 0.45, -0.5, 0.45);
        } else if (i == 3) {
            add_block(m, (const double[]){-1.5, 0, -0.9}, (const double[]){0.7, 0.9, 0.6});
        } else { /* looks down */
            add_quad(m, (const double[]){-0.7, 1.8, -0.6}, (const double[]){1.2, 0, 0},
                     (const double[]){0, 0, 0.5});
        }
    }
}

static const char materials[] =
    "{\"name\": \"plaster\", \"pbrMetallicRoughness\": {\"baseColorFactor\": [0.7, 0.68, 0.65, 1], "
    "\"metallicFactor\": 0, \"roughnessFactor\": 0.9}},\n"
    "    {\"name\": \"glass\", \"pbrMetallicRoughness\": {\"metallicFactor\": 0, \"roughnessFactor\": 0}, "
    "\"extensions\": {\"KHR_materials_transmission\": {\"transmissionFactor\": 1}, \"KHR_materials_volume\": "
    "{\"thicknessFactor\": 0.8, \"attenuationDistance\": 1, \"attenuationColor\": [0.6, 0.9, 0.8]}}},\n"
    "    {\"name\": \"metal\", \"pbrMetallicRoughness\": {\"baseColorFactor\": [0.95, 0.8, 0.6, 1], "
    "\"metallicFactor\": 1, \"roughnessFactor\": 0.01}},\n"
    "    {\"name\": \"block\", \"pbrMetallicRoughness\": {\"baseColorFactor\": [0.6, 0.15, 0.1, 1], "
    "\"metallicFactor\": 0, \"roughnessFactor\": 0.6}},\n"
    "    {\"name\": \"panel\", \"pbrMetallicRoughness\": {\"baseColorFactor\": [0, 0, 0, 1], "
    "\"metallicFactor\": 0}, \"emissiveFactor\": [1, 0.85, 0.6], \"extensions\": "
    "{\"KHR_materials_emissive_strength\": {\"emissiveStrength\": 6}}}";

enum { VIEWS = 3 }; /* points, normals, indices */

static const void *const view_data[VIEWS] = {points, normals, indices};

static void view_sizes(size_t sizes[VIEWS]) {
    sizes[0] = point_count * sizeof points[0];
    sizes[1] = point_count * sizeof normals[0];
    sizes[2] = index_count * sizeof indices[0];
}

static size_t write_mesh(char *text, size_t size, int i) {
    char normal[32] = "";
    if (meshes[i].smooth)
        snprintf(normal, sizeof normal, ", \"NORMAL\": %d", VIEWS * i + 1);
    return (size_t)snprintf(
        text, size,
        "    {\"primitives\": [{\"attributes\": {\"POSITION\": %d%s}, \"indices\": %d, \"material\": %d}]}",
        VIEWS * i, normal, VIEWS * i + 2, i);
}

static size_t write_accessors(char *text, size_t size, const mesh *m) {
    return (size_t)snprintf(
        text, size,
        "    {\"bufferView\": 0, \"byteOffset\": %zu, \"componentType\": 5126, \"count\": %" PRIu32
        ", \"type\": \"VEC3\", \"min\": [%.9g, %.9g, %.9g], \"max\": [%.9g, %.9g, %.9g]},\n"
        "    {\"bufferView\": 1, \"byteOffset\": %zu, \"componentType\": 5126, \"count\": %" PRIu32
        ", \"type\": \"VEC3\"},\n"
        "    {\"bufferView\": 2, \"byteOffset\": %zu, \"componentType\": 5123, \"count\": %" PRIu32
        ", \"type\": \"SCALAR\"}",
        m->first_point * sizeof points[0], m->points, (double)m->low[0], (double)m->low[1], (double)m->low[2],
        (double)m->high[0], (double)m->high[1], (double)m->high[2], m->first_point * sizeof normals[0],
        m->points, m->first_index * sizeof indices[0], m->indices);
}

static size_t write_gltf(char *text, size_t size) {
    size_t sizes[VIEWS], from = 0;
    view_sizes(sizes);
    size_t used = (size_t)snprintf(
        text, size,
        "{\n  \"asset\": {\"version\": \"2.0\", \"generator\": \"make_lit_scene\"},\n"
        "  \"extensionsUsed\": [\"KHR_materials_transmission\", \"KHR_materials_volume\", "
        "\"KHR_materials_emissive_strength\"],\n"
        "  \"scene\": 0, \"scenes\": [{\"nodes\": [0, 1, 2, 3, 4]}],\n"
        "  \"buffers\": [{\"uri\": \"lit.bin\", \"byteLength\": %zu}],\n  \"materials\": [\n    %s\n  ],\n",
        sizes[0] + sizes[1] + sizes[2], materials);
    used += (size_t)snprintf(text + used, size - used, "  \"bufferViews\": [\n");
    for (int view = 0; view < VIEWS; from += sizes[view++])
        used += (size_t)snprintf(text + used, size - used,
                                 "    {\"buffer\": 0, \"byteOffset\": %zu, \"byteLength\": %zu}%s\n", from,
                                 sizes[view], view + 1 < VIEWS ? "," : "\n  ],");
    static const char *const lists[3] = {"nodes", "meshes", "accessors"};
    for (int list = 0; list < 3; ++list) {
        used += (size_t)snprintf(text + used, size - used, "  \"%s\": [\n", lists[list]);
        for (int i = 0; i < MESHES; ++i) {
            used += list == 0   ? (size_t)snprintf(text + used, size - used, "    {\"mesh\": %d}", i)
                    : list == 1 ? write_mesh(text + used, size - used, i)
                                : write_accessors(text + used, size - used, &meshes[i]);
            used += (size_t)snprintf(text + used, size - used, "%s\n",
                                     i + 1 < MESHES ? ","
                                     : list < 2     ? "\n  ],"
                                                    : "\n  ]");
        }
    }
    return used + (size_t)snprintf(text + used, size - used, "}\n");
}

static void to_rgbe(const double rgb[3], uint8_t out[4]) {
    int exponent = 0;
    (void)frexp(fmax(fmax(rgb[0], rgb[1]), rgb[2]), &exponent);
    for (int c = 0; c < 3; ++c)
        out[c] = (uint8_t)fmin(ldexp(rgb[c], 8 - exponent), 255.0);
    out[3] = (uint8_t)(exponent + 128);
}

/* An evening: blue above, a warm rim, dull ground, and a sun 12 degrees high, one texel of it. */
static size_t write_sky(uint8_t *out) {
    size_t used =
        (size_t)sprintf((char *)out, "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n", SKY / 2, SKY);
    for (int y = 0; y < SKY / 2; ++y)
        for (int x = 0; x < SKY; ++x, used += 4) {
            const double up = gw_cos(GW_PI * (y + 0.5) / (SKY / 2)),
                         rim = up > 0.0 ? (1.0 - up) * (1.0 - up) : 0.0;
            double rgb[3] = {0.06 + 0.5 * rim * rim, 0.10 + 0.3 * rim * rim, 0.22 + 0.12 * rim};
            if (up <= 0.0)
                rgb[0] = rgb[1] = rgb[2] = 0.05;
            if (x == 104 && y == 27)
                rgb[0] = 900.0, rgb[1] = 650.0, rgb[2] = 380.0;
            to_rgbe(rgb, out + used);
        }
    return used;
}

static void save(const char *folder, const char *name, const void *data, size_t size) {
    char path[4096];
    gw_error error = {0};
    if (snprintf(path, sizeof path, "%s/%s", folder, name) >= (int)sizeof path ||
        gw_file_write(path, data, size, &error)) {
        fprintf(stderr, "make_lit_scene: %s: %s\n", name, error.text);
        exit(5);
    }
}

int main(int argc, char **argv) {
    static char text[1 << 15];
    static uint8_t bytes[sizeof points + sizeof normals + sizeof indices + SKY * SKY * 2 + 128];
    size_t sizes[VIEWS], size = 0;
    if (argc != 2) {
        fprintf(stderr, "make_lit_scene FOLDER\n");
        return 2;
    }
    make_meshes();
    save(argv[1], "lit.gltf", text, write_gltf(text, sizeof text));
    view_sizes(sizes);
    for (int view = 0; view < VIEWS; size += sizes[view++])
        memcpy(bytes + size, view_data[view], sizes[view]);
    save(argv[1], "lit.bin", bytes, size);
    save(argv[1], "lit-sky.hdr", bytes, write_sky(bytes));
    return 0;
}
