/* The forms that `gazewall bench layouts` measures: each gives the shipped hits, bit for bit, on hard rays,
 * also in pieces; and a broken form is noticed. */
#include "tests/support/check.h"

#include "shaders/bench/node_forms.h"
#include "tests/support/rays.h"
#include "tests/support/renders.h"
#include "wall/node_study.h"

enum { RAYS = 6000, SEED = 20261123 };

/* A scene, its study, and what entry 0 answered. */
typedef struct bed {
    gw_stage stage;
    gw_node_study study;
    gw_ray *rays;
    gw_hit *shipped, *hits;
} bed;

static void open_bed(bed *b, const char *depth, uint32_t loop_budget) {
    gw_renderer_options options = {.loop_budget = loop_budget};
    check_ok(gw_stage_open(&b->stage, gw_test_scene(SEED), NULL,
                           (const char *const[]){depth, "dense_leaf=0", NULL}, &error));
    check_ok(
        gw_node_study_open(b->stage.device, b->stage.scene, b->stage.octree, &options, &b->study, &error));
    b->rays = gw_test_rays(b->stage.scene, RAYS, SEED + 1);
    b->shipped = calloc(RAYS, sizeof *b->shipped);
    b->hits = calloc(RAYS, sizeof *b->hits);
    assert_true(b->shipped && b->hits);
}

static void close_bed(bed *b) {
    gw_node_study_close(&b->study);
    gw_stage_close(&b->stage);
    free(b->rays);
    free(b->shipped);
    free(b->hits);
}

static uint32_t entry_named(const bed *b, const char *name) {
    for (uint32_t i = 0; i < GW_STUDY_ENTRIES; ++i)
        if (!strcmp(b->study.entries[i].name, name))
            return i;
    fail_msg("no layout '%s'", name);
    return 0;
}

/* 1 for one entry of each kernel. */
static int has_its_own_kernel(const bed *b, uint32_t entry) {
    const gw_study_entry *e = &b->study.entries[entry];
    return entry == 0 || (e->variant.kernel && strcmp(e->name, "seed64-lists") && strcmp(e->name, "grid-64"));
}

static gw_counters trace(bed *b, uint32_t entry, int count) {
    gw_counters counters = {0};
    gw_trace_time time;
    gw_hit *hits = entry == 0 ? b->shipped : b->hits;
    check_ok(gw_node_study_trace(&b->study, entry, b->rays, RAYS, hits, count, &counters, &time, &error));
    assert_int_equal(counters.step_cap_hits, 0);
    return counters;
}

/* Returns how many hits of the entry differ. */
static uint64_t compare(const bed *b, uint32_t entry) {
    uint64_t different = 0;
    check_ok(gw_study_compare(&b->study.entries[entry], b->shipped, b->hits, RAYS, &different, &error));
    return different;
}

static void all_layouts_give_the_same_hits(void **state) {
    (void)state;
    bed b;
    open_bed(&b, "octree_depth=9", 0);
    gw_counters work[GW_STUDY_ENTRIES] = {{0}};
    for (uint32_t i = 0; i < GW_STUDY_ENTRIES; ++i) {
        assert_string_equal(b.study.entries[i].skipped.text, "");
        for (int count = 0; count < 1 + has_its_own_kernel(&b, i); ++count) {
            work[i] = trace(&b, i, count);
            if (i > 0)
                assert_int_equal(compare(&b, i), 0);
        }
    }
    const gw_counters *plain = &work[entry_named(&b, "branching")], *seed = &work[entry_named(&b, "seed64")];
    assert_true(plain->steps > RAYS && plain->triangle_tests > RAYS);
    assert_true(work[0].steps < plain->steps && work[0].node_loads < plain->node_loads);
    assert_int_equal(work[0].triangle_tests, plain->triangle_tests);
    /* Their node is read to know that it is empty. */
    assert_int_equal(seed->steps, plain->steps);
    assert_int_equal(seed->node_loads, seed->steps);
    assert_true(plain->node_loads < plain->steps);
    assert_true(work[entry_named(&b, "wide")].steps < work[entry_named(&b, "wide-plain")].steps);
    assert_true(work[entry_named(&b, "wide-plain")].steps < plain->steps);
    assert_true(work[entry_named(&b, "grid-32")].steps < plain->steps);
    assert_int_equal(work[entry_named(&b, "grid-32")].triangle_tests, plain->triangle_tests);
    assert_true(work[entry_named(&b, "three-phase")].steps > plain->steps);
    close_bed(&b);
}

/* The wide node's levels go in twos: with an even limit the root is an ordinary one. */
static void wide_nodes_with_an_even_depth_too(void **state) {
    (void)state;
    bed b;
    open_bed(&b, "octree_depth=8", 0);
    uint32_t wide = entry_named(&b, "wide");
    trace(&b, 0, 0);
    trace(&b, wide, 0);
    compare(&b, wide);
    close_bed(&b);
}

static void suspended_rays_go_on_in_every_layout(void **state) {
    (void)state;
    bed b;
    open_bed(&b, "octree_depth=8", 32);
    for (uint32_t i = 0; i < GW_STUDY_ENTRIES; ++i) {
        if (!has_its_own_kernel(&b, i))
            continue;
        gw_counters work = trace(&b, i, 0);
        assert_true(work.resumed > RAYS / 20);
        if (i > 0)
            compare(&b, i);
    }
    close_bed(&b);
}

static void too_shallow_an_octree_skips_the_grid(void **state) {
    (void)state;
    bed b;
    open_bed(&b, "octree_depth=5", 0);
    assert_non_null(strstr(b.study.entries[entry_named(&b, "grid-32")].skipped.text, "deeper than 5"));
    trace(&b, 0, 0);
    trace(&b, entry_named(&b, "wide"), 0);
    compare(&b, entry_named(&b, "wide"));
    close_bed(&b);
}

/* Puts `to` into the bits `mask` of every word of an array that has `value` there; at least one must. */
static void overwrite(gw_gl_buffer *buffer, uint32_t mask, uint32_t value, uint32_t bits, uint32_t to) {
    size_t count = buffer->size / sizeof(uint32_t), changed = 0;
    uint32_t *words = malloc(buffer->size);
    assert_non_null(words);
    check_ok(gw_gl_buffer_read(buffer, 0, buffer->size, words, &error));
    for (size_t i = 0; i < count; ++i)
        if ((words[i] & mask) == value) {
            words[i] = (words[i] & ~bits) | to;
            changed++;
        }
    check_ok(gw_gl_buffer_write(buffer, 0, buffer->size, words, &error));
    free(words);
    assert_true(changed > 0);
}

static void expect_noticed(bed *b, uint32_t entry) {
    uint64_t different = 0;
    char sentence[64];
    snprintf(sentence, sizeof sentence, "layout '%s' gives", b->study.entries[entry].name);
    trace(b, entry, 0);
    check_fails(gw_study_compare(&b->study.entries[entry], b->shipped, b->hits, RAYS, &different, &error),
                GW_MACHINE, sentence);
    assert_true(different > 0 && different < RAYS);
}

static void a_broken_form_is_noticed(void **state) {
    (void)state;
    bed b;
    open_bed(&b, "octree_depth=8", 0);
    trace(&b, 0, 0);
    uint32_t seed = entry_named(&b, "seed64"), lists = entry_named(&b, "seed64-lists"),
             compact = entry_named(&b, "short"), wide = entry_named(&b, "wide"),
             grid = entry_named(&b, "grid-32");
    /* Leaves whose link is a multiple of 64 become empty, or another triangle's. */
    overwrite(&b.study.entries[seed].buffers[0], GW_SEED_LEAF | 63, GW_SEED_LEAF, UINT32_MAX, GW_SEED_EMPTY);
    overwrite(&b.study.entries[lists].buffers[1], 63, 0, GW_REFERENCE_ID, 1);
    overwrite(&b.study.entries[compact].buffers[1], 63, 0, GW_LEAF_WORD_LINK, 1);
    overwrite(&b.study.entries[wide].buffers[1], 63, 0, GW_LEAF_WORD_LINK, 1);
    /* The grid's inner cells, three levels above the finest, become empty. */
    overwrite(&b.study.entries[grid].buffers[0], UINT32_MAX, 3 | GW_GRID_PRESENT, GW_GRID_PRESENT, 0);
    expect_noticed(&b, seed);
    expect_noticed(&b, lists);
    expect_noticed(&b, compact);
    expect_noticed(&b, wide);
    expect_noticed(&b, grid);
    close_bed(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_layouts_give_the_same_hits),
        cmocka_unit_test(wide_nodes_with_an_even_depth_too),
        cmocka_unit_test(suspended_rays_go_on_in_every_layout),
        cmocka_unit_test(too_shallow_an_octree_skips_the_grid),
        cmocka_unit_test(a_broken_form_is_noticed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
