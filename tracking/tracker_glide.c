/* From where an eye was to where it is: what lies between them shrinks at an even speed. */
#include "tracking/tracker_internal.h"

#include <math.h>
#include <string.h>

static const double FASTEST = 3000; /* mm/s, of a head that is predicted */

double gw_head_horizon(const gw_tracker_tuning *tuning, const gw_head_motion *m, int64_t presentation) {
    if (!tuning->predicts)
        return 0;
    const double ahead = 1e-9 * (double)(presentation - m->time) + m->delay;
    return fmin(fmax(ahead, 0), tuning->prediction_limit) * m->known;
}

void gw_head_predict(const gw_tracker_tuning *tuning, const gw_head_motion *m, int64_t presentation,
                     gw_head_pose *out) {
    const double *v = m->velocity;
    const double speed = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    const double seconds = gw_head_horizon(tuning, m, presentation);
    const double ahead = seconds * (speed > FASTEST ? FASTEST / speed : 1);
    double way[3];
    for (int i = 0; i < 3; i++) {
        out->eye[i] = m->at[i] + ahead * v[i];
        way[i] = seconds * m->spin[i];
    }
    gw_turn_on(m->turn, way, out->turn);
}

/* Both glides begin where the eye was, seen from where it is, and end there. `glide` and `swing` are those of
 * the changes before, and become those of this one. */
static void take_over(const gw_tracker_tuning *tuning, const gw_head_change *c, int64_t lead, gw_glide *glide,
                      gw_glide *swing) {
    gw_head_pose was = c->from, is;
    double left[3], turn_left[3];
    if (!c->stood) {
        gw_head_predict(tuning, &c->before, c->since + lead, &was);
        gw_glide_at(glide, c->since, tuning->glide_speed, left);
        gw_glide_at(swing, c->since, GW_SWING_SPEED, turn_left);
        for (int i = 0; i < 3; i++) {
            was.eye[i] += left[i] + c->rest[i];
            turn_left[i] += c->turn_rest[i];
        }
        gw_turn_on(was.turn, turn_left, was.turn);
    }
    gw_head_predict(tuning, &c->after, c->since + lead, &is);
    for (int i = 0; i < 3; i++)
        glide->from[i] = was.eye[i] - is.eye[i];
    gw_turn_between(is.turn, was.turn, swing->from);
    glide->since = swing->since = c->since;
}

gw_head_change *gw_head_change_add(const gw_tracker_tuning *tuning, gw_head_channel *head, int64_t since) {
    gw_head_change *changes = head->changes;
    if (head->change_count == GW_HEAD_CHANGES) {
        gw_glide glide = {.since = 0}, swing = {.since = 0};
        take_over(tuning, &changes[0], 0, &glide, &swing);
        gw_glide_at(&glide, changes[1].since, tuning->glide_speed, changes[1].rest);
        gw_glide_at(&swing, changes[1].since, GW_SWING_SPEED, changes[1].turn_rest);
        memmove(changes, changes + 1, (GW_HEAD_CHANGES - 1) * sizeof *changes);
        head->change_count--;
    }
    gw_head_change *added = &changes[head->change_count++];
    memset(added, 0, sizeof *added);
    added->since = since;
    return added;
}

int gw_head_glide(const gw_tracker_tuning *tuning, const gw_head_channel *head, int64_t now, int64_t lead,
                  double eye[3], double turn[3]) {
    gw_glide glide = {.since = 0}, swing = {.since = 0};
    for (uint32_t i = 0; i < head->change_count; i++)
        take_over(tuning, &head->changes[i], lead, &glide, &swing);
    gw_glide_at(&swing, now, GW_SWING_SPEED, turn);
    return gw_glide_at(&glide, now, tuning->glide_speed, eye);
}
