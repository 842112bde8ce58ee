/* `gazewall bench resident`: many models resident at once, as in section 7 of Weier et al. 2014 ("several
 * dozen models"): each with an octree of 512^3 and a renderer of its own on one device; bytes by part and one
 * frame of each. Without models, rocks of many sizes made by formula. */
#include "wall/bench.h"

#include "base/clock.h"
#include "base/memory.h"
#include "build/import.h"
#include "wall/cost_model.h"
#include "wall/frames.h"
#include "wall/report.h"
#include "wall/rock.h"
#include "wall/sim_options.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PAPER_DEPTH = 9, QUICK_DEPTH = 6 };
enum { ROCKS = 36, QUICK_ROCKS = 4 };

typedef struct resident {
    gw_scene *scene;
    gw_octree *octree;
    gw_renderer *renderer;
    gw_similarity placement;
    gw_renderer_parts parts;
    gw_hash picture;
    double build_ms, frame_ms;
} resident;

typedef struct residents {
    gw_bench *bench;
    gw_settings settings;
    gw_layout layout;
    gw_rectangle rectangle;
    gw_frame_state state;
    uint8_t *pixels;
    size_t count;
    resident *models;
} residents;

static gw_code make_wall(residents *r, gw_error *error) {
    const gw_bench *bench = r->bench;
    gw_wall_options wall;
    gw_wall_options_init(&wall, 1, 1);
    wall.size[0] = bench->size[0] ? bench->size[0] : bench->quick ? 80 : 480;
    wall.size[1] = bench->size[0] ? bench->size[1] : bench->quick ? 45 : 270;
    gw_code code = gw_wall_layout(&wall, &r->layout, error);
    r->rectangle = (gw_rectangle){.width = wall.size[0], .height = wall.size[1]};
    gw_frame_begin(&r->state, 0, &r->settings, bench->draw.seed, bench->draw.debug);
    gw_frame_stare(&r->state, r->layout.eye, NULL, &r->settings);
    if (!code)
        code = gw_allocate((void **)&r->pixels, (size_t)wall.size[0] * wall.size[1], 4, "pixels", error);
    return code;
}

static gw_code read_model(const residents *r, size_t index, gw_scene **out, gw_error *error) {
    const gw_bench *bench = r->bench;
    const gw_import_options import = {.outlier_extents = r->settings.outlier_extents,
                                      .animation = bench->draw.animation,
                                      .log = &bench->console.log};
    const uint32_t step = bench->quick ? 500 : 5000;
    return bench->scene_count ? gw_import(bench->scenes[index], &import, out, error)
                              : gw_rock_scene(4 * step + (uint32_t)index * step, out, error);
}

static gw_code open_model(residents *r, resident *model, size_t index, gw_error *error) {
    gw_gl *device = r->bench->model.device;
    const gw_octree_options how = {.settings = &r->settings};
    const gw_renderer_options plain = gw_bench_rendering(r->bench, 0);
    gw_code code = read_model(r, index, &model->scene, error);
    const int64_t begin = gw_now_ns();
    if (!code)
        code = gw_octree_build(device, model->scene, &how, &model->octree, error);
    model->build_ms = (double)(gw_now_ns() - begin) * 1e-6;
    if (!code)
        code = gw_place_scene(model->scene, r->layout.size[0], r->layout.size[1], r->layout.centre,
                              r->layout.eye, &model->placement, error);
    if (!code)
        code = gw_renderer_create(device, model->scene, model->octree, &plain, &model->renderer, error);
    return code;
}

static gw_code draw_model(residents *r, resident *model, gw_error *error) {
    const int64_t begin = gw_now_ns();
    gw_code code = gw_renderer_frame(model->renderer, &model->placement, &r->layout.tiles[0].plane,
                                     &r->rectangle, &r->state, r->pixels, NULL, error);
    model->frame_ms = (double)(gw_now_ns() - begin) * 1e-6;
    model->picture =
        gw_hash_bytes((gw_hash){0, 0}, r->pixels, (size_t)r->rectangle.width * r->rectangle.height * 4);
    model->parts = gw_renderer_parts_of(model->renderer);
    return code;
}

/* All models open before the first frame; the first round compiles kernels, the second counts. */
static gw_code run(residents *r, gw_error *error) {
    gw_code code = make_wall(r, error);
    for (size_t i = 0; i < r->count && !code; i++) {
        code = open_model(r, &r->models[i], i, error);
        gw_log_progress(&r->bench->console.log, "building octrees", (double)(i + 1) / (double)r->count);
    }
    for (size_t i = 0; i < 2 * r->count && !code; i++) {
        code = draw_model(r, &r->models[i % r->count], error);
        gw_log_progress(&r->bench->console.log, "drawing", (double)(i + 1) / (double)(2 * r->count));
    }
    return code;
}

/* --- results --- */

static uint64_t sum_of(const gw_renderer_parts *p) {
    return p->nodes + p->references + p->voxels + p->triangles + p->attributes + p->textures + p->rays;
}

static resident total_of(const residents *r, uint64_t *triangles) {
    resident total = {0};
    *triangles = 0;
    for (size_t i = 0; i < r->count; i++) {
        const resident *m = &r->models[i];
        *triangles += m->scene->triangle_count;
        total.parts.nodes += m->parts.nodes;
        total.parts.references += m->parts.references;
        total.parts.voxels += m->parts.voxels;
        total.parts.triangles += m->parts.triangles;
        total.parts.attributes += m->parts.attributes;
        total.parts.textures += m->parts.textures;
        total.parts.rays += m->parts.rays;
        total.build_ms += m->build_ms;
        total.frame_ms += m->frame_ms;
    }
    return total;
}

static json_t *row_of(const char *name, uint64_t triangles, const resident *m) {
    const gw_renderer_parts *p = &m->parts;
    return json_pack("{s:s, s:I, s:{s:I, s:I, s:I, s:I, s:I, s:I, s:I}, s:f, s:f}", "name", name, "triangles",
                     (json_int_t)triangles, "bytes", "nodes", (json_int_t)p->nodes, "references",
                     (json_int_t)p->references, "voxels", (json_int_t)p->voxels, "triangles",
                     (json_int_t)p->triangles, "attributes", (json_int_t)p->attributes, "textures",
                     (json_int_t)p->textures, "rays", (json_int_t)p->rays, "build_ms", m->build_ms,
                     "frame_ms", m->frame_ms);
}

static void write_row(FILE *csv, const char *name, uint64_t triangles, const resident *m) {
    const gw_renderer_parts *p = &m->parts;
    fprintf(csv,
            "%s,%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%" PRIu64
            ",%.3f,%.3f\n",
            name, triangles, p->nodes, p->references, p->voxels, p->triangles, p->attributes, p->textures,
            p->rays, m->build_ms, m->frame_ms);
}

static void print_row(const char *name, uint64_t triangles, const resident *m) {
    const double mib = 1.0 / 1048576.0;
    const gw_renderer_parts *p = &m->parts;
    printf("%-28.28s %9" PRIu64 " %7.2f %7.2f %7.2f %7.2f %7.2f %7.2f %7.2f %8.2f %8.0f %8.1f\n", name,
           triangles, (double)p->nodes * mib, (double)p->references * mib, (double)p->voxels * mib,
           (double)p->triangles * mib, (double)p->attributes * mib, (double)p->textures * mib,
           (double)p->rays * mib, (double)sum_of(p) * mib, m->build_ms, m->frame_ms);
}

static void name_model(const residents *r, size_t index, char name[64]) {
    const gw_bench *bench = r->bench;
    const char *path = bench->scene_count ? bench->scenes[index] : "";
    const char *slash = strrchr(path, '/');
    if (bench->scene_count)
        snprintf(name, 64, "%s", slash ? slash + 1 : path);
    else
        snprintf(name, 64, "rock %zu", index);
}

/* The model of bytes beside what is there; textures are what they are. Every model is judged by one that is
 * fitted to the others. */
static gw_code judge_bytes(const residents *r, json_t **out, gw_error *error) {
    gw_cost_model fitted;
    gw_cost_sample *samples = NULL;
    double worst = 1;
    int flagged = 0;
    char text[240];
    gw_code code = gw_allocate((void **)&samples, r->count, sizeof *samples, "bytes of models", error);
    for (size_t i = 0; i < r->count && !code; i++) {
        const resident *m = &r->models[i];
        samples[i] =
            gw_cost_of_memory(m->octree, m->scene, (uint64_t)r->rectangle.width * r->rectangle.height,
                              sum_of(&m->parts) - m->parts.textures);
    }
    if (!code)
        code = gw_cost_fit(GW_COST_MEMORY, samples, r->count, &fitted, error);
    for (size_t i = 0; i < r->count && !code; i++) {
        gw_cost_verdict verdict;
        code = gw_cost_judge_left_out(GW_COST_MEMORY, samples, r->count, i, &verdict, error);
        flagged += verdict.flagged;
        if (fabs(log(verdict.ratio)) > fabs(log(worst)))
            worst = verdict.ratio;
    }
    free(samples);
    if (code)
        return code;
    gw_cost_describe(&fitted, text, sizeof text);
    if (!r->bench->draw.quiet)
        printf("bytes by the model: %s; predicted from the others, at worst %.2f of what is there%s\n", text,
               worst, flagged ? ": OFF by more than a factor 3" : "");
    *out = gw_cost_report(&fitted);
    json_object_set_new(*out, "worst", json_real(worst));
    json_object_set_new(*out, "flagged", json_integer(flagged));
    return GW_OK;
}

static gw_code tell(const residents *r, gw_error *error) {
    const gw_bench *bench = r->bench;
    char *text = NULL, name[64], digits[33];
    size_t size = 0;
    uint64_t triangles;
    const resident total = total_of(r, &triangles);
    FILE *csv = open_memstream(&text, &size);
    json_t *models = json_array();
    if (!csv || !models)
        return gw_fail(error, GW_MACHINE, "memory is out while writing results");
    fputs(
        "model,triangles,node_bytes,reference_bytes,voxel_bytes,triangle_bytes,attribute_bytes,texture_bytes,"
        "ray_bytes,build_ms,frame_ms\n",
        csv);
    if (!bench->draw.quiet)
        printf("%-28s %9s %7s %7s %7s %7s %7s %7s %7s %8s %8s %8s\n", "MiB by part", "triangles", "nodes",
               "refs", "voxels", "corners", "others", "texture", "rays", "all", "build ms", "frame ms");
    for (size_t i = 0; i < r->count; i++) {
        const resident *m = &r->models[i];
        name_model(r, i, name);
        json_t *row = row_of(name, m->scene->triangle_count, m);
        gw_hash_text(m->picture, digits);
        json_object_set_new(row, "picture", json_string(digits));
        json_array_append_new(models, row);
        write_row(csv, name, m->scene->triangle_count, m);
        if (!bench->draw.quiet)
            print_row(name, m->scene->triangle_count, m);
    }
    snprintf(name, sizeof name, "all %zu", r->count);
    write_row(csv, name, triangles, &total);
    if (!bench->draw.quiet)
        print_row(name, triangles, &total);
    fclose(csv);
    json_object_set_new(bench->report, "bench",
                        json_pack("{s:s, s:i, s:o, s:o}", "name", "resident", "depth",
                                  (int)r->settings.octree_depth, "models", models, "all",
                                  row_of(name, triangles, &total)));
    json_t *bytes = NULL;
    gw_code code = r->count > 1 ? judge_bytes(r, &bytes, error) : GW_OK;
    json_object_set_new(json_object_get(bench->report, "bench"), "model", bytes ? bytes : json_null());
    if (!code)
        code = gw_bench_write(bench, "resident", text, size, error);
    free(text);
    return code;
}

gw_code gw_bench_resident(gw_bench *bench, gw_error *error) {
    residents r = {.bench = bench, .settings = bench->draw.settings};
    r.settings.octree_depth = bench->quick ? QUICK_DEPTH : PAPER_DEPTH;
    r.count = bench->scene_count ? bench->scene_count : bench->quick ? QUICK_ROCKS : ROCKS;
    gw_code code = gw_allocate((void **)&r.models, r.count, sizeof *r.models, "models", error);
    if (!code)
        code = run(&r, error);
    gw_console_finish(&bench->console);
    if (!code)
        code = tell(&r, error);
    for (size_t i = 0; r.models && i < r.count; i++) {
        gw_renderer_destroy(&r.models[i].renderer);
        gw_octree_destroy(&r.models[i].octree);
        gw_scene_destroy(&r.models[i].scene);
    }
    free(r.models);
    free(r.pixels);
    return code;
}
