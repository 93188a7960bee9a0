#include "datasets/interruption.h"

#include <atomic>

namespace morphodesic::datasets {
namespace {

std::atomic<bool (*)()> interruption{nullptr};

}  // namespace

void set_interruption(bool (*is_wanted)()) {
    interruption = is_wanted;
}

void interruption_point() {
    const auto is_wanted = interruption.load(std::memory_order_relaxed);
    if (is_wanted != nullptr && is_wanted()) throw Interrupted{};
}

}  // namespace morphodesic::datasets
