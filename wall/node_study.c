/* See node_study.h. */
#include "wall/node_study.h"

#include "render/root_grid.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

typedef enum form_kind {
    FORM_SHIPPED,
    FORM_SEED64,
    FORM_SEED64_LISTS,
    FORM_SHORT,
    FORM_WIDE,
    FORM_GRID
} form_kind;

typedef struct study_row {
    const char *name, *what;
    form_kind form;
    uint32_t grid_level;
    const char *kernel, *defines;
    int root_grid; /* it starts at the grid behind the shipped nodes */
    int storage, loses;
} study_row;

static const study_row rows[GW_STUDY_ENTRIES] = {
    {.name = "shipped",
     .root_grid = 1,
     .what =
         "8 bytes a node, siblings packed, a grid of up to 64^3 cells behind them; buffer textures, stack "
         "in registers, steps without branches"},
    {.name = "no-grid", .what = "from the root, without the grid", .defines = "NO_ROOT_GRID"},
    {.name = "branching",
     .what = "from the root, a step branches into down and on",
     .kernel = "bench/branching.comp"},
    {.name = "refetch",
     .what = "from the root, the stack holds the node's index, fetched again",
     .defines = "WIDE_NODES"},
    {.name = "storage", .what = "storage blocks", .defines = "STORAGE_FETCH", .root_grid = 1, .storage = 1},
    {.name = "local-stack", .what = "stack in an array of the ray", .defines = "STACK_LOCAL", .root_grid = 1},
    {.name = "shared-stack",
     .what = "stack in memory of the work group",
     .defines = "STACK_SHARED",
     .root_grid = 1},
    {.name = "seed64-lists",
     .what = "Weier et al.'s node, a lone triangle is a list of one",
     .form = FORM_SEED64_LISTS,
     .kernel = "bench/seed64.comp"},
    {.name = "seed64",
     .what = "Weier et al.'s node, a lone triangle stands in the leaf",
     .form = FORM_SEED64,
     .kernel = "bench/seed64.comp"},
    {.name = "short",
     .what = "12 bytes an inner node, 4 a leaf",
     .form = FORM_SHORT,
     .kernel = "bench/short.comp"},
    {.name = "wide-plain",
     .what = "4x4x4 children a node",
     .form = FORM_WIDE,
     .kernel = "bench/wide.comp",
     .defines = "WIDE_NO_SKIP"},
    {.name = "wide",
     .what = "4x4x4 children a node, empty 2x2x2 blocks left in one step",
     .form = FORM_WIDE,
     .kernel = "bench/wide.comp"},
    {.name = "grid-32",
     .what = "a grid of 32^3 cells in an array of its own, steps that branch",
     .form = FORM_GRID,
     .grid_level = 5,
     .kernel = "bench/root_grid.comp"},
    {.name = "grid-64",
     .what = "a grid of 64^3 cells in an array of its own, steps that branch",
     .form = FORM_GRID,
     .grid_level = 6,
     .kernel = "bench/root_grid.comp"},
    {.name = "three-phase",
     .what = "Weier et al.'s traversal of the shipped nodes, nearest hit kept",
     .kernel = "bench/three_phase.comp"},
    {.name = "three-phase-bounded",
     .what = "the same, a hit counts only inside its leaf's cell",
     .kernel = "bench/three_phase.comp",
     .defines = "LEAF_BOUNDS",
     .loses = 1},
};

static gw_code make_form(const study_row *row, const gw_scene *scene, const gw_octree *octree,
                         gw_node_form *out, gw_error *error) {
    switch (row->form) {
    case FORM_SEED64:
    case FORM_SEED64_LISTS:
        return gw_form_seed64(octree, scene->triangle_count, row->form == FORM_SEED64, out, error);
    case FORM_SHORT:
        return gw_form_short(octree, out, error);
    case FORM_WIDE:
        return gw_form_wide(octree, out, error);
    case FORM_GRID:
        return gw_form_root_grid(octree, row->grid_level, out, error);
    case FORM_SHIPPED:
        break;
    }
    *out = (gw_node_form){.voxels = octree->node_count};
    return GW_OK;
}

static gw_code upload_form(gw_gl *device, gw_study_entry *entry, const gw_node_form *form, gw_error *error) {
    entry->voxels = form->voxels;
    for (uint32_t i = 0; i < form->array_count; i++) {
        const gw_form_array *array = &form->arrays[i];
        gw_code code = gw_gl_buffer_create(device, entry->name, array->bytes, array->data, array->format,
                                           &entry->buffers[i], error);
        if (code)
            return code;
        entry->bytes[array->part] += array->bytes;
        entry->variant.textures[array->unit] = &entry->buffers[i];
    }
    return GW_OK;
}

/* Storage blocks have a limit of their own. */
static gw_code check_blocks(gw_gl *device, const gw_scene *scene, const gw_octree *octree, gw_error *error) {
    uint64_t largest = (uint64_t)scene->triangle_count * sizeof(gw_gpu_triangle);
    if (gw_octree_node_bytes(octree) > largest)
        largest = gw_octree_node_bytes(octree);
    if (gw_octree_reference_bytes(octree) > largest)
        largest = gw_octree_reference_bytes(octree);
    int64_t most = gw_gl_limits_of(device)->storage_block_bytes;
    return largest <= (uint64_t)most
               ? GW_OK
               : gw_fail(error, GW_MACHINE, "a storage block holds %" PRId64 " bytes, %" PRIu64 " are needed",
                         most, largest);
}

static void fill_variant(const study_row *row, const gw_scene *scene, gw_study_entry *entry) {
    entry->name = row->name;
    entry->what = row->what;
    entry->loses = row->loses;
    snprintf(entry->defines, sizeof entry->defines,
             "%s%s%s#define TRIANGLE_COUNT %uu\n#define OWN_GRID_LEVEL %u\n", row->defines ? "#define " : "",
             row->defines ? row->defines : "", row->defines ? " 1\n" : "", scene->triangle_count,
             row->grid_level);
    entry->variant = (gw_trace_variant){.kernel = row->kernel,
                                        .defines = row->kernel || row->defines ? entry->defines : NULL,
                                        .storage = row->storage};
}

static void open_entry(gw_gl *device, const gw_scene *scene, const gw_octree *octree, const study_row *row,
                       gw_study_entry *entry) {
    gw_error *why = &entry->skipped;
    gw_node_form form = {0};
    fill_variant(row, scene, entry);
    gw_code code = make_form(row, scene, octree, &form, why);
    if (!code)
        code = upload_form(device, entry, &form, why);
    if (!code && row->storage)
        code = check_blocks(device, scene, octree, why);
    gw_node_form_finish(&form);
    /* What the form does not bring is the shipped array. */
    if (!entry->variant.textures[0])
        entry->bytes[GW_PART_NODES] += gw_octree_node_bytes(octree);
    if (row->root_grid)
        entry->bytes[GW_PART_GRID] += gw_root_grid_size(gw_root_grid_level(octree)) * sizeof(gw_node);
    if (!entry->variant.textures[1])
        entry->bytes[GW_PART_REFERENCES] += gw_octree_reference_bytes(octree);
}

gw_code gw_node_study_open(gw_gl *device, const gw_scene *scene, const gw_octree *octree,
                           const gw_renderer_options *options, gw_node_study *out, gw_error *error) {
    memset(out, 0, sizeof *out);
    gw_code code = gw_renderer_create(device, scene, octree, options, &out->renderer, error);
    for (uint32_t i = 0; i < GW_STUDY_ENTRIES && !code; i++) {
        open_entry(device, scene, octree, &rows[i], &out->entries[i]);
        gw_log_progress(options->log, "making other forms of the octree", (double)(i + 1) / GW_STUDY_ENTRIES);
    }
    return code;
}

void gw_node_study_close(gw_node_study *study) {
    for (uint32_t i = 0; i < GW_STUDY_ENTRIES; i++)
        for (int k = 0; k < GW_FORM_ARRAYS; k++)
            gw_gl_buffer_finish(&study->entries[i].buffers[k]);
    gw_renderer_destroy(&study->renderer);
    memset(study, 0, sizeof *study);
}

gw_code gw_node_study_trace(gw_node_study *study, uint32_t entry, const gw_ray *rays, size_t ray_count,
                            gw_hit *hits, int count, gw_counters *counters, gw_trace_time *time,
                            gw_error *error) {
    gw_trace_variant variant = study->entries[entry].variant;
    variant.count = count;
    gw_code code =
        gw_renderer_trace_variant(study->renderer, &variant, rays, ray_count, hits, counters, time, error);
    return code ? gw_context(error, "layout '%s'", study->entries[entry].name) : GW_OK;
}

gw_code gw_study_compare(const gw_study_entry *entry, const gw_hit *shipped, const gw_hit *hits, size_t count,
                         uint64_t *different, gw_error *error) {
    *different = 0;
    size_t first = count;
    for (size_t i = 0; i < count; i++) {
        if (!memcmp(&shipped[i], &hits[i], sizeof hits[i]))
            continue;
        first = *different ? first : i;
        ++*different;
    }
    if (!*different || entry->loses)
        return GW_OK;
    return gw_fail(
        error, GW_MACHINE,
        "layout '%s' gives %" PRIu64 " of %zu rays another hit than the shipped one; the first is ray %zu, "
        "triangle %" PRId64 " at %.9g instead of %" PRId64 " at %.9g",
        entry->name, *different, count, first, (int64_t)(int32_t)hits[first].triangle, (double)hits[first].t,
        (int64_t)(int32_t)shipped[first].triangle, (double)shipped[first].t);
}
