#include "build/pack_animation.h"

#include "base/memory.h"
#include "build/block.h"

#include <string.h>

/* Arrays of the block, in this order. */
typedef enum section {
    CLIPS,
    NODES,
    CHANNELS,
    TIMES,
    VALUES,
    JOINTS,
    BINDINGS,
    BINDING_OF,
    BIND_POSITIONS,
    BIND_NORMALS,
    SECTION_COUNT
} section;

typedef struct header {
    gw_block_head head;
    uint32_t clip_count, node_count, channel_count, time_count, value_count, joint_count, binding_count,
        vertex_count;
    gw_block_span sections[SECTION_COUNT];
} header;

static const gw_block_head kind = {
    .magic = {'G', 'W', 'M', 'O', 'T', 'I', 'O', 'N'}, .version = 1, .section_count = SECTION_COUNT};
static const char what[] = "the shared animation";

static void section_sizes(const header *head, uint64_t sizes[SECTION_COUNT]) {
    const uint64_t vertices = head->vertex_count;
    sizes[CLIPS] = head->clip_count * sizeof(gw_motion_clip);
    sizes[NODES] = head->node_count * sizeof(gw_motion_node);
    sizes[CHANNELS] = head->channel_count * sizeof(gw_motion_channel);
    sizes[TIMES] = head->time_count * sizeof(float);
    sizes[VALUES] = head->value_count * sizeof(float);
    sizes[JOINTS] = head->joint_count * sizeof(gw_motion_joint);
    sizes[BINDINGS] = head->binding_count * sizeof(gw_binding);
    sizes[BINDING_OF] = vertices * sizeof(uint32_t);
    sizes[BIND_POSITIONS] = vertices * 3 * sizeof(double);
    sizes[BIND_NORMALS] = vertices * 3 * sizeof(float);
}

static void make_header(const gw_animation *animation, header *head) {
    uint64_t sizes[SECTION_COUNT];
    *head = (header){.head = kind,
                     .clip_count = animation->clip_count,
                     .node_count = animation->node_count,
                     .channel_count = animation->channel_count,
                     .time_count = animation->time_count,
                     .value_count = animation->value_count,
                     .joint_count = animation->joint_count,
                     .binding_count = animation->binding_count,
                     .vertex_count = animation->vertex_count};
    section_sizes(head, sizes);
    head->head.size = gw_block_place(sizeof *head, sizes, head->sections, SECTION_COUNT);
}

size_t gw_pack_animation_size(const gw_animation *animation) {
    header head;
    make_header(animation, &head);
    return (size_t)head.head.size;
}

void gw_pack_animation(const gw_animation *animation, void *block) {
    header head;
    make_header(animation, &head);
    const void *arrays[SECTION_COUNT] = {[CLIPS] = animation->clips,
                                         [NODES] = animation->nodes,
                                         [CHANNELS] = animation->channels,
                                         [TIMES] = animation->times,
                                         [VALUES] = animation->values,
                                         [JOINTS] = animation->joints,
                                         [BINDINGS] = animation->bindings,
                                         [BINDING_OF] = animation->binding_of,
                                         [BIND_POSITIONS] = animation->bind_positions,
                                         [BIND_NORMALS] = animation->bind_normals};
    memset(block, 0, (size_t)head.head.size);
    memcpy(block, &head, sizeof head);
    for (int i = 0; i < SECTION_COUNT; i++)
        gw_block_put(block, &head.sections[i], arrays[i]);
}

static void view(uint8_t *block, const header *head, gw_animation *out) {
#define AT(part) ((void *)(block + head->sections[part].offset))
    *out = (gw_animation){.clip_count = head->clip_count,
                          .node_count = head->node_count,
                          .channel_count = head->channel_count,
                          .time_count = head->time_count,
                          .value_count = head->value_count,
                          .joint_count = head->joint_count,
                          .binding_count = head->binding_count,
                          .vertex_count = head->vertex_count,
                          .clips = AT(CLIPS),
                          .nodes = AT(NODES),
                          .channels = AT(CHANNELS),
                          .times = AT(TIMES),
                          .values = AT(VALUES),
                          .joints = AT(JOINTS),
                          .bindings = AT(BINDINGS),
                          .binding_of = AT(BINDING_OF),
                          .bind_positions = AT(BIND_POSITIONS),
                          .bind_normals = AT(BIND_NORMALS),
                          .borrowed = 1};
#undef AT
}

gw_code gw_unpack_animation(const void *block, size_t size, gw_animation **out, gw_error *error) {
    uint64_t sizes[SECTION_COUNT];
    header head;
    *out = NULL;
    gw_code code = gw_block_check_head(block, size, &kind, what, error);
    if (!code && size < sizeof head)
        code = gw_fail(error, GW_BAD_INPUT, "%s is damaged (it is cut); start again", what);
    if (code)
        return code;
    memcpy(&head, block, sizeof head);
    section_sizes(&head, sizes);
    code = gw_block_check_spans(head.sections, sizes, SECTION_COUNT, size, what, error);
    if (!code)
        code = gw_allocate((void **)out, 1, sizeof **out, "animation", error);
    if (code)
        return code;
    view((uint8_t *)(uintptr_t)block, &head, *out); /* nobody writes through a borrowed one */
    code = gw_animation_check(*out, error);
    if (code)
        gw_animation_destroy(out);
    return code;
}
