#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

namespace morphodesic::pipeline {

/// "4G", "512M", "1.5GiB", "800000K", plain bytes; K, M, G, T are powers of 1024.
/// @throws std::invalid_argument with an example if the text is no size
[[nodiscard]] std::size_t size_from_text(const std::string& text);
/// 3221225472 -> "3.0 GB" (powers of 1024)
[[nodiscard]] std::string size_text(std::size_t bytes);

/// Memory that this process may still take: what the system calls available, or less if its control group (or one
/// above it, as a batch system sets them) or the shell's limit of the address space (ulimit -v) leaves less.
[[nodiscard]] std::size_t available_memory();

/// What the control groups of a process leave it; no value: no limit.
/// @param groups  text of /proc/self/cgroup: "0::/path" (version 2), "n:memory:/path" (version 1)
/// @param root    where they are mounted: /sys/fs/cgroup
[[nodiscard]] std::optional<std::size_t> left_by_control_groups(const std::string& groups,
                                                                const std::filesystem::path& root);

/// Message if the shell limits the address space so far that libraries and threads do not fit and would end the
/// program one way or another; empty otherwise.
[[nodiscard]] std::string address_space_problem();

}  // namespace morphodesic::pipeline
