/* See compare.h: frame by frame, each drawn as it was recorded and once more, exact. */
#include "wall/compare.h"

#include "render/camera.h"
#include "render/predicted_error.h"
#include "render/vector3.h"
#include "wall/frames.h"
#include "wall/model.h"
#include "wall/report.h"
#include "wall/triple.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

/* One of the two frames that are compared. */
typedef struct drawn {
    gw_image picture;
    gw_geometry geometry;
} drawn;

typedef struct run {
    gw_compare *compare;
    gw_model model;
    gw_renderer *renderer;
    gw_layout layout; /* one tile */
    gw_rectangle all;
    gw_states states;
    gw_metric_track track;
    drawn frames[2]; /* reference, test */
    gw_pair_folder pairs;
} run;

static gw_code make_frame(drawn *frame, const gw_rectangle *all, gw_error *error) {
    gw_code code = gw_image_create(all->width, all->height, &frame->picture, error);
    return code ? code : gw_geometry_create(all->width, all->height, &frame->geometry, error);
}

static void finish_frame(drawn *frame) {
    gw_image_finish(&frame->picture);
    gw_geometry_finish(&frame->geometry);
}

static gw_metric_frame frame_of(const drawn *frame) {
    return (gw_metric_frame){.width = frame->picture.width,
                             .height = frame->picture.height,
                             .picture = &frame->picture,
                             .ids = frame->geometry.ids,
                             .depths = frame->geometry.depths,
                             .normals = frame->geometry.normals};
}

static gw_code draw(run *r, const gw_similarity *placement, const gw_frame_state *state, drawn *out,
                    gw_counters *counters, gw_error *error) {
    const gw_plane *plane = &r->layout.tiles[0].plane;
    gw_code code =
        gw_renderer_frame(r->renderer, placement, plane, &r->all, state, out->picture.rgba, counters, error);
    return code ? code
                : gw_renderer_geometry(r->renderer, placement, plane, &r->all, state, &out->geometry, error);
}

/* Where the first viewer's gaze meets the plane, px. Returns 0 when it does not, or nobody's is known. */
static int gaze_pixel(const gw_plane *plane, const gw_frame_state *state, double out[2]) {
    double normal[3], corner[3], direction[3], at[3];
    if (state->gaze_count == 0)
        return 0;
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        normal[k] = plane->step_x[i] * plane->step_y[j] - plane->step_x[j] * plane->step_y[i];
        corner[k] = plane->corner[k] - (double)state->gazes[0].eye[k];
        direction[k] = (double)state->gazes[0].direction[k];
    }
    const double t = gw_dot(corner, normal) / gw_dot(direction, normal);
    if (!(t > 0) || !isfinite(t))
        return 0;
    for (int k = 0; k < 3; k++)
        at[k] = t * direction[k] - corner[k];
    out[0] = gw_dot(at, plane->step_x) / gw_dot(plane->step_x, plane->step_x);
    out[1] = gw_dot(at, plane->step_y) / gw_dot(plane->step_y, plane->step_y);
    return 1;
}

static void write_head(FILE *rows) {
    fputs("frame,time_s,eye_x_mm,eye_y_mm,eye_z_mm,gaze_x_px,gaze_y_px,gaze_age_s,px_per_degree,tau,strain,"
          "predicted_error,rays,steps,node_loads,triangle_tests,voxels,further_rays,",
          rows);
    gw_compare_write_names(rows);
}

static void write_row(FILE *rows, const gw_frame_state *s, const double *gaze, double density,
                      double predicted, const gw_counters *c, const gw_metrics *metrics) {
    fprintf(rows, "%" PRIu32 ",%.6f,%.3f,%.3f,%.3f,", s->frame, (double)s->time * 1e-9, s->eye[0], s->eye[1],
            s->eye[2]);
    if (gaze)
        fprintf(rows, "%.2f,%.2f,%.4f,", gaze[0], gaze[1], (double)s->gazes[0].age);
    else
        fputs(",,,", rows);
    fprintf(rows, "%.4f,%g,%g,%.4f,%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",",
            density, (double)s->tau, (double)s->strain, predicted, c->rays, c->steps, c->node_loads,
            c->triangle_tests, c->voxels, gw_secondary_rays(c));
    gw_compare_write_values(rows, metrics);
}

static gw_code compare_frame(run *r, const gw_frame_state *state, FILE *rows, gw_error *error) {
    const gw_layout *layout = &r->layout;
    const gw_plane *plane = &layout->tiles[0].plane;
    const gw_frame_state exact = gw_exact_state(state);
    gw_similarity placement;
    gw_frame_block block;
    gw_counters counters = {0};
    gw_predicted_error predicted = {0};
    gw_metrics metrics;
    double gaze[2];
    const int gazed = gaze_pixel(plane, state, gaze);
    gw_code code = gw_place_frame(r->model.scene, state, layout->size[0], layout->size[1], layout->centre,
                                  layout->eye, &placement, error);
    if (!code)
        code = gw_frame_block_fill(r->model.scene, r->model.octree, &placement, plane, state, &block, NULL,
                                   error);
    if (!code)
        code = draw(r, &placement, &exact, &r->frames[0], NULL, error);
    if (!code)
        code = draw(r, &placement, state, &r->frames[1], &counters, error);
    if (!code)
        code = gw_predict_error(r->model.scene, r->model.octree, &placement, plane, &r->all, state,
                                &predicted, error);
    if (code)
        return code;
    const double offset = sqrt((double)(state->eye_offset[0] * state->eye_offset[0] +
                                        state->eye_offset[1] * state->eye_offset[1] +
                                        state->eye_offset[2] * state->eye_offset[2]));
    const gw_metric_view view = {.pixels_per_degree =
                                     gw_pixels_per_degree(plane, state->eye, r->all.width, r->all.height),
                                 .block = &block,
                                 .baseline = 2 * offset};
    const gw_metric_frame reference = frame_of(&r->frames[0]), test = frame_of(&r->frames[1]);
    code = gw_metric_track_add(&r->track, &reference, &test, &view, &metrics, error);
    if (!code)
        write_row(rows, state, gazed ? gaze : NULL, view.pixels_per_degree,
                  gw_predicted_error_worst(&predicted), &counters, &metrics);
    if (!code && r->compare->out)
        code = gw_pair_folder_add(&r->pairs, &r->frames[0].picture, &r->frames[1].picture, plane, state,
                                  gazed ? gaze : NULL, error);
    return code;
}

static gw_code open_run(run *r, gw_error *error) {
    gw_compare *c = r->compare;
    const gw_renderer_options how = {.count = 1,
                                     .settings = &c->draw.settings,
                                     .force_features = c->draw.force_effects,
                                     .forbid_features = c->draw.forbid_effects,
                                     .log = &c->console.log};
    gw_code code = gw_states_load(c->states, &r->states, error);
    if (!code && r->states.count == 0)
        code = gw_fail(error, GW_BAD_INPUT, "%s holds no frame state", c->states);
    if (!code)
        code = gw_wall_layout(&c->wall, &r->layout, error);
    if (!code)
        code = gw_model_open(&r->model, &c->draw, &c->console.log, error);
    if (!code)
        code =
            gw_renderer_create(r->model.device, r->model.scene, r->model.octree, &how, &r->renderer, error);
    r->all = (gw_rectangle){.width = c->wall.size[0], .height = c->wall.size[1]};
    for (int i = 0; i < 2 && !code; i++)
        code = make_frame(&r->frames[i], &r->all, error);
    return !code && c->out ? gw_pair_folder_open(&r->pairs, c->out, &r->layout.tiles[0].plane, r->all.width,
                                                 r->all.height, error)
                           : code;
}

static void close_run(run *r) {
    for (int i = 0; i < 2; i++)
        finish_frame(&r->frames[i]);
    gw_pair_folder_finish(&r->pairs);
    gw_metric_track_finish(&r->track);
    gw_renderer_destroy(&r->renderer);
    gw_model_close(&r->model);
    gw_states_finish(&r->states);
}

gw_code gw_compare_states(gw_compare *compare, FILE *rows, gw_metrics *out, gw_error *error) {
    run r = {.compare = compare};
    gw_code code = open_run(&r, error);
    size_t count = r.states.count;
    if (compare->frames > 0 && (size_t)compare->frames < count)
        count = (size_t)compare->frames;
    if (!code)
        write_head(rows);
    for (size_t i = 0; i < count && !code; i++)
        code = compare_frame(&r, &r.states.states[i], rows, error);
    if (!code) {
        gw_metric_track_of(&r.track, out);
        gw_report_device(compare->report, gw_gl_limits_of(r.model.device));
        gw_report_scene(compare->report, r.model.scene, r.model.import_ms);
        json_object_set_new(compare->report, "frames", json_integer((json_int_t)count));
    }
    if (!code && compare->out)
        code = gw_pair_folder_close(&r.pairs, compare->luminance, error);
    close_run(&r);
    return code;
}
