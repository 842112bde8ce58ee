/* The white furnace: surfaces of every kind of material under light from everywhere, lit once by what shading
 * does with light from all around, and once by many directional lights whose sum it is. Nothing may reflect
 * more than arrives, and white metal nothing less. */
#include "tests/support/check.h"

#include "base/file.h"
#include "base/gl.h"
#include "render/albedo_table.h"
#include "tests/support/renders.h"

#include <math.h>
#include <stdio.h>

/* Roughness, cosine to the view, metalness, reflectance at 0 degrees, layers (the last a coat whose own map
 * bends its normal): as the kernel counts them. */
enum { ROUGHNESSES = 5, COSINES = 5, METALS = 3, REFLECTANCES = 3, LAYERS = 6 };
enum { CASES = ROUGHNESSES * COSINES * METALS * REFLECTANCES * LAYERS };

/* Lights are drawn by the highlight's, the coat's and the cosine's own distribution in turn and weighted by
 * the mean of all three. */
static const char kernel[] =
    "#define SPECULAR 1\n#define CLEARCOAT 1\n#define SHEEN 1\n"
    "layout(local_size_x = 25) in;\n"
    "#include \"common/frame_block.glsl\"\n"
    "#include \"shade/brdf.glsl\"\n"
    "layout(std430, binding = 0) buffer Results { vec2 results[]; };\n"
    "const float roughnesses[5] = float[5](0.0, 0.1, 0.3, 0.6, 1.0);\n"
    "const float cosines[5] = float[5](1.0, 0.6, 0.2, 0.05, 0.02);\n"
    "const float reflectances[3] = float[3](0.0, 0.04, 0.3);\n"
    "const uint DRAWS = 6000u;\n"
    "float density_of_normal(float roughness, float n_h, float v_h) {\n"
    "    float a = max(roughness * roughness, LEAST_ALPHA), a2 = a * a, s = n_h * n_h * (a2 - 1.0) + 1.0;\n"
    "    return a2 * INVERSE_PI / (s * s) * max(n_h, 0.0) / max(4.0 * v_h, 1e-6);\n"
    "}\n"
    "void main() {\n"
    "    uint i = gl_WorkGroupID.x * 25u + gl_LocalInvocationIndex, k = i;\n"
    "    Surface s;\n"
    "    s.normal = vec3(0, 0, 1); s.base_color = vec3(1); s.agreement = 1.0; s.emissive = vec3(0); s.alpha "
    "= 1.0;\n"
    "    s.position = vec3(0); s.coat_normal = s.normal; s.coat = 0.0; s.sheen = vec3(0);\n"
    "    s.coat_roughness = 0.0; s.sheen_roughness = 0.5;\n"
    "    s.roughness = roughnesses[k % 5u]; k /= 5u;\n"
    "    float c = cosines[k % 5u]; k /= 5u;\n"
    "    s.metalness = 0.5 * float(k % 3u); k /= 3u;\n"
    "    s.dielectric = vec4(vec3(reflectances[k % 3u]), 1.0); k /= 3u;\n"
    "    if (k == 1u || k == 4u) s.coat = 1.0;\n"
    "    if (k == 2u) { s.coat = 1.0; s.coat_roughness = 0.6; }\n"
    "    if (k == 5u) { s.coat = 1.0; s.coat_roughness = 0.3; s.coat_normal = vec3(0.6, 0.0, 0.8); }\n"
    "    if (k == 3u || k == 4u) s.sheen = vec3(1.0, 0.5, 1.0);\n"
    "    if (k == 4u) s.sheen_roughness = 0.25;\n"
    "    vec3 view = vec3(sqrt(1.0 - c * c), 0.0, c);\n"
    "    see_surface(s, view);\n"
    "    float white = max(reflect_environment(s, view, vec3(1.0 / INVERSE_PI), vec3(1), vec3(1)).r, 0.0);\n"
    "    float sum = 0.0;\n"
    "    for (uint n = 0u; n < DRAWS; ++n) {\n"
    "        uint which = n % 3u;\n"
    "        float u = (float(n / 3u) + 0.5) / float(DRAWS / 3u);\n"
    "        float angle = 6.2831853 * float(bitfieldReverse(n / 3u)) * 2.3283064e-10;\n"
    "        float a = max(which == 0u ? s.roughness * s.roughness : s.coat_roughness * s.coat_roughness, "
    "LEAST_ALPHA);\n"
    "        float z = which == 2u ? sqrt(1.0 - u) : sqrt((1.0 - u) / (1.0 + (a * a - 1.0) * u));\n"
    "        float r = sqrt(max(1.0 - z * z, 0.0));\n"
    "        vec3 drawn = vec3(r * cos(angle), r * sin(angle), z);\n"
    "        vec3 c_n = s.coat_normal;\n"
    "        vec3 side = vec3(c_n.z, 0.0, -c_n.x);\n"
    "        if (which == 1u) drawn = drawn.x * side + drawn.y * vec3(0, 1, 0) + drawn.z * c_n;\n"
    "        if (dot(view, drawn) <= 0.0 && which != 2u) continue;\n"
    "        vec3 light = which == 2u ? drawn : 2.0 * dot(view, drawn) * drawn - view;\n"
    "        if (light.z <= 0.0 && dot(light, c_n) <= 0.0) continue;\n"
    "        vec3 h = normalize(view + light);\n"
    "        float v_h = dot(view, h);\n"
    "        float density = (density_of_normal(s.roughness, h.z, v_h) + density_of_normal(s.coat_roughness, "
    "dot(h, c_n), v_h) +\n"
    "                         max(light.z, 0.0) * INVERSE_PI) / 3.0;\n"
    "        sum += reflect_light(s, view, light, vec3(1), vec2(1)).r / density;\n"
    "    }\n"
    "    results[i] = vec2(white, sum / float(DRAWS));\n"
    "}\n";

/* All cases with one line defined before shade/brdf.glsl. */
static void burn(const char *define, float results[CASES][2]) {
    static float albedo[GW_ALBEDO_SIDE][GW_ALBEDO_SIDE][2], sheen[GW_ALBEDO_SIDE][GW_ALBEDO_SIDE];
    char folder[512], path[600];
    gw_gl *device = NULL;
    gw_gl_buffer buffer;
    GLuint program = 0;
    gw_naive_shaders(folder, "furnace", "shade/brdf.glsl", define);
    snprintf(path, sizeof path, "%s/shade/furnace.comp", folder);
    check_ok(gw_file_write(path, kernel, strlen(kernel), &error));
    check_ok(gw_gl_create(&(gw_gl_options){.shader_folder = folder}, &device, &error));
    gw_albedo_table_fill(albedo);
    gw_sheen_table_fill(sheen);
    GLuint textures[2] = {gw_albedo_table_texture(GL_RG32F, GL_RG, albedo),
                          gw_albedo_table_texture(GL_R32F, GL_RED, sheen)};
    glBindTextureUnit(19, textures[0]);
    glBindTextureUnit(24, textures[1]);
    check_ok(gw_gl_buffer_create(device, "results", sizeof(float[CASES][2]), NULL, 0, &buffer, &error));
    check_ok(gw_gl_program(device, "shade/furnace.comp", NULL, &program, &error));
    gw_gl_buffer_bind(&buffer, 0);
    check_ok(gw_gl_dispatch(device, program, CASES / 25, &error));
    check_ok(gw_gl_buffer_read(&buffer, 0, sizeof(float[CASES][2]), results, &error));
    glDeleteTextures(2, textures);
    gw_gl_buffer_finish(&buffer);
    gw_gl_destroy(&device);
}

static void greatest(float results[CASES][2], float most[2], int where[2]) {
    most[0] = most[1] = 0;
    for (int i = 0; i < CASES; i++)
        for (int k = 0; k < 2; k++) {
            assert_true(isfinite(results[i][k]) && results[i][k] >= 0.0f);
            if (results[i][k] > most[k]) {
                most[k] = results[i][k];
                where[k] = i;
            }
        }
}

/* What white metal without layers gives back at least, over every roughness and angle; the kernel's order of
 * cases. */
static float least_of_white_metal(float results[CASES][2]) {
    float least = 1;
    for (int r = 0; r < ROUGHNESSES; r++)
        for (int c = 0; c < COSINES; c++)
            least = fminf(least, results[r + ROUGHNESSES * (c + COSINES * 2)][1]);
    return least;
}

static void nothing_reflects_more_than_arrives(void **state) {
    (void)state;
    static float results[CASES][2];
    float most[2];
    int where[2] = {0};
    burn("FURNACE", results);
    greatest(results, most, where);
    print_message("# reflected of 1: light from everywhere %.4f (case %d), as many lights %.4f (case %d)\n",
                  (double)most[0], where[0], (double)most[1], where[1]);
    assert_true(most[0] <= 1.001f && most[1] <= 1.01f);
    const float least = least_of_white_metal(results);
    print_message("# white metal gives back %.4f at least\n", (double)least);
    assert_true(least > 0.97f);
}

/* Schlick's term of the half vector alone leaves the diffuse part whole where the highlight takes nearly all.
 */
static void the_naive_sum_makes_light(void **state) {
    (void)state;
    static float results[CASES][2];
    float most[2];
    int where[2] = {0};
    burn("WHOLE_DIFFUSE", results);
    greatest(results, most, where);
    print_message("# with the whole diffuse part: %.4f and %.4f\n", (double)most[0], (double)most[1]);
    assert_true(most[0] > 1.3f && most[1] > 1.3f);
}

/* Light that meets several microfacets of a rough metal is lost where only the first counts. */
static void a_single_microfacet_loses_light(void **state) {
    (void)state;
    static float results[CASES][2];
    burn("SINGLE_SCATTERING", results);
    const float least = least_of_white_metal(results);
    print_message("# with one microfacet: white metal gives back %.4f at least\n", (double)least);
    assert_true(least < 0.8f);
}

static void the_tables_hold_what_is_known(void **state) {
    (void)state;
    static float table[GW_ALBEDO_SIDE][GW_ALBEDO_SIDE][2];
    const int last = GW_ALBEDO_SIDE - 1;
    gw_albedo_table_fill(table);
    assert_true(fabs((double)table[last][last][0] - (1.0 - log(2.0))) < 2e-3); /* alpha 1, straight on */
    for (int c = 8; c <= last; c++) { /* smooth: all of it, and Schlick's own term */
        const double cosine = (double)(c * c) / (last * last);
        assert_true(fabs((double)table[0][c][0] - 1.0) < 1e-3);
        assert_true(fabs((double)table[0][c][1] - pow(1.0 - cosine, 5.0)) < 2e-3);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_tables_hold_what_is_known),
        cmocka_unit_test(nothing_reflects_more_than_arrives),
        cmocka_unit_test(the_naive_sum_makes_light),
        cmocka_unit_test(a_single_microfacet_loses_light),
    };
    return cmocka_run_group_tests_name("furnace", tests, NULL, NULL);
}
