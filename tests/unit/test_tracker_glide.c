/* The tracker: silence that is too short to lose a sensor, and rooms that are changed while frames are drawn,
 * make no eye jump either, however far ahead frames are seen. */
#include "tests/support/check.h"

#include "tests/support/track_scene.h"

/* A head that turns round while its sensor is silent for less than the hold time, again and again, before
 * what was left of the last time is made up for; then its room is changed. */
static void short_silence_and_new_rooms_are_made_up_for(void **state) {
    (void)state;
    for (size_t filter = 0; filter < 3; filter++)
        for (int64_t lead = 0; lead <= 50 * ms; lead += 50 * ms) {
            static scene s;
            s.count = 0;
            const double hole = 0.09, speed = 1, again = 0.19; /* s, m/s, s */
            for (int i = 0; i < 300; i++) {
                const double t = i / 60.0, phase = fmod(t, again);
                gw_tracking_event e = head_event(t, 0);
                if (t > 1 && phase < hole)
                    continue;
                const double to_and_fro = fmod(t, 2 * again) / again; /* turns in the middle of each hole */
                const double at = (to_and_fro < 1 ? to_and_fro : 2 - to_and_fro) - hole / 2 / again;
                const double place[3] = {speed * again * at, 0, 2};
                memcpy(e.of.pose.position, place, sizeof place);
                turn_at(0, e.of.pose.orientation);
                add(&s, e);
            }
            open_tracker(&s, every_filter[filter], 1);
            gw_viewer_view before = ask(&s, 0, lead);
            double snap = 0, worst = 0;
            int held = 0;
            const int moved = 246; /* just after a hole */
            for (int frame = 1; frame < 300; frame++) {
                double sample_before[3], sample[3];
                const int64_t now = frame * second / 60 + 5 * ms;
                newest_sample(&s, sample_before);
                if (frame == moved) {
                    gw_tracker_setup other;
                    gw_tracker_setup_default("Test@localhost", &other);
                    other.sources[0].room.shift[1] = 400;
                    gw_tracker_set_rooms(s.tracker, &other);
                }
                const gw_viewer_view view = ask(&s, now, lead);
                newest_sample(&s, sample);
                const double step = apart(view.eye, before.eye);
                /* Beyond what it follows, which is predicted, by a filter that may overshoot its turns. */
                const double raw = fmax(apart(sample, sample_before), 1.8 * 1000 * speed / 60);
                if (before.head_state == GW_SENSOR_HELD || (frame >= moved && frame < moved + 4))
                    worst = fmax(worst, step - raw);
                if (before.head_state == GW_SENSOR_HELD && view.head_state != GW_SENSOR_HELD) {
                    snap = fmax(snap, apart(sample, before.eye));
                    held++;
                }
                before = view;
            }
            if (!(worst <= 20))
                fail_msg("filter %zu, lead %lld ms: %g mm", filter, (long long)(lead / ms), worst);
            assert_true(snap > 50 && held > 10);        /* what an eye does that follows at once */
            assert_true(fabs(before.eye[1] - 400) < 1); /* and there it is */
            gw_tracker_destroy(&s.tracker);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(short_silence_and_new_rooms_are_made_up_for),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
