/* Rays from inside a closed surface, aimed at its vertices and edges, never pass. The naive test of Moeller
 * and Trumbore, run over the same rays, does let some through: the rays are hard enough to tell. */
#include "tests/support/check.h"

#include "tests/support/meshes.h"
#include "tests/support/renders.h"

#include <math.h>

enum { AROUND = 60, RINGS = 36, ON_EDGE = 10, SEED = 7 };

static gw_stage stage;
static gw_renderer *renderer;
static gw_ray *rays;
static size_t ray_count;
static float centre[3]; /* of the sphere, rebased */

static const float *position(uint32_t vertex) {
    return stage.scene->positions + (size_t)vertex * 3;
}

static void aim(const float from[3], const double at[3]) {
    gw_ray *ray = &rays[ray_count++];
    for (int k = 0; k < 3; ++k) {
        ray->origin[k] = from[k];
        ray->direction[k] = (float)(at[k] - (double)from[k]);
    }
    ray->maximum = INFINITY;
}

/* At every corner of every triangle and at points along every edge, from the centre and from a place beside
 * it. */
static void make_rays(void) {
    const gw_scene *scene = stage.scene;
    rays = calloc((size_t)scene->triangle_count * 3 * (ON_EDGE + 1), sizeof *rays);
    assert_non_null(rays);
    uint64_t random = SEED;
    for (uint32_t t = 0; t < scene->triangle_count; ++t)
        for (uint32_t k = 0; k < 3; ++k) {
            const float *a = position(scene->triangles[t][k]),
                        *b = position(scene->triangles[t][(k + 1) % 3]);
            float from[3];
            for (int i = 0; i < 3; ++i)
                from[i] = t % 2 ? centre[i] : centre[i] + (float)(0.2 * (gw_test_random(&random) - 0.5));
            for (int j = 0; j <= ON_EDGE; ++j) {
                double share = j == 0 ? 0.0 : gw_test_random(&random), at[3];
                for (int i = 0; i < 3; ++i)
                    at[i] = (1.0 - share) * (double)a[i] + share * (double)b[i];
                aim(from, at);
            }
        }
}

static int open_stage(void **state) {
    (void)state;
    gw_mesh mesh = {0};
    gw_scene *scene = NULL;
    gw_mesh_add_sphere(&mesh, (const double[]){0, 0, 0}, 1.0, 0.15, AROUND, RINGS);
    scene = gw_mesh_take(&mesh);
    check_ok(gw_stage_open(&stage, scene, NULL, (const char *const[]){"octree_depth=9", NULL}, &error));
    check_ok(gw_renderer_create(stage.device, stage.scene, stage.octree, NULL, &renderer, &error));
    for (int k = 0; k < 3; ++k)
        centre[k] = (float)ldexp(0.0 - stage.scene->centre[k], -stage.scene->exponent);
    make_rays();
    return 0;
}

static int close_stage(void **state) {
    (void)state;
    free(rays);
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
    return 0;
}

static size_t misses_of(const gw_hit *hits) {
    size_t misses = 0;
    for (size_t i = 0; i < ray_count; ++i)
        misses += hits[i].triangle == GW_NO_TRIANGLE;
    return misses;
}

static void no_ray_leaves_through_a_vertex_or_an_edge(void **state) {
    (void)state;
    gw_hit *hits = calloc(ray_count, sizeof *hits);
    assert_non_null(hits);
    gw_counters counters = {0};
    check_ok(gw_renderer_trace(renderer, GW_TRACE_OCTREE, rays, ray_count, hits, &counters, &error));
    print_message("%zu rays at vertices and edges, %zu misses\n", ray_count, misses_of(hits));
    assert_int_equal(misses_of(hits), 0);
    assert_int_equal(counters.step_cap_hits, 0);
    /* They hit where they were aimed: t is about 1. */
    for (size_t i = 0; i < ray_count; ++i)
        assert_true(fabsf(hits[i].t - 1.0f) < 0.6f);
    free(hits);
}

static const char naive_source[] =
    "#version 450 core\n"
    "layout(local_size_x = 64) in;\n"
    "layout(std430, binding = 0) readonly buffer Rays { vec4 rays[]; };\n"
    "layout(std430, binding = 1) writeonly buffer Hits { uvec2 hits[]; };\n"
    "layout(std430, binding = 2) readonly buffer Triangles { vec4 triangles[]; };\n"
    "layout(location = 0) uniform uvec2 counts;\n"
    "void main() {\n"
    "    uint slot = gl_GlobalInvocationID.x;\n"
    "    if (slot >= counts.x) return;\n"
    "    vec3 o = rays[2u * slot].xyz, d = rays[2u * slot + 1u].xyz;\n"
    "    uint found = 0xffffffffu;\n"
    "    for (uint i = 0u; i < counts.y; ++i) {\n"
    "        vec3 a = triangles[3u * i].xyz, e1 = triangles[3u * i + 1u].xyz - a, e2 = triangles[3u * i + "
    "2u].xyz - a;\n"
    "        vec3 p = cross(d, e2), s = o - a, q = cross(s, e1);\n"
    "        float inverse = 1.0 / dot(e1, p), u = dot(s, p) * inverse, v = dot(d, q) * inverse;\n"
    "        if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && dot(e2, q) * inverse > 0.0) found = i;\n"
    "    }\n"
    "    hits[slot] = uvec2(0u, found);\n"
    "}\n";

static GLuint naive_program(void) {
    const char *source = naive_source;
    GLuint shader = glCreateShader(GL_COMPUTE_SHADER), program = glCreateProgram();
    glShaderSource(shader, 1, &source, NULL);
    glCompileShader(shader);
    glAttachShader(program, shader);
    glLinkProgram(program);
    glDeleteShader(shader);
    GLint linked = 0;
    glGetProgramiv(program, GL_LINK_STATUS, &linked);
    assert_true(linked);
    return program;
}

static void the_naive_test_lets_rays_through(void **state) {
    (void)state;
    const gw_scene *scene = stage.scene;
    float(*corners)[3][4] = calloc(scene->triangle_count, sizeof *corners);
    gw_hit *hits = calloc(ray_count, sizeof *hits);
    assert_non_null(corners);
    assert_non_null(hits);
    for (uint32_t t = 0; t < scene->triangle_count; ++t)
        for (int k = 0; k < 3; ++k)
            memcpy(corners[t][k], position(scene->triangles[t][k]), 3 * sizeof(float));
    gw_gl_buffer ray_buffer, hit_buffer, triangle_buffer;
    check_ok(
        gw_gl_buffer_create(stage.device, "rays", ray_count * sizeof *rays, rays, 0, &ray_buffer, &error));
    check_ok(
        gw_gl_buffer_create(stage.device, "hits", ray_count * sizeof *hits, NULL, 0, &hit_buffer, &error));
    check_ok(gw_gl_buffer_create(stage.device, "corners", scene->triangle_count * sizeof *corners, corners, 0,
                                 &triangle_buffer, &error));
    gw_gl_buffer_bind(&ray_buffer, 0);
    gw_gl_buffer_bind(&hit_buffer, 1);
    gw_gl_buffer_bind(&triangle_buffer, 2);
    GLuint program = naive_program();
    glProgramUniform2ui(program, 0, (GLuint)ray_count, scene->triangle_count);
    check_ok(gw_gl_dispatch(stage.device, program, (ray_count + 63) / 64, &error));
    check_ok(gw_gl_buffer_read(&hit_buffer, 0, ray_count * sizeof *hits, hits, &error));
    print_message("Moeller-Trumbore misses %zu of %zu\n", misses_of(hits), ray_count);
    assert_true(misses_of(hits) > 0);
    glDeleteProgram(program);
    gw_gl_buffer_finish(&ray_buffer);
    gw_gl_buffer_finish(&hit_buffer);
    gw_gl_buffer_finish(&triangle_buffer);
    free(corners);
    free(hits);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_ray_leaves_through_a_vertex_or_an_edge),
        cmocka_unit_test(the_naive_test_lets_rays_through),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
