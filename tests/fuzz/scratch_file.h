#pragma once

#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

namespace morphodesic::tests {

/// A file of this process for the bytes of one input: the readers take files. In memory where the machine has /dev/shm.
inline std::filesystem::path scratch_file(const std::uint8_t* data, std::size_t size, const std::string& ending) {
    static const struct Folder {
        Folder() {
            const bool in_memory = ::access("/dev/shm", W_OK) == 0;
            std::string name = std::string(in_memory ? "/dev/shm" : "/tmp") + "/morphodesic-fuzz-XXXXXX";
            if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no folder for scratch files");
            path = name;
        }
        ~Folder() {
            std::error_code ignored;
            std::filesystem::remove_all(path, ignored);
        }
        std::filesystem::path path;
    } folder;
    const std::filesystem::path file = folder.path / ("input" + ending);
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    return file;
}

}  // namespace morphodesic::tests
