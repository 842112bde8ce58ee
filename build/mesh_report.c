#include "build/mesh_report.h"

#include "base/memory.h"
#include "build/components.h"
#include "build/mesh_junctions.h"
#include "build/mesh_sides.h"
#include "build/weld.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct component {
    uint32_t triangles;
    int open;      /* some edge does not balance */
    double volume; /* six times the signed volume, rebased units; means something when closed */
} component;

typedef struct mesh {
    const gw_scene *scene;
    uint32_t *component_of; /* [welded_count] */
    component *components;  /* [welded_count] at the component's least vertex */
    uint64_t *boundary;     /* [boundary_count] keys of edges of one triangle */
    size_t boundary_count, boundary_capacity;
    gw_mesh_report *report;
} mesh;

static uint32_t welded_corner(const gw_scene *scene, uint32_t triangle, int k) {
    return scene->welded[scene->triangles[triangle][k]];
}

static const float *position(const gw_scene *scene, uint32_t triangle, int k) {
    return scene->positions + (size_t)scene->triangles[triangle][k] * 3;
}

/* --- edges
 * -------------------------------------------------------------------------------------------------------- */

/* One edge: `sides` triangles, of which `forward` run from its lesser vertex to its greater. */
static gw_code judge_edge(mesh *self, uint64_t key, size_t sides, size_t forward, gw_error *error) {
    gw_mesh_report *report = self->report;
    report->edges++;
    report->boundary_edges += sides == 1;
    report->inconsistent_edges += sides == 2 && forward != 1;
    report->non_manifold_edges += sides > 2;
    if (sides != 2 * forward)
        self->components[self->component_of[key >> 32]].open = 1;
    if (sides != 1)
        return GW_OK;
    gw_code code = gw_grow((void **)&self->boundary, &self->boundary_capacity, self->boundary_count + 1,
                           sizeof *self->boundary, "boundary edges", error);
    if (code == GW_OK)
        self->boundary[self->boundary_count++] = key;
    return code;
}

static gw_code judge_edges(mesh *self, gw_error *error) {
    const size_t count = (size_t)self->scene->triangle_count * 3;
    gw_keyed *sides = NULL;
    gw_code code = gw_mesh_sides(self->scene, &sides, error);
    for (size_t begin = 0, end; code == GW_OK && begin < count; begin = end) {
        size_t forward = 0;
        for (end = begin; end < count && sides[end].key == sides[begin].key; end++)
            forward += sides[end].value & 1u;
        code = judge_edge(self, sides[begin].key, end - begin, forward, error);
    }
    free(sides);
    return code;
}

static gw_code find_junctions(mesh *self, gw_error *error) {
    const gw_scene *scene = self->scene;
    float(*positions)[3] = NULL;
    gw_code code =
        gw_allocate((void **)&positions, scene->welded_count, sizeof *positions, "positions", error);
    for (uint32_t v = 0; code == GW_OK && v < scene->vertex_count; v++)
        memcpy(positions[scene->welded[v]], scene->positions + (size_t)v * 3, sizeof *positions);
    if (code == GW_OK)
        code = gw_mesh_junctions((const float(*)[3])positions, self->boundary, self->boundary_count,
                                 &self->report->t_junctions, error);
    free(positions);
    return code;
}

/* --- triangles
 * -------------------------------------------------------------------------------------------------------- */

static void cross(const double a[3], const double b[3], double out[3]) {
    for (int i = 0; i < 3; i++)
        out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Longest edge over the height above it: longest^2 / (2 area). */
static int is_sliver(const gw_scene *scene, uint32_t t) {
    double edge[3][3], normal[3], longest = 0;
    for (int k = 0; k < 3; k++) {
        for (int axis = 0; axis < 3; axis++)
            edge[k][axis] = (double)position(scene, t, (k + 1) % 3)[axis] - position(scene, t, k)[axis];
        longest = fmax(longest, dot(edge[k], edge[k]));
    }
    cross(edge[0], edge[1], normal);
    return longest >= GW_SLIVER_ASPECT * sqrt(dot(normal, normal));
}

/* Six times the volume between the triangle and the middle of the scene's cube. */
static double signed_volume(const gw_scene *scene, uint32_t t) {
    double p[3][3], normal[3];
    for (int k = 0; k < 3; k++)
        for (int axis = 0; axis < 3; axis++)
            p[k][axis] = position(scene, t, k)[axis];
    cross(p[1], p[2], normal);
    return dot(p[0], normal);
}

static void judge_triangles(mesh *self) {
    for (uint32_t t = 0; t < self->scene->triangle_count; t++) {
        component *c = &self->components[self->component_of[welded_corner(self->scene, t, 0)]];
        c->triangles++;
        c->volume += signed_volume(self->scene, t);
        self->report->slivers += (uint64_t)is_sliver(self->scene, t);
    }
}

static void judge_components(const mesh *self) {
    gw_mesh_report *report = self->report;
    for (uint32_t v = 0; v < self->scene->welded_count; v++) {
        const component *c = &self->components[v];
        if (c->triangles == 0)
            continue;
        report->components++;
        if (c->triangles > report->largest_component)
            report->largest_component = c->triangles;
        if (c->open)
            continue;
        report->closed_components++;
        report->closed_triangles += c->triangles;
        report->inside_out += c->volume < 0;
    }
}

/* --- coincident triangles
 * -------------------------------------------------------------------------------------------------------- */

/* The three vertices in rising order; returns 1 when that turns the triangle over. */
static int sorted_corners(const gw_scene *scene, uint32_t t, uint32_t out[3]) {
    int turned = 0;
    for (int k = 0; k < 3; k++)
        out[k] = welded_corner(scene, t, k);
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 2 - i; k++)
            if (out[k] > out[k + 1]) {
                const uint32_t swap = out[k];
                out[k] = out[k + 1];
                out[k + 1] = swap;
                turned ^= 1;
            }
    return turned;
}

static void compare_with_first(const mesh *self, const uint32_t *place_of, uint32_t *first) {
    const gw_scene *scene = self->scene;
    uint32_t places = 0, corners[3];
    for (uint32_t t = 0; t < scene->triangle_count; t++) {
        if (place_of[t] == places) { /* places are numbered in order of first occurrence */
            first[places++] = t;
            continue;
        }
        const uint32_t other = first[place_of[t]];
        self->report->coincident++;
        self->report->coincident_turned +=
            sorted_corners(scene, t, corners) != sorted_corners(scene, other, corners);
        self->report->coincident_materials += scene->material_of[t] != scene->material_of[other];
    }
}

static gw_code find_coincident(mesh *self, gw_error *error) {
    const uint32_t count = self->scene->triangle_count;
    uint32_t(*corners)[3] = NULL, *place_of = NULL, *first = NULL, places = 0;
    gw_code code = gw_allocate((void **)&corners, count, sizeof *corners, "coincident triangles", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&place_of, count, sizeof *place_of, "coincident triangles", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&first, count, sizeof *first, "coincident triangles", error);
    for (uint32_t t = 0; code == GW_OK && t < count; t++)
        sorted_corners(self->scene, t, corners[t]);
    if (code == GW_OK)
        code = gw_weld(corners[0], count, 3, place_of, &places, error);
    if (code == GW_OK)
        compare_with_first(self, place_of, first);
    free(corners);
    free(place_of);
    free(first);
    return code;
}

gw_code gw_mesh_report_make(const gw_scene *scene, gw_mesh_report *out, gw_error *error) {
    mesh self = {.scene = scene, .report = out};
    *out = (gw_mesh_report){0};
    gw_code code = gw_components(scene, &self.component_of, error);
    if (code == GW_OK)
        code = gw_allocate((void **)&self.components, scene->welded_count, sizeof *self.components,
                           "mesh components", error);
    if (code == GW_OK)
        code = judge_edges(&self, error);
    if (code == GW_OK)
        code = find_junctions(&self, error);
    if (code == GW_OK) {
        judge_triangles(&self);
        judge_components(&self);
        code = find_coincident(&self, error);
    }
    free(self.component_of);
    free(self.components);
    free(self.boundary);
    return code;
}
