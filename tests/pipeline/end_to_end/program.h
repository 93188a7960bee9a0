#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace morphodesic::tests {

/// Whether the program under test carries the address or the thread sanitizer.
#ifdef MORPHODESIC_SANITIZED
inline constexpr bool sanitized = true;
#else
inline constexpr bool sanitized = false;
#endif

/// How a run of the program ended. A signal n is code 128 + n, as in a shell.
struct Outcome {
    int code = -1;
    std::string out, err;
};

/// Runs the program and waits.
Outcome morphodesic(const std::vector<std::string>& arguments);
/// The same, always from its file: for what asks where that is.
Outcome morphodesic_file(const std::vector<std::string>& arguments);
/// Runs a shell command with the program's path in $MORPHODESIC and waits.
Outcome shell(const std::string& command);

/// The program in the background.
class BackgroundRun {
public:
    explicit BackgroundRun(const std::vector<std::string>& arguments);
    ~BackgroundRun();
    BackgroundRun(const BackgroundRun&) = delete;
    BackgroundRun& operator=(const BackgroundRun&) = delete;
    void signal(int number) const;
    [[nodiscard]] pid_t process() const { return process_; }
    Outcome wait();

private:
    TemporaryFolder folder_;
    pid_t process_ = -1;
    bool waited_ = false;
};

std::string read_file(const std::filesystem::path& file);
void write_file(const std::filesystem::path& file, const std::string& bytes);

/// The schema of an answer or a report, by the name of its file.
std::filesystem::path schema(const std::string& name);

/// A collection of n disks on pictures of so many pixels a side; small and quick at --level 4.
void make_disks(const std::filesystem::path& folder, int n, int pixels = 64);

/// Options that make a pair a matter of milliseconds; of `run` also one that draws no paths, unless some are chosen.
std::vector<std::string> quick(std::vector<std::string> arguments);

/// Geodesics in a store right now, 0 if there is none yet; may be asked while the program runs.
long stored_rows(const std::filesystem::path& study);

}  // namespace morphodesic::tests
