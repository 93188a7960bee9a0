#include "pipeline/study_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <set>
#include <stdexcept>
#include <system_error>

#include "datasets/folder_scan.h"

namespace morphodesic::pipeline {

namespace fs = std::filesystem;

namespace {

/// @param kept  whether a store keeps what was computed, however the writing of files ends
std::string remedy(int error, bool kept) {
    const std::string what = std::strerror(error);
    if (error == ENOSPC || error == EDQUOT || error == EFBIG) {
        return "cannot be written: " + what +
               (kept ? "; nothing that was computed is lost" : "; what this run computed is not kept") +
               ": free some space, then give the same command again";
    }
    if (error == EISDIR || error == ENOTDIR || error == EEXIST || error == ENOTEMPTY) {
        return "cannot be written: " + what +
               "; a folder stands where a file must be, or a file where a folder must be: move it away, then give the "
               "same command again";
    }
    if (error == ELOOP) {
        return "is a link, and what it leads to would be overwritten; remove it, then give the same command again";
    }
    return "cannot be written: " + what + "; check its permissions, or use another study folder";
}

/// What a file is called until it is complete.
std::string part_of(const fs::path& file) {
    return file.string() + ".part";
}

constexpr const char* owner_begin = "process ";  // what a lock file says first

/// A lock file of this program. It is empty if the process died before it wrote its name.
bool is_lock(const fs::path& file) {
    std::error_code error;
    if (!fs::is_regular_file(fs::symlink_status(file, error))) return false;
    std::string text(std::string_view(owner_begin).size(), ' ');
    std::ifstream in(file, std::ios::binary);
    in.read(text.data(), static_cast<std::streamsize>(text.size()));
    return in.gcount() == 0 || text == owner_begin;
}

}  // namespace

fs::path with_last_name(const fs::path& path) {
    fs::path named = path.lexically_normal();
    if (!named.has_filename()) named = named.parent_path();
    return named == "." || named.filename() == ".." ? fs::canonical(named) : named;
}

StudyFolder StudyFolder::of_collection(const fs::path& collection) {
    fs::path folder = with_last_name(fs::absolute(collection));
    folder += ".study";
    return StudyFolder(folder);
}

void StudyFolder::refuse_if_foreign() const {
    std::error_code error;
    if (!fs::is_directory(path_, error)) return;
    std::set<std::string> names;
    fs::directory_iterator it(path_, error);
    for (; !error && it != fs::directory_iterator(); it.increment(error)) {
        const std::string name = it->path().filename().string();
        // What systems put into every folder is in nobody's way.
        if (!name.starts_with('.') && name != "lost+found") names.insert(name);
    }
    if (error) {
        throw StoreError(path_, "the folder cannot be looked at: " + error.message() +
                                    "; check its permissions, or choose another one with --out");
    }
    if (names.empty() || is_lock(lock()) || !datasets::results_in(names).empty()) return;
    throw std::invalid_argument(path_.string() +
                                ": the folder is not empty and holds no results of this program, which could replace "
                                "your files; choose another one with --out");
}

void StudyFolder::create() const {
    refuse_if_foreign();
    std::error_code error;
    fs::create_directories(path_, error);
    if (error || !fs::is_directory(path_)) {
        throw StoreError(path_,
                         "the folder cannot be made: " + (error ? error.message() : "there is a file of that name") +
                             "; choose another one with --out");
    }
}

void StudyFolder::write(const fs::path& name, std::string_view bytes) const {
    const bool kept = has_store();
    write_part(name, bytes, kept);
    put_in_place(name, kept);
}

void StudyFolder::write_together(const RunFiles& files) const {
    const bool kept = has_store();
    try {
        for (const auto& [name, bytes] : files.written) write_part(name, bytes, kept);
        for (const auto& [name, bytes] : files.written) {
            if (fs::is_directory(path_ / name)) throw StoreError(path_ / name, remedy(EISDIR, kept));
        }
        for (const fs::path& name : files.dropped) remove(name);
        remove(files.written.back().first);
        for (const auto& [name, bytes] : files.written) put_in_place(name, kept);
    } catch (...) {
        for (const auto& [name, bytes] : files.written) ::unlink(part_of(path_ / name).c_str());
        throw;
    }
}

bool StudyFolder::has_store() const {
    std::error_code error;
    return fs::exists(store(), error);
}

void StudyFolder::write_part(const fs::path& name, std::string_view bytes, bool kept) const {
    const fs::path target = path_ / name;
    std::error_code ignored;
    fs::create_directories(target.parent_path(), ignored);
    const std::string temporary = part_of(target);
    const int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (file < 0) throw StoreError(target, remedy(errno, kept));
    int error = 0;
    for (std::size_t done = 0; done < bytes.size() && error == 0;) {
        const ssize_t written = ::write(file, bytes.data() + done, bytes.size() - done);
        if (written < 0 && errno == EINTR) continue;
        if (written < 0)
            error = errno;
        else
            done += static_cast<std::size_t>(written);
    }
    // On the disk before it takes the place of the old one: a power cut must not leave an empty table.
    if (error == 0 && ::fdatasync(file) != 0 && errno != EINVAL) error = errno;
    if (::close(file) != 0 && error == 0) error = errno;
    if (error != 0) {
        ::unlink(temporary.c_str());
        throw StoreError(target, remedy(error, kept));
    }
}

void StudyFolder::put_in_place(const fs::path& name, bool kept) const {
    const fs::path target = path_ / name;
    const std::string temporary = part_of(target);
    if (::rename(temporary.c_str(), target.c_str()) == 0) return;
    const int error = errno;
    ::unlink(temporary.c_str());
    throw StoreError(target, remedy(error, kept));
}

void StudyFolder::remove(const fs::path& name) const {
    std::error_code error;
    fs::remove(path_ / name, error);
    if (error == std::errc::directory_not_empty) throw StoreError(path_ / name, remedy(EISDIR, has_store()));
    if (error) throw StoreError(path_ / name, "cannot be removed: " + error.message() + "; check its permissions");
}

void refuse_lost_store(const fs::path& store) {
    std::error_code error;
    if (fs::is_directory(store, error)) {
        throw StoreError(store,
                         "a folder stands where the store must be; move it away, then give the same command again");
    }
    if (!fs::is_regular_file(store, error) || fs::file_size(store, error) != 0 || error) return;
    for (const char* name : {"distances.csv", "pairs.csv", "shapes.csv", "clusters.csv", "analysis.json", "report.json",
                             "report.html", "shards/plan.sqlite"}) {
        if (!fs::exists(store.parent_path() / name, error)) continue;
        throw StoreError(store, std::string("is empty, though results of the study lie beside it (") + name +
                                    "); restore a copy of it, or remove the file to have everything computed anew");
    }
}

StudyLock::StudyLock(const StudyFolder& folder) {
    const fs::path file = folder.lock();
    descriptor_ = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (descriptor_ < 0) {
        const int error = errno;
        std::error_code ignored;
        throw StoreError(file, remedy(error, fs::exists(folder.store(), ignored)));
    }
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
        if (const int error = errno; error != EWOULDBLOCK) {
            ::close(descriptor_);
            throw StoreError(file, std::string("cannot be locked: ") + std::strerror(error) +
                                       "; the file system may not know locks, as some of a network: use a study folder "
                                       "on another disk");
        }
        char owner[256] = {};
        const ssize_t size = ::read(descriptor_, owner, sizeof owner - 1);
        ::close(descriptor_);
        throw StoreError(file, "another process works on this study (" +
                                   (size > 0 ? std::string(owner, static_cast<std::size_t>(size)) : "unknown") +
                                   "); wait until it is done, or use another study folder");
    }
    char host[128] = "unknown";
    ::gethostname(host, sizeof host - 1);
    const std::string owner = owner_begin + std::to_string(::getpid()) + " on " + host;
    // For the message of a second process and as the mark of the folder; the lock itself does not depend on it.
    if (::ftruncate(descriptor_, 0) != 0 || ::pwrite(descriptor_, owner.data(), owner.size(), 0) < 0) return;
}

StudyLock::~StudyLock() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace morphodesic::pipeline
