#include "pipeline/memory_limits.h"

#include <sys/resource.h>
#include <unistd.h>

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

namespace fs = std::filesystem;

std::optional<std::size_t> number_in(const fs::path& file) {
    std::ifstream stream(file);
    std::size_t value = 0;
    if (stream >> value) return value;
    return std::nullopt;  // "max", or no such file
}

/// Limits hold for all groups below: the least of what a group and those above it leave.
std::optional<std::size_t> least_left(const fs::path& mount, const fs::path& group, const char* limit_file,
                                      const char* usage_file) {
    std::optional<std::size_t> least;
    for (fs::path at = group.relative_path();; at = at.parent_path()) {
        const auto limit = number_in(mount / at / limit_file), used = number_in(mount / at / usage_file);
        // Version 1 says "no limit" as a number near 2^63.
        if (limit && used && *limit < (std::size_t{1} << 60)) {
            const std::size_t left = *used < *limit ? *limit - *used : 0;
            least = std::min(left, least.value_or(left));
        }
        if (at.empty()) return least;
    }
}

/// The limit of ulimit -v, if there is one.
std::optional<std::size_t> address_space_limit() {
    rlimit limit{};
    if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return std::nullopt;
    return static_cast<std::size_t>(limit.rlim_cur);
}

}  // namespace

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

std::optional<std::size_t> left_by_control_groups(const std::string& groups, const fs::path& root) {
    std::optional<std::size_t> least;
    std::istringstream lines(groups);
    for (std::string line; std::getline(lines, line);) {
        const auto first = line.find(':'), second = line.find(':', first + 1);
        if (first == std::string::npos || second == std::string::npos) continue;
        const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
        const fs::path group = line.substr(second + 1);
        std::optional<std::size_t> left;
        if (controllers == ",,") {
            left = least_left(root, group, "memory.max", "memory.current");
        } else if (controllers.find(",memory,") != std::string::npos) {
            left = least_left(root / "memory", group, "memory.limit_in_bytes", "memory.usage_in_bytes");
        }
        if (left) least = std::min(*left, least.value_or(*left));
    }
    return least;
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
    std::ostringstream groups;
    groups << std::ifstream("/proc/self/cgroup").rdbuf();
    if (const auto left = left_by_control_groups(groups.str(), "/sys/fs/cgroup"))
        available = std::min(available, *left);
    if (const auto limit = address_space_limit()) {
        const std::size_t taken =
            number_in("/proc/self/statm").value_or(0) * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
        available = std::min(available, taken < *limit ? *limit - taken : 0);
    }
    return available;
}

std::string address_space_problem() {
    // Measured: with two threads everything runs from 600 MB on; below, thread after thread cannot be created, and
    // libraries that draw text end the process instead of reporting it.
    constexpr std::size_t least = std::size_t{700} << 20;
    const auto limit = address_space_limit();
    if (!limit || *limit >= least) return {};
    return "the shell limits the address space to " + size_text(*limit) +
           " (ulimit -v), and libraries and threads take " + size_text(least) +
           "; raise the limit, e.g. with ulimit -v unlimited, and bound memory by --memory";
}

}  // namespace morphodesic::pipeline
