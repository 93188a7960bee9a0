#pragma once

#include <hwy/targets.h>

#include <cstdint>
#include <set>
#include <string>

#include "geodesic/kernels/step_kernel.h"

namespace morphodesic::tests {

/// check(name) with the kernels of one instruction set after the other: of all that were compiled and that this machine
/// has.
template <class Check>
void for_each_instruction_set(const Check& check) {
    const auto choose = [](std::int64_t targets) {
        hwy::SetSupportedTargetsForTest(targets);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    };
    std::set<std::string> seen;
    for (std::int64_t left = hwy::SupportedTargets(); left != 0; left &= left - 1) {
        choose(left & -left);
        const std::string name = kernels::instruction_set();
        if (seen.insert(name).second) check(name);
    }
    choose(0);  // all of them again
}

}  // namespace morphodesic::tests
