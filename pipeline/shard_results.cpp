#include "pipeline/shard_results.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>
#include <type_traits>

#include "pipeline/digest.h"
#include "pipeline/run_settings.h"

namespace morphodesic::pipeline {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int results_version = 1;
/// Longer than any line that a shard writes (a few kB): what does not end within it is damage, and is not loaded.
constexpr std::size_t longest_line = std::size_t{16} << 20;

constexpr const char* of_other_version =
    "was written by another version of morphodesic, whose numbers are not to be mixed with those of this one; compute "
    "the shard again with the same program as the study";
constexpr const char* damaged_header =
    "its first line is damaged, so nothing says what its rows belong to; move the file away and run the shard again";

/// The bytes behind the last line end of a file: those of a line that was not finished.
std::size_t unfinished_bytes(std::ifstream& in, std::size_t size) {
    std::string tail(std::min(size, longest_line), '\0');
    in.seekg(static_cast<std::streamoff>(size - tail.size()));
    in.read(tail.data(), static_cast<std::streamsize>(tail.size()));
    const std::size_t end = tail.rfind('\n');
    return end == std::string::npos ? tail.size() : tail.size() - end - 1;
}

std::string header(const std::string& settings_hash) {
    json head{{"format", "morphodesic shard"},
              {"version", results_version},
              {"settings", settings_hash},
              {"solver_revision", solver_revision}};
    head["checksum"] = digest(head.dump());
    return head.dump();
}

/// Whether a file holds no more than a line that begins as the header does.
bool is_beginning_of(const std::string& header, std::ifstream& in, std::size_t size) {
    if (size > header.size()) return false;
    std::string bytes(size, '\0');
    in.seekg(0);
    in.read(bytes.data(), static_cast<std::streamsize>(size));
    return in && header.starts_with(bytes);
}

/// A field of a line of anybody's, who may have written whatever he liked there.
template <class Value>
Value field(const json& line, const char* name, Value otherwise) {
    const auto found = line.find(name);
    const bool fits =
        found != line.end() && (std::is_same_v<Value, int> ? found->is_number_integer() : found->is_string());
    return fits ? found->template get<Value>() : otherwise;
}

bool is_header(const json& line) {
    return line.is_object() && field<std::string>(line, "format", "") == "morphodesic shard";
}

bool is_of_other_version(const json& head) {
    return field(head, "version", 0) != results_version || field(head, "solver_revision", 0) != solver_revision;
}

/// Whether a header is what was written; older programs wrote it without a checksum.
bool is_sound(json head) {
    if (!head.contains("checksum")) return true;
    const json checksum = head["checksum"];
    head.erase("checksum");
    return checksum == digest(head.dump(-1, ' ', false, json::error_handler_t::replace));
}

}  // namespace

ShardResults read_shard_results(const fs::path& file) {
    ShardResults results;
    if (fs::is_directory(file)) {
        results.problem = file.string() + ": is a folder, not the result file of a shard";
        return results;
    }
    std::ifstream in(file, std::ios::binary);
    if (!in) {
        results.problem = file.string() + ": cannot be read; check that it is there, and its permissions";
        return results;
    }
    if (in.peek() == std::ifstream::traits_type::eof()) {
        results.problem = file.string() + ": is empty; the shard has not begun, or its start was lost: run it again";
        return results;
    }
    std::string buffer(longest_line, '\0');
    bool first = true, any_header = false;
    std::string problem_of_first;
    while (in.getline(buffer.data(), static_cast<std::streamsize>(buffer.size()))) {
        const bool is_ended = !in.eof();
        const std::string line(buffer.data(), static_cast<std::size_t>(in.gcount()) - (is_ended ? 1 : 0));
        if (line.find_first_not_of(" \t\r") == line.npos && !first) continue;
        const bool text = line.find('\0') == line.npos;  // the JSON reader would stop at the zero and be content
        if (auto row = first || !text ? std::nullopt : geodesic_from_line(line)) {
            // It says itself, under its checksum, to which settings it belongs.
            if (results.ends_in_other_version) {
                ++results.of_other_version;
            } else {
                results.rows[row->settings_hash].push_back(std::move(*row));
            }
            results.lacks_line_end = !is_ended;
            continue;
        }
        if (!is_ended && !first) break;  // was being written when the shard was stopped
        const json head = text ? json::parse(line, nullptr, false) : json();
        if (first && !is_header(head)) {
            results.problem = file.string() + ": is not the result file of a shard";
            return results;
        }
        // What is damaged may have been a header; the rows behind it speak for themselves.
        results.ends_in_other_version = is_header(head) && is_of_other_version(head);
        if (is_header(head) && !results.ends_in_other_version && is_sound(head)) {
            const auto settings = field<std::string>(head, "settings", "");
            results.rows.try_emplace(settings);
            if (first) results.settings_hash = settings;
            any_header = true;
        } else if (results.ends_in_other_version) {
            if (first) problem_of_first = of_other_version;
        } else {
            ++results.damaged;
            if (first) problem_of_first = damaged_header;
        }
        first = false;
    }
    if (!in.eof()) ++results.damaged;  // a line without an end; what may come behind it is not looked for
    if (!any_header) {
        results = {};
        results.problem =
            file.string() + ": " + (problem_of_first.empty() ? "is not the result file of a shard" : problem_of_first);
    }
    return results;
}

ShardWriter::ShardWriter(fs::path file, const std::string& settings_hash) : file_(std::move(file)) {
    // Without O_NONBLOCK, a pipe or a device might wait for somebody at its other end.
    descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC | O_NONBLOCK | O_NOCTTY, 0666);
    if (descriptor_ < 0) {
        const std::string reason = errno == EISDIR ? "is a folder; name a file in it with --out"
                                                   : std::string("cannot be written: ") + std::strerror(errno) +
                                                         "; check its folder, or choose another file with --out";
        throw StoreError(file_, reason);
    }
    try {
        take_up(settings_hash);
    } catch (...) {
        ::close(descriptor_);
        throw;
    }
}

void ShardWriter::take_up(const std::string& settings_hash) {
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode)) {
        throw StoreError(file_, "is no file that can be continued after a stop; choose another one with --out");
    }
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
        throw StoreError(file_, "another process computes this shard; wait until it is done");
    }
    // Whose file it is comes first: nothing is cut off or written where it may be another's.
    const std::string head = header(settings_hash);
    std::ifstream in(file_, std::ios::binary | std::ios::ate);
    if (!in) throw StoreError(file_, "cannot be read; check its permissions, or choose another file with --out");
    const auto size = static_cast<std::size_t>(std::max<std::streamoff>(in.tellg(), 0));
    if (is_beginning_of(head, in, size)) {  // empty, or stopped while the header was written
        cut_to(0);
        write(head);
        return;
    }
    ShardResults results = read_shard_results(file_);
    if (!results.problem.empty()) {
        throw StoreError(
            file_, "cannot be continued (" + results.problem + "); it stays as it is: choose another file with --out");
    }
    if (results.settings_hash != settings_hash) {
        throw StoreError(file_, "holds results of other settings; choose another file with --out");
    }
    const std::size_t unfinished = unfinished_bytes(in, size);
    if (unfinished == longest_line) {
        throw StoreError(file_,
                         "cannot be continued: its last line has no end, the file is damaged; move it away, or "
                         "choose another file with --out");
    }
    if (unfinished == size) {  // nothing but the header of an older program, which had no checksum
        throw StoreError(file_, "cannot be continued: its first line has no end; move it away");
    }
    if (results.lacks_line_end) {
        write("");
    } else if (unfinished > 0) {
        cut_to(size - unfinished);
    }
    if (results.ends_in_other_version) write(head);  // what comes now is not of that header
    before_ = std::move(results.rows[settings_hash]);
}

void ShardWriter::cut_to(std::size_t size) {
    if (::ftruncate(descriptor_, static_cast<off_t>(size)) == 0) return;
    throw StoreError(file_, std::string("cannot be written: ") + std::strerror(errno) +
                                "; check its permissions, or choose another with --out");
}

ShardWriter::~ShardWriter() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

void ShardWriter::write(const std::string& line) {
    const std::string bytes = line + "\n";
    const std::scoped_lock lock(mutex_);
    for (std::size_t done = 0; done < bytes.size();) {
        const ssize_t written = ::write(descriptor_, bytes.data() + done, bytes.size() - done);
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) {
            throw StoreError(file_, std::string("cannot be written: ") + std::strerror(errno) +
                                        "; what is in it stays: free some space, then give the same command again");
        }
        done += static_cast<std::size_t>(written);
    }
}

void ShardWriter::append(const StoredGeodesic& geodesic) {
    write(line_of(geodesic));
    if (::fdatasync(descriptor_) != 0 && errno != EINVAL) {
        throw StoreError(file_, std::string("cannot be written: ") + std::strerror(errno));
    }
}

}  // namespace morphodesic::pipeline
