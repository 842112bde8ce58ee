/* Animated glTF: poses against what the formulas give by hand, what stays the same over time, and files that
 * lie. The scene is configs/scenes/moving.gltf (tests/tools/make_moving_scene.c tells what is in it); it goes
 * through the real import child ($GAZEWALL). */
#include "tests/support/check.h"

#include "base/file.h"
#include "base/memory.h"
#include "base/portable_math.h"
#include "build/animation.h"
#include "build/gltf_animation.h"
#include "build/gltf_data.h"
#include "build/import.h"
#include "build/scene_pose.h"
#include "tests/support/meshes.h"

#include <math.h>
#include <unistd.h>

static const char moving[] = "configs/scenes/moving.gltf";
static const int64_t second = 1000000000;

static gw_scene *import(const char *path, const char *animation) {
    const char *program = getenv("GAZEWALL");
    gw_scene *scene = NULL;
    const gw_import_options options = {.program = program ? program : "out/release/gazewall",
                                       .animation = animation};
    check_ok(gw_import(path, &options, &scene, &error));
    return scene;
}

static void metres(const gw_scene *scene, uint32_t vertex, double out[3]) {
    for (uint32_t i = 0; i < 3; i++)
        out[i] = scalbn((double)scene->positions[vertex * 3 + i], scene->exponent) + scene->centre[i];
}

/* Vertices of the scene at this point, to a hundredth of a millimetre. */
static uint32_t count_at(const gw_scene *scene, double x, double y, double z) {
    uint32_t count = 0;
    for (uint32_t v = 0; v < scene->vertex_count; v++) {
        double p[3];
        metres(scene, v, p);
        count += fabs(p[0] - x) < 1e-5 && fabs(p[1] - y) < 1e-5 && fabs(p[2] - z) < 1e-5;
    }
    return count;
}

static int has_note(const gw_scene *scene, const char *part) {
    for (size_t i = 0; i < scene->note_count; i++)
        if (strstr(scene->notes[i], part))
            return 1;
    return 0;
}

/* --- poses --- */

static void time_0_is_the_finished_scene(void **state) {
    (void)state;
    gw_scene *scene = import(moving, NULL);
    gw_posed *posed = NULL;
    assert_non_null(scene->animation);
    assert_true(has_note(scene, "animation 0 'all together' plays, 4 s long"));
    check_ok(gw_posed_create(scene, &posed, &error));
    const gw_scene *at = gw_posed_scene(posed);
    const size_t bytes = (size_t)scene->vertex_count * 3 * sizeof(float);
    assert_memory_equal(at->positions, scene->positions, bytes);
    assert_memory_equal(at->normals, scene->normals, bytes);
    gw_posed_move(posed, second / 3);
    assert_true(memcmp(at->positions, scene->positions, bytes) != 0);
    assert_true(memcmp(at->normals, scene->normals, bytes) != 0);
    gw_posed_move(posed, 0);
    assert_memory_equal(at->positions, scene->positions, bytes);
    gw_posed_destroy(&posed);
    gw_scene_destroy(&scene);
}

/* The box's centre on its cubic path and its turn about y; each corner of its sides has three vertices. */
static void check_box(const gw_scene *scene, double x, double z, double turn) {
    for (int corner = 0; corner < 4; corner++) {
        const double u = corner & 1 ? 0.4 : -0.4, w = corner & 2 ? 0.4 : -0.4;
        const double c = gw_cos(turn), s = gw_sin(turn);
        assert_int_equal(count_at(scene, x + c * u + s * w, 1.0, z - s * u + c * w), 3);
    }
    /* The rider: half as large, 0.6 m above the box's centre, turned with it. */
    const double c = gw_cos(turn), s = gw_sin(turn);
    assert_int_equal(count_at(scene, x + c * 0.2 + s * 0.2, 1.4, z - s * 0.2 + c * 0.2), 3);
}

static void nodes_follow_their_curves(void **state) {
    (void)state;
    gw_scene *scene = import(moving, NULL);
    gw_posed *posed = NULL;
    check_ok(gw_posed_create(scene, &posed, &error));
    const gw_scene *at = gw_posed_scene(posed);
    check_box(at, 0, 0, 0);
    gw_posed_move(posed, second); /* keys: exactly there */
    check_box(at, -1, 1, 0.5 * GW_PI);
    gw_posed_move(posed, second / 2);
    /* Half way a Hermite curve is the mean of its ends plus an eighth of what the tangents differ by; a chord
     * would pass (-0.5, 0.5), inside the circle. The turn is half of a quarter, at constant speed. */
    const double speed = 0.5 * GW_PI;
    check_box(at, -0.5 + (0 + speed) / 8, 0.5 + (speed - 0) / 8, 0.25 * GW_PI);
    gw_posed_move(posed, second / 4); /* a quarter of the turn: mixing quaternions would give 21.97 degrees */
    const double t = 0.25,
                 x = (2 * t * t * t - 3 * t * t + 1) * 0 + (-2 * t * t * t + 3 * t * t) * -1 +
                     (t * t * t - t * t) * -speed,
                 z = (-2 * t * t * t + 3 * t * t) * 1 + (t * t * t - 2 * t * t + t) * speed;
    check_box(at, x, z, 0.125 * GW_PI);
    gw_posed_destroy(&posed);
    gw_scene_destroy(&scene);
}

/* Two joints bend by 50 degrees each: the tube's mouth stands at 100. */
static void skins_follow_their_joints(void **state) {
    (void)state;
    gw_scene *scene = import(moving, NULL);
    gw_posed *posed = NULL;
    check_ok(gw_posed_create(scene, &posed, &error));
    gw_posed_move(posed, second);
    const double a = 50 * GW_PI / 180, third = 2.0 / 3, radius = 0.25;
    const double tip[2] = {1.4 - third * gw_sin(a), third + third * gw_cos(a)};
    const double along[2] = {-gw_sin(2 * a), gw_cos(2 * a)}, across[2] = {gw_cos(2 * a), gw_sin(2 * a)};
    for (int side = -1; side <= 1; side += 2)
        assert_int_equal(count_at(gw_posed_scene(posed),
                                  tip[0] + third * along[0] + side * radius * across[0],
                                  tip[1] + third * along[1] + side * radius * across[1], 0),
                         1);
    /* A ring half way between the joints' shares: half of it stays upright, half is bent about the joint. */
    const double half[2] = {1.4 + 0.5 * radius + 0.5 * radius * gw_cos(a), third + 0.5 * radius * gw_sin(a)};
    assert_int_equal(count_at(gw_posed_scene(posed), half[0], half[1], 0), 1);
    for (uint32_t v = 0; v < scene->vertex_count; v++) {
        const float *n = gw_posed_scene(posed)->normals + (size_t)v * 3;
        assert_true(fabs((double)n[0] * n[0] + (double)n[1] * n[1] + (double)n[2] * n[2] - 1) < 1e-5);
    }
    gw_posed_destroy(&posed);
    gw_scene_destroy(&scene);
}

static void clips_are_looped(void **state) {
    (void)state;
    static const int64_t pairs[][2] = {
        {4000000000, 0}, {5500000000, 1500000000}, {-1000000000, 3000000000}, {4000000000 * 100000 + 1, 1}};
    gw_scene *scene = import(moving, NULL);
    gw_posed *first = NULL, *later = NULL;
    check_ok(gw_posed_create(scene, &first, &error));
    check_ok(gw_posed_create(scene, &later, &error));
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        gw_posed_move(later, pairs[i][0]);
        gw_posed_move(first, pairs[i][1]);
        assert_memory_equal(gw_posed_scene(later)->positions, gw_posed_scene(first)->positions,
                            (size_t)scene->vertex_count * 12);
    }
    gw_posed_destroy(&first);
    gw_posed_destroy(&later);
    gw_scene_destroy(&scene);
}

/* --- what stays over time --- */

static void nothing_leaves_the_cube(void **state) {
    (void)state;
    gw_scene *scene = import(moving, NULL);
    gw_posed *posed = NULL;
    check_ok(gw_posed_create(scene, &posed, &error));
    for (int64_t time = 0; time < 4 * second; time += 7654321) {
        gw_posed_move(posed, time);
        assert_int_equal(gw_posed_held(posed), 0);
    }
    gw_posed_destroy(&posed);
    gw_scene_destroy(&scene);
}

/* The bead is a point at time 0: its triangles stay, its eight corners are not one vertex, and at its size
 * they are where they belong. Judged by the pose at time 0 it would be dropped, welded by position it would
 * be one vertex for ever. */
static void a_point_at_time_0_may_grow(void **state) {
    (void)state;
    gw_scene *scene = import(moving, NULL);
    gw_posed *posed = NULL;
    assert_int_equal(scene->triangle_count, 2 + 3 * 12 + 24 * 16 * 2);
    assert_int_equal(gw_dropped_total(&scene->dropped), 0);
    assert_int_equal(scene->welded_count, 4 + 3 * 8 + 25 * 16);
    check_ok(gw_posed_create(scene, &posed, &error));
    assert_int_equal(count_at(scene, 0.2, 1.6, 0.8), 24);
    gw_posed_move(posed, 3 * second / 2);
    assert_int_equal(count_at(gw_posed_scene(posed), 0.4, 1.8, 1.0), 3);
    gw_posed_move(posed, 7 * second / 2);
    assert_int_equal(count_at(gw_posed_scene(posed), 0.3, 1.7, 0.9), 3);
    gw_posed_destroy(&posed);
    gw_scene_destroy(&scene);
}

static void welded_vertices_stay_together(void **state) {
    (void)state;
    gw_scene *scene = import(moving, NULL);
    gw_posed *posed = NULL;
    check_ok(gw_posed_create(scene, &posed, &error));
    uint32_t *first = malloc(scene->welded_count * sizeof *first);
    assert_non_null(first);
    for (int64_t time = 0; time < 4 * second; time += 333333333) {
        gw_posed_move(posed, time);
        const float *positions = gw_posed_scene(posed)->positions;
        memset(first, 0xff, scene->welded_count * sizeof *first);
        for (uint32_t v = 0; v < scene->vertex_count; v++) {
            uint32_t *seen = &first[scene->welded[v]];
            *seen = *seen == UINT32_MAX ? v : *seen;
            assert_memory_equal(positions + (size_t)v * 3, positions + (size_t)*seen * 3, 12);
        }
    }
    free(first);
    gw_posed_destroy(&posed);
    gw_scene_destroy(&scene);
}

/* --- files --- */

/* moving.gltf with one text for another, in a scratch file. */
static const char *changed(char path[512], const char *from, const char *to) {
    gw_bytes bytes = {0};
    check_ok(gw_file_read(moving, 1 << 20, &bytes, &error));
    const char *text = (const char *)bytes.data, *at = strstr(text, from);
    assert_non_null(at);
    char *whole = NULL;
    assert_true(asprintf(&whole, "%.*s%s%s", (int)(at - text), text, to, at + strlen(from)) > 0);
    check_ok(gw_file_write(scratch_path(path, "changed.gltf"), whole, strlen(whole), &error));
    free(whole);
    gw_bytes_finish(&bytes);
    return path;
}

static void none_is_the_pose_at_rest(void **state) {
    (void)state;
    char path[512];
    gw_scene *scene = import(moving, "none");
    assert_null(scene->animation);
    assert_int_equal(scene->dropped.repeated_vertex,
                     12); /* at rest the bead is a point, and nothing will change that */
    assert_int_equal(count_at(scene, 1.65, 2.0, 0), 1);
    gw_scene_destroy(&scene);
    /* A skin that stays is put into its pose once: its joints decide, its node does not. */
    scene = import(
        changed(path, "\"mesh\": 2, \"skin\": 0", "\"mesh\": 2, \"skin\": 0, \"translation\": [9, 9, 9]"),
        "none");
    assert_null(scene->animation);
    assert_int_equal(count_at(scene, 1.65, 2.0, 0), 1);
    gw_scene_destroy(&scene);
}

static void the_choice_is_checked(void **state) {
    (void)state;
    gw_scene *scene = NULL;
    gw_import_options options = {.program = getenv("GAZEWALL"), .animation = "walk"};
    check_fails(gw_import(moving, &options, &scene, &error), GW_BAD_INPUT,
                "no animation 'walk' (it has 1, the first is 'all together')");
    check_fails(gw_import("tests/data/poster.gltf", &options, &scene, &error), GW_BAD_INPUT,
                "nothing in it moves, so no animation 'walk' can play");
    options.animation = "0";
    check_ok(gw_import(moving, &options, &scene, &error));
    assert_non_null(scene->animation);
    gw_scene_destroy(&scene);
}

/* The spans that the import child tells of moving.gltf. */
static const gw_vertex_span true_spans[5] = {
    {0, 0, 0, 0, 4}, {1, 1, 0, 4, 24}, {2, 1, 0, 28, 24}, {3, 2, 0, 52, 400}, {7, 1, 0, 452, 24}};

/* Reads a changed moving.gltf without the child, whose importer refuses some lies itself. */
static gw_code animate(const char *from, const char *to, const gw_vertex_span spans[5], gw_error *failure) {
    char path[512];
    gw_bytes bytes = {0};
    gw_gltf gltf;
    gw_source_model *model = NULL;
    check_ok(gw_file_read(changed(path, from, to), 1 << 20, &bytes, &error));
    check_ok(gw_gltf_open(bytes.data, bytes.size, NULL, &gltf, &error));
    check_ok(gw_source_model_create(&model, &error));
    model->scene->vertex_count = 476;
    check_ok(gw_allocate((void **)&model->world, 476, 3 * sizeof(double), "world", &error));
    model->spans = malloc(sizeof true_spans);
    assert_non_null(model->spans);
    memcpy(model->spans, spans, sizeof true_spans);
    model->span_count = 5;
    gw_code code = gw_gltf_animate(&gltf, NULL, NULL, model, failure);
    assert_true((model->scene->animation != NULL) == (code == GW_OK));
    gw_source_model_destroy(&model);
    gw_gltf_close(&gltf);
    gw_bytes_finish(&bytes);
    return code;
}

static void lies_are_refused(void **state) {
    (void)state;
    static const struct {
        const char *from, *to, *why;
    } lies[] = {
        {"\"joints\": [4, 5, 6]", "\"joints\": [4, 5, 99]", "joint 2 is not a node"},
        {"\"joints\": [4, 5, 6]", "\"joints\": [4, 5, -1]", "joint 2 is not a node"},
        {"\"joints\": [4, 5, 6]", "\"joints\": [4]", "hangs on joint 1 of 1"},
        {"\"joints\": [4, 5, 6]", "\"joints\": [4, 5, 6, 1]", "4 joints and 3 inverse bind matrices"},
        {"\"inverseBindMatrices\": 11", "\"inverseBindMatrices\": 2", "instead of 16 numbers"},
        {"\"interpolation\": \"STEP\"", "\"interpolation\": \"LEAP\"", "interpolation is not known"},
        {"\"interpolation\": \"CUBICSPLINE\"", "\"interpolation\": \"LINEAR\"", "15 values, 5 keys need 5"},
        {"{\"input\": 12", "{\"input\": 120", "'input' is not a number below"},
        {"{\"input\": 13", "{\"input\": 12", "3 values, 5 keys need 5"},
        {"{\"sampler\": 0", "{\"sampler\": 4", "'sampler' is not a number below"},
        {"\"node\": 1", "\"node\": 8", "'node' is not a number below"},
        {"\"skin\": 0", "\"skin\": 1", "'skin' is not a number below"},
        {"\"JOINTS_0\": 9", "\"JOINTS_0\": 2", "instead of 4 numbers"},
        {"\"JOINTS_0\": 9", "\"JOINTS_0\": 10", "has componentType 5126"},
        {"AACAPwAAAEAAAEBAAACAQA", "AACAPwAAAEAAAMB/AACAQA", "number 3 is not finite"},
        {"AACAPwAAAEAAAEBAAACAQA", "AACAPwAAAEAAAABAAACAQA", "do not rise"},
        {";base64,", ";base32,", "is not base64"},
    };
    for (size_t i = 0; i < sizeof lies / sizeof *lies; i++)
        check_fails(animate(lies[i].from, lies[i].to, true_spans, &error), GW_BAD_INPUT, lies[i].why);
    check_ok(animate("asset", "asset", true_spans, &error));
    for (uint32_t i = 1; i < 5; i++) { /* the child is not trusted, either */
        gw_vertex_span spans[5];
        memcpy(spans, true_spans, sizeof spans);
        spans[i].count--;
        check_fails(animate("asset", "asset", spans, &error), GW_BAD_INPUT, "vertices were read");
        memcpy(spans, true_spans, sizeof spans);
        spans[i].node = 8;
        check_fails(animate("asset", "asset", spans, &error), GW_BAD_INPUT, "is not in the file");
        spans[i] = (gw_vertex_span){1, 3, 0, 0, 4};
        check_fails(animate("asset", "asset", spans, &error), GW_BAD_INPUT, "is not in the file");
    }
}

/* --- order --- */

static void shuffle(uint32_t *values, uint32_t count, uint64_t *random) {
    for (uint32_t i = 0; i < count; i++)
        values[i] = i;
    for (uint32_t i = count; i > 1; i--) {
        const uint32_t k = (uint32_t)(gw_test_random(random) * i), swap = values[k];
        values[k] = values[i - 1];
        values[i - 1] = swap;
    }
}

enum { VERTICES = 476, TRIANGLES = 806 };

/* The animation's vertices in another order: the old v becomes place[v]; and its bindings, from the last to
 * the first, for a file in which the first vertex comes last. */
static void move_vertices(gw_animation *animation, const uint32_t place[VERTICES], int backwards) {
    static double positions[VERTICES][3];
    static float normals[VERTICES][3];
    uint32_t binding_of[VERTICES];
    memcpy(positions, animation->bind_positions, sizeof positions);
    memcpy(normals, animation->bind_normals, sizeof normals);
    memcpy(binding_of, animation->binding_of, sizeof binding_of);
    for (uint32_t v = 0; v < VERTICES; v++) {
        memcpy(animation->bind_positions + (size_t)place[v] * 3, positions[v], sizeof positions[v]);
        memcpy(animation->bind_normals + (size_t)place[v] * 3, normals[v], sizeof normals[v]);
        animation->binding_of[place[v]] =
            backwards && binding_of[v] > 0 ? animation->binding_count - binding_of[v] : binding_of[v];
    }
    for (uint32_t i = 1; backwards && 2 * i < animation->binding_count; i++) {
        const gw_binding swap = animation->bindings[i];
        animation->bindings[i] = animation->bindings[animation->binding_count - i];
        animation->bindings[animation->binding_count - i] = swap;
    }
}

/* Triangle t becomes turn[t] and begins at another corner. */
static void put_triangles(gw_scene *scene, gw_gltf_data *data, const uint32_t *place, const uint32_t *turn) {
    static const size_t indices_of[3] = {2, 5, 8}; /* accessors by mesh */
    uint32_t t = 0;
    for (uint32_t s = 0; s < 5; s++) {
        uint32_t *indices = NULL;
        size_t count = 0;
        check_ok(
            gw_gltf_integers(data, indices_of[true_spans[s].mesh], 1, "indices", &indices, &count, &error));
        for (size_t i = 0; i < count; i += 3, t++)
            for (uint32_t k = 0; k < 3; k++)
                scene->triangles[turn[t]][(k + turn[t]) % 3] = place[true_spans[s].first + indices[i + k]];
        free(indices);
    }
    assert_int_equal(t, TRIANGLES);
}

/* moving.gltf as a file would give it whose vertices, triangles and corners stand in another order, finished.
 */
static gw_scene *shuffled(uint64_t seed) {
    static double world[VERTICES][3];
    gw_bytes bytes = {0};
    gw_gltf gltf;
    gw_gltf_data data;
    gw_source_model *model = NULL;
    uint32_t place[VERTICES], turn[TRIANGLES];
    const int backwards = seed % 2 == 0;
    check_ok(gw_file_read(moving, 1 << 20, &bytes, &error));
    check_ok(gw_gltf_open(bytes.data, bytes.size, NULL, &gltf, &error));
    check_ok(gw_gltf_data_open(&gltf, NULL, &data, &error));
    check_ok(gw_source_model_create(&model, &error));
    gw_scene *scene = model->scene;
    scene->vertex_count = VERTICES;
    scene->triangle_count = TRIANGLES;
    scene->material_count = 1;
    scene->materials = calloc(1, sizeof *scene->materials);
    scene->material_of = calloc(TRIANGLES, sizeof *scene->material_of);
    scene->triangles = calloc(TRIANGLES, sizeof *scene->triangles);
    scene->normals = calloc((size_t)VERTICES * 3, sizeof *scene->normals);
    model->spans = malloc(sizeof true_spans);
    model->world = malloc(sizeof world);
    assert_true(scene->materials && scene->material_of && scene->triangles && scene->normals &&
                model->spans && model->world);
    scene->materials[0].base_color_texture = -1;
    for (int v = 0; v < 4; v++) { /* the floor, which stays */
        world[v][0] = v & 1 ? 3 : -3;
        world[v][2] = v & 2 ? 2 : -2;
    }
    memcpy(model->world, world, sizeof world);
    memcpy(model->spans, true_spans, sizeof true_spans);
    model->span_count = 5;
    check_ok(gw_gltf_animate(&gltf, NULL, NULL, model, &error));
    shuffle(place, VERTICES, &seed);
    shuffle(turn, TRIANGLES, &seed);
    put_triangles(scene, &data, place, turn);
    move_vertices(scene->animation, place, backwards);
    check_ok(gw_scene_finish(scene, model->world, &error));
    model->scene = NULL;
    gw_source_model_destroy(&model);
    gw_gltf_data_close(&data);
    gw_gltf_close(&gltf);
    gw_bytes_finish(&bytes);
    return scene;
}

static void the_order_in_the_file_changes_no_byte(void **state) {
    (void)state;
    gw_scene *first = shuffled(1);
    assert_int_equal(first->triangle_count, TRIANGLES);
    for (uint64_t seed = 2; seed < 6; seed++) {
        gw_scene *other = shuffled(seed);
        gw_posed *a = NULL, *b = NULL;
        assert_true(gw_hash_equal(first->hash, other->hash));
        check_ok(gw_posed_create(first, &a, &error));
        check_ok(gw_posed_create(other, &b, &error));
        gw_posed_move(a, 5 * second / 4);
        gw_posed_move(b, 5 * second / 4);
        assert_memory_equal(gw_posed_scene(a)->positions, gw_posed_scene(b)->positions,
                            (size_t)first->vertex_count * 12);
        gw_posed_destroy(&a);
        gw_posed_destroy(&b);
        gw_scene_destroy(&other);
    }
    gw_scene_destroy(&first);
}

static void yaml_places_what_moves(void **state) {
    (void)state;
    char path[512], folder[512];
    assert_non_null(getcwd(folder, sizeof folder));
    char *text = NULL;
    assert_true(asprintf(&text,
                         "version: 1\nmodels:\n  - {file: %s/tests/data/tetra.off}\n"
                         "  - {file: %s/%s, translate: [10, 0, 0]}\n"
                         "  - {file: %s/%s, rotate: [0, 90, 0], scale: 2}\n"
                         "  - {file: %s/%s, translate: [0, 0, 20], animation: none}\n",
                         folder, folder, moving, folder, moving, folder, moving) > 0);
    check_ok(gw_file_write(scratch_path(path, "moving.yaml"), text, strlen(text), &error));
    gw_scene *scene = import(path, NULL);
    gw_posed *posed = NULL;
    check_ok(gw_posed_create(scene, &posed, &error));
    gw_posed_move(posed, second);
    const gw_scene *at = gw_posed_scene(posed);
    assert_int_equal(count_at(at, -1 + 10 + 0.4, 1.0, 1.4), 3);
    assert_int_equal(count_at(at, 2 * 1.4, 2 * 1.0, -2 * (-1 + 0.4)), 3); /* x, z become z, -x */
    assert_int_equal(count_at(at, 0.4, 1.0, 20.4), 3);                    /* the third one stays */
    assert_int_equal(count_at(at, 0, 1, 0), 3);                           /* and so does the tetrahedron */
    gw_posed_destroy(&posed);
    gw_scene_destroy(&scene);
    free(text);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(time_0_is_the_finished_scene),
        cmocka_unit_test(nodes_follow_their_curves),
        cmocka_unit_test(skins_follow_their_joints),
        cmocka_unit_test(clips_are_looped),
        cmocka_unit_test(nothing_leaves_the_cube),
        cmocka_unit_test(a_point_at_time_0_may_grow),
        cmocka_unit_test(welded_vertices_stay_together),
        cmocka_unit_test(none_is_the_pose_at_rest),
        cmocka_unit_test(the_choice_is_checked),
        cmocka_unit_test(lies_are_refused),
        cmocka_unit_test(yaml_places_what_moves),
        cmocka_unit_test(the_order_in_the_file_changes_no_byte),
    };
    return cmocka_run_group_tests_name("animation", tests, NULL, NULL);
}
