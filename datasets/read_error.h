#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace morphodesic::datasets {

/// An input file cannot be used. The message names the file, what is wrong and what to do about it.
class ReadError : public std::runtime_error {
public:
    /// @param problem  what is wrong, without a full stop: "the image has only one colour"
    /// @param remedy   what the user can do, without a full stop: "draw the shape in another colour than its
    /// background"
    ReadError(const std::filesystem::path& file, const std::string& problem, const std::string& remedy)
        : std::runtime_error(file.string() + ": " + problem + "; " + remedy),
          file_(file),
          problem_(problem),
          remedy_(remedy) {}

    [[nodiscard]] const std::filesystem::path& file() const { return file_; }
    [[nodiscard]] const std::string& problem() const { return problem_; }
    [[nodiscard]] const std::string& remedy() const { return remedy_; }

private:
    std::filesystem::path file_;
    std::string problem_, remedy_;
};

/// What helps against a file that breaks off or contradicts itself.
inline constexpr const char* get_it_again = "export or download the file again";

/// @throws ReadError always
[[noreturn]] inline void refuse(const std::filesystem::path& file, const std::string& problem,
                                const std::string& remedy = get_it_again) {
    throw ReadError(file, problem, remedy);
}

/// An output file cannot be written: the environment is at fault, not the input.
class WriteError : public std::runtime_error {
public:
    explicit WriteError(const std::filesystem::path& file)
        : std::runtime_error(file.string() + ": cannot be written; check the folder's permissions and the free space") {
    }
};

}  // namespace morphodesic::datasets
