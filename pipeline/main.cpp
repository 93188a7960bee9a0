#include "pipeline/cli.h"

int main(int argc, char** argv) {
    return morphodesic::pipeline::run_program({argv + 1, argv + argc});
}
