/* Glass against a tracer in double precision that follows the same rules over every triangle: slabs, prisms,
 * balls, media in media, a viewer in glass; and what must hold however it is drawn. */
#include "tests/support/check.h"

#include "base/srgb.h"
#include "render/features.h"
#include "tests/support/meshes.h"
#include "tests/support/renders.h"

#include <math.h>

enum {
    SIDE = 24,
    PIXELS = SIDE * SIDE,
    STRIPES = 6,
    GLASS = STRIPES,
    WATER,
    MATERIALS,
    MOST_TRIANGLES = 1024
};

/* --- scenes -----------------------------------------------------------------------------------------------
 */

/* Right-angled, its edge along y: the short sides look at +z and -x. */
static void add_prism(gw_mesh *mesh, double size, double height) {
    uint32_t p[2][3];
    for (int k = 0; k < 2; ++k) {
        const double y = k ? height : -height;
        p[k][0] = gw_mesh_point(mesh, -size, y, size);
        p[k][1] = gw_mesh_point(mesh, size, y, size);
        p[k][2] = gw_mesh_point(mesh, -size, y, -size);
    }
    gw_mesh_triangle(mesh, p[0][0], p[0][2], p[0][1]);
    gw_mesh_triangle(mesh, p[1][0], p[1][1], p[1][2]);
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3;
        gw_mesh_triangle(mesh, p[0][i], p[0][j], p[1][j]);
        gw_mesh_triangle(mesh, p[0][i], p[1][j], p[1][i]);
    }
}

typedef struct model {
    gw_mesh mesh;
    uint8_t material[MOST_TRIANGLES];
    size_t marked;
} model;

static void mark(model *m, int material) {
    assert_true(m->mesh.triangle_count <= MOST_TRIANGLES);
    while (m->marked < m->mesh.triangle_count)
        m->material[m->marked++] = (uint8_t)material;
}

/* Stripes that shine, behind the middle and to its left. */
static void add_stripes(model *m) {
    for (int s = 0; s < STRIPES; ++s) {
        const double at = -2.4 + 0.8 * s;
        gw_mesh_add_grid(&m->mesh, (const double[]){at, -2.4, -2}, (const double[]){0.8, 0, 0},
                         (const double[]){0, 4.8, 0}, 1, 1);
        gw_mesh_add_grid(&m->mesh, (const double[]){-3, -2.4, at}, (const double[]){0, 4.8, 0},
                         (const double[]){0, 0, 0.8}, 1, 1);
        mark(m, s);
    }
}

/* Triangles of a finished scene stand in an order of their own: found again by where they lie. */
static void give_materials(gw_scene *scene, const model *m) {
    for (uint32_t t = 0; t < scene->triangle_count; ++t) {
        double best = 1e30;
        for (size_t i = 0; i < m->marked; ++i) {
            double off = 0;
            /* The finished triangle starts with its least corner: all rotations are tried. */
            double least = 1e30;
            for (int turn = 0; turn < 3; ++turn) {
                off = 0;
                for (int k = 0; k < 3; ++k)
                    for (int c = 0; c < 3; ++c)
                        off += fabs(ldexp((double)scene->positions[scene->triangles[t][k] * 3 + (uint32_t)c],
                                          scene->exponent) +
                                    scene->centre[c] -
                                    m->mesh.points[m->mesh.triangles[i][(k + turn) % 3] * 3 + (uint32_t)c]);
                least = fmin(least, off);
            }
            if (least < best) {
                best = least;
                scene->material_of[t] = m->material[i];
            }
        }
        assert_true(best < 1e-4);
    }
}

typedef struct look {
    double eye[3], target[3], fov;
} look;

static gw_scene *scene_of(model *m, double thickness, double background, double ambient) {
    gw_scene *scene = NULL;
    check_ok(gw_mesh_scene(&m->mesh, &scene, &error));
    free(scene->materials);
    scene->materials = calloc(MATERIALS, sizeof *scene->materials);
    scene->extensions = calloc(MATERIALS, sizeof *scene->extensions);
    assert_non_null(scene->materials);
    assert_non_null(scene->extensions);
    scene->material_count = MATERIALS;
    for (int i = 0; i < MATERIALS; ++i) {
        scene->materials[i] =
            (gw_material){.roughness = 1, .base_color_texture = -1, .base_color = {0, 0, 0, 1}};
        scene->extensions[i] = gw_material_extension_none();
        for (int c = 0; c < 3 && i < STRIPES; ++c)
            scene->materials[i].emissive[c] = (i >> c) & 1 ? 0.8f : 0.2f;
    }
    for (int i = GLASS; i <= WATER; ++i) {
        for (int c = 0; c < 3; ++c)
            scene->materials[i].base_color[c] = 1;
        scene->materials[i].roughness = 0;
        scene->extensions[i].transmission = 1;
        scene->extensions[i].thickness = (float)thickness;
        scene->extensions[i].ior = i == GLASS ? 1.5f : 1.33f;
    }
    for (int i = 0; i < 3; ++i) {
        scene->ambient[i] = (float)ambient;
        scene->background[i] = (float)background;
    }
    give_materials(scene, m);
    gw_mesh_finish(&m->mesh);
    return scene;
}

/* --- the oracle -------------------------------------------------------------------------------------------
 */

typedef struct oracle {
    const gw_scene *scene;
    double (*corner)[3][3]; /* of triangles, scene metres */
    int bounces;
} oracle;

typedef struct media {
    int stack[8], count; /* the innermost last */
} media;

static void oracle_of(const gw_stage *stage, oracle *o) {
    o->scene = stage->scene;
    o->corner = calloc(o->scene->triangle_count, sizeof *o->corner);
    assert_non_null(o->corner);
    for (uint32_t t = 0; t < o->scene->triangle_count; ++t)
        for (int k = 0; k < 3; ++k)
            for (int c = 0; c < 3; ++c)
                o->corner[t][k][c] =
                    ldexp((double)o->scene->positions[o->scene->triangles[t][k] * 3 + (uint32_t)c],
                          o->scene->exponent) +
                    o->scene->centre[c];
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* t of the triangle, 1e30 for a miss; *normal: unit, of its front. */
static double hit_of(const double corner[3][3], const double o[3], const double d[3], double normal[3]) {
    double e[2][3], p[3], q[3], s[3], size = 0;
    for (int c = 0; c < 3; ++c) {
        e[0][c] = corner[1][c] - corner[0][c];
        e[1][c] = corner[2][c] - corner[0][c];
        s[c] = o[c] - corner[0][c];
    }
    for (int c = 0; c < 3; ++c) {
        const int i = (c + 1) % 3, j = (c + 2) % 3;
        p[c] = d[i] * e[1][j] - d[j] * e[1][i];
        q[c] = s[i] * e[0][j] - s[j] * e[0][i];
        normal[c] = e[0][i] * e[1][j] - e[0][j] * e[1][i];
        size += normal[c] * normal[c];
    }
    for (int c = 0; c < 3; ++c)
        normal[c] /= sqrt(size);
    const double determinant = dot(e[0], p);
    if (fabs(determinant) < 1e-14)
        return 1e30;
    const double u = dot(s, p) / determinant, v = dot(d, q) / determinant;
    return u < 0 || v < 0 || u + v > 1 ? 1e30 : dot(e[1], q) / determinant;
}

static double index_of(const oracle *o, const media *m) {
    return m->count > 0 ? (double)o->scene->extensions[m->stack[m->count - 1]].ior : 1.0;
}

static media crossed(const media *m, int medium, int back) {
    media next = {{0}, 0};
    int held = 0;
    for (int i = 0; i < m->count; ++i) {
        held |= m->stack[i] == medium;
        if (!back || m->stack[i] != medium)
            next.stack[next.count++] = m->stack[i];
    }
    if (!back && !held)
        next.stack[next.count++] = medium;
    return next;
}

static void oracle_ray(const oracle *o, const double origin[3], const double d[3], media in, int64_t skipped,
                       int bounce, double out[3]);

static void oracle_event(const oracle *o, const double at[3], const double d[3], const double n[3], media in,
                         media beyond, int64_t triangle, int bounce, double out[3]) {
    const int material = (int)o->scene->material_of[triangle];
    const gw_material_extension *e = &o->scene->extensions[material];
    const int sheet = e->thickness <= 0;
    const double eta = index_of(o, &in) / (sheet ? (double)e->ior : index_of(o, &beyond)),
                 cosine = -dot(d, n);
    const double squared = eta * eta * (1 - cosine * cosine), other = squared < 1 ? sqrt(1 - squared) : 0;
    const double s = (eta * cosine - other) / (eta * cosine + other),
                 p = (eta * other - cosine) / (eta * other + cosine);
    const double reflectance = squared >= 1 ? 1 : (s * s + p * p) / 2;
    double reflected[3], bent[3], part[3];
    for (int c = 0; c < 3; ++c) {
        reflected[c] = d[c] + 2 * cosine * n[c];
        bent[c] = sheet ? d[c] : eta * d[c] + (eta * cosine - other) * n[c];
        out[c] = 0;
    }
    if (bounce == o->bounces)
        return;
    if (reflectance > 0) {
        oracle_ray(o, at, reflected, in, triangle, bounce + 1, part);
        for (int c = 0; c < 3; ++c)
            out[c] += reflectance * part[c];
    }
    if (reflectance < 1) {
        oracle_ray(o, at, bent, beyond, triangle, bounce + 1, part);
        for (int c = 0; c < 3; ++c)
            out[c] += (1 - reflectance) * (double)e->transmission * part[c];
    }
}

static void oracle_ray(const oracle *o, const double origin[3], const double d[3], media in, int64_t skipped,
                       int bounce, double out[3]) {
    double from = skipped >= 0 ? -1e-9 : 0;
    for (;;) {
        double nearest = 1e30, normal[3] = {0}, at[3];
        int64_t met = -1;
        for (uint32_t t = 0; t < o->scene->triangle_count; ++t) {
            double n[3];
            const double hit =
                (int64_t)t == skipped ? 1e30 : hit_of((const double(*)[3])o->corner[t], origin, d, n);
            if (hit > from && hit < nearest) {
                nearest = hit;
                met = t;
                memcpy(normal, n, sizeof n);
            }
        }
        const int material = met < 0 ? -1 : (int)o->scene->material_of[met];
        const int back = met >= 0 && dot(normal, d) > 0;
        const int sheer = material == GLASS || material == WATER;
        const int boundary = sheer && o->scene->extensions[material].thickness > 0;
        const media beyond = boundary ? crossed(&in, material, back) : in;
        if (boundary && index_of(o, &beyond) == index_of(o, &in) &&
            (beyond.count ? beyond.stack[beyond.count - 1] : -1) ==
                (in.count ? in.stack[in.count - 1] : -1)) {
            in = beyond;
            from = nearest;
            continue;
        }
        for (int c = 0; c < 3; ++c) {
            at[c] = origin[c] + nearest * d[c];
            normal[c] = back ? -normal[c] : normal[c];
            out[c] =
                met < 0 ? (double)o->scene->background[c] : (double)o->scene->materials[material].emissive[c];
        }
        if (sheer)
            oracle_event(o, at, d, normal, in, beyond, met, bounce, out);
        const gw_material_extension *e = in.count ? &o->scene->extensions[in.stack[in.count - 1]] : NULL;
        for (int c = 0; c < 3 && met >= 0; ++c)
            if (e && e->attenuation_distance > 0)
                out[c] *= pow((double)e->attenuation_color[c], nearest / (double)e->attenuation_distance);
        return;
    }
}

/* Pixels of the picture that are off by more than rounding and the least step of a code. */
static size_t wrong_pixels(const gw_stage *stage, const gw_camera *camera, const uint8_t *rgba, media in) {
    oracle o = {.bounces = camera->state.bounces};
    size_t wrong = 0;
    oracle_of(stage, &o);
    for (uint32_t i = 0; i < PIXELS; ++i) {
        double direction[3], eye[3], wanted[3], off = 0;
        gw_camera_ray(camera, i % SIDE, i / SIDE, direction);
        for (int c = 0; c < 3; ++c)
            eye[c] = camera->state.eye[c] / 1000.0;
        oracle_ray(&o, eye, direction, in, -1, 0, wanted);
        for (int c = 0; c < 3; ++c)
            off = fmax(off, fabs(gw_srgb_code_to_linear(rgba[i * 4 + (uint32_t)c]) - wanted[c]));
        wrong += off > 0.012;
    }
    free(o.corner);
    return wrong;
}

/* --- tests ------------------------------------------------------------------------------------------------
 */

static const look before = {{0.5, 0.35, 3}, {0, 0, 0}, 30};

static void open_stage(gw_stage *stage, gw_camera *camera, gw_scene *scene, const look *from,
                       const char *shaders) {
    check_ok(gw_stage_open(stage, scene, shaders,
                           (const char *const[]){"octree_depth=7", "least_throughput=0", "bounces=5",
                                                 "tau_inside=0", "emissive_lights=0", NULL},
                           &error));
    gw_camera_look(camera, stage, from->eye, from->target, from->fov, SIDE);
}

/* How many pixels of a scene with stripes are not as the oracle says. */
static size_t wrong_of(const char *what, gw_scene *scene, const look *from, media in, const char *shaders) {
    gw_stage stage;
    gw_camera camera;
    gw_counters counters = {0};
    open_stage(&stage, &camera, scene, from, shaders);
    uint8_t *rgba = gw_stage_take(&stage, &camera, NULL, &counters);
    const size_t wrong = wrong_pixels(&stage, &camera, rgba, in);
    print_message("# %s: %zu of %d pixels off, %u rays\n", what, wrong, PIXELS,
                  (unsigned)counters.mirror_rays);
    assert_int_equal(counters.nan_pixels + counters.step_cap_hits, 0);
    free(rgba);
    gw_stage_close(&stage);
    return wrong;
}
static const media air = {{0}, 0}, glass = {{GLASS}, 1}, water = {{WATER}, 1};
static const look inside = {{0.1, 0.05, 0.1}, {-0.2, 0, -2}, 70};

static void glass_bends_and_reflects_as_the_oracle_says(void **state) {
    (void)state;
    model m = {.marked = 0};
    add_stripes(&m);
    gw_mesh_add_box(&m.mesh, (const double[]){-0.7, -0.6, -0.2}, (const double[]){0.7, 0.6, 0.2});
    mark(&m, GLASS);
    gw_scene *slab = scene_of(&m, 1, 0.05, 0);
    slab->extensions[GLASS].attenuation_distance = 0.5f;
    slab->extensions[GLASS].attenuation_color[0] = 0.6f;
    assert_true(wrong_of("slab", slab, &before, air, NULL) <= 6);

    m = (model){.marked = 0};
    add_stripes(&m);
    add_prism(&m.mesh, 0.6, 0.6);
    mark(&m, GLASS);
    assert_true(wrong_of("prism", scene_of(&m, 1, 0.05, 0), &before, air, NULL) <= 6);

    m = (model){.marked = 0};
    add_stripes(&m);
    gw_mesh_add_sphere(&m.mesh, (const double[]){0, 0, 0}, 0.7, 0, 16, 9);
    mark(&m, GLASS);
    assert_true(wrong_of("ball", scene_of(&m, 1, 0.05, 0), &before, air, NULL) <= 10);

    m = (model){.marked = 0};
    add_stripes(&m);
    gw_mesh_add_box(&m.mesh, (const double[]){-0.7, -0.6, -0.2}, (const double[]){0.7, 0.6, 0.2});
    mark(&m, GLASS);
    assert_true(wrong_of("sheets", scene_of(&m, 0, 0.05, 0), &before, air, NULL) <= 6);
}

/* A box of water in a wall of glass; over: how far the water reaches into the wall. */
static gw_scene *aquarium(double over) {
    model m = {.marked = 0};
    add_stripes(&m);
    const double x = 0.5 + over, y = 0.4 + over, z = 0.3 + over;
    gw_mesh_add_box(&m.mesh, (const double[]){-0.7, -0.6, -0.5}, (const double[]){0.7, 0.6, 0.5});
    mark(&m, GLASS);
    /* The wall's inner side looks inwards. */
    const size_t first = m.mesh.triangle_count;
    gw_mesh_add_box(&m.mesh, (const double[]){-0.5, -0.4, -0.3}, (const double[]){0.5, 0.4, 0.3});
    for (size_t t = first; t < m.mesh.triangle_count; ++t) {
        const uint32_t second = m.mesh.triangles[t][1];
        m.mesh.triangles[t][1] = m.mesh.triangles[t][2];
        m.mesh.triangles[t][2] = second;
    }
    mark(&m, GLASS);
    gw_mesh_add_box(&m.mesh, (const double[]){-x, -y, -z}, (const double[]){x, y, z});
    mark(&m, WATER);
    return scene_of(&m, 1, 0.05, 0);
}

static void media_survive_coincident_faces(void **state) {
    (void)state;
    assert_true(wrong_of("water in its wall", aquarium(0.01), &before, air, NULL) <= 10);
    assert_true(wrong_of("seen from the water", aquarium(0.01), &inside, water, NULL) <= 10);
    char folder[512];
    gw_stage stage;
    gw_camera camera;
    uint8_t *pictures[3];
    const char *naive = gw_naive_shaders(folder, "skipping", "shade/refracted_ray.glsl", "SKIP_COINCIDENT");
    const double over[3] = {1e-4, 0, 0};
    for (int i = 0; i < 3; ++i) {
        open_stage(&stage, &camera, aquarium(over[i]), &inside, i == 2 ? naive : NULL);
        pictures[i] = gw_stage_take(&stage, &camera, NULL, NULL);
        gw_stage_close(&stage);
    }
    size_t off[2] = {0};
    for (size_t i = 0; i < PIXELS * 4; ++i)
        for (int k = 0; k < 2; ++k)
            off[k] += abs(pictures[0][i] - pictures[1 + k][i]) > 3;
    print_message("# coincident faces: %zu channels off, %zu if they are skipped\n", off[0], off[1]);
    assert_true(off[0] <= 30);
    assert_true(off[1] > 10 * off[0] + 100); /* the naive rule fails */
    for (int i = 0; i < 3; ++i)
        free(pictures[i]);
}

static void a_viewer_in_glass_knows(void **state) {
    (void)state;
    model m = {.marked = 0};
    add_stripes(&m);
    gw_mesh_add_box(&m.mesh, (const double[]){-0.7, -0.6, -0.2}, (const double[]){0.7, 0.6, 0.2});
    mark(&m, GLASS);
    assert_true(wrong_of("in glass", scene_of(&m, 1, 0.05, 0), &inside, glass, NULL) <= 6);
}

/* Whatever stands in light that is the same from everywhere looks like it, and no brighter. */
static void a_furnace_shows_nothing(void **state) {
    (void)state;
    static const float indices[] = {1.0f, 1.5f, 2.4f};
    const double light = 0.5;
    for (int k = 0; k < 2; ++k) {
        model m = {.marked = 0};
        gw_mesh_add_sphere(&m.mesh, (const double[]){-0.3, 0, 0}, 0.5, 0, 14, 8);
        gw_mesh_add_box(&m.mesh, (const double[]){0.1, -0.6, -0.8}, (const double[]){0.7, 0.2, -0.3});
        mark(&m, GLASS);
        gw_scene *scene = scene_of(&m, k, light, light * 3.14159265358979);
        gw_stage stage;
        gw_camera camera;
        open_stage(&stage, &camera, scene, &before, NULL);
        for (size_t i = 0; i < sizeof indices / sizeof indices[0]; ++i) {
            stage.scene->extensions[GLASS].ior = indices[i];
            gw_counters counters = {0};
            uint8_t *rgba = gw_stage_take(&stage, &camera, NULL, &counters);
            for (size_t p = 0; p < PIXELS; ++p)
                assert_true(fabs(gw_srgb_code_to_linear(rgba[p * 4]) / light - 1) < 0.01);
            assert_true(counters.mirror_rays > PIXELS / 8);
            assert_int_equal(counters.nan_pixels, 0);
            free(rgba);
        }
        gw_stage_close(&stage);
    }
}

static void however_it_is_drawn_pixels_are_the_same(void **state) {
    (void)state;
    gw_stage stage;
    gw_camera camera;
    open_stage(&stage, &camera, aquarium(0), &before, NULL);
    camera.state.tau_inside = 2;
    uint8_t *whole = gw_stage_take(&stage, &camera, NULL, NULL), *part = calloc(PIXELS, 4);
    assert_non_null(part);
    const gw_renderer_options ways[] = {
        {.count = 1}, {.loop_budget = 32}, {.force_features = GW_ALL_FEATURES}};
    for (size_t w = 0; w < sizeof ways / sizeof ways[0]; ++w) {
        uint8_t *other = gw_stage_take(&stage, &camera, &ways[w], NULL);
        if (memcmp(whole, other, PIXELS * 4))
            fail_msg("way %zu: other pixels", w);
        free(other);
    }
    gw_renderer *renderer = gw_stage_renderer(&stage);
    static const gw_rectangle parts[] = {{0, 0, 11, 15}, {11, 3, 13, 21}};
    for (size_t p = 0; p < sizeof parts / sizeof parts[0]; ++p) {
        const gw_rectangle *r = &parts[p];
        check_ok(gw_renderer_frame(renderer, &camera.placement, &camera.plane, r, &camera.state, part, NULL,
                                   &error));
        for (uint32_t y = 0; y < r->height; ++y)
            assert_memory_equal(part + (size_t)y * r->width * 4,
                                whole + ((size_t)(r->y + (int)y) * SIDE + (size_t)r->x) * 4,
                                (size_t)r->width * 4);
    }
    free(part);
    free(whole);
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
}

/* Glass is glass at any tau: mean difference of a coarse picture to the exact one, in 1/255. */
static double error_of_tau(const char *shaders) {
    model m = {.marked = 0};
    add_stripes(&m);
    gw_mesh_add_sphere(&m.mesh, (const double[]){0, 0, 0}, 0.7, 0, 16, 9);
    mark(&m, GLASS);
    gw_stage stage;
    gw_camera camera;
    open_stage(&stage, &camera, scene_of(&m, 1, 0.05, 0), &before, shaders);
    uint8_t *exact = gw_stage_take(&stage, &camera, NULL, NULL);
    camera.state.tau_inside = 3;
    uint8_t *coarse = gw_stage_take(&stage, &camera, NULL, NULL);
    const double difference = gw_mean_difference(exact, coarse, PIXELS);
    free(exact);
    free(coarse);
    gw_stage_close(&stage);
    return difference;
}

static void glass_never_becomes_a_voxel(void **state) {
    (void)state;
    char folder[512];
    const double kept = error_of_tau(NULL),
                 voxels = error_of_tau(
                     gw_naive_shaders(folder, "voxels", "trace/traverse_lod.glsl", "VOXELS_OF_GLASS"));
    print_message("# a ball at tau 3: %.2f/255 off, %.2f if its cells stand for it\n", kept, voxels);
    assert_true(voxels > 2 * kept + 5); /* the naive rule fails */
}

/* Sheets between a floor and its light let by what they transmit, one after the other. */
static void sheets_cast_partial_shadows(void **state) {
    (void)state;
    static const look down = {{0, 2.5, 0.01}, {0, 0, 0}, 20};
    static const float transmissions[] = {0.5f, 0.8f};
    double light[3];
    for (int sheets = 0; sheets <= 2; ++sheets) {
        model m = {.marked = 0};
        gw_mesh_add_grid(&m.mesh, (const double[]){-1, 0, -1}, (const double[]){0, 0, 2},
                         (const double[]){2, 0, 0}, 1, 1);
        mark(&m, 0);
        for (int s = 0; s < sheets; ++s) { /* above the viewer */
            gw_mesh_add_grid(&m.mesh, (const double[]){-1, 3 + s, -1}, (const double[]){0, 0, 2},
                             (const double[]){2, 0, 0}, 1, 1);
            mark(&m, GLASS + s);
        }
        gw_scene *scene = scene_of(&m, 0, 0, 0);
        for (int c = 0; c < 3; ++c) {
            scene->materials[0].base_color[c] = 1;
            scene->materials[0].emissive[c] = 0;
        }
        for (int s = 0; s < 2; ++s) {
            scene->extensions[GLASS + s].ior = 1;
            scene->extensions[GLASS + s].transmission = transmissions[s];
        }
        scene->lights = calloc(1, sizeof *scene->lights);
        assert_non_null(scene->lights);
        scene->lights[0].kind = GW_LIGHT_DIRECTIONAL;
        scene->lights[0].vector[1] = -1;
        for (int c = 0; c < 3; ++c)
            scene->lights[0].color[c] = 2;
        scene->light_count = 1;
        gw_stage stage;
        gw_camera camera;
        open_stage(&stage, &camera, scene, &down, NULL);
        uint8_t *rgba = gw_stage_take(&stage, &camera, NULL, NULL);
        light[sheets] = gw_srgb_code_to_linear(rgba[(PIXELS / 2 + SIDE / 2) * 4]);
        free(rgba);
        gw_stage_close(&stage);
    }
    print_message("# light on a floor: %.3f, under a sheet %.3f, under two %.3f\n", light[0], light[1],
                  light[2]);
    assert_true(light[0] > 0.3);
    assert_true(fabs(light[1] / light[0] - 0.5) < 0.02);
    assert_true(fabs(light[2] / light[0] - 0.4) < 0.02);
}

/* A sheet whose map lets by none, a third, two thirds and all of the light, in columns. */
static void a_map_of_transmission_is_shown_texel_by_texel(void **state) {
    (void)state;
    enum { COLUMNS = 4 };
    static const look straight = {{0, 0, 3}, {0, 0, 0}, 36};
    model m = {.marked = 0};
    gw_mesh_add_grid(&m.mesh, (const double[]){-4, -4, -1}, (const double[]){8, 0, 0},
                     (const double[]){0, 8, 0}, 1, 1);
    mark(&m, 1);
    gw_mesh_add_grid(&m.mesh, (const double[]){-1, -1, 0}, (const double[]){2, 0, 0},
                     (const double[]){0, 2, 0}, 3, 3);
    mark(&m, GLASS);
    gw_scene *scene = scene_of(&m, 0, 0, 0);
    gw_material_extension *e = &scene->extensions[GLASS];
    e->ior = 1;
    e->transmission_map = (gw_texture_use){.texture = 0, .to_uv = {{1, 0, 0}, {0, 1, 0}}};
    scene->textures = calloc(1, sizeof *scene->textures);
    assert_non_null(scene->textures);
    scene->texture_count = 1;
    scene->textures[0].nearest = 1;
    check_ok(gw_image_create(COLUMNS, 1, &scene->textures[0].image, &error));
    for (int i = 0; i < COLUMNS; ++i)
        memcpy(scene->textures[0].image.rgba + i * 4, (const uint8_t[]){(uint8_t)(85 * i), 0, 0, 255}, 4);
    for (uint32_t v = 0; v < scene->vertex_count; ++v)
        scene->texcoords[v * 2] =
            (float)((ldexp((double)scene->positions[v * 3], scene->exponent) + scene->centre[0] + 1) / 2);
    gw_stage stage;
    gw_camera camera;
    open_stage(&stage, &camera, scene, &straight, NULL);
    uint8_t *rgba = gw_stage_take(&stage, &camera, NULL, NULL);
    int seen[COLUMNS] = {0};
    for (uint32_t i = 0; i < PIXELS; ++i) {
        double d[3];
        gw_camera_ray(&camera, i % SIDE, i / SIDE, d);
        const double column = (1 - 3 * d[0] / d[2]) * COLUMNS / 2;
        const int k = (int)column;
        if (fabs(column - round(column)) < 0.02)
            continue;
        ++seen[k];
        assert_true(fabs(gw_srgb_code_to_linear(rgba[i * 4]) - 0.8 * k / 3) < 0.01);
    }
    for (int k = 0; k < COLUMNS; ++k)
        assert_true(seen[k] > PIXELS / 8);
    free(rgba);
    gw_stage_close(&stage);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(glass_bends_and_reflects_as_the_oracle_says),
        cmocka_unit_test(media_survive_coincident_faces),
        cmocka_unit_test(a_viewer_in_glass_knows),
        cmocka_unit_test(a_furnace_shows_nothing),
        cmocka_unit_test(however_it_is_drawn_pixels_are_the_same),
        cmocka_unit_test(glass_never_becomes_a_voxel),
        cmocka_unit_test(sheets_cast_partial_shadows),
        cmocka_unit_test(a_map_of_transmission_is_shown_texel_by_texel),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
