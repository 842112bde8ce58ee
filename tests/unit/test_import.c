/* gw_import from file to scene, through the real import child ($GAZEWALL), and what becomes of children that
 * misbehave. */
#include "tests/support/check.h"

#include "base/file.h"
#include "build/import.h"
#include "tests/fuzz/import_entry.h"
#include "tests/support/meshes.h"

#include <math.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>

static const char *program(void) {
    const char *name = getenv("GAZEWALL");
    return name ? name : "out/release/gazewall";
}

static gw_scene *import(const char *path) {
    gw_scene *scene = NULL;
    const gw_import_options options = {.program = program()};
    check_ok(gw_import(path, &options, &scene, &error));
    return scene;
}

static int near(double a, double b) {
    return fabs(a - b) < 1e-5;
}

static void position(const gw_scene *scene, uint32_t vertex, double out[3]) {
    for (uint32_t i = 0; i < 3; i++)
        out[i] = scalbn((double)scene->positions[vertex * 3 + i], scene->exponent) + scene->centre[i];
}

/* --- formats --- */

static int has_note(const gw_scene *scene, const char *part) {
    for (size_t i = 0; i < scene->note_count; i++)
        if (strstr(scene->notes[i], part))
            return 1;
    return 0;
}

static void all_formats_give_the_same_tetrahedron(void **state) {
    (void)state;
    static const char *const paths[] = {"tests/data/tetra_binary.ply", "tests/data/tetra.stl",
                                        "tests/data/tetra.off"};
    gw_scene *reference = NULL;
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
        gw_scene *scene = import(paths[i]);
        assert_int_equal(scene->triangle_count, 4);
        assert_int_equal(scene->welded_count, 4);
        assert_int_equal(scene->vertex_count, 12); /* its edges are creases */
        assert_int_equal(scene->placement.kind, GW_PLACE_FIT_BEHIND_WALL);
        assert_true(has_note(scene, "no light in the file") && has_note(scene, "metres and y up"));
        assert_true(scene->light_count == 1 && scene->viewpoint_count == 1);
        assert_true(scene->viewpoints[0].eye[2] > scene->bounds[1][2]);
        if (reference)
            assert_true(gw_hash_equal(reference->hash, scene->hash));
        else
            reference = scene;
        if (scene != reference)
            gw_scene_destroy(&scene);
    }
    gw_scene_destroy(&reference);
}

static void vertex_colours_become_linear(void **state) {
    (void)state;
    gw_scene *scene = import("tests/data/tetra.ply");
    assert_non_null(scene->colors);
    assert_true(scene->materials[0].base_color[0] == 1.0f);
    for (uint32_t v = 0; v < scene->vertex_count; v++) {
        double p[3];
        position(scene, v, p);
        assert_int_equal(scene->colors[v * 4], p[0] > 0.5 ? 255 : 0);
        assert_int_equal(scene->colors[v * 4 + 1], p[1] > 0.5 ? 255 : 0);
        assert_int_equal(scene->colors[v * 4 + 2], 55); /* 128 / 255 decoded, times 255 */
    }
    gw_scene_destroy(&scene);
}

static const gw_material *material_named(const gw_scene *scene, const char *name) {
    for (uint32_t i = 0; i < scene->material_count; i++)
        if (strcmp(scene->materials[i].name, name) == 0)
            return &scene->materials[i];
    fail_msg("no material '%s'", name);
    return NULL;
}

static void mtl_keys_are_carried(void **state) {
    (void)state;
    gw_scene *scene = import("tests/data/box.obj");
    assert_int_equal(scene->triangle_count, 12);
    assert_int_equal(scene->welded_count, 8);
    assert_int_equal(scene->texture_count,
                     2); /* the picture of a material that nothing uses is not looked for */
    const gw_material *wood = material_named(scene, "wood"), *leaf = material_named(scene, "leaf"),
                      *glass = material_named(scene, "glass");
    assert_true(near(wood->roughness, pow(2.0 / 32.0, 0.25)) && wood->alpha_mode == GW_ALPHA_OPAQUE);
    assert_true(leaf->roughness == 1.0f && leaf->alpha_mode == GW_ALPHA_MASK);
    assert_true(near(leaf->base_color[0], 0.21404114));
    assert_true(glass->alpha_mode == GW_ALPHA_BLEND && glass->base_color[3] == 0.25f);
    assert_true(near(glass->emissive[1], 0.21404114));
    const gw_image *image = &scene->textures[leaf->base_color_texture].image;
    assert_int_equal(image->width, 8);
    assert_int_equal(image->rgba[3], 255); /* map_d is white on the left, black on the right */
    assert_int_equal(image->rgba[7 * 4 + 3], 0);
    gw_scene_destroy(&scene);
}

/* A triangle for each material "m0", "m1", ... of the text. */
static gw_scene *import_mtl(const char *mtl, int materials) {
    char path[512], from[600], obj[2048];
    int used = snprintf(obj, sizeof obj, "mtllib keys.mtl\nvt 0 0\nvt 1 0\nvt 0 1\n");
    for (int i = 0; i < materials; i++)
        used += snprintf(obj + used, sizeof obj - (size_t)used,
                         "v %d 0 0\nv %d.5 0 0\nv %d 1 0\nusemtl m%d\nf %d/1 %d/2 %d/3\n", i, i, i, i,
                         3 * i + 1, 3 * i + 2, 3 * i + 3);
    const char *names[] = {"checker.png", "mask.png"};
    for (int i = 0; i < 2; i++) {
        gw_bytes bytes = {0};
        snprintf(from, sizeof from, "tests/data/%s", names[i]);
        check_ok(gw_file_read(from, 1 << 20, &bytes, &error));
        check_ok(gw_file_write(scratch_path(path, names[i]), bytes.data, bytes.size, &error));
        gw_bytes_finish(&bytes);
    }
    check_ok(gw_file_write(scratch_path(path, "keys.mtl"), mtl, strlen(mtl), &error));
    check_ok(gw_file_write(scratch_path(path, "keys.obj"), obj, strlen(obj), &error));
    return import(path);
}

static uint32_t number_of(const gw_scene *scene, const char *name) {
    return (uint32_t)(material_named(scene, name) - scene->materials);
}

/* mask.png is white on the left, black on the right; checker.png is coloured. */
static void mtl_maps_and_models_are_carried(void **state) {
    (void)state;
    gw_scene *scene =
        import_mtl("newmtl m0\nKs 1 1 1\nNs 98\nillum 2\nmap_Ks checker.png\nmap_Ns -s 2 2 1 mask.png\n"
                   "newmtl m1\nPm 0.5\nillum 3\nmap_Pr mask.png\n"
                   "newmtl m2\nKd 0 0 0\nTf 1 0.5 0\nNi 1.5\nd 0.25\nillum 7\n"
                   "newmtl m3\nillum 0\n"
                   "newmtl m4\nKs 1 1 1\nNs 98\nd 0.5\nTf 1 0.5 0\nillum 1\nmap_Ks mask.png\n"
                   "newmtl m5\nillum 10\ndisp mask.png\n",
                   6);
    const gw_material_extension *shiny = &scene->extensions[number_of(scene, "m0")];
    assert_true(shiny->specular_color_map.texture >= 0 && shiny->metallic_roughness.texture >= 0);
    const gw_image *finish = &scene->textures[shiny->metallic_roughness.texture].image;
    assert_int_equal(finish->rgba[1], lround(255.0 * pow(2.0 / 100.0, 0.25)));
    assert_int_equal(finish->rgba[7 * 4 + 1], 255); /* an exponent of 0 */
    assert_true(shiny->roughness == 1.0f && shiny->metalness == 0.0f);
    const uint32_t metal = number_of(scene, "m1");
    finish = &scene->textures[scene->extensions[metal].metallic_roughness.texture].image;
    assert_int_equal(finish->rgba[1], 255);
    assert_int_equal(finish->rgba[7 * 4 + 1], 0);
    assert_true(scene->extensions[metal].metalness == 0.5f &&
                near((double)scene->materials[metal].roughness, 0.5));
    const uint32_t glass = number_of(scene, "m2");
    assert_true(scene->extensions[glass].transmission == 0.75f && scene->extensions[glass].thickness > 0.0f);
    assert_true(scene->materials[glass].alpha_mode == GW_ALPHA_OPAQUE &&
                near((double)scene->materials[glass].base_color[1], 0.375));
    assert_int_equal(scene->extensions[number_of(scene, "m3")].unlit, 1);
    assert_true(material_named(scene, "m4")->roughness == 1.0f &&
                material_named(scene, "m4")->alpha_mode == GW_ALPHA_BLEND);
    const char *const named[] = {"disp, 1 times",
                                 "-s, 1 times",
                                 "1 materials with illum 3, 5 or 8",
                                 "1 materials with illum 10",
                                 "1 materials with Tf",
                                 "1 materials with map_Ks or map_Ns"};
    for (size_t i = 0; i < sizeof named / sizeof *named; i++)
        if (!has_note(scene, named[i]))
            fail_msg("nothing is said of '%s'", named[i]);
    assert_false(has_note(scene, "illumination model"));
    gw_scene_destroy(&scene);
    /* No line names a model: the other keys decide. */
    scene = import_mtl("newmtl m0\nKs 1 1 1\nNs 98\n", 1);
    assert_true(near((double)material_named(scene, "m0")->roughness, pow(2.0 / 100.0, 0.25)));
    gw_scene_destroy(&scene);
}

static void check_poster(const gw_scene *scene) {
    assert_int_equal(scene->triangle_count, 4);
    for (uint32_t t = 0; t < 4; t++) { /* one of the two quads is mirrored: both must face +z */
        double p[3][3];
        for (int k = 0; k < 3; k++)
            position(scene, scene->triangles[t][k], p[k]);
        assert_true((p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[1][1] - p[0][1]) * (p[2][0] - p[0][0]) >
                    0.0);
    }
    assert_true(near(scene->bounds[0][0], -1.0) && near(scene->bounds[1][0], 3.0));
    for (uint32_t v = 0; v < scene->vertex_count; v++) {
        double p[3];
        position(scene, v, p);
        const double x = p[0] > 0.5 ? p[0] - 2.0 : -p[0], u = 2.0 * x, w = 2.0 * (1.0 - p[1]);
        assert_true(scene->normals[v * 3 + 2] == 1.0f);
        assert_true(near(scene->texcoords[v * 2], w + 0.5)); /* a quarter turn: u' = v, v' = -u */
        assert_true(near(scene->texcoords[v * 2 + 1], -u));
    }
    const gw_material *poster = material_named(scene, "poster");
    assert_true(poster->alpha_mode == GW_ALPHA_MASK && poster->alpha_cutoff == 0.25f && poster->two_sided);
    assert_true(poster->metalness == 0.25f && poster->roughness == 0.75f && poster->base_color[0] == 0.5f);
    assert_true(near(poster->emissive[1], 2.0)); /* 0.5 at strength 4 */
    const gw_texture *texture = &scene->textures[poster->base_color_texture];
    assert_int_equal(texture->wrap_u, GW_WRAP_CLAMP);
    assert_int_equal(texture->wrap_v, GW_WRAP_MIRROR);
    assert_int_equal(texture->image.rgba[0], 40);
    assert_int_equal(texture->image.rgba[2], 160);
}

static void gltf_is_carried(void **state) {
    (void)state;
    gw_scene *text = import("tests/data/poster.gltf"), *binary = import("tests/data/poster.glb");
    check_poster(text);
    check_poster(binary);
    assert_true(gw_hash_equal(text->hash, binary->hash));
    assert_int_equal(text->light_count, 3);
    assert_true(text->lights[0].kind == GW_LIGHT_DIRECTIONAL && near(text->lights[0].vector[1], -1.0));
    assert_true(near(text->lights[0].color[0], 3.0) && near(text->lights[0].color[2], 0.75));
    assert_true(text->lights[1].kind == GW_LIGHT_POINT && near(text->lights[1].vector[2], 3.0));
    assert_true(near(text->lights[1].color[1], 10.0));
    assert_int_equal(text->viewpoint_count, 1);
    assert_string_equal(text->viewpoints[0].name, "door");
    assert_true(near(text->viewpoints[0].eye[2], 5.0) && near(text->viewpoints[0].look_at[2], 4.0));
    assert_true(fabs(text->viewpoints[0].fov - 0.7 * 180.0 / 3.14159265358979) < 1e-3);
    assert_true(has_note(text, "EXT_from_nowhere: unknown"));
    assert_true(text->lights[2].kind == GW_LIGHT_SPOT && !has_note(text, "no light"));
    gw_scene_destroy(&text);
    gw_scene_destroy(&binary);
}

/* A triangle with one material, written beside the test's data: pictures are found there. */
static gw_scene *import_material(const char *material, const char *more) {
    static const char frame[] =
        "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":1,\"TEXCOORD_1\":1},"
        "\"material\":0}]}],\"materials\":[{%s}],"
        "\"textures\":[{\"source\":0,\"sampler\":0},{\"source\":1}],"
        "\"samplers\":[{\"magFilter\":9728,\"wrapS\":33648}],"
        "\"images\":[{\"uri\":\"checker.png\"},{\"uri\":\"mask.png\"}],%s"
        "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\","
        "\"min\":[0,0,0],\"max\":[1,1,0]},"
        "{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC2\"}],"
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],"
        "\"buffers\":[{\"byteLength\":36,\"uri\":\"data:application/octet-stream;base64,"
        "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\"}]}";
    char text[4096], path[512], from[600];
    snprintf(text, sizeof text, frame, material, more);
    const char *names[] = {"checker.png", "mask.png"};
    for (int i = 0; i < 2; i++) {
        gw_bytes bytes = {0};
        snprintf(from, sizeof from, "tests/data/%s", names[i]);
        check_ok(gw_file_read(from, 1 << 20, &bytes, &error));
        check_ok(gw_file_write(scratch_path(path, names[i]), bytes.data, bytes.size, &error));
        gw_bytes_finish(&bytes);
    }
    check_ok(gw_file_write(scratch_path(path, "material.gltf"), text, strlen(text), &error));
    gw_scene *scene = import(path);
    remove(path);
    return scene;
}

static void extensions_are_carried(void **state) {
    (void)state;
    gw_scene *scene = import_material(
        "\"extensions\":{\"KHR_materials_ior\":{\"ior\":1.25},\"KHR_materials_transmission\":"
        "{\"transmissionFactor\":0.5},\"KHR_materials_volume\":{\"thicknessFactor\":2,"
        "\"attenuationDistance\":3,"
        "\"attenuationColor\":[0.25,0.5,1]},\"KHR_materials_clearcoat\":{\"clearcoatFactor\":0.75,"
        "\"clearcoatRoughnessFactor\":0.125},\"KHR_materials_sheen\":{\"sheenColorFactor\":[1,0.5,0.25],"
        "\"sheenRoughnessFactor\":0.5},\"KHR_materials_specular\":{\"specularFactor\":0.5,"
        "\"specularColorFactor\":[2,1,0.5]},\"KHR_materials_unlit\":{}}",
        "\"extensionsUsed\":[\"KHR_materials_ior\",\"KHR_materials_sheen\",\"KHR_materials_anisotropy\"],");
    assert_non_null(scene->extensions);
    const gw_material_extension *e = &scene->extensions[scene->material_of[0]];
    assert_true(e->ior == 1.25f && e->transmission == 0.5f && e->thickness == 2 &&
                e->attenuation_distance == 3);
    assert_true(e->attenuation_color[0] == 0.25f && e->clearcoat == 0.75f &&
                e->clearcoat_roughness == 0.125f);
    assert_true(e->sheen_color[1] == 0.5f && e->sheen_roughness == 0.5f && e->specular == 0.5f);
    assert_true(e->specular_color[0] == 2 && e->unlit == 1 && e->normal.texture == -1);
    assert_true(has_note(scene, "KHR_materials_anisotropy: not carried"));
    assert_false(has_note(scene, "KHR_materials_sheen") || has_note(scene, "KHR_materials_ior"));
    assert_null(scene->second_texcoords);
    gw_scene_destroy(&scene);
}

static void maps_lie_where_the_file_puts_them(void **state) {
    (void)state;
    gw_scene *scene = import_material(
        "\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0,\"extensions\":{\"KHR_texture_"
        "transform\":"
        "{\"scale\":[2,4]}}},\"roughnessFactor\":0.5,\"metallicRoughnessTexture\":{\"index\":1}},"
        "\"normalTexture\":{\"index\":0,\"scale\":0.5,\"extensions\":{\"KHR_texture_transform\":"
        "{\"scale\":[2,4]}}},\"occlusionTexture\":{\"index\":1,\"texCoord\":1,\"strength\":0.25},"
        "\"emissiveFactor\":[1,0.5,0],\"emissiveTexture\":{\"index\":1,\"extensions\":{\"KHR_texture_"
        "transform\":"
        "{\"offset\":[0.5,0]}}}",
        "");
    const uint32_t m = scene->material_of[0];
    const gw_material_extension *e = &scene->extensions[m];
    const gw_texture *color = &scene->textures[scene->materials[m].base_color_texture];
    assert_int_equal(scene->texture_count, 2);
    assert_true(color->nearest == 1 && color->wrap_u == GW_WRAP_MIRROR && color->wrap_v == GW_WRAP_REPEAT);
    assert_true(e->normal.texture == scene->materials[m].base_color_texture && e->normal_scale == 0.5f);
    assert_true(e->normal.to_uv[0][0] == 1 && e->normal.to_uv[1][1] == 1); /* moved with the base colour */
    assert_true(e->occlusion.coordinate == 1 && e->occlusion_strength == 0.25f);
    assert_true(e->emissive_map.coordinate == 0 && e->emissive_map.to_uv[0][0] == 0.5f &&
                e->emissive_map.to_uv[1][1] == 0.25f && e->emissive_map.to_uv[0][2] == 0.5f);
    assert_non_null(scene->second_texcoords);
    assert_true(e->roughness == 0.5f && e->metalness == 1 && e->emissive[1] == 0.5f);
    /* mask.png is white in its left half and black in the other: what shows no map shows the mean */
    assert_true(near((double)scene->materials[m].roughness, 0.25) &&
                near((double)scene->materials[m].metalness, 0.5) &&
                near((double)scene->materials[m].emissive[1], 0.25));
    gw_scene_destroy(&scene);
}

/* Maps of layers go by texture, each with its own picture's channels; of the thickness only the mean. */
static void maps_of_extensions_are_carried(void **state) {
    (void)state;
    gw_scene *scene = import_material(
        "\"extensions\":{\"KHR_materials_clearcoat\":{\"clearcoatFactor\":1,\"clearcoatTexture\":{\"index\":"
        "1},"
        "\"clearcoatRoughnessTexture\":{\"index\":1},\"clearcoatNormalTexture\":{\"index\":0,\"scale\":0.5}},"
        "\"KHR_materials_sheen\":{\"sheenColorFactor\":[1,1,1],\"sheenColorTexture\":{\"index\":0},"
        "\"sheenRoughnessTexture\":{\"index\":1}},\"KHR_materials_specular\":{\"specularTexture\":{\"index\":"
        "1},"
        "\"specularColorTexture\":{\"index\":0,\"texCoord\":1}},\"KHR_materials_volume\":{"
        "\"thicknessFactor\":2,"
        "\"thicknessTexture\":{\"index\":1}},\"KHR_materials_transmission\":{\"transmissionFactor\":0.5,"
        "\"transmissionTexture\":{\"index\":1}}}",
        "");
    const gw_material_extension *e = &scene->extensions[scene->material_of[0]];
    assert_true(e->clearcoat == 1 && e->clearcoat_map.texture >= 0 && e->transmission == 0.5f);
    assert_true(e->clearcoat_roughness_map.texture == e->clearcoat_map.texture &&
                e->transmission_map.texture == e->clearcoat_map.texture);
    assert_true(e->clearcoat_normal.texture == e->sheen_color_map.texture &&
                e->clearcoat_normal_scale == 0.5f);
    assert_true(e->specular_color_map.coordinate == 1 && e->thickness == 1);
    /* mask.png is opaque: its alpha is a picture of its own, white all over. */
    assert_true(e->specular_map.texture == e->sheen_roughness_map.texture &&
                e->specular_map.texture != e->clearcoat_map.texture);
    assert_int_equal(scene->textures[e->clearcoat_map.texture].image.rgba[7 * 4], 0);
    assert_int_equal(scene->textures[e->specular_map.texture].image.rgba[7 * 4], 255);
    assert_true(has_note(scene, "thickness map: its mean") && !has_note(scene, "clearcoat"));
    gw_scene_destroy(&scene);
}

/* The conversion's own cases: no reflection of its own, a metal, and what lies between. */
static void specular_glossiness_becomes_metallic_roughness(void **state) {
    (void)state;
    static const char used[] = "\"extensionsUsed\":[\"KHR_materials_pbrSpecularGlossiness\"],";
    gw_scene *scene = import_material(
        "\"extensions\":{\"KHR_materials_pbrSpecularGlossiness\":{\"diffuseFactor\":[0.25,0.5,0.75,1],"
        "\"specularFactor\":[0.04,0.04,0.04],\"glossinessFactor\":0.75}}",
        used);
    const gw_material *matt = &scene->materials[scene->material_of[0]];
    assert_true(near((double)matt->base_color[2], 0.75) && near((double)matt->roughness, 0.25));
    assert_true(fabs((double)matt->metalness) < 1e-3);
    gw_scene_destroy(&scene);
    scene = import_material(
        "\"extensions\":{\"KHR_materials_pbrSpecularGlossiness\":{\"diffuseFactor\":[0,0,0,1],"
        "\"specularFactor\":[1,0.75,0.25]}}",
        used);
    const gw_material *gold = &scene->materials[scene->material_of[0]];
    assert_true(near((double)gold->metalness, 1.0) && near((double)gold->base_color[1], 0.75) &&
                gold->roughness == 0);
    gw_scene_destroy(&scene);
    /* checker.png is opaque: glossiness 1 everywhere, and colours above 4 % are metal */
    scene = import_material(
        "\"extensions\":{\"KHR_materials_pbrSpecularGlossiness\":{\"diffuseFactor\":[0,0,0,1],"
        "\"glossinessFactor\":0.5,\"specularGlossinessTexture\":{\"index\":0}}}",
        used);
    const uint32_t m = scene->material_of[0];
    assert_true(scene->materials[m].base_color_texture >= 0 &&
                scene->extensions[m].metallic_roughness.texture >= 0);
    const gw_image *finish = &scene->textures[scene->extensions[m].metallic_roughness.texture].image;
    assert_int_equal(finish->rgba[1], 128);
    assert_true(near((double)scene->materials[m].roughness, 128.0 / 255.0));
    gw_scene_destroy(&scene);
}

/* --- children that misbehave --- */

/* A stand-in for the import child: a shell script. */
static const char *script(char path[512], const char *name, const char *body) {
    scratch_path(path, name);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "#!/bin/sh\n%s\n", body);
    fclose(file);
    assert_int_equal(chmod(path, 0755), 0);
    return path;
}

static void check_child(const char *body, double seconds, uint64_t bytes, gw_code wanted, const char *part) {
    char path[512];
    gw_scene *scene = NULL;
    const gw_import_options options = {
        .program = script(path, "child.sh", body), .time_limit = seconds, .memory_limit = bytes};
    check_fails(gw_import("tests/data/tetra.ply", &options, &scene, &error), wanted, part);
    assert_null(scene);
    assert_int_equal(waitpid(-1, NULL, WNOHANG), -1); /* nobody is left behind */
    remove(path);
}

static void bad_children_are_named(void **state) {
    (void)state;
    struct timespec begin, end;
    clock_gettime(CLOCK_MONOTONIC, &begin);
    check_child("exec sleep 60", 0.5, 0, GW_BAD_INPUT, "did not finish within 0.5 s");
    clock_gettime(CLOCK_MONOTONIC, &end);
    assert_true(end.tv_sec - begin.tv_sec < 20);
    check_child("kill -SEGV $$", 0, 0, GW_BAD_INPUT, "crashed on it (signal 11");
    check_child("echo 'std::bad_alloc' >&2; kill -ABRT $$", 0, 64 << 20, GW_BAD_INPUT,
                "the 64 MiB of memory");
    check_child("kill -XCPU $$", 3, 0, GW_BAD_INPUT, "more than 3 s of processor time");
    check_child("exec cat /dev/zero", 0, 4 << 20, GW_BAD_INPUT, "larger than the limit of 4 MiB");
    check_child("exit 0", 0, 0, GW_BAD_INPUT, "is not a model (0 bytes)");
    check_child("echo hello there, this is not what you think", 0, 0, GW_BAD_INPUT, "is not a model");
    check_child("echo 'chatter' >&2; echo 'error: the reason' >&2; exit 2", 0, 0, GW_BAD_INPUT,
                "tetra.ply: the reason");
    check_child("exit 3", 0, 0, GW_MACHINE, "ended without a reason");
    check_child("i=0; while [ $i -lt 9000 ]; do echo chatter; i=$((i + 1)); done >&2; echo 'error: after "
                "much talk' >&2; "
                "exit 2",
                0, 0, GW_BAD_INPUT, "after much talk");
}

/* The child's environment forbids a second import, so that a program that is no importer cannot start itself
 * without end. */
static void an_import_inside_an_import_is_refused(void **state) {
    (void)state;
    const gw_import_options options = {.program = program()};
    gw_scene *scene = NULL;
    setenv("GAZEWALL_IMPORTING", "1", 1);
    check_fails(gw_import("tests/data/tetra.ply", &options, &scene, &error), GW_MACHINE, "started itself");
    unsetenv("GAZEWALL_IMPORTING");
}

static void a_program_that_is_not_there_is_named(void **state) {
    (void)state;
    gw_scene *scene = NULL;
    const gw_import_options options = {.program = "/nonexistent/gazewall"};
    check_fails(gw_import("tests/data/tetra.ply", &options, &scene, &error), GW_MACHINE,
                "/nonexistent/gazewall");
}

/* Limits hold in the real child too. */
static void memory_limit_holds(void **state) {
    (void)state;
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    skip(); /* no limit of address space under a sanitizer */
#endif
    char path[512];
    gw_scene *scene = NULL;
    FILE *file = fopen(scratch_path(path, "large.obj"), "w");
    assert_non_null(file);
    for (int i = 0; i < 600000; i++)
        fprintf(file, "v %d 0 0\n", i);
    for (int i = 1; i < 600000 - 2; i++)
        fprintf(file, "f %d %d %d\n", i, i + 1, i + 2);
    fclose(file);
    const gw_import_options options = {.program = program(), .memory_limit = (uint64_t)110 << 20};
    check_fails(gw_import(path, &options, &scene, &error), GW_BAD_INPUT, "110 MiB of memory");
    remove(path);
}

/* --- glTF JSON under mutation --- */

static void gltf_survives_mutations(void **state) {
    (void)state;
    static const char *const paths[] = {"tests/data/poster.gltf", "tests/data/poster.glb",
                                        "configs/scenes/moving.gltf"};
    uint64_t random = 20240608;
    print_message("seed %llu\n", (unsigned long long)random);
    for (size_t p = 0; p < sizeof paths / sizeof *paths; p++) {
        gw_bytes bytes = {0};
        check_ok(gw_file_read(paths[p], 1 << 20, &bytes, &error));
        const double reach = bytes.size < 6000 ? (double)bytes.size : 6000.0; /* what follows are numbers */
        for (int run = 0; run < (p < 2 ? 6000 : 2000); run++) {
            uint8_t *copy = malloc(bytes.size);
            assert_non_null(copy);
            memcpy(copy, bytes.data, bytes.size);
            const size_t length = gw_test_random(&random) < 0.1
                                      ? (size_t)(gw_test_random(&random) * (double)bytes.size)
                                      : bytes.size;
            for (int i = 0; i < 3; i++) { /* digits for digits reach further than random bytes */
                const size_t at = (size_t)(gw_test_random(&random) * reach);
                const int digit = copy[at] >= '0' && copy[at] <= '9';
                copy[at] = (uint8_t)(digit ? '0' + (int)(gw_test_random(&random) * 10.0)
                                     : gw_test_random(&random) < 0.3 ? gw_test_random(&random) * 256.0
                                                                     : copy[at]);
            }
            fuzz_gltf(copy, length);
            free(copy);
        }
        gw_bytes_finish(&bytes);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_formats_give_the_same_tetrahedron),
        cmocka_unit_test(vertex_colours_become_linear),
        cmocka_unit_test(mtl_keys_are_carried),
        cmocka_unit_test(mtl_maps_and_models_are_carried),
        cmocka_unit_test(gltf_is_carried),
        cmocka_unit_test(extensions_are_carried),
        cmocka_unit_test(maps_lie_where_the_file_puts_them),
        cmocka_unit_test(maps_of_extensions_are_carried),
        cmocka_unit_test(specular_glossiness_becomes_metallic_roughness),
        cmocka_unit_test(bad_children_are_named),
        cmocka_unit_test(a_program_that_is_not_there_is_named),
        cmocka_unit_test(an_import_inside_an_import_is_refused),
        cmocka_unit_test(memory_limit_holds),
        cmocka_unit_test(gltf_survives_mutations),
    };
    return cmocka_run_group_tests_name("import", tests, NULL, NULL);
}
