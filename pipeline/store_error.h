#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace morphodesic::pipeline {

/// The study folder or its store cannot be used: full disk, no permission, damaged, locked, another version. The
/// message names the file, what is wrong and what to do. The program ends with exit code 3.
class StoreError : public std::runtime_error {
public:
    StoreError(const std::filesystem::path& file, const std::string& what_and_remedy)
        : std::runtime_error(file.string() + ": " + what_and_remedy) {}
};

}  // namespace morphodesic::pipeline
