#include "build/octree_internal.h"
#include "build/texture_chain.h"
#include "build/voxel_roughness.h"

#include "base/clock.h"
#include "base/memory.h"
#include "base/srgb.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { GROUP = 64, LIST_LIMIT = 256, BUCKETS = 32, ROW_BYTES = 16, SINGLE = (int)0x80000000u };
enum {
    LOCATION_JOB_COUNT = 1,
    LOCATION_NODE_FIRST,
    LOCATION_LEVEL,
    LOCATION_LIST_FIRST,
    LOCATION_LIST_LIMIT,
    LOCATION_SEPARATION
};

/* Everything that the leaf kernel reads, and the sums of two levels. */
typedef struct payload_stage {
    gw_octree_builder *builder;
    gw_octree *octree;
    gw_gl_buffer references, vertices;
    gw_gl_buffer sums, below; /* [node of the level][rows] of the present level and the one below it */
    GLuint leaf_program, inner_program, encode_program;
    uint32_t window_nodes; /* nodes whose sums fit in one storage block */
    size_t sum_bytes;      /* of one node: sum_rows() */
} payload_stage;

static void finish_stage(payload_stage *stage) {
    gw_gl_buffer *all[] = {&stage->references, &stage->vertices, &stage->sums, &stage->below};
    for (size_t i = 0; i < sizeof all / sizeof *all; ++i)
        gw_gl_buffer_finish(all[i]);
}

void gw_payload_inputs_finish(gw_payload_inputs *inputs) {
    gw_gl_buffer *all[] = {&inputs->faces, &inputs->materials, &inputs->chains, &inputs->texels,
                           &inputs->thresholds};
    for (size_t i = 0; i < sizeof all / sizeof *all; ++i)
        gw_gl_buffer_finish(all[i]);
    inputs->ready = 0;
}

static uint32_t pack_color(const uint8_t *rgba) {
    return rgba ? (uint32_t)rgba[0] | (uint32_t)rgba[1] << 8 | (uint32_t)rgba[2] << 16 |
                      (uint32_t)rgba[3] << 24
                : 0xffffffffu;
}

static gw_code upload_faces(payload_stage *stage, gw_error *error) {
    const gw_scene *scene = stage->builder->scene;
    uint32_t(*faces)[4] = NULL;
    gw_code code = gw_allocate((void **)&faces, scene->triangle_count, sizeof *faces, "faces", error);
    for (uint32_t t = 0; code == GW_OK && t < scene->triangle_count; ++t) {
        memcpy(faces[t], scene->triangles[t], sizeof scene->triangles[t]);
        faces[t][3] = scene->material_of[t];
    }
    if (code == GW_OK)
        code = gw_gl_buffer_create(stage->builder->device, "build faces",
                                   (size_t)scene->triangle_count * sizeof *faces, faces, GL_RGBA32UI,
                                   &stage->builder->inputs.faces, error);
    free(faces);
    return code;
}

static gw_code upload_vertices(payload_stage *stage, gw_error *error) {
    const gw_scene *scene = stage->builder->scene;
    uint32_t(*vertices)[2][4] = NULL;
    gw_code code = gw_allocate((void **)&vertices, scene->vertex_count, sizeof *vertices, "vertices", error);
    for (uint32_t v = 0; code == GW_OK && v < scene->vertex_count; ++v) {
        memcpy(vertices[v][0], scene->normals + (size_t)v * 3, 3 * sizeof(float));
        vertices[v][0][3] = pack_color(scene->colors ? scene->colors + (size_t)v * 4 : NULL);
        memcpy(vertices[v][1], scene->texcoords + (size_t)v * 2, 2 * sizeof(float));
    }
    if (code == GW_OK)
        code = gw_gl_buffer_create(stage->builder->device, "build vertices",
                                   (size_t)scene->vertex_count * sizeof *vertices, vertices, GL_RGBA32UI,
                                   &stage->vertices, error);
    free(vertices);
    return code;
}

static int is_unlit(const gw_scene *scene, uint32_t material) {
    return scene->extensions && scene->extensions[material].unlit;
}

static gw_code upload_materials(payload_stage *stage, gw_error *error) {
    const gw_scene *scene = stage->builder->scene;
    gw_texture_chains chains = {0};
    float(*materials)[3][4] = NULL;
    uint32_t(*links)[4] = NULL;
    gw_code code = gw_texture_chains_init(scene, (uint32_t)stage->builder->settings->payload_texture_side,
                                          &chains, error);
    if (code == GW_OK)
        code = gw_allocate((void **)&materials, scene->material_count, sizeof *materials, "materials", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&links, scene->material_count, sizeof *links, "texture links", error);
    for (uint32_t m = 0; code == GW_OK && m < scene->material_count; ++m) {
        const gw_material *material = &scene->materials[m];
        const float finish[4] = {gw_voxel_roughness(scene, m), material->metalness,
                                 (float)material->alpha_mode, material->alpha_cutoff};
        memcpy(materials[m][0], material->base_color, sizeof material->base_color);
        memcpy(materials[m][1], finish, sizeof finish);
        memcpy(materials[m][2], material->emissive, sizeof material->emissive);
        materials[m][2][3] = is_unlit(scene, m) ? 1.0f : 0.0f;
        if (chains.chain_of[m] >= 0) {
            const gw_texture_chain *chain = &chains.chains[chains.chain_of[m]];
            const gw_texture *texture = &scene->textures[material->base_color_texture];
            links[m][0] = chain->offset;
            links[m][1] = chain->width_bits | chain->height_bits << 8 | (uint32_t)texture->wrap_u << 16 |
                          (uint32_t)texture->wrap_v << 24;
            links[m][2] = 1;
        }
    }
    gw_gl *device = stage->builder->device;
    if (code == GW_OK)
        code = gw_gl_buffer_create(device, "build materials", scene->material_count * sizeof *materials,
                                   materials, GL_RGBA32F, &stage->builder->inputs.materials, error);
    if (code == GW_OK)
        code = gw_gl_buffer_create(device, "texture links", scene->material_count * sizeof *links, links,
                                   GL_RGBA32UI, &stage->builder->inputs.chains, error);
    if (code == GW_OK)
        code = gw_gl_buffer_create(device, "texture chains", chains.texel_count * sizeof *chains.texels,
                                   chains.texels, GL_RG32UI, &stage->builder->inputs.texels, error);
    gw_texture_chains_finish(&chains);
    free(materials);
    free(links);
    return code;
}

/* thresholds[i]: least linear value whose sRGB code of 10 bits is i. */
static gw_code upload_thresholds(payload_stage *stage, gw_error *error) {
    float thresholds[1024];
    thresholds[0] = 0;
    for (int i = 1; i < 1024; ++i) {
        thresholds[i] = (float)gw_srgb_to_linear((i - 0.5) / 1023.0);
    }
    return gw_gl_buffer_create(stage->builder->device, "sRGB thresholds", sizeof thresholds, thresholds, 0,
                               &stage->builder->inputs.thresholds, error);
}

int gw_octree_emits(const gw_scene *scene) {
    for (uint32_t t = 0; t < scene->triangle_count; ++t) {
        const float *emissive = scene->materials[scene->material_of[t]].emissive;
        if (emissive[0] > 0 || emissive[1] > 0 || emissive[2] > 0 || is_unlit(scene, scene->material_of[t]))
            return 1;
    }
    return 0;
}

/* The leaf kernel reads only what the scene has. */
static void leaf_defines(const gw_scene *scene, const char *common, char *text, size_t size) {
    int normals = 0, textures = 0;
    for (size_t i = 0; !normals && i < (size_t)scene->vertex_count * 3; ++i)
        normals = scene->normals[i] != 0;
    for (uint32_t m = 0; !textures && m < scene->material_count; ++m)
        textures = scene->materials[m].base_color_texture >= 0;
    snprintf(text, size, "%s%s%s%s", common, normals ? "#define GW_NORMALS 1\n" : "",
             textures ? "#define GW_TEXTURES 1\n" : "", scene->colors ? "#define GW_COLORS 1\n" : "");
}

/* Rows of a node's sums, as shaders/build/payload.glsl has them. */
static int sum_rows(int seed, int emits) {
    return (seed ? 4 : 6) + (emits ? 1 : 0);
}

gw_code gw_payload_inputs_make(gw_octree_builder *builder, gw_error *error) {
    payload_stage stage = {.builder = builder};
    if (builder->inputs.ready)
        return GW_OK;
    gw_code code = upload_faces(&stage, error);
    if (code == GW_OK)
        code = upload_materials(&stage, error);
    if (code == GW_OK)
        code = upload_thresholds(&stage, error);
    if (code == GW_OK)
        builder->inputs.ready = 1;
    else
        gw_payload_inputs_finish(&builder->inputs);
    return code;
}

static gw_code start_stage(payload_stage *stage, gw_error *error) {
    gw_gl *device = stage->builder->device;
    int emits = gw_octree_emits(stage->builder->scene);
    int seed = stage->builder->settings->payload_rule == GW_PAYLOAD_SEED;
    char common[64], defines[192];
    snprintf(common, sizeof common, "%s%s", emits ? "#define GW_EMISSION 1\n" : "",
             seed ? "#define GW_SEED_RULE 1\n" : "");
    stage->sum_bytes = (size_t)sum_rows(seed, emits) * ROW_BYTES;
    uint64_t nodes = (uint64_t)gw_gl_limits_of(device)->storage_block_bytes / stage->sum_bytes;
    /* A window begins at a multiple of 16 nodes, which is one of 256 bytes: every driver's offset alignment
     * divides that. */
    stage->window_nodes = (uint32_t)(nodes < (1u << 30) ? nodes : 1u << 30) & ~15u;
    leaf_defines(stage->builder->scene, common, defines, sizeof defines);
    gw_code code = gw_gl_program(device, "build/payload_leaf.comp", defines, &stage->leaf_program, error);
    if (code == GW_OK && emits && !stage->octree->emissions)
        code = gw_allocate((void **)&stage->octree->emissions, stage->octree->node_room,
                           sizeof *stage->octree->emissions, "emissions of voxels", error);
    if (code == GW_OK)
        code = gw_gl_program(device, "build/payload_inner.comp", common, &stage->inner_program, error);
    if (code == GW_OK)
        code = gw_gl_program(device, "build/payload_encode.comp", common, &stage->encode_program, error);
    if (code == GW_OK)
        code = gw_gl_buffer_create(device, "references", (size_t)gw_octree_reference_bytes(stage->octree),
                                   stage->octree->references, GL_R32UI, &stage->references, error);
    if (code == GW_OK)
        code = upload_vertices(stage, error);
    return code == GW_OK ? gw_payload_inputs_make(stage->builder, error) : code;
}

/* The sums of nodes [first, first + count) of the level as storage binding 0. */
static void bind_sums(const payload_stage *stage, uint32_t first, uint32_t count) {
    glBindBufferRange(GL_SHADER_STORAGE_BUFFER, 0, stage->sums.id,
                      (GLintptr)((size_t)first * stage->sum_bytes),
                      (GLsizeiptr)((size_t)count * stage->sum_bytes));
}

static gw_code run_jobs(payload_stage *stage, GLuint program, const uint32_t (*jobs)[4], uint32_t job_count,
                        uint32_t node_first, gw_error *error) {
    gw_gl_buffer buffer = {0};
    if (job_count == 0)
        return GW_OK;
    gw_code code = gw_gl_buffer_create(stage->builder->device, "payload jobs", (size_t)job_count * 16, jobs,
                                       0, &buffer, error);
    if (code == GW_OK) {
        glProgramUniform1ui(program, LOCATION_JOB_COUNT, job_count);
        glProgramUniform1ui(program, LOCATION_NODE_FIRST, node_first);
        gw_gl_buffer_bind(&buffer, 1);
        code = gw_gl_dispatch(stage->builder->device, program, (job_count + GROUP - 1) / GROUP, error);
    }
    gw_gl_buffer_finish(&buffer);
    return code;
}

static uint32_t list_length(const gw_octree *octree, const gw_node *node) {
    uint32_t length = 1;
    if (GW_NODE_KIND(node->bits) == GW_LEAF_SINGLE)
        return 1;
    while (!(octree->references[node->link + length - 1] & GW_REFERENCE_LAST))
        length++;
    return length;
}

/* The job of a leaf of `length` triangles; a job belongs to bucket min(length, BUCKETS) - 1. */
static uint32_t bucket_of(uint32_t length) {
    return (length < BUCKETS ? length : BUCKETS) - 1;
}

/* Leaves of the window, list entries [pass * LIST_LIMIT, ...): one invocation may only loop so often. Returns
 * the jobs in `jobs`, short lists first, and sets *more when a longer list is left. The invocations that a
 * GPU runs side by side then have lists of one length; nobody waits for a longer one. */
static uint32_t leaf_jobs(const payload_stage *stage, uint32_t level, uint32_t first, uint32_t count,
                          uint32_t pass, uint32_t (*jobs)[4], int *more) {
    const gw_octree *octree = stage->octree;
    const gw_node *nodes = octree->nodes + octree->level_begin[level];
    uint32_t places[BUCKETS + 1] = {0}, after = pass * LIST_LIMIT;
    *more = 0;
    for (uint32_t i = first; i < first + count; ++i) {
        uint32_t length = GW_NODE_KIND(nodes[i].bits) == GW_KIND_INNER ? 0 : list_length(octree, &nodes[i]);
        *more |= length > after + LIST_LIMIT;
        if (length > after)
            places[bucket_of(length) + 1]++;
    }
    for (uint32_t b = 0; b < BUCKETS; ++b)
        places[b + 1] += places[b];
    for (uint32_t i = first; i < first + count; ++i) {
        const uint32_t *cell = stage->builder->levels[level].cells[i];
        uint32_t kind = GW_NODE_KIND(nodes[i].bits);
        uint32_t length = kind == GW_KIND_INNER ? 0 : list_length(octree, &nodes[i]);
        if (length <= after)
            continue;
        uint32_t *job = jobs[places[bucket_of(length)]++];
        job[0] = i;
        job[1] = cell[0];
        job[2] = cell[1] | (kind == GW_LEAF_SINGLE ? (uint32_t)SINGLE : 0u);
        job[3] = nodes[i].link;
    }
    return places[BUCKETS - 1];
}

static gw_code sum_leaves(payload_stage *stage, uint32_t level, uint32_t first, uint32_t count,
                          uint32_t (*jobs)[4], gw_error *error) {
    const gw_payload_inputs *inputs = &stage->builder->inputs;
    const gw_gl_buffer *textures[] = {
        &stage->builder->triangles, &stage->references, &inputs->faces, &stage->vertices,
        &inputs->materials,         &inputs->chains,    &inputs->texels};
    gw_code code = GW_OK;
    int more = 1;
    for (GLuint unit = 0; unit < sizeof textures / sizeof *textures; ++unit)
        gw_gl_texture_bind(textures[unit], unit);
    glProgramUniform1ui(stage->leaf_program, LOCATION_LEVEL, level);
    glProgramUniform1ui(stage->leaf_program, LOCATION_LIST_LIMIT, LIST_LIMIT);
    for (uint32_t pass = 0; more && code == GW_OK; ++pass) {
        uint32_t job_count = leaf_jobs(stage, level, first, count, pass, jobs, &more);
        glProgramUniform1ui(stage->leaf_program, LOCATION_LIST_FIRST, pass * LIST_LIMIT);
        code = run_jobs(stage, stage->leaf_program, (const uint32_t(*)[4])jobs, job_count, first, error);
    }
    return code;
}

static gw_code sum_inner(payload_stage *stage, uint32_t level, uint32_t first, uint32_t count,
                         uint32_t (*jobs)[4], gw_error *error) {
    const gw_octree *octree = stage->octree;
    uint32_t job_count = 0;
    for (uint32_t i = first; i < first + count; ++i) {
        const gw_node *node = &octree->nodes[octree->level_begin[level] + i];
        if (GW_NODE_KIND(node->bits) != GW_KIND_INNER)
            continue;
        jobs[job_count][0] = i;
        jobs[job_count][1] = node->link - octree->level_begin[level + 1];
        jobs[job_count][2] = GW_NODE_VALID(node->bits);
        job_count++;
    }
    if (job_count == 0)
        return GW_OK;
    gw_gl_texture_bind(&stage->below, 0);
    return run_jobs(stage, stage->inner_program, (const uint32_t(*)[4])jobs, job_count, first, error);
}

static gw_code encode(payload_stage *stage, uint32_t level, uint32_t first, uint32_t count, gw_error *error) {
    gw_gl_buffer words = {0}, emissions = {0};
    gw_octree *octree = stage->octree;
    size_t at = (size_t)octree->level_begin[level] + first, bytes = (size_t)count * sizeof(gw_payload);
    size_t emission_bytes = octree->emissions ? (size_t)count * sizeof *octree->emissions : 0;
    gw_code code =
        gw_gl_buffer_create(stage->builder->device, "payload words", bytes, NULL, 0, &words, error);
    if (code == GW_OK && octree->emissions)
        code = gw_gl_buffer_create(stage->builder->device, "emission words", emission_bytes, NULL, 0,
                                   &emissions, error);
    if (code == GW_OK) {
        glProgramUniform1ui(stage->encode_program, LOCATION_JOB_COUNT, count);
        gw_gl_buffer_bind(&stage->builder->inputs.thresholds, 1);
        glProgramUniform1f(stage->encode_program, LOCATION_SEPARATION,
                           (float)stage->builder->settings->separation);
        gw_gl_buffer_bind(&words, 2);
        if (octree->emissions)
            gw_gl_buffer_bind(&emissions, 3);
        code =
            gw_gl_dispatch(stage->builder->device, stage->encode_program, (count + GROUP - 1) / GROUP, error);
    }
    if (code == GW_OK)
        code = gw_gl_buffer_read(&words, 0, bytes, octree->payloads + at, error);
    if (code == GW_OK && octree->emissions)
        code = gw_gl_buffer_read(&emissions, 0, emission_bytes, octree->emissions + at, error);
    gw_gl_buffer_finish(&words);
    gw_gl_buffer_finish(&emissions);
    return code;
}

/* All nodes of a level, window by window; stage->below holds the sums of the level below. */
static gw_code sum_level(payload_stage *stage, uint32_t level, gw_error *error) {
    gw_octree *octree = stage->octree;
    uint32_t nodes = octree->level_begin[level + 1] - octree->level_begin[level];
    uint32_t(*jobs)[4] = NULL;
    gw_code code =
        gw_gl_buffer_create(stage->builder->device, "payload sums", (size_t)nodes * stage->sum_bytes, NULL,
                            GL_RGBA32F, &stage->sums, error);
    if (code == GW_OK)
        code = gw_allocate((void **)&jobs, nodes < stage->window_nodes ? nodes : stage->window_nodes,
                           sizeof *jobs, "payload jobs", error);
    for (uint32_t first = 0; code == GW_OK && first < nodes; first += stage->window_nodes) {
        uint32_t count = nodes - first < stage->window_nodes ? nodes - first : stage->window_nodes;
        int64_t start = gw_now_ns();
        bind_sums(stage, first, count);
        code = sum_leaves(stage, level, first, count, jobs, error);
        if (code == GW_OK)
            code = gw_gl_finish(stage->builder->device, error);
        octree->statistics.milliseconds[1] += (double)(gw_now_ns() - start) * 1e-6;
        start = gw_now_ns();
        if (code == GW_OK)
            code = sum_inner(stage, level, first, count, jobs, error);
        if (code == GW_OK)
            code = encode(stage, level, first, count, error);
        octree->statistics.milliseconds[2] += (double)(gw_now_ns() - start) * 1e-6;
    }
    free(jobs);
    gw_gl_buffer_finish(&stage->below);
    stage->below = stage->sums;
    stage->sums = (gw_gl_buffer){0};
    return code;
}

/* The sums that the stage holds as those of the level below the next one. */
static gw_code read_sums(const payload_stage *stage, uint32_t level, void **out, gw_error *error) {
    uint32_t nodes = stage->octree->level_begin[level + 1] - stage->octree->level_begin[level];
    gw_code code = gw_allocate(out, nodes, stage->sum_bytes, "sums of voxels", error);
    return code == GW_OK && nodes > 0
               ? gw_gl_buffer_read(&stage->below, 0, nodes * stage->sum_bytes, *out, error)
               : code;
}

static gw_code write_sums(payload_stage *stage, uint32_t level, const void *sums, gw_error *error) {
    uint32_t nodes = stage->octree->level_begin[level + 1] - stage->octree->level_begin[level];
    return nodes == 0 ? GW_OK
                      : gw_gl_buffer_create(stage->builder->device, "payload sums", nodes * stage->sum_bytes,
                                            sums, GL_RGBA32F, &stage->below, error);
}

gw_code gw_octree_payload(gw_octree_builder *builder, const gw_payload_range *range, gw_octree *octree,
                          gw_error *error) {
    payload_stage stage = {.builder = builder, .octree = octree};
    gw_code code = start_stage(&stage, error);
    if (code == GW_OK && range->sums_below)
        code = write_sums(&stage, range->deepest + 1, range->sums_below, error);
    for (uint32_t level = range->deepest + 1; code == GW_OK && level-- > range->highest;) {
        gw_log_progress(builder->log, "averaging voxels",
                        1.0 - (double)level / (octree->statistics.deepest + 1));
        code = sum_level(&stage, level, error);
    }
    if (code == GW_OK && range->sums_above)
        code = read_sums(&stage, range->highest, range->sums_above, error);
    if (range->sum_bytes)
        *range->sum_bytes = stage.sum_bytes;
    finish_stage(&stage);
    return code;
}
