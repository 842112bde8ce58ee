/* Turns a track of SuperTuxKart into glTF: convert_supertuxkart DATA TRACK FOLDER
 * DATA: the game's data folder (tracks/, library/, textures/); FOLDER gets TRACK.gltf, TRACK.bin and
 * textures/. */
#include "base/file.h"
#include "tests/tools/stk_gltf.h"

#include <inttypes.h>
#include <stdio.h>

int main(int argc, char **argv) {
    gw_error error = {0};
    stk_scene scene = {0};
    stk_gltf_counts counts = {0};
    if (argc != 4) {
        fprintf(stderr, "usage: convert_supertuxkart DATA TRACK FOLDER\n");
        return GW_BAD_INPUT;
    }
    gw_code code = stk_scene_read(argv[1], argv[2], &scene, &error);
    if (code == GW_OK)
        code = gw_make_directories(argv[3], &error);
    if (code == GW_OK)
        code = stk_gltf_write(&scene, argv[3], argv[2], &counts, &error);
    if (code == GW_OK)
        printf("%s: %" PRIu64 " triangles in %zu instances of %zu meshes; %" PRIu64
               " invisible ones left out; %" PRIu32 " materials, %" PRIu32 " pictures, %" PRIu32
               " missing; %zu lamps\n",
               argv[2], counts.triangles, scene.instance_count, scene.model_count, counts.hidden,
               counts.materials, counts.textures, counts.missing, scene.light_count);
    else
        fprintf(stderr, "convert_supertuxkart: %s\n", error.text);
    stk_scene_finish(&scene);
    return (int)code;
}
