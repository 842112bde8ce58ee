/* Tiles that were started again take their places at the gate. */
#include "wall/gate_internal.h"

#include "base/clock.h"

static const char *refuse(void *context, uint32_t tile, uint32_t start) {
    const gw_gate *gate = context;
    if (tile >= gate->count)
        return "the wall has no such tile";
    const gw_gate_member *m = &gate->members[tile];
    if (m->told || m->left)
        return "the run is over";
    if (m->wire)
        return "its tile is still here";
    return start <= m->start ? "it was started before the one that was here last" : NULL;
}

static int is_here(void *context, uint32_t tile) {
    const gw_gate *gate = context;
    return gate->members[tile].here;
}

static const char *name_of(void *context, uint32_t tile) {
    const gw_gate *gate = context;
    return gate->layout->tiles[tile].name;
}

gw_code gw_gate_open_door(gw_gate *gate, const gw_door_options *options, const gw_site *site,
                          gw_error *error) {
    gate->keeper = (gw_door_keeper){.context = gate,
                                    .refuse = refuse,
                                    .is_here = is_here,
                                    .name = name_of,
                                    .site = site,
                                    .site_epoch = gate->site_epoch};
    return gw_door_open(options, &gate->door, error);
}

const gw_door *gw_gate_door(const gw_gate *gate) {
    return gate->door;
}

/* It is released into the next frame, and waited for once it has kept up for a while. */
static void take_wire(gw_gate *gate, const gw_newcomer *newcomer) {
    gw_gate_member *m = &gate->members[newcomer->tile];
    /* Its place was free when it knocked; meanwhile nobody else can have taken it but a later start. */
    if (m->wire || m->told || newcomer->start <= m->start) {
        newcomer->wire->close(newcomer->wire);
        return;
    }
    m->wire = newcomer->wire;
    m->start = newcomer->start;
    m->process = m->here ? gw_process_find(newcomer->process) : (gw_process){0};
    m->bell = 0; /* its line wakes */
    m->site = newcomer->site;
    m->outstanding = m->due = m->pixels_due = m->pong_due = 0;
    m->silence = 0;
    m->kept_up = 0;
    m->heard = m->looked = gw_now_ns();
    m->tile.state = GW_TILE_LATE;
    m->tile.returned++;
    gw_gate_name_fault(m, "was lost, and was started again");
    gw_gate_tell(gate, m, "takes part again from");
}

void gw_gate_attend_door(gw_gate *gate) {
    gw_newcomer newcomer;
    gate->keeper.number = gate->next;
    gw_door_attend(gate->door, &gate->keeper);
    while (gw_door_take(gate->door, &newcomer))
        take_wire(gate, &newcomer);
}
