/* Effects cost nothing where nothing calls for them, and change nothing where they are compiled in without
 * need: over the whole table (render/features.h), so that new rows are judged without a line here. */
#include "tests/support/check.h"

#include "base/file.h"
#include "render/features.h"
#include "tests/support/meshes.h"
#include "tests/support/renders.h"

#include <ctype.h>
#include <math.h>
#include <unistd.h>

enum { SIDE = 16, PIXELS = SIDE * SIDE };

/* A frame of a scene that calls for no effect at all. An effect that a frame calls for by default is turned
 * off here. */
static const char *const plain_settings[] = {"octree_depth=4", "tau=0",     "tau_inside=0",
                                             "sample_block=1", "samples=1", NULL};

/* Buffers that every frame needs. */
static const char *const base_buffers[] = {
    "octree nodes", "octree references", "octree payload", "triangles",
    "faces",        "vertices",          "materials",      "totals",
    "frame block",  "fragments",         "ray statuses",   "ray states",
    "ray queue",    "next ray queue",    "radiance sums",  "pixels"};

static gw_stage stage;
static gw_camera camera;
static gw_renderer *plain;
static uint8_t *wanted; /* the plain renderer's picture */
static gw_counters counted;

/* The program of this name that the plain frame compiled; what its text is to the compiler. */
typedef struct plain_program {
    const char *name, *defines;
    char *text;
} plain_program;
enum { MOST_PLAIN = 4 };
static plain_program plain_programs[MOST_PLAIN];
static size_t plain_count;

static gw_renderer *renderer_on(gw_gl *device, const gw_scene *scene, gw_features forced) {
    const gw_renderer_options options = {.force_features = forced};
    gw_renderer *renderer = NULL;
    check_ok(gw_renderer_create(device, scene, stage.octree, &options, &renderer, &error));
    return renderer;
}

/* Spheres of one grey material without shading normals, lit from everywhere. */
static gw_scene *grey_spheres(void) {
    gw_mesh mesh = {0};
    gw_mesh_add_sphere(&mesh, (const double[]){-0.2, 0, 0}, 0.5, 0.1, 9, 6);
    gw_mesh_add_sphere(&mesh, (const double[]){0.4, 0.2, -0.6}, 0.5, 0, 8, 5);
    return gw_mesh_take(&mesh);
}

static int open_stage(void **state) {
    (void)state;
    check_ok(gw_stage_open(&stage, grey_spheres(), NULL, plain_settings, &error));
    gw_camera_look(&camera, &stage, (const double[]){0.3, 0.4, 3}, (const double[]){0, 0, 0}, 32, SIDE);
    plain = renderer_on(stage.device, stage.scene, 0);
    wanted = gw_camera_take(&camera, plain, &counted);
    return 0;
}

static int close_stage(void **state) {
    (void)state;
    for (size_t p = 0; p < plain_count; ++p)
        free(plain_programs[p].text);
    free(wanted);
    gw_renderer_destroy(&plain);
    gw_stage_close(&stage);
    return 0;
}

/* Programs of frames, not of the octree's build. */
static int is_of_frame(const char *name) {
    return !strncmp(name, "trace/", 6) || !strncmp(name, "shade/", 6) || !strncmp(name, "blend/", 6) ||
           !strncmp(name, "sample/", 7) || !strncmp(name, "tone/", 5);
}

/* Where `defines` has this row's line, else NULL. */
static const char *line_of(const char *defines, const gw_feature_row *row) {
    char line[96];
    snprintf(line, sizeof line, "#define %s 1\n", row->define);
    const char *at = strstr(defines, line);
    return at && (at == defines || at[-1] == '\n') ? at : NULL;
}

/* What the compiler sees of a shader's assembled text: without directives and what they leave out. */
static char *preprocessed(const char *name, const char *defines) {
    char *text = NULL, path[512], command[600];
    check_ok(gw_gl_shader_text(stage.device, name, defines, &text, &error));
    scratch_path(path, "effects-kernel.txt");
    /* "#version" is none of the C preprocessor's. */
    const char *body = strchr(text, '\n');
    assert_non_null(body);
    check_ok(gw_file_write(path, body, strlen(body), &error));
    free(text);
    snprintf(command, sizeof command, "cpp -P -undef -w '%s'", path);
    FILE *pipe = popen(command, "r");
    assert_non_null(pipe);
    size_t size = 0, capacity = 1 << 20;
    char *seen = calloc(capacity, 1);
    assert_non_null(seen);
    while (size + 1 < capacity && !feof(pipe))
        size += fread(seen + size, 1, capacity - 1 - size, pipe);
    assert_int_equal(pclose(pipe), 0);
    unlink(path);
    assert_true(size > 500);
    return seen;
}

/* The next identifier from *at on; its length, 0 at the end. */
static size_t next_name(const char **at) {
    const char *c = *at;
    while (*c && !isalpha((unsigned char)*c) && *c != '_')
        c += isdigit((unsigned char)*c) ? strspn(c, "0123456789abcdefABCDEFxu.") : 1;
    *at = c;
    while (isalnum((unsigned char)*c) || *c == '_')
        ++c;
    return (size_t)(c - *at);
}

static int has_name(const char *text, const char *name, size_t length) {
    for (size_t found; (found = next_name(&text)) > 0; text += found)
        if (found == length && !memcmp(text, name, length))
            return 1;
    return 0;
}

static void nothing_called_for_is_compiled(void **state) {
    (void)state;
    json_t *report = json_object(), *run;
    check_ok(gw_renderer_report(plain, NULL, report, &error));
    run = json_object_get(json_object_get(report, "effects"), "run");
    assert_true(json_is_array(run));
    if (json_array_size(run) > 0)
        fail_msg("the plain frame calls for '%s': turn it off in plain_settings",
                 json_string_value(json_array_get(run, 0)));
    json_decref(report);
    const char *name, *defines;
    for (size_t i = 0; gw_gl_program_at(stage.device, i, &name, &defines); ++i) {
        if (!is_of_frame(name))
            continue;
        for (size_t r = 0; r < gw_feature_count; ++r)
            if (line_of(defines, &gw_feature_rows[r]))
                fail_msg("%s has '%s', which nothing calls for", name, gw_feature_rows[r].define);
        assert_true(plain_count < MOST_PLAIN);
        plain_programs[plain_count++] = (plain_program){name, defines, preprocessed(name, defines)};
    }
    /* What finds rays' ends, and what lights them; anything more is an effect's. */
    assert_int_equal(plain_count, 2);
    assert_string_equal(plain_programs[0].name, "trace/primary.comp");
    assert_string_equal(plain_programs[1].name, "shade/shade.comp");
}

static void nothing_called_for_is_counted_or_allocated(void **state) {
    (void)state;
    gw_counters rest = counted;
    assert_int_equal(rest.rays, PIXELS);
    rest.rays = 0;
    static const gw_counters zeros;
    assert_memory_equal(&rest, &zeros, sizeof rest);
    size_t needed = 0;
    const char *name;
    for (size_t i = 0; (name = gw_gl_buffer_name(stage.device, i)); ++i) {
        uint64_t bytes = gw_gl_buffer_bytes(stage.device, name);
        size_t known = 0;
        while (known < sizeof base_buffers / sizeof *base_buffers && strcmp(name, base_buffers[known]))
            ++known;
        /* A buffer of nothing has 16 bytes, so that it can be bound. */
        if (known < sizeof base_buffers / sizeof *base_buffers)
            needed += bytes > 16;
        else if (bytes > 16)
            fail_msg("the buffer '%s' has %llu bytes, and nothing calls for it", name,
                     (unsigned long long)bytes);
    }
    assert_true(needed > 10);
    assert_int_equal(gw_renderer_parts_of(plain).textures, 0);
}

/* 1: a renderer with these effects forced in draws other pixels than `expected`. */
static int changes_pixels(const gw_scene *scene, const gw_camera *view, const uint8_t *expected,
                          gw_features forced) {
    gw_renderer *renderer = renderer_on(stage.device, scene, forced);
    uint8_t *got = gw_camera_take(view, renderer, NULL);
    const int differs = memcmp(got, expected, PIXELS * 4) != 0;
    free(got);
    gw_renderer_destroy(&renderer);
    return differs;
}

static void expect_same(const gw_scene *scene, const gw_camera *view, const uint8_t *expected,
                        gw_features forced) {
    if (!changes_pixels(scene, view, expected, forced))
        return;
    for (size_t i = 0; i < gw_feature_count; ++i)
        if ((forced & gw_feature_rows[i].bit) &&
            changes_pixels(scene, view, expected, gw_feature_rows[i].bit))
            fail_msg("the effect '%s', forced in without need, changes pixels", gw_feature_rows[i].name);
    fail_msg("effects that are forced in together without need change pixels");
}

/* Compiling each effect in by itself would take a second a row. They are in all at once, and then every
 * second one, so that the changes of neighbours, which are often of one kind, cannot cancel. Where pixels
 * change, effects by themselves tell which. */
static void forced_effects_change_no_pixel(void **state) {
    (void)state;
    gw_features every_second = 0;
    for (size_t i = 0; i < gw_feature_count; i += 2)
        every_second |= gw_feature_rows[i].bit;
    expect_same(stage.scene, &camera, wanted, GW_ALL_FEATURES);
    expect_same(stage.scene, &camera, wanted, every_second);
}

/* Once more where the effects that nothing calls for stand beside lights, shadows, voxels and a gaze. */
static void forced_effects_change_no_lit_pixel(void **state) {
    (void)state;
    gw_light lights[2] = {{.kind = GW_LIGHT_DIRECTIONAL, .vector = {0.48, -0.8, -0.36}, .color = {2, 2, 1}},
                          {.kind = GW_LIGHT_POINT, .vector = {1, 1, 1}, .color = {3, 3, 4}}};
    gw_scene lit = *stage.scene;
    lit.lights = lights;
    lit.light_count = 2;
    gw_camera view = camera;
    gw_camera_gaze(&view, 4, 5, 5);
    view.state.tau = 2;
    view.state.shadow_tau = 1;
    gw_renderer *renderer = renderer_on(stage.device, &lit, 0);
    uint8_t *expected = gw_camera_take(&view, renderer, NULL);
    gw_renderer_destroy(&renderer);
    size_t colors = 0;
    for (size_t i = 1; i < PIXELS; ++i)
        colors += memcmp(expected + i * 4, expected + i * 4 - 4, 4) != 0;
    assert_true(colors > PIXELS / 4);
    expect_same(&lit, &view, expected, GW_ALL_FEATURES);
    free(expected);
}

static int is_plain(const char *name) {
    for (size_t p = 0; p < plain_count; ++p)
        if (!strcmp(name, plain_programs[p].name))
            return 1;
    return 0;
}

/* What the compiler sees without one line of the defines. */
static char *without_line(const char *name, const char *defines, const char *line) {
    char *fewer = strdup(defines);
    assert_non_null(fewer);
    char *cut = fewer + (line - defines), *rest = strchr(cut, '\n') + 1;
    memmove(cut, rest, strlen(rest) + 1);
    char *text = preprocessed(name, fewer);
    free(fewer);
    return text;
}

/* How many names of the full text are the row's own; the plain kernel of this name may have none of them. */
static size_t judge_names(const char *name, const char *full, const char *less, const gw_feature_row *row) {
    size_t count = 0;
    for (size_t length; (length = next_name(&full)) > 0; full += length) {
        if (has_name(less, full, length))
            continue;
        ++count;
        for (size_t p = 0; p < plain_count; ++p)
            if (!strcmp(name, plain_programs[p].name) && has_name(plain_programs[p].text, full, length))
                fail_msg("%s has '%.*s', which is of '%s' only", name, (int)length, full, row->name);
    }
    return count;
}

/* Kernels of variants that were not used for long are deleted, and are the same when they are made again. */
static void deleted_kernels_come_back_the_same(void **state) {
    (void)state;
    gw_renderer *renderer = renderer_on(stage.device, stage.scene, 0);
    uint8_t *first = gw_camera_take(&camera, renderer, NULL);
    const gw_gl_variant_counts before = gw_gl_variant_counts_of(stage.device);
    for (uint64_t i = 0; i < GW_GL_VARIANTS; ++i) {
        gw_gl_variant_begin(stage.device, (gw_hash){1, i});
        gw_gl_variant_end(stage.device);
    }
    const gw_gl_variant_counts after = gw_gl_variant_counts_of(stage.device);
    assert_int_equal(after.alive, GW_GL_VARIANTS);
    assert_true(after.deleted >= before.deleted + 2);
    uint8_t *again = gw_camera_take(&camera, renderer, NULL);
    assert_memory_equal(first, again, PIXELS * 4);
    assert_int_equal(gw_gl_variant_counts_of(stage.device).programs, after.programs + 2);
    free(first);
    free(again);
    gw_renderer_destroy(&renderer);
}

/* What a renderer's report says of one effect's use; NULL: it says nothing. */
static json_t *use_of(json_t *report, const char *effect) {
    return json_object_get(json_object_get(json_object_get(report, "effects"), "met"), effect);
}

static void expect_use(gw_renderer *renderer, const gw_counters *counters, const char *effect, int met,
                       int frames, int idle) {
    json_t *report = json_object();
    check_ok(gw_renderer_report(renderer, counters, report, &error));
    const json_t *use = use_of(report, effect);
    assert_non_null(use);
    assert_int_equal(json_integer_value(json_object_get(use, "met")) > 0, met);
    assert_int_equal(json_integer_value(json_object_get(use, "frames")), frames);
    assert_int_equal(json_integer_value(json_object_get(use, "idle")), idle);
    json_decref(report);
}

/* A mirror and a lamp that the scene has, seen and not seen. */
static void effects_that_meet_nothing_are_idle(void **state) {
    (void)state;
    gw_material materials[2] = {stage.scene->materials[0], stage.scene->materials[0]};
    uint32_t material_of[256] = {0};
    gw_scene scene = *stage.scene;
    assert_true(scene.triangle_count <= 256);
    materials[1].metalness = 1;
    materials[1].roughness = 0;
    materials[1].emissive[1] = 1;
    /* One of the two spheres: what lies to the right. */
    for (uint32_t i = 0; i < scene.triangle_count; ++i)
        material_of[i] = ldexp((double)scene.positions[(size_t)scene.triangles[i][0] * 3], scene.exponent) +
                             scene.centre[0] >
                         0.5;
    scene.materials = materials;
    scene.material_of = material_of;
    scene.material_count = 2;
    const gw_renderer_options options = {.count = 1};
    gw_renderer *renderer = NULL;
    check_ok(gw_renderer_create(stage.device, &scene, stage.octree, &options, &renderer, &error));
    gw_counters counters = {0};
    gw_camera away = camera;
    gw_camera_look(&away, &stage, (const double[]){0.3, 0.4, 3}, (const double[]){-0.6, 0, 0}, 8, SIDE);
    free(gw_camera_take(&away, renderer, &counters));
    expect_use(renderer, &counters, "emissive", 0, 1, 1);
    expect_use(renderer, &counters, "mirror", 0, 1, 1);
    free(gw_camera_take(&camera, renderer, &counters));
    expect_use(renderer, &counters, "emissive", 1, 2, 1);
    expect_use(renderer, &counters, "mirror", 1, 2, 1);
    assert_true(counters.mirror_rays > 0 && counters.mirror_rays < counters.rays);
    gw_renderer_destroy(&renderer);
}

/* Each of up to 64 effects has a bit of its own, whichever that is, a name and a define; what groups effects
 * knows no others; and all of them reach a kernel's text. */
static void every_bit_is_in_the_table(void **state) {
    (void)state;
    char text[GW_KERNEL_DEFINES];
    gw_features all = 0, highest = 0;
    assert_true(gw_feature_count > 0 && gw_feature_count <= GW_MOST_FEATURES);
    for (size_t r = 0; r < gw_feature_count; ++r) {
        const gw_feature_row *row = &gw_feature_rows[r];
        gw_features found = 0;
        assert_true(row->bit != 0 && (row->bit & (row->bit - 1)) == 0 && !(all & row->bit));
        check_ok(gw_feature_of_name(row->name, &found, &error));
        assert_true(found == row->bit);
        all |= row->bit;
        highest = row->bit > highest ? row->bit : highest;
        const gw_kernel_key key = {.features = row->bit};
        check_ok(gw_kernel_defines(&key, text, sizeof text, &error));
        for (size_t other = 0; other < gw_feature_count; ++other)
            assert_int_equal(line_of(text, &gw_feature_rows[other]) != NULL, other == r);
    }
    assert_true(highest > UINT32_MAX);
    const gw_features grouped = GW_FRAME_FEATURES | GW_SECONDARY_FEATURES | GW_EXTENSION_FEATURES |
                                GW_PICTURE_FEATURES | GW_NEEDED_FEATURES;
    assert_true((grouped & ~all) == 0);
    const gw_kernel_key key = {.features = GW_ALL_FEATURES};
    check_ok(gw_kernel_defines(&key, text, sizeof text, &error));
    for (size_t r = 0; r < gw_feature_count; ++r)
        assert_non_null(line_of(text, &gw_feature_rows[r]));
}

/* docs/effects.md has a row that says when each effect is called for, and names none that there is not. */
static void the_manual_names_every_effect(void **state) {
    (void)state;
    gw_bytes page;
    check_ok(gw_file_read("docs/effects.md", 1 << 20, &page, &error));
    char *table = strstr((char *)page.data, "| effect | called for when |");
    assert_non_null(table);
    char *end = strstr(table, "\n\n");
    assert_non_null(end);
    *end = '\0';
    for (size_t r = 0; r < gw_feature_count; ++r) {
        char name[64];
        snprintf(name, sizeof name, "`%s`", gw_feature_rows[r].name);
        if (!strstr(table, name))
            fail_msg("docs/effects.md does not tell when %s is called for", name);
    }
    for (char *line = strchr(table, '\n'); line; line = strchr(line + 1, '\n')) {
        char *cell = strchr(line + 3, '|');
        for (char *at = strchr(line, '`'); at && cell && at < cell; at = strchr(at + 1, '`')) {
            gw_features bit;
            char *close = strchr(at + 1, '`');
            assert_non_null(close);
            *close = '\0';
            check_ok(gw_feature_of_name(at + 1, &bit, &error));
            *close = '`';
            at = close;
        }
    }
    gw_bytes_finish(&page);
}

/* Every row's define takes code of its own into some kernel of a frame that has them all; and none of the
 * names that are only the row's are in the kernels of the plain frame. */
static void left_out_effects_leave_no_text(void **state) {
    (void)state;
    size_t changed[64] = {0}, own_names[64] = {0};
    const char *name, *defines;
    assert_true(gw_feature_count <= 64 && plain_count > 0);
    for (size_t i = 0; gw_gl_program_at(stage.device, i, &name, &defines); ++i) {
        char *full = NULL;
        for (size_t r = 0; r < gw_feature_count && is_of_frame(name); ++r) {
            const char *line = line_of(defines, &gw_feature_rows[r]);
            if (!line || (changed[r] > 0 && !is_plain(name)))
                continue;
            if (!full)
                full = preprocessed(name, defines);
            char *less = without_line(name, defines, line);
            changed[r] += strcmp(full, less) != 0;
            own_names[r] += judge_names(name, full, less, &gw_feature_rows[r]);
            free(less);
        }
        free(full);
    }
    for (size_t r = 0; r < gw_feature_count; ++r) {
        print_message("%-20s %zu names of its own\n", gw_feature_rows[r].name, own_names[r]);
        if (!changed[r])
            fail_msg("the effect '%s' changes no kernel's text: what does '%s' leave out?",
                     gw_feature_rows[r].name, gw_feature_rows[r].define);
    }
}

/* The same comparison with a fault planted: an effect whose define makes pixels a little darker. */
static void an_effect_that_changes_pixels_is_found(void **state) {
    (void)state;
    static const char before[] = "precise vec3 mean = color;";
    static const char after[] = "precise vec3 mean = color;\n#ifdef EMISSIVE\nmean *= 0.9;\n#endif\n";
    char folder[512], path[640];
    gw_naive_shaders(folder, "planted", "", "");
    snprintf(path, sizeof path, "%s/blend/store_pixel.glsl", folder);
    gw_bytes file;
    check_ok(gw_file_read(path, 1 << 20, &file, &error));
    char *text = calloc(file.size + sizeof after, 1);
    assert_non_null(text);
    memcpy(text, file.data, file.size);
    char *at = strstr(text, before);
    assert_non_null(at);
    memmove(at + sizeof after - 1, at + sizeof before - 1, strlen(at + sizeof before - 1) + 1);
    memcpy(at, after, sizeof after - 1);
    check_ok(gw_file_write(path, text, strlen(text), &error));
    free(text);
    free(file.data);
    gw_gl *device = NULL;
    check_ok(gw_gl_create(&(gw_gl_options){.shader_folder = folder}, &device, &error));
    gw_renderer *faulty = renderer_on(device, stage.scene, GW_FEATURE_EMISSIVE);
    uint8_t *got = gw_camera_take(&camera, faulty, NULL);
    assert_true(memcmp(got, wanted, PIXELS * 4));
    free(got);
    gw_renderer_destroy(&faulty);
    gw_gl_destroy(&device);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_bit_is_in_the_table),
        cmocka_unit_test(the_manual_names_every_effect),
        cmocka_unit_test(nothing_called_for_is_compiled),
        cmocka_unit_test(nothing_called_for_is_counted_or_allocated),
        cmocka_unit_test(forced_effects_change_no_pixel),
        cmocka_unit_test(forced_effects_change_no_lit_pixel),
        cmocka_unit_test(left_out_effects_leave_no_text),
        cmocka_unit_test(effects_that_meet_nothing_are_idle),
        cmocka_unit_test(deleted_kernels_come_back_the_same),
        cmocka_unit_test(an_effect_that_changes_pixels_is_found),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
