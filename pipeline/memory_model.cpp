#include "pipeline/memory_model.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace morphodesic::pipeline {
namespace {

double nodes(int dimension, int level) {
    return std::pow(std::ldexp(1.0, level) + 1.0, dimension);
}

std::size_t number_in(const char* file) {
    std::ifstream stream(file);
    std::size_t value = 0;
    return stream >> value ? value : std::numeric_limits<std::size_t>::max();  // "max" and no file: no limit
}

}  // namespace

std::size_t bytes_of_pair(int dimension, int level, int time_steps) {
    const double n = nodes(dimension, level), fields = dimension * time_steps + time_steps - 1;
    const double coarser = dimension == 2 ? 4.0 / 3.0 : 8.0 / 7.0;
    constexpr double history = 4;
    // The path and the next one; the path, two gradients and the direction in single precision; the history.
    const double path = fields * (2 * sizeof(double) + (4 + 2 * history) * sizeof(float));
    // Multigrid: diagonal, mass and block inverse (symmetric matrices), edges.
    const double matrix = dimension * (dimension + 1) / 2.0;
    const double cycles = time_steps * (1 + 2 * matrix + dimension) * coarser + (time_steps - 1);
    // Trajectories: derivative of the map, place in the coarse grid, gradient of the level sets, their unit.
    const double trajectories = time_steps * (dimension * dimension + 2 * dimension + 1) + (time_steps - 1);
    // While they are assembled: origins, gradients, weights and masses of the shapes. While they are applied: three
    // vectors per V-cycle, which in 3D are freed before.
    const double assembly = time_steps * (2.0 * dimension + 3), vectors = time_steps * 3 * dimension * coarser;
    const double for_a_time = dimension == 3 ? std::max(assembly, vectors) : assembly + vectors;
    const double preconditioner = sizeof(float) * (cycles + trajectories + for_a_time);
    const double ends = 4 * sizeof(double);
    return static_cast<std::size_t>(1.1 * n * (path + preconditioner + ends));
}

std::size_t bytes_of_shape(int dimension, int level) {
    return static_cast<std::size_t>(nodes(dimension, level)) * sizeof(double);
}

std::size_t available_memory() {
    std::size_t available = std::numeric_limits<std::size_t>::max();
    std::ifstream meminfo("/proc/meminfo");
    for (std::string line; std::getline(meminfo, line);) {
        if (line.rfind("MemAvailable:", 0) != 0) continue;
        std::istringstream words(line.substr(13));
        std::size_t kilobytes = 0;
        if (words >> kilobytes) available = kilobytes * 1024;
    }
    const auto within = [&](const char* limit_file, const char* usage_file) {
        const std::size_t limit = number_in(limit_file);
        if (limit == std::numeric_limits<std::size_t>::max()) return;
        const std::size_t used = number_in(usage_file);
        available = std::min(available, used < limit ? limit - used : 0);
    };
    within("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory.current");
    within("/sys/fs/cgroup/memory/memory.limit_in_bytes", "/sys/fs/cgroup/memory/memory.usage_in_bytes");
    return available;
}

std::size_t size_from_text(const std::string& text) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    std::string unit(end, text.data() + text.size());
    for (const char* ending : {"iB", "B", "b"}) {
        const std::string tail = ending;
        if (unit.size() >= tail.size() && unit.ends_with(tail)) {
            unit.resize(unit.size() - tail.size());
            break;
        }
    }
    const std::string units = "KMGT";
    const std::size_t power = unit.empty() ? 0 : units.find(static_cast<char>(std::toupper(unit.front()))) + 1;
    const double bytes = value * std::pow(1024.0, static_cast<double>(power));
    if (error != std::errc() || unit.size() > 1 || (!unit.empty() && power == 0) || !(bytes >= 1) || bytes > 1e18) {
        throw std::invalid_argument("--memory is \"" + text + "\"; give a size such as 4G or 800M");
    }
    return static_cast<std::size_t>(bytes);
}

std::string size_text(std::size_t bytes) {
    const char* units[] = {"bytes", "kB", "MB", "GB", "TB"};
    auto value = static_cast<double>(bytes);
    std::size_t unit = 0;
    while (value >= 1000 && unit + 1 < std::size(units)) value /= 1024, ++unit;
    char text[40];
    std::snprintf(text, sizeof text, unit == 0 || value >= 100 ? "%.0f %s" : "%.2g %s", value, units[unit]);
    return text;
}

MemoryPlan plan_memory(const std::string& memory_option, int dimension, int level, int shape_level, int time_steps,
                       std::size_t shapes, int threads) {
    MemoryPlan plan;
    plan.limit = memory_option.empty() ? available_memory() / 10 * 8 : size_from_text(memory_option);
    plan.per_pair = bytes_of_pair(dimension, level, time_steps);
    const std::size_t shape = bytes_of_shape(dimension, shape_level);
    plan.all_shapes = shapes * shape;
    // A pair in flight holds its two shapes, whatever is kept besides.
    const std::size_t one = plan.per_pair + 2 * shape;
    if (bytes_of_program + one > plan.limit) {
        std::string advice = memory_option.empty() ? "use a machine with more memory" : "give more --memory";
        for (int lower = level - 1; lower >= 3; --lower) {
            const std::size_t less = bytes_of_program + bytes_of_pair(dimension, lower, time_steps) + 2 * shape;
            if (less > plan.limit) continue;
            advice += ", or choose --level " + std::to_string(lower);
            break;
        }
        throw std::invalid_argument("one pair on level " + std::to_string(level) + " with " +
                                    std::to_string(time_steps) + " steps needs about " +
                                    size_text(bytes_of_program + one) + ", and " + size_text(plan.limit) +
                                    " may be used; " + advice);
    }
    const std::size_t free = plan.limit - bytes_of_program;
    plan.pairs_in_flight =
        static_cast<int>(std::min<std::size_t>(static_cast<std::size_t>(std::max(threads, 1)), free / one));
    plan.shapes = std::min(plan.all_shapes, free - static_cast<std::size_t>(plan.pairs_in_flight) * one);
    plan.predicted = bytes_of_program + plan.shapes + static_cast<std::size_t>(plan.pairs_in_flight) * one;
    return plan;
}

std::string MemoryPlan::sentence() const {
    std::string text = "memory: about " + size_text(predicted) + " (" + std::to_string(pairs_in_flight) +
                       (pairs_in_flight == 1 ? " pair" : " pairs") + " at once, " + size_text(per_pair) +
                       " each; shapes " + size_text(shapes);
    if (shapes < all_shapes) text += " of " + size_text(all_shapes) + ", the others are read when needed";
    return text + "), limit " + size_text(limit);
}

}  // namespace morphodesic::pipeline
