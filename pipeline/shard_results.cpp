#include "pipeline/shard_results.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>

#include "pipeline/digest.h"
#include "pipeline/run_settings.h"

namespace morphodesic::pipeline {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int results_version = 1;
/// Longer than any line that a shard writes (a few kB): what does not end within it is damage, and is not loaded.
constexpr std::size_t longest_line = std::size_t{16} << 20;

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

/// Whether the first line is what was written; older programs wrote it without a checksum.
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
    std::string_view line;
    const auto next_line = [&]() -> bool {
        if (!in.getline(buffer.data(), static_cast<std::streamsize>(buffer.size()))) return false;
        line = {buffer.data(), static_cast<std::size_t>(in.gcount()) - (in.eof() ? 0 : 1)};
        return true;
    };
    next_line();
    const json head = json::parse(line, nullptr, false);
    if (!head.is_object() || head.value("format", "") != "morphodesic shard") {
        results.problem = file.string() + ": is not the result file of a shard";
        return results;
    }
    results.settings_hash = head.value("settings", "");
    results.solver = head.value("solver_revision", 0);
    if (head.value("version", 0) != results_version || results.solver != solver_revision) {
        results.problem = file.string() +
                          ": was written by another version of morphodesic, whose numbers are not to be mixed with "
                          "those of this one; compute the shard again with the same program as the study";
        return results;
    }
    if (!is_sound(head)) {
        results.problem =
            file.string() +
            ": its first line is damaged, so nothing says what its rows belong to; move the file away and "
            "run the shard again";
        return results;
    }
    while (next_line()) {
        if (in.eof()) return results;  // without its line end: was being written when the shard was stopped
        const bool text = line.find('\0') == line.npos;  // the JSON reader would stop at the zero and be content
        if (auto row = geodesic_from_line(std::string(line));
            text && row && row->settings_hash == results.settings_hash) {
            results.rows.push_back(std::move(*row));
        } else {
            ++results.damaged;
        }
    }
    if (!in.eof()) ++results.damaged;  // a line without an end; what may come behind it is not looked for
    return results;
}

ShardWriter::ShardWriter(fs::path file, const std::string& settings_hash) : file_(std::move(file)) {
    descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (descriptor_ < 0) {
        throw StoreError(file_, std::string("cannot be written: ") + std::strerror(errno) +
                                    "; check its folder, or choose another file with --out");
    }
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
        ::close(descriptor_);
        throw StoreError(file_, "another process computes this shard; wait until it is done");
    }
    std::ifstream in(file_, std::ios::binary | std::ios::ate);
    const auto size = static_cast<std::size_t>(std::max<std::streamoff>(in.tellg(), 0));
    const std::size_t unfinished = unfinished_bytes(in, size);
    if (unfinished == longest_line) {
        ::close(descriptor_);
        throw StoreError(file_,
                         "cannot be continued: its last line has no end, the file is damaged; move it away, or "
                         "choose another file with --out");
    }
    const std::size_t end = size - unfinished;
    if (unfinished > 0 && ::ftruncate(descriptor_, static_cast<off_t>(end)) != 0) {
        const std::string reason = std::strerror(errno);
        ::close(descriptor_);
        throw StoreError(file_,
                         "cannot be written: " + reason + "; check its permissions, or choose another with --out");
    }
    if (end == 0) {
        write(header(settings_hash));
        return;
    }
    ShardResults results = read_shard_results(file_);
    if (!results.problem.empty() || results.settings_hash != settings_hash) {
        ::close(descriptor_);
        throw StoreError(file_, results.problem.empty()
                                    ? "holds results of other settings; choose another file with --out"
                                    : "cannot be continued (" + results.problem +
                                          "); move it away or choose another file with --out");
    }
    before_ = std::move(results.rows);
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
