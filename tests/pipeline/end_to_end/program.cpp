#include "program.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>
#include <stdexcept>

#include "pipeline/cli.h"

namespace morphodesic::tests {

namespace fs = std::filesystem;

namespace {

/// A process that does something and never returns from it, with its output in files of a folder.
template <class Work>
pid_t start_process(const fs::path& folder, const Work& work) {
    const std::string out = (folder / "out").string(), err = (folder / "err").string();
    const pid_t process = fork();
    if (process == 0) {
        const int o = ::open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
        const int e = ::open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
        ::dup2(o, STDOUT_FILENO);
        ::dup2(e, STDERR_FILENO);
        work();
        ::_exit(127);
    }
    return process;
}

pid_t start(const std::string& program, const std::vector<std::string>& arguments, const fs::path& folder) {
    std::vector<char*> argv{const_cast<char*>(program.c_str())};
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    return start_process(folder, [&] { ::execv(program.c_str(), argv.data()); });
}

/// The program in a copy of this process: starting it anew means to load its 170 libraries, which takes longer than
/// what most tests do with it.
pid_t start_copy(const std::vector<std::string>& arguments, const fs::path& folder) {
    std::cout.flush();
    std::fflush(nullptr);  // or the copy would print what this process has not printed yet
    return start_process(folder, [&] {
        try {
            const int code = pipeline::run_program(arguments);
            std::cout.flush();
            std::fflush(nullptr);
            ::_exit(code);
        } catch (...) {
            ::_exit(128 + SIGABRT);  // as where nobody catches it
        }
    });
}

std::ptrdiff_t thread_count() {
    const fs::directory_iterator threads("/proc/self/task");
    return std::distance(begin(threads), end(threads));
}

/// Those that libraries start when they are loaded, for their logs; the program does without.
const std::ptrdiff_t threads_of_libraries = thread_count();

/// Threads are not copied with a process, and what waits for one would wait forever.
bool can_be_copied() {
    return !sanitized && thread_count() == threads_of_libraries;
}

Outcome outcome(pid_t process, const fs::path& folder) {
    if (process < 0) throw std::runtime_error("no process can be started");
    int status = 0;
    ::waitpid(process, &status, 0);
    const int code = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
    return {code, read_file(folder / "out"), read_file(folder / "err")};
}

}  // namespace

Outcome morphodesic(const std::vector<std::string>& arguments) {
    if (!can_be_copied()) return morphodesic_file(arguments);
    const TemporaryFolder folder;
    return outcome(start_copy(arguments, folder.path()), folder.path());
}

Outcome morphodesic_file(const std::vector<std::string>& arguments) {
    const TemporaryFolder folder;
    return outcome(start(MORPHODESIC_PROGRAM, arguments, folder.path()), folder.path());
}

Outcome shell(const std::string& command) {
    const TemporaryFolder folder;
    return outcome(start("/bin/bash", {"-c", "MORPHODESIC=" MORPHODESIC_PROGRAM "; " + command}, folder.path()),
                   folder.path());
}

BackgroundRun::BackgroundRun(const std::vector<std::string>& arguments)
    : process_(start(MORPHODESIC_PROGRAM, arguments, folder_.path())) {}
BackgroundRun::~BackgroundRun() {
    if (waited_) return;
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
}
void BackgroundRun::signal(int number) const {
    ::kill(process_, number);
}
Outcome BackgroundRun::wait() {
    waited_ = true;
    return outcome(process_, folder_.path());
}

std::string read_file(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}
void write_file(const fs::path& file, const std::string& bytes) {
    fs::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << bytes;
}

fs::path schema(const std::string& name) {
    return fs::path(MORPHODESIC_SOURCE_DIR) / "reports" / name;
}

void make_disks(const fs::path& folder, int n, int pixels) {
    const Outcome made = morphodesic({"datasets", "disks", "--out", folder.string(), "--count", std::to_string(n),
                                      "--size", std::to_string(pixels), "--quiet"});
    ASSERT_EQ(made.code, 0) << made.err;
}

std::vector<std::string> quick(std::vector<std::string> arguments) {
    const bool chosen = std::any_of(arguments.begin(), arguments.end(),
                                    [](const std::string& word) { return word.rfind("--paths", 0) == 0; });
    if (arguments.front() == "run" && !chosen) arguments.insert(arguments.end(), {"--paths", "none"});
    for (const char* option : {"--level", "4", "--steps", "2", "--starts", "1"}) arguments.emplace_back(option);
    return arguments;
}

long stored_rows(const fs::path& study) {
    sqlite3* connection = nullptr;
    long rows = 0;
    if (sqlite3_open_v2((study / "study.sqlite").c_str(), &connection, SQLITE_OPEN_READONLY, nullptr) == SQLITE_OK) {
        sqlite3_stmt* statement = nullptr;
        if (sqlite3_prepare_v2(connection, "SELECT count(*) FROM geodesics", -1, &statement, nullptr) == SQLITE_OK &&
            sqlite3_step(statement) == SQLITE_ROW) {
            rows = static_cast<long>(sqlite3_column_int64(statement, 0));
        }
        sqlite3_finalize(statement);
    }
    sqlite3_close(connection);
    return rows;
}

}  // namespace morphodesic::tests
