#include <malloc.h>

#include "pipeline/cli.h"

int main(int argc, char** argv) {
    // Every solve takes and gives back fields of many sizes. Kept by the process instead of going back to the system
    // each time, they cost a fifth less processor time (glibc's own limits would grow only to what it has seen freed).
    mallopt(M_MMAP_THRESHOLD, 32 << 20);
    mallopt(M_TRIM_THRESHOLD, 64 << 20);
    return morphodesic::pipeline::run_program({argv + 1, argv + argc});
}
