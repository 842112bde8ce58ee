/* The doctor: tests what a wall needs, hop by hop, and says for each what it found or what is wrong and what
 * mends it. Starts a program on every host, draws nothing but a window for a moment where a tile has one.
 * Main thread. */
#ifndef GW_WALL_DOCTOR_H
#define GW_WALL_DOCTOR_H

#include "base/status.h"
#include "wall/examine.h"
#include "wall/hosts.h"
#include "wall/site.h"

#include <stdint.h>

typedef enum gw_finding {
    GW_FINDING_GOOD,
    GW_FINDING_MIND, /* it works; worth knowing */
    GW_FINDING_WRONG
} gw_finding;

typedef struct gw_doctor {
    const gw_site *site;
    const gw_hosts *hosts;
    const char *agent; /* as mpirun takes it; NULL: ssh */
    int quiet;         /* prints only what is wrong or worth knowing */
    gw_code code;      /* of the first wrong finding; GW_OK: none */
    uint32_t counts[3];
} gw_doctor;

/* Prints one finding; code is that of a wrong one. */
void gw_doctor_find(gw_doctor *doctor, gw_finding finding, gw_code code, const char *where,
                    const char *format, ...) __attribute__((format(printf, 5, 6)));
/* This machine's MPI, then every host, the ways between them, the tracker. */
void gw_doctor_examine(gw_doctor *doctor);

/* --- The parts in files of their own. */

/* wall/doctor_ways.c: MPI's ways, from every host to every other on ports of their own choice. hosts[i] is
 * the site's host i as far as it can be asked: NULL where it cannot, or where something else is wrong
 * already. */
void gw_doctor_ways(gw_doctor *doctor, gw_examiner *const *hosts);
/* wall/doctor_tracker.c */
void gw_doctor_tracker(gw_doctor *doctor);

#endif
