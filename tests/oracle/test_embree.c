/* Hits of the shipped traversal against Embree (robust), on the demo scene and on real scenes where they were
 * fetched.
 *
 * Rays and vertices are the same bits on both sides. Every ray whose hit differs is judged by a
 * double-precision search over all triangles: a disagreement is explained when the double result is ours, or
 * when the double result itself hangs on a border (a triangle edge, a grazing plane, two surfaces at one
 * distance) that float arithmetic cannot resolve. What is left is unexplained and fails the test. */
#include "tests/support/device.h"

#include "build/demo_scene.h"
#include "build/import.h"
#include "build/octree.h"
#include "render/renderer.h"
#include "render/vector3.h"
#include "tests/support/meshes.h"

#include <embree3/rtcore.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { RAYS = 1 << 18 };
/* Of the triangle's barycentric coordinates: nearer to an edge than this, float may decide either way. */
static const double EDGE_BAND = 2e-5;
/* Relative distance between hits that count as one surface, and what is added to it: an ulp of the
 * coordinates, which decides for rays that start next to a surface. */
static const double DISTANCE_BAND = 1e-4, DISTANCE_FLOOR = 0x1p-23;

/* One double-precision crossing of a ray and a triangle's plane. */
typedef struct crossing {
    double t;
    double margin;  /* least barycentric coordinate: negative outside */
    double grazing; /* |cosine| between ray and normal */
} crossing;

static void vertex_of(const gw_scene *scene, uint32_t triangle, int corner, double out[3]) {
    const float *p = scene->positions + (size_t)scene->triangles[triangle][corner] * 3;
    for (int k = 0; k < 3; ++k)
        out[k] = p[k];
}

/* 0 when the ray is parallel to the plane. */
static int cross_triangle(const gw_scene *scene, uint32_t triangle, const gw_ray *ray, crossing *out) {
    double v[3][3], e1[3], e2[3], n[3], o[3], d[3], s[3], p[3];
    for (int i = 0; i < 3; ++i)
        vertex_of(scene, triangle, i, v[i]);
    for (int k = 0; k < 3; ++k) {
        e1[k] = v[1][k] - v[0][k];
        e2[k] = v[2][k] - v[0][k];
        o[k] = ray->origin[k];
        d[k] = ray->direction[k];
        s[k] = v[0][k] - o[k];
    }
    gw_cross(e1, e2, n);
    double along = gw_dot(n, d), square = gw_dot(n, n);
    if (along == 0 || square == 0)
        return 0;
    out->t = gw_dot(n, s) / along;
    out->grazing = fabs(along) / sqrt(square * gw_dot(d, d));
    double w[3], a[3], b[3];
    for (int k = 0; k < 3; ++k) {
        p[k] = o[k] + d[k] * out->t;
        w[k] = p[k] - v[0][k];
    }
    gw_cross(w, e2, a);
    gw_cross(e1, w, b);
    double second = gw_dot(a, n) / square, third = gw_dot(b, n) / square;
    out->margin = fmin(fmin(second, third), 1 - second - third);
    return 1;
}

typedef struct verdicts {
    uint32_t differ, ours_right, border, unexplained; /* the first rays of each that differ are listed */
    uint32_t other_triangle; /* the same distance in another triangle that the ray meets there too: a shared
                                edge, a copy */
} verdicts;

enum { LISTED = 10 }; /* rounding cases of each kind and scene */

static void list_ray(const char *kind, uint32_t number, const gw_ray *ray, const gw_hit *ours, float theirs,
                     double nearest) {
    if (number <= LISTED)
        print_message(
            "%s: from %.9g %.9g %.9g to %.9g %.9g %.9g: ours %.9g (triangle %u), Embree %.9g, double "
            "%.17g\n",
            kind, (double)ray->origin[0], (double)ray->origin[1], (double)ray->origin[2],
            (double)ray->direction[0], (double)ray->direction[1], (double)ray->direction[2], (double)ours->t,
            ours->triangle, (double)theirs, nearest);
}

/* Judges one ray on which both sides differ. Ours is right when it is the nearest double hit; the case is a
 * border when some triangle at or before either hit has the ray within the band of its edges or grazes it. */
static void judge(const gw_scene *scene, const gw_ray *ray, const gw_hit *ours, float theirs, verdicts *v) {
    double nearest = INFINITY,
           limit = fmax(ours->triangle == GW_NO_TRIANGLE ? 0 : ours->t, isinf(theirs) ? 0 : theirs);
    int border = 0;
    limit = limit * (1 + DISTANCE_BAND);
    for (uint32_t t = 0; t < scene->triangle_count; ++t) {
        crossing c;
        if (!cross_triangle(scene, t, ray, &c) || !(c.t > -1e-6) || c.t > limit)
            continue;
        if (c.margin >= 0 && c.t > 0 && c.t < nearest)
            nearest = c.t;
        if (fabs(c.margin) < EDGE_BAND || (c.grazing < 1e-3 && c.margin > -1e-2) ||
            (c.margin > -EDGE_BAND && fabs(c.t) < 1e-6))
            border = 1;
    }
    double own = ours->triangle == GW_NO_TRIANGLE ? INFINITY : ours->t;
    v->differ++;
    if ((isinf(own) && isinf(nearest)) || fabs(own - nearest) <= DISTANCE_BAND * nearest + DISTANCE_FLOOR)
        list_ray("ours is the double result", ++v->ours_right, ray, ours, theirs, nearest);
    else if (border)
        list_ray("on a border", ++v->border, ray, ours, theirs, nearest);
    else {
        v->unexplained++;
        list_ray("unexplained", 0, ray, ours, theirs, nearest);
    }
}

/* Whether, in double, the ray meets both triangles at our distance, within the bands. */
static int meets_both(const gw_scene *scene, const gw_ray *ray, const gw_hit *ours, uint32_t theirs) {
    const uint32_t triangles[2] = {ours->triangle, theirs};
    for (int i = 0; i < 2; ++i) {
        crossing c;
        if (!cross_triangle(scene, triangles[i], ray, &c) || c.margin < -EDGE_BAND ||
            fabs(c.t - ours->t) > DISTANCE_BAND * c.t + DISTANCE_FLOOR)
            return 0;
    }
    return 1;
}

static RTCScene embree_scene(RTCDevice embree, const gw_scene *scene) {
    RTCScene out = rtcNewScene(embree);
    RTCGeometry mesh = rtcNewGeometry(embree, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSceneFlags(out, RTC_SCENE_FLAG_ROBUST);
    float *points = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                            3 * sizeof(float), scene->vertex_count);
    uint32_t *indices = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                3 * sizeof(uint32_t), scene->triangle_count);
    memcpy(points, scene->positions, (size_t)scene->vertex_count * 3 * sizeof(float));
    memcpy(indices, scene->triangles, (size_t)scene->triangle_count * 3 * sizeof(uint32_t));
    rtcCommitGeometry(mesh);
    rtcAttachGeometry(out, mesh);
    rtcReleaseGeometry(mesh);
    rtcCommitScene(out);
    return out;
}

/* Distance and triangle of the nearest hit; INFINITY for none. */
static float embree_hit(RTCScene scene, const gw_ray *ray, uint32_t *triangle) {
    struct RTCIntersectContext context;
    struct RTCRayHit hit = {.ray = {.org_x = ray->origin[0],
                                    .org_y = ray->origin[1],
                                    .org_z = ray->origin[2],
                                    .tnear = ray->minimum,
                                    .dir_x = ray->direction[0],
                                    .dir_y = ray->direction[1],
                                    .dir_z = ray->direction[2],
                                    .tfar = ray->maximum,
                                    .mask = UINT32_MAX},
                            .hit = {.geomID = RTC_INVALID_GEOMETRY_ID, .primID = RTC_INVALID_GEOMETRY_ID}};
    hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene, &context, &hit);
    *triangle = hit.hit.primID;
    return hit.hit.geomID == RTC_INVALID_GEOMETRY_ID ? INFINITY : hit.ray.tfar;
}

/* Half the rays as a camera would send them from outside the scene, half from random points inside in all
 * directions. */
static void make_rays(gw_ray *rays, uint64_t seed) {
    for (size_t i = 0; i < RAYS; ++i) {
        double o[3], d[3], length = 0;
        for (int k = 0; k < 3; ++k) {
            o[k] = (2 * gw_test_random(&seed) - 1) * 0.9;
            d[k] = 2 * gw_test_random(&seed) - 1;
        }
        if (i % 2 == 0) {
            const double eye[3] = {0.9, 0.8, 1.7};
            for (int k = 0; k < 3; ++k) {
                d[k] = 0.8 * d[k] - eye[k];
                o[k] = eye[k];
            }
        }
        for (int k = 0; k < 3; ++k)
            length += d[k] * d[k];
        length = length > 0 ? sqrt(length) : 1;
        for (int k = 0; k < 3; ++k) {
            rays[i].origin[k] = (float)o[k];
            rays[i].direction[k] = (float)(d[k] / length);
        }
        rays[i].minimum = 0;
        rays[i].maximum = 1e30f;
    }
}

static void compare(const char *name, const gw_scene *scene) {
    gw_error error = {0};
    gw_settings settings;
    gw_octree *octree = NULL;
    gw_renderer *renderer = NULL;
    gw_renderer_options renderer_options = {0};
    verdicts v = {0};
    uint32_t hits_counted = 0;
    gw_ray *rays = malloc(RAYS * sizeof *rays);
    gw_hit *hits = malloc(RAYS * sizeof *hits);
    assert_true(rays && hits);
    gw_settings_init(&settings);
    gw_octree_options options = {.settings = &settings};
    make_rays(rays, 11);
    if (gw_octree_build(device, scene, &options, &octree, &error) != GW_OK ||
        gw_octree_validate(device, scene, octree, &error) != GW_OK ||
        gw_renderer_create(device, scene, octree, &renderer_options, &renderer, &error) != GW_OK ||
        gw_renderer_trace(renderer, GW_TRACE_OCTREE, rays, RAYS, hits, NULL, &error) != GW_OK)
        fail_msg("%s: %s", name, error.text);
    RTCDevice embree = rtcNewDevice("threads=2");
    RTCScene peer = embree_scene(embree, scene);
    for (size_t i = 0; i < RAYS; ++i) {
        uint32_t their_triangle;
        float theirs = embree_hit(peer, &rays[i], &their_triangle);
        int own_hit = hits[i].triangle != GW_NO_TRIANGLE;
        hits_counted += (uint32_t)own_hit;
        int apart = own_hit != !isinf(theirs) ||
                    (own_hit && fabs((double)hits[i].t - theirs) >
                                    DISTANCE_BAND * fabs((double)theirs) + DISTANCE_FLOOR);
        int other = own_hit && !apart && hits[i].triangle != their_triangle;
        if (other && meets_both(scene, &rays[i], &hits[i], their_triangle))
            v.other_triangle++;
        else if (apart || other)
            judge(scene, &rays[i], &hits[i], theirs, &v);
    }
    print_message(
        "%s: %u triangles, %d rays (seed 11), %u hits; %u differ from Embree robust: ours is the "
        "double result "
        "in %u, %u hang on a border, %u unexplained; %u name the neighbour that is met at the same place\n",
        name, scene->triangle_count, RAYS, hits_counted, v.differ, v.ours_right, v.border, v.unexplained,
        v.other_triangle);
    assert_true(hits_counted > RAYS / 50);
    assert_int_equal(v.unexplained, 0);
    assert_true(v.differ < RAYS / 1000);
    rtcReleaseScene(peer);
    rtcReleaseDevice(embree);
    gw_renderer_destroy(&renderer);
    gw_octree_destroy(&octree);
    free(rays);
    free(hits);
}

static void test_demo(void **state) {
    gw_error error = {0};
    gw_scene *scene = NULL;
    (void)state;
    if (gw_demo_scene(&scene, &error) != GW_OK)
        fail_msg("%s", error.text);
    compare("demo", scene);
    gw_scene_destroy(&scene);
}

/* A scene that tests/scenes.sh fetches; skipped by name where it was not. */
static void test_fetched(void **state) {
    const char *name = *state;
    const char *folder = getenv("GAZEWALL_SCENES"), *program = getenv("GAZEWALL");
    char path[1024];
    gw_error error = {0};
    gw_scene *scene = NULL;
    gw_import_options options = {.program = program ? program : "out/gazewall"};
    snprintf(path, sizeof path, "%s/%s", folder ? folder : "out/scenes", name);
    if (access(path, R_OK) != 0) {
        print_message("%s was not fetched (tests/scenes.sh)\n", path);
        skip();
    }
    if (gw_import(path, &options, &scene, &error) != GW_OK)
        fail_msg("%s", error.text);
    compare(name, scene);
    gw_scene_destroy(&scene);
}

int main(void) {
    static char dragon[] = "dragon/dragon_vrip.ply.gz", sponza[] = "sponza/Sponza_LowPoly.gltf",
                engine[] = "testmodels/glTF2/2CylinderEngine-glTF-Binary/2CylinderEngine.glb",
                maple[] = "furniture/Scopia/scopia/japaneseMaple/japaneseMaple.obj";
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_demo),
        {"test_dragon", test_fetched, NULL, NULL, dragon},
        {"test_sponza", test_fetched, NULL, NULL, sponza},
        {"test_cylinder_engine", test_fetched, NULL, NULL, engine},
        {"test_japanese_maple", test_fetched, NULL, NULL, maple},
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
