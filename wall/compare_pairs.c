/* See compare.h: PNG pairs, where the viewer looked, and the display as FovVideoVDP describes one. */
#include "wall/compare.h"

#include "base/file.h"
#include "render/vector3.h"
#include "wall/picture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double millimetres_per_inch = 25.4;

gw_code gw_pair_folder_open(gw_pair_folder *pairs, const char *folder, const gw_plane *plane, uint32_t width,
                            uint32_t height, gw_error *error) {
    *pairs = (gw_pair_folder){.folder = folder,
                              .width = width,
                              .height = height,
                              .pitch = sqrt(gw_dot(plane->step_x, plane->step_x)),
                              .least = INFINITY};
    pairs->fixations = open_memstream(&pairs->text, &pairs->size);
    if (!pairs->fixations)
        return gw_fail(error, GW_MACHINE, "memory is out while comparing frames");
    fputs("frame,time_s,x,y,distance_mm\n", pairs->fixations);
    return GW_OK;
}

/* From the eye to the plane of the pixels, mm. */
static double distance_of(const gw_plane *plane, const double eye[3]) {
    double normal[3], along[3];
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        normal[k] = plane->step_x[i] * plane->step_y[j] - plane->step_x[j] * plane->step_y[i];
        along[k] = plane->corner[k] - eye[k];
    }
    return fabs(gw_dot(normal, along)) / sqrt(gw_dot(normal, normal));
}

static gw_code write_picture(const gw_pair_folder *pairs, const char *name, const gw_image *picture,
                             gw_error *error) {
    char *path = gw_picture_path(pairs->folder, "%s-%05u.png", name, pairs->frames);
    gw_code code = path ? gw_image_write_png(path, picture, NULL, error)
                        : gw_fail(error, GW_MACHINE, "memory is out while naming a picture");
    free(path);
    return code;
}

gw_code gw_pair_folder_add(gw_pair_folder *pairs, const gw_image *reference, const gw_image *test,
                           const gw_plane *plane, const gw_frame_state *state, const double *gaze,
                           gw_error *error) {
    const double distance = distance_of(plane, state->eye);
    fprintf(pairs->fixations, "%u,%.6f,", pairs->frames, (double)state->time * 1e-9);
    if (gaze)
        fprintf(pairs->fixations, "%.2f,%.2f,%.1f\n", gaze[0], gaze[1], distance);
    else
        fprintf(pairs->fixations, ",,%.1f\n", distance);
    pairs->distances += distance;
    pairs->least = fmin(pairs->least, distance);
    gw_code code = write_picture(pairs, "reference", reference, error);
    if (!code)
        code = write_picture(pairs, "test", test, error);
    pairs->frames++;
    return code;
}

static gw_code write_text(const char *folder, const char *name, const char *text, size_t size,
                          gw_error *error) {
    char *path = gw_picture_path(folder, "%s", name);
    gw_code code = path ? gw_file_write(path, text, size, error)
                        : gw_fail(error, GW_MACHINE, "memory is out while naming a file");
    free(path);
    return code;
}

/* The keys of FovVideoVDP's fvvdp_data/display_models.json. */
static gw_code write_display(const gw_pair_folder *pairs, double luminance, gw_error *error) {
    const double diagonal = hypot(pairs->width, pairs->height) * pairs->pitch / millimetres_per_inch;
    json_t *models =
        json_pack("{s:{s:s, s:[i,i], s:f, s:f, s:f, s:i, s:i, s:s}}", "gazewall", "name",
                  "wall of this run, seen from the mean distance of its viewer", "resolution",
                  (int)pairs->width, (int)pairs->height, "viewing_distance_meters",
                  pairs->distances / fmax(pairs->frames, 1) * 1e-3, "diagonal_size_inches", diagonal,
                  "max_luminance", luminance, "contrast", 1000, "E_ambient", 0, "source", "none");
    char *text = models ? json_dumps(models, JSON_INDENT(2) | JSON_REAL_PRECISION(9)) : NULL;
    json_decref(models);
    gw_code code = text ? write_text(pairs->folder, "display_models.json", text, strlen(text), error)
                        : gw_fail(error, GW_MACHINE, "memory is out while describing the display");
    free(text);
    return code;
}

gw_code gw_pair_folder_close(gw_pair_folder *pairs, double luminance, gw_error *error) {
    fflush(pairs->fixations);
    gw_code code = write_text(pairs->folder, "fixations.csv", pairs->text, pairs->size, error);
    return code ? code : write_display(pairs, luminance, error);
}

void gw_pair_folder_finish(gw_pair_folder *pairs) {
    if (pairs->fixations)
        fclose(pairs->fixations);
    free(pairs->text);
    memset(pairs, 0, sizeof *pairs);
}
