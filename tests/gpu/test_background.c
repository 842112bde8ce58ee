/* Kernels that are made in the background: meanwhile others that know more draw the same pixels, afterwards
 * those that were made do, and nothing of it is left when the renderer is gone. And what is told while
 * kernels are compiled. */
#include "tests/support/check.h"

#include "base/clock.h"
#include "render/features.h"
#include "tests/support/meshes.h"
#include "tests/support/renders.h"

#include <dirent.h>
#include <time.h>

enum { SIDE = 24, PIXELS = SIDE * SIDE };

static gw_stage stage;
static gw_camera sharp, coarse; /* the second calls for voxels beside what the first calls for */

static int open_stage(void **state) {
    (void)state;
    gw_mesh mesh = {0};
    gw_mesh_add_sphere(&mesh, (const double[]){-0.2, 0, 0}, 0.5, 0.1, 24, 12);
    gw_mesh_add_sphere(&mesh, (const double[]){0.4, 0.2, -0.6}, 0.5, 0, 24, 12);
    check_ok(gw_stage_open(
        &stage, gw_mesh_take(&mesh), NULL,
        (const char *const[]){"octree_depth=5", "tau=0", "tau_inside=0", "sample_block=1", "samples=1", NULL},
        &error));
    gw_camera_look(&sharp, &stage, (const double[]){0.3, 0.4, 3}, (const double[]){0, 0, 0}, 32, SIDE);
    coarse = sharp;
    coarse.state.tau_inside = 2;
    return 0;
}

static int close_stage(void **state) {
    (void)state;
    gw_stage_close(&stage);
    return 0;
}

/* Forgets all variants, so that no test profits from another's. */
static void forget_variants(void) {
    for (uint64_t i = 0; i < GW_GL_VARIANTS; ++i) {
        gw_gl_variant_begin(stage.device, (gw_hash){1, i});
        gw_gl_variant_end(stage.device);
    }
}

static gw_renderer *renderer_making(gw_kernel_making kernels) {
    const gw_renderer_options options = {.kernels = kernels};
    return gw_stage_renderer_with(&stage, &options);
}

static int64_t told(const gw_renderer *renderer, const char *what) {
    json_t *report = json_object();
    check_ok(gw_renderer_report(renderer, NULL, report, &error));
    const json_t *value =
        json_object_get(json_object_get(json_object_get(report, "effects"), "variants"), what);
    assert_non_null(value);
    const int64_t number = json_is_boolean(value) ? json_is_true(value) : json_integer_value(value);
    json_decref(report);
    return number;
}

/* Threads of this process that make kernels. */
static int kernel_threads(void) {
    DIR *folder = opendir("/proc/self/task");
    int count = 0;
    assert_non_null(folder);
    for (const struct dirent *entry; (entry = readdir(folder));) {
        char path[300], name[32] = "";
        snprintf(path, sizeof path, "/proc/self/task/%s/comm", entry->d_name);
        FILE *file = fopen(path, "r");
        if (file && fgets(name, sizeof name, file))
            count += !strcmp(name, "gw-kernels\n");
        if (file)
            fclose(file);
    }
    closedir(folder);
    return count;
}

/* As long as it takes a loaded machine. */
static void wait_until_made(const gw_renderer *renderer) {
    for (const int64_t end = gw_now_ns() + INT64_C(300000000000); told(renderer, "pending");) {
        assert_true(gw_now_ns() < end);
        nanosleep(&(struct timespec){.tv_nsec = 20000000}, NULL);
    }
}

static void living_kernels_stand_in_and_step_back(void **state) {
    (void)state;
    forget_variants();
    gw_renderer *renderer = renderer_making(GW_KERNELS_AT_ONCE);
    uint8_t *expected = gw_camera_take(&sharp, renderer, NULL);
    gw_renderer_destroy(&renderer);
    forget_variants();

    renderer = renderer_making(GW_KERNELS_BACKGROUND);
    uint8_t *other = gw_camera_take(&coarse, renderer, NULL);
    assert_true(memcmp(other, expected, sizeof(uint32_t) * PIXELS) != 0);
    free(other);
    assert_int_equal(told(renderer, "stand_in_frames"), 0); /* nothing lived that could have */
    assert_int_equal(kernel_threads(), 0);

    /* What voxels need can draw without them: nothing is compiled on this thread, pixels are right. */
    const uint64_t programs = gw_gl_variant_counts_of(stage.device).programs;
    uint8_t *got = gw_camera_take(&sharp, renderer, NULL);
    assert_memory_equal(got, expected, sizeof(uint32_t) * PIXELS);
    free(got);
    assert_int_equal(told(renderer, "stand_in_frames"), 1);
    assert_int_equal(gw_gl_variant_counts_of(stage.device).programs, programs);
    assert_int_equal(kernel_threads(), 1);

    /* Once made, they live beside the others, at first use and from then on. */
    wait_until_made(renderer);
    for (int i = 0; i < 2; ++i) {
        got = gw_camera_take(&sharp, renderer, NULL);
        assert_memory_equal(got, expected, sizeof(uint32_t) * PIXELS);
        free(got);
        assert_int_equal(told(renderer, "background"), 1);
        assert_int_equal(told(renderer, "stand_in_frames"), 1);
        /* All that the frame needs was made there; what both need was there already. */
        assert_int_equal(gw_gl_variant_counts_of(stage.device).programs, programs + 2);
    }
    assert_int_equal(told(renderer, "failed"), 0);
    gw_renderer_destroy(&renderer);
    assert_int_equal(kernel_threads(), 0);
    free(expected);
}

/* Shadows, a mirror, a gaze that is lost: all kernels of the frame without it are made in the background. */
static void a_lost_gaze_compiles_nothing(void **state) {
    (void)state;
    gw_material mirror = stage.scene->materials[0];
    gw_light light = {.kind = GW_LIGHT_DIRECTIONAL, .vector = {0.48, -0.8, -0.36}, .color = {2, 2, 1}};
    gw_scene scene = *stage.scene;
    mirror.metalness = 1;
    mirror.roughness = 0;
    scene.materials = &mirror;
    scene.lights = &light;
    scene.light_count = 1;
    forget_variants();
    const gw_renderer_options options = {.kernels = GW_KERNELS_BACKGROUND};
    gw_renderer *renderer = NULL;
    check_ok(gw_renderer_create(stage.device, &scene, stage.octree, &options, &renderer, &error));
    gw_camera gazed = sharp;
    gw_camera_gaze(&gazed, 8, 12, 4);
    gazed.state.tau = 2;
    gazed.state.sample_block = 1;
    free(gw_camera_take(&gazed, renderer, NULL));
    uint8_t *while_made = gw_camera_take(&sharp, renderer, NULL);
    assert_int_equal(told(renderer, "stand_in_frames"), 1);
    wait_until_made(renderer);
    uint8_t *first = gw_camera_take(&sharp, renderer, NULL);
    const uint64_t programs = gw_gl_variant_counts_of(stage.device).programs;
    uint8_t *then = gw_camera_take(&sharp, renderer, NULL);
    assert_int_equal(told(renderer, "stand_in_frames"), 1);
    assert_int_equal(told(renderer, "background"), 1);
    assert_int_equal(gw_gl_variant_counts_of(stage.device).programs, programs);
    assert_memory_equal(first, while_made, sizeof(uint32_t) * PIXELS);
    assert_memory_equal(then, while_made, sizeof(uint32_t) * PIXELS);
    free(while_made);
    free(first);
    free(then);
    gw_renderer_destroy(&renderer);
}

static void a_renderer_may_go_while_kernels_are_made(void **state) {
    (void)state;
    forget_variants();
    gw_renderer *renderer = renderer_making(GW_KERNELS_BACKGROUND);
    free(gw_camera_take(&coarse, renderer, NULL));
    free(gw_camera_take(&sharp, renderer, NULL));
    assert_int_equal(kernel_threads(), 1);
    gw_renderer_destroy(&renderer);
    assert_int_equal(kernel_threads(), 0);
    /* The device is none the worse for it. */
    renderer = renderer_making(GW_KERNELS_AT_ONCE);
    free(gw_camera_take(&sharp, renderer, NULL));
    gw_renderer_destroy(&renderer);
}

/* On software GL kernels are made at once unless told otherwise; and so is what nothing living can draw. */
static void at_once_makes_no_thread(void **state) {
    (void)state;
    forget_variants();
    gw_renderer *renderer = renderer_making(GW_KERNELS_AUTO);
    if (!gw_gl_limits_of(stage.device)->software) {
        gw_renderer_destroy(&renderer);
        skip();
    }
    free(gw_camera_take(&coarse, renderer, NULL));
    free(gw_camera_take(&sharp, renderer, NULL));
    assert_int_equal(told(renderer, "stand_in_frames"), 0);
    assert_int_equal(kernel_threads(), 0);
    gw_renderer_destroy(&renderer);
    renderer = renderer_making(GW_KERNELS_BACKGROUND);
    free(gw_camera_take(&sharp, renderer, NULL));
    free(gw_camera_take(&coarse, renderer, NULL)); /* calls for more than lives */
    assert_int_equal(told(renderer, "stand_in_frames"), 0);
    gw_renderer_destroy(&renderer);
}

typedef struct told_lines {
    int count;
    unsigned done, most;
    double seconds;
} told_lines;

static void hear(void *context, const char *what, double fraction) {
    told_lines *told = context;
    unsigned done = 0, most = 0;
    double seconds = -1;
    (void)fraction;
    if (sscanf(what, "compiling kernels: %u of at most %u, %lf s", &done, &most, &seconds) != 3)
        return;
    assert_true(done >= 1 && done <= most && done >= told->done && seconds >= told->seconds);
    *told = (told_lines){told->count + 1, done, most, seconds};
}

/* With a gaze and shadows; and a frame whose kernels live is silent. */
static void compiling_is_told(void **state) {
    (void)state;
    told_lines told = {0};
    gw_log log = {.context = &told, .progress = hear};
    gw_light light = {.kind = GW_LIGHT_DIRECTIONAL, .vector = {0.48, -0.8, -0.36}, .color = {2, 2, 1}};
    gw_gl *device = NULL;
    check_ok(gw_gl_create(&(gw_gl_options){.log = &log}, &device, &error));
    gw_scene lit = *stage.scene;
    lit.lights = &light;
    lit.light_count = 1;
    gw_renderer *renderer = NULL;
    check_ok(gw_renderer_create(device, &lit, stage.octree, NULL, &renderer, &error));
    gw_camera camera = sharp;
    gw_camera_gaze(&camera, 4, 5, 2);
    camera.state.tau = 2;
    camera.state.sample_block = 2;
    free(gw_camera_take(&camera, renderer, NULL));
    print_message("# %u kernels of at most %u\n", told.done, told.most);
    assert_true(told.count > 8 && told.done > 8 && told.most < 3 * told.done);
    told = (told_lines){0};
    free(gw_camera_take(&camera, renderer, NULL));
    assert_int_equal(told.count, 0);
    gw_renderer_destroy(&renderer);
    gw_gl_destroy(&device);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(living_kernels_stand_in_and_step_back),
        cmocka_unit_test(a_lost_gaze_compiles_nothing),
        cmocka_unit_test(a_renderer_may_go_while_kernels_are_made),
        cmocka_unit_test(at_once_makes_no_thread),
        cmocka_unit_test(compiling_is_told),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
