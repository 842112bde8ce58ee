/* An octree as one block: everything comes back, damage is noticed. */
#include "tests/support/check.h"

#include "build/pack_octree.h"

enum { NODES = 4, REFERENCES = 6 };

typedef struct fixture {
    gw_octree octree;
    gw_node nodes[NODES];
    gw_payload payloads[NODES];
    uint32_t references[REFERENCES], emissions[NODES];
    uint8_t *block;
    size_t size;
} fixture;

static void pack(fixture *f) {
    f->size = gw_pack_octree_size(&f->octree);
    assert_true(f->size % 64 == 0);
    f->block = aligned_alloc(64, f->size);
    assert_non_null(f->block);
    memset(f->block, 0xa5, f->size);
    gw_pack_octree(&f->octree, f->block);
}

static fixture *make_fixture(void) {
    fixture *f = calloc(1, sizeof *f);
    assert_non_null(f);
    gw_octree *o = &f->octree;
    o->depth = 2;
    o->node_count = NODES;
    o->reference_count = REFERENCES;
    o->level_begin[1] = 1;
    for (int l = 2; l < GW_OCTREE_MAXIMUM_DEPTH + 2; l++)
        o->level_begin[l] = NODES;
    o->nodes = f->nodes;
    o->payloads = f->payloads;
    o->references = f->references;
    o->emissions = f->emissions;
    o->hash = (gw_hash){3, 4};
    o->statistics.pairs = 11;
    o->statistics.deepest = 1;
    for (uint32_t i = 0; i < NODES; i++) {
        f->nodes[i] = (gw_node){i, i * 2};
        f->payloads[i] = (gw_payload){i, i + 1, i + 2};
        f->emissions[i] = i * 5;
    }
    for (uint32_t i = 0; i < REFERENCES; i++)
        f->references[i] = i * 7;
    pack(f);
    return f;
}

static void destroy(fixture *f) {
    free(f->block);
    free(f);
}

static void everything_comes_back(void **state) {
    (void)state;
    fixture *f = make_fixture();
    gw_octree o;
    check_ok(gw_unpack_octree(f->block, f->size, &o, &error));
    assert_int_equal(o.depth, 2);
    assert_memory_equal(o.level_begin, f->octree.level_begin, sizeof o.level_begin);
    assert_memory_equal(o.nodes, f->nodes, sizeof f->nodes);
    assert_memory_equal(o.payloads, f->payloads, sizeof f->payloads);
    assert_memory_equal(o.references, f->references, sizeof f->references);
    assert_memory_equal(o.emissions, f->emissions, sizeof f->emissions);
    assert_memory_equal(&o.hash, &f->octree.hash, sizeof o.hash);
    assert_int_equal(o.statistics.pairs, 11);
    assert_true(o.borrowed);
    free(f->block);
    f->octree.emissions = NULL;
    pack(f);
    check_ok(gw_unpack_octree(f->block, f->size, &o, &error));
    assert_null(o.emissions);
    destroy(f);
}

static void damage_is_noticed(void **state) {
    (void)state;
    fixture *f = make_fixture();
    gw_octree o;
    check_fails(gw_unpack_octree(f->block, f->size - 64, &o, &error), GW_BAD_INPUT, "size");
    check_fails(gw_unpack_octree(f->block, 16, &o, &error), GW_BAD_INPUT, "cut");
    f->octree.depth = 16;
    gw_pack_octree(&f->octree, f->block);
    check_fails(gw_unpack_octree(f->block, f->size, &o, &error), GW_BAD_INPUT, "contradict");
    f->octree.depth = 2;
    f->octree.level_begin[3] = NODES + 1;
    gw_pack_octree(&f->octree, f->block);
    check_fails(gw_unpack_octree(f->block, f->size, &o, &error), GW_BAD_INPUT, "contradict");
    destroy(f);
}

/* Every byte of the head flipped: either an error, or a block that still lies inside itself. Under the
 * address sanitizer this proves that nothing outside is read. */
static void a_flipped_head_is_harmless(void **state) {
    (void)state;
    fixture *f = make_fixture();
    int refused = 0;
    uint64_t touched = 0;
    for (size_t i = 0; i < 320 && i < f->size; i++) {
        gw_octree o;
        gw_error error = {0};
        f->block[i] ^= 0x40;
        if (gw_unpack_octree(f->block, f->size, &o, &error) == GW_OK)
            touched += o.nodes[o.node_count - 1].link + o.payloads[o.node_count - 1].surface +
                       o.references[o.reference_count - 1];
        else
            refused++;
        f->block[i] ^= 0x40;
    }
    assert_true(refused > 100 && touched > 0);
    destroy(f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(everything_comes_back),
        cmocka_unit_test(damage_is_noticed),
        cmocka_unit_test(a_flipped_head_is_harmless),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
