/* See transmission.h. */
#include "render/transmission.h"

#include "base/memory.h"
#include "build/gpu_types.h"
#include "render/vector3.h"
#include "shaders/common/frame.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct gw_medium {
    uint32_t material;
    double low[3], high[3], volume; /* of its box */
} gw_medium;

int gw_lets_light_through(const gw_scene *scene, uint32_t material) {
    return scene->extensions && scene->extensions[material].transmission > 0.0f &&
           scene->materials[material].metalness < 1.0f;
}

int gw_bounds_medium(const gw_scene *scene, uint32_t material) {
    return material < GW_MOST_MEDIA && gw_lets_light_through(scene, material) &&
           scene->extensions[material].thickness > 0.0f;
}

uint32_t gw_transmission_flags(const gw_scene *scene, uint32_t material) {
    return (gw_lets_light_through(scene, material) ? GW_TRIANGLE_SHEER : 0u) |
           (gw_bounds_medium(scene, material) ? GW_TRIANGLE_BOUNDARY : 0u);
}

/* --- nodes ------------------------------------------------------------------------------------------------
 */

static int sheer(const gw_scene *scene, uint32_t triangle) {
    return gw_lets_light_through(scene, scene->material_of[triangle]);
}

static int list_is_sheer(const gw_scene *scene, const gw_octree *octree, uint32_t at) {
    for (;; ++at) {
        if (sheer(scene, octree->references[at] & GW_REFERENCE_ID))
            return 1;
        if (octree->references[at] & GW_REFERENCE_LAST)
            return 0;
    }
}

/* The list under boxes ends with a reference that says so, as others do. */
static int boxes_are_sheer(const gw_scene *scene, const gw_octree *octree, uint32_t box) {
    for (;; ++box) {
        uint32_t words[8];
        memcpy(words, &octree->boxes[box], sizeof words);
        for (uint32_t k = 0; k < GW_BOX_TRIANGLES(words[7]); ++k)
            if (sheer(scene, octree->references[words[3] + k] & GW_REFERENCE_ID))
                return 1;
        if (words[7] & GW_BOX_LAST)
            return 0;
    }
}

/* Of an inner node: its children, which stand behind it, are marked already. */
static int node_is_sheer(const gw_scene *scene, const gw_octree *octree, const gw_node *nodes, uint32_t i) {
    const gw_node *node = &nodes[i];
    switch (GW_NODE_KIND(node->bits)) {
    case GW_LEAF_SINGLE:
        return sheer(scene, node->link);
    case GW_LEAF_LIST:
        return list_is_sheer(scene, octree, node->link);
    case GW_LEAF_DENSE:
        return boxes_are_sheer(scene, octree, node->link);
    default:
        break;
    }
    const uint32_t children = (uint32_t)__builtin_popcount(GW_NODE_VALID(node->bits));
    for (uint32_t c = 0; c < children; ++c)
        if (nodes[node->link + c].bits & GW_NODE_SHEER)
            return 1;
    return 0;
}

gw_code gw_transmission_mark_nodes(const gw_scene *scene, const gw_octree *octree, gw_gl_buffer *nodes,
                                   gw_error *error) {
    int any = 0;
    for (uint32_t m = 0; m < scene->material_count; ++m)
        any |= gw_lets_light_through(scene, m);
    if (!any)
        return GW_OK;
    gw_node *marked = NULL;
    gw_code code = gw_allocate((void **)&marked, octree->node_count, sizeof *marked,
                               "nodes that let light through", error);
    if (code)
        return code;
    memcpy(marked, octree->nodes, octree->node_count * sizeof *marked);
    for (uint32_t i = octree->node_count; i-- > 0;)
        if (node_is_sheer(scene, octree, marked, i))
            marked[i].bits |= GW_NODE_SHEER;
    code = gw_gl_buffer_write(nodes, 0, octree->node_count * sizeof *marked, marked, error);
    free(marked);
    return code;
}

/* --- media ------------------------------------------------------------------------------------------------
 */

static int by_volume(const void *a, const void *b) {
    const gw_medium *x = a, *y = b;
    if (x->volume != y->volume)
        return x->volume > y->volume ? -1 : 1;
    return x->material < y->material ? -1 : 1;
}

static void widen(gw_medium *medium, const float *position) {
    for (int k = 0; k < 3; ++k) {
        medium->low[k] = fmin(medium->low[k], (double)position[k]);
        medium->high[k] = fmax(medium->high[k], (double)position[k]);
    }
}

static void take_boxes(const gw_scene *scene, gw_media *out, const uint32_t *medium_of) {
    for (uint32_t t = 0; t < scene->triangle_count; ++t)
        if (medium_of[scene->material_of[t]] != UINT32_MAX)
            for (int k = 0; k < 3; ++k)
                widen(&out->list[medium_of[scene->material_of[t]]],
                      scene->positions + (size_t)scene->triangles[t][k] * 3);
    for (uint32_t i = 0; i < out->count; ++i) {
        gw_medium *m = &out->list[i];
        m->volume = (m->high[0] - m->low[0]) * (m->high[1] - m->low[1]) * (m->high[2] - m->low[2]);
    }
    qsort(out->list, out->count, sizeof *out->list, by_volume);
}

gw_code gw_media_take(const gw_scene *scene, gw_media *out, gw_error *error) {
    gw_media_finish(out);
    out->scene = scene;
    uint32_t count = 0;
    for (uint32_t m = 0; m < scene->material_count; ++m)
        count += (uint32_t)gw_bounds_medium(scene, m);
    if (count == 0)
        return GW_OK;
    uint32_t *medium_of = NULL;
    gw_code code = gw_allocate((void **)&medium_of, scene->material_count, sizeof *medium_of, "media", error);
    if (!code)
        code = gw_allocate((void **)&out->list, count, sizeof *out->list, "media", error);
    for (uint32_t m = 0; !code && m < scene->material_count; ++m) {
        medium_of[m] = UINT32_MAX;
        if (!gw_bounds_medium(scene, m))
            continue;
        medium_of[m] = out->count;
        out->list[out->count++] = (gw_medium){m, {1e30, 1e30, 1e30}, {-1e30, -1e30, -1e30}, 0};
    }
    if (!code)
        take_boxes(scene, out, medium_of);
    free(medium_of);
    return code;
}

void gw_media_finish(gw_media *media) {
    free(media->list);
    memset(media, 0, sizeof *media);
}

/* Solid angle of a triangle seen from the origin, signed (van Oosterom and Strackee, The Solid Angle of a
 * Plane Triangle, 1983). */
static double solid_angle(const double a[3], const double b[3], const double c[3]) {
    double cross[3];
    gw_cross(b, c, cross);
    const double x = gw_length(a), y = gw_length(b), z = gw_length(c);
    return 2.0 * atan2(gw_dot(a, cross), x * y * z + gw_dot(a, b) * z + gw_dot(b, c) * x + gw_dot(c, a) * y);
}

/* How often the medium's surface winds round the place; small holes in it change little (Jacobson, Kavan and
 * Sorkine-Hornung, Robust Inside-Outside Segmentation using Generalized Winding Numbers, 2013). */
static double winding(const gw_scene *scene, uint32_t material, const double place[3]) {
    double sum = 0;
    for (uint32_t t = 0; t < scene->triangle_count; ++t) {
        if (scene->material_of[t] != material)
            continue;
        double corner[3][3];
        for (int k = 0; k < 3; ++k)
            for (int i = 0; i < 3; ++i)
                corner[k][i] =
                    (double)scene->positions[(size_t)scene->triangles[t][k] * 3 + (size_t)i] - place[i];
        sum += solid_angle(corner[0], corner[1], corner[2]);
    }
    return sum / (4.0 * 3.14159265358979323846);
}

void gw_media_at(const gw_media *media, const double place[3], uint32_t stack[2]) {
    stack[0] = stack[1] = 0;
    for (uint32_t i = 0; i < media->count; ++i) {
        const gw_medium *m = &media->list[i];
        int inside = 1;
        for (int k = 0; k < 3; ++k)
            inside &= place[k] >= m->low[k] && place[k] <= m->high[k];
        if (!inside || winding(media->scene, m->material, place) < 0.5)
            continue;
        stack[1] = (stack[1] << 16) | (stack[0] >> 16);
        stack[0] = (stack[0] << 16) | (m->material + 1);
    }
}
