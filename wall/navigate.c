#include "wall/navigate.h"

#include "render/vector3.h"

#include <string.h>

/* Surfaces met at a slant are seen before the eye comes near them: the least cosine that is reckoned with. */
static const double least_cosine = 0.25;
/* Along how many surfaces a step may slide: two in a corner, three where three meet. */
enum { SLIDES = 4 };

static void forward_of(const gw_navigation *n, double out[3]) {
    out[0] = sin(n->yaw) * cos(n->pitch);
    out[1] = sin(n->pitch);
    out[2] = -cos(n->yaw) * cos(n->pitch);
}

gw_navigation gw_navigation_of(const gw_similarity *placement, const double neutral_eye[3], double speed) {
    gw_navigation n = {.scale = placement->scale, .speed = speed};
    gw_wall_to_scene(placement, neutral_eye, n.position);
    /* The wall's -z in the scene. */
    const double *back = placement->rotation[2];
    n.pitch = fmin(fmax(asin(fmin(fmax(-back[1], -1), 1)), -GW_STEEPEST), GW_STEEPEST);
    n.yaw = atan2(-back[0], back[2]);
    return n;
}

int gw_navigation_is_asked(const gw_navigation_input *input) {
    int asked = 0;
    for (int k = 0; k < 3; k++)
        asked |= input->move[k] != 0;
    for (int k = 0; k < 2; k++)
        asked |= input->turning[k] != 0 || input->turn[k] != 0;
    return asked;
}

/* Moves from `at` by at most `step`, stopping short of what is in the way; *step becomes what is left of it,
 * bent along that surface. Returns 0 when nothing was in the way. */
static int advance(double at[3], double step[3], double clearance, const gw_surfaces *surfaces) {
    double direction[3] = {step[0], step[1], step[2]}, normal[3], distance;
    const double length = sqrt(gw_dot(step, step));
    if (!gw_normalise(direction, 0))
        return 0;
    if (!surfaces || !surfaces->meet(surfaces->context, at, direction, length + clearance / least_cosine,
                                     &distance, normal)) {
        for (int k = 0; k < 3; k++)
            at[k] += step[k];
        return 0;
    }
    double cosine = gw_dot(normal, direction);
    if (cosine > 0)
        for (int k = 0; k < 3; k++)
            normal[k] = -normal[k];
    cosine = fabs(cosine);
    const double short_of = distance - clearance / fmax(cosine, least_cosine);
    const double moved = fmin(fmax(short_of, 0), length);
    const double inward = fmin(gw_dot(step, normal) * (1 - moved / length), 0);
    for (int k = 0; k < 3; k++) {
        at[k] += moved * direction[k];
        step[k] = (1 - moved / length) * step[k] - inward * normal[k];
    }
    return 1;
}

static void move(gw_navigation *n, const double step[3], const gw_surfaces *surfaces) {
    double left[3] = {step[0], step[1], step[2]};
    const double clearance = GW_CLEARANCE / n->scale;
    for (int i = 0; i < SLIDES && advance(n->position, left, clearance, surfaces); i++) {
    }
}

gw_navigation gw_navigate(const gw_navigation *before, const gw_navigation_input *input, double dt,
                          const gw_surfaces *surfaces) {
    gw_navigation n = *before;
    dt = fmax(dt, 0);
    n.speed = fmin(fmax(n.speed * pow(1.25, input->notches), GW_SLOWEST), GW_FASTEST);
    n.yaw = remainder(n.yaw + input->turn[0] + dt * input->turning[0], 2 * M_PI);
    n.pitch = fmin(fmax(n.pitch + input->turn[1] + dt * input->turning[1], -GW_STEEPEST), GW_STEEPEST);
    double forward[3], step[3];
    const double right[3] = {cos(n.yaw), 0, sin(n.yaw)};
    forward_of(&n, forward);
    /* Metres of the room are 1000 / scale metres of the scene. */
    const double way = n.speed * (input->haste > 0 ? input->haste : 1) * dt * 1000 / n.scale;
    for (int k = 0; k < 3; k++)
        step[k] = way * (input->move[0] * right[k] + input->move[1] * (k == 1) + input->move[2] * forward[k]);
    move(&n, step, surfaces);
    return n;
}

void gw_navigation_apply(const gw_navigation *navigation, gw_frame_state *state) {
    double forward[3];
    forward_of(navigation, forward);
    /* Far enough that the rounding of a float does not turn the view. */
    double far = 16;
    for (int k = 0; k < 3; k++)
        far = fmax(far, fabs(navigation->position[k]));
    for (int k = 0; k < 3; k++) {
        state->stand[k] = (float)navigation->position[k];
        state->look_at[k] = (float)(navigation->position[k] + far * forward[k]);
    }
    state->scene_scale = (float)navigation->scale;
}
