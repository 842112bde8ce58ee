/* The program's entry. Everything it does is a verb: wall/verbs.h. */
#include "wall/verbs.h"

int main(int argc, char **argv) {
    return gw_verbs_run(argc, argv);
}
