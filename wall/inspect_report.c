#include "wall/inspect_report.h"

#include "wall/report.h"

#include <inttypes.h>
#include <stdio.h>

static const double mebibyte = 1048576.0;

static uint64_t texture_bytes(const gw_scene *scene) {
    uint64_t bytes = 0;
    for (uint32_t i = 0; i < scene->texture_count; i++)
        bytes += (uint64_t)scene->textures[i].image.width * scene->textures[i].image.height * 4;
    return bytes;
}

static uint64_t scene_bytes(const gw_scene *scene) {
    const uint64_t vertex = 3 * sizeof *scene->positions + 3 * sizeof *scene->normals +
                            2 * sizeof *scene->texcoords + sizeof *scene->welded + (scene->colors ? 4 : 0) +
                            (scene->tangents ? sizeof *scene->tangents : 0);
    return scene->vertex_count * vertex +
           scene->triangle_count * (uint64_t)(sizeof *scene->triangles + sizeof *scene->material_of);
}

static void measure_memory(const gw_model *model, const gw_renderer *renderer, const gw_settings *settings,
                           gw_memory_report *m) {
    const gw_octree *octree = model->octree;
    m->nodes = gw_octree_node_bytes(octree);
    m->references = gw_octree_reference_bytes(octree);
    m->boxes = gw_octree_box_bytes(octree);
    m->payload = gw_octree_payload_bytes(octree) + gw_octree_emission_bytes(octree);
    m->triangles = gw_triangle_bytes(model->scene);
    m->host_octree = m->nodes + m->references + m->boxes + m->payload;
    m->others = gw_renderer_bytes(renderer) - m->host_octree - m->triangles;
    gw_renderer_ray_memory(renderer, settings, &m->ray, &m->rays_at_once, &m->sample_lists);
    m->build_peak = model->build_peak;
    m->host_scene = scene_bytes(model->scene);
    m->host_textures = texture_bytes(model->scene);
}

gw_code gw_inspect_mesh(const gw_model *model, gw_inspect_report *out, gw_error *error) {
    return gw_mesh_report_make(model->scene, &out->mesh, error);
}

void gw_inspect_octree(const gw_model *model, const gw_renderer *renderer, const gw_settings *settings,
                       gw_inspect_report *out) {
    gw_octree_report_make(model->octree, &out->octree);
    measure_memory(model, renderer, settings, &out->memory);
}

/* --- JSON
 * -------------------------------------------------------------------------------------------------------- */

static json_t *count(uint64_t value) {
    return json_integer((json_int_t)value);
}

static json_t *mesh_json(const gw_mesh_report *m) {
    return json_pack("{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "edges",
                     count(m->edges), "boundary_edges", count(m->boundary_edges), "inconsistent_edges",
                     count(m->inconsistent_edges), "non_manifold_edges", count(m->non_manifold_edges),
                     "t_junctions", count(m->t_junctions), "coincident", count(m->coincident),
                     "coincident_turned", count(m->coincident_turned), "coincident_materials",
                     count(m->coincident_materials), "slivers", count(m->slivers), "components",
                     count(m->components), "closed_components", count(m->closed_components),
                     "closed_triangles", count(m->closed_triangles), "inside_out", count(m->inside_out),
                     "largest_component", count(m->largest_component));
}

static json_t *levels_json(const gw_octree_report *r) {
    json_t *levels = json_array();
    for (uint32_t l = 0; l < r->level_count; l++)
        json_array_append_new(levels,
                              json_pack("{s:o, s:o, s:o, s:o}", "level", count(l), "inner",
                                        count(r->levels[l].inner), "leaves", count(r->levels[l].leaves),
                                        "triangles", count(r->levels[l].triangles)));
    return levels;
}

static json_t *lists_json(const gw_octree_report *r) {
    json_t *lists = json_array();
    for (uint32_t i = 0; i < r->list_classes; i++) {
        uint32_t range[2];
        gw_list_class_range(i, range);
        json_array_append_new(lists, json_pack("{s:o, s:o, s:o}", "from", count(range[0]), "to",
                                               count(range[1]), "leaves", count(r->lists[i])));
    }
    return lists;
}

static json_t *memory_json(const gw_memory_report *m) {
    return json_pack(
        "{s:{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}, s:{s:o, s:o, s:o}}", "gpu", "nodes",
        count(m->nodes), "references", count(m->references), "boxes", count(m->boxes), "payload",
        count(m->payload), "triangles", count(m->triangles), "others", count(m->others), "ray", count(m->ray),
        "rays_at_once", count(m->rays_at_once), "sample_lists", count(m->sample_lists), "build_peak",
        m->build_peak ? count(m->build_peak) : json_null(), "host", "scene", count(m->host_scene), "textures",
        count(m->host_textures), "octree", count(m->host_octree));
}

void gw_inspect_report_json(const gw_inspect_report *inspected, const gw_model *model, json_t *report) {
    const gw_memory_report *m = &inspected->memory;
    const double triangles = model->scene->triangle_count;
    json_t *octree = json_object_get(report, "octree");
    json_object_set_new(json_object_get(report, "scene"), "mesh", mesh_json(&inspected->mesh));
    json_object_set_new(octree, "levels", levels_json(&inspected->octree));
    json_object_set_new(octree, "lists", lists_json(&inspected->octree));
    json_object_set_new(octree, "bytes_per_triangle",
                        json_pack("{s:f, s:f, s:f, s:f, s:f}", "nodes", (double)m->nodes / triangles,
                                  "references", (double)m->references / triangles, "boxes",
                                  (double)m->boxes / triangles, "payload", (double)m->payload / triangles,
                                  "triangles", (double)m->triangles / triangles));
    json_object_set_new(report, "memory", memory_json(m));
}

/* --- words
 * -------------------------------------------------------------------------------------------------------- */

void gw_inspect_print_mesh(const gw_inspect_report *inspected, const gw_scene *scene) {
    const gw_mesh_report *m = &inspected->mesh;
    printf("mesh               %" PRIu64 " edges: %" PRIu64 " of one triangle, %" PRIu64
           " of more than two, %" PRIu64 " between triangles that face opposite ways; %" PRIu64
           " T-junctions\n",
           m->edges, m->boundary_edges, m->non_manifold_edges, m->inconsistent_edges, m->t_junctions);
    printf("    components     %" PRIu64 ", the largest of %" PRIu64 " triangles; %" PRIu64
           " closed (%.1f %% of all triangles), %" PRIu64 " of them inside out\n",
           m->components, m->largest_component, m->closed_components,
           100.0 * (double)m->closed_triangles / scene->triangle_count, m->inside_out);
    printf("    coincident     %" PRIu64 " triangles in the place of another: %" PRIu64
           " turned over, %" PRIu64 " of another material\n",
           m->coincident, m->coincident_turned, m->coincident_materials);
    printf("    slivers        %" PRIu64 " triangles at least %d times as long as high\n", m->slivers,
           GW_SLIVER_ASPECT);
}

void gw_inspect_print_levels(const gw_inspect_report *inspected) {
    const gw_octree_report *r = &inspected->octree;
    printf("    level          %12s %12s %20s\n", "inner", "leaves", "triangles in leaves");
    for (uint32_t l = 0; l < r->level_count; l++)
        printf("        %2" PRIu32 "         %12" PRIu64 " %12" PRIu64 " %20" PRIu64 "\n", l,
               r->levels[l].inner, r->levels[l].leaves, r->levels[l].triangles);
    printf("    leaves by triangles:");
    for (uint32_t i = 0; i < r->list_classes; i++) {
        uint32_t range[2];
        gw_list_class_range(i, range);
        if (r->lists[i] == 0)
            continue;
        printf("%s %" PRIu64 " with %" PRIu32, i ? "," : "", r->lists[i], range[0]);
        if (range[1] > range[0])
            printf(" to %" PRIu32, range[1]);
    }
    printf("\n");
}

void gw_inspect_print_memory(const gw_inspect_report *inspected, const gw_scene *scene) {
    const gw_memory_report *m = &inspected->memory;
    const struct {
        const char *what;
        uint64_t bytes;
    } parts[] = {{"nodes", m->nodes},
                 {"references", m->references},
                 {"boxes over long lists", m->boxes},
                 {"payload", m->payload},
                 {"triangles and vertices", m->triangles},
                 {"textures, materials, lights", m->others}};
    uint64_t total = 0;
    printf("memory on the GPU\n");
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        if (parts[i].bytes == 0)
            continue;
        printf("    %10.2f MiB %8.1f bytes a triangle  %s\n", (double)parts[i].bytes / mebibyte,
               (double)parts[i].bytes / scene->triangle_count, parts[i].what);
        total += parts[i].bytes;
    }
    printf("    %10.2f MiB %8.1f bytes a triangle  in all\n", (double)total / mebibyte,
           (double)total / scene->triangle_count);
    printf("    %10.2f MiB at most for rays: %" PRIu64 " bytes each, %" PRIu64
           " at a time, however large the tile\n",
           (double)(m->ray * m->rays_at_once) / mebibyte, m->ray, m->rays_at_once);
    printf("    %10.2f MiB at most for lists of samples, where somebody's gaze is known\n",
           (double)m->sample_lists / mebibyte);
    if (m->build_peak)
        printf("    %10.2f MiB at most while the octree was built\n", (double)m->build_peak / mebibyte);
    printf("memory of the host %.2f MiB triangles and vertices, %.2f MiB textures, %.2f MiB octree\n",
           (double)m->host_scene / mebibyte, (double)m->host_textures / mebibyte,
           (double)m->host_octree / mebibyte);
}
