#include "wall/mpi_wait.h"

#include "base/clock.h"

#include <time.h>

enum { SHORTEST_NAP_NS = 20000, LONGEST_NAP_NS = 1000000 };

gw_code gw_mpi_check(int result, const char *what, gw_error *error) {
    if (result == MPI_SUCCESS)
        return GW_OK;
    char text[MPI_MAX_ERROR_STRING] = "";
    int length = 0;
    MPI_Error_string(result, text, &length);
    return gw_fail(error, GW_MACHINE, "%s: MPI says: %s", what, text);
}

void gw_mpi_nap(int64_t *nap) {
    *nap = *nap == 0 ? SHORTEST_NAP_NS : *nap * 2 > LONGEST_NAP_NS ? LONGEST_NAP_NS : *nap * 2;
    struct timespec time = {.tv_nsec = *nap};
    nanosleep(&time, NULL);
}

gw_code gw_mpi_wait(MPI_Request *request, int64_t deadline, const char *what, gw_error *error) {
    int64_t nap = 0;
    for (;;) {
        int done = 0;
        gw_code code = gw_mpi_check(MPI_Test(request, &done, MPI_STATUS_IGNORE), what, error);
        if (code || done)
            return code;
        if (deadline && gw_now_ns() > deadline)
            return gw_fail(error, GW_ENDED_EARLY,
                           "%s: nothing came in time; raise --load-deadline if the machines only need longer",
                           what);
        gw_mpi_nap(&nap);
    }
}
