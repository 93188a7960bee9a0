#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pipeline/store_error.h"

namespace morphodesic::pipeline {

/// Files that belong to one run, by names relative to the folder of results; the last one tells that all are there.
struct RunFiles {
    std::vector<std::pair<std::filesystem::path, std::string>> written;
    std::vector<std::filesystem::path> dropped;  ///< what an earlier run may have left and this one does not have
};

/// The path with a last name to put an ending to: "folder/" has none, nor have "." and "..", which become absolute.
[[nodiscard]] std::filesystem::path with_last_name(const std::filesystem::path& path);

/// Names of what a study folder, or another folder of results, holds.
class StudyFolder {
public:
    explicit StudyFolder(std::filesystem::path path) : path_(std::move(path)) {}

    /// The study folder of a collection: beside it, with the ending .study.
    [[nodiscard]] static StudyFolder of_collection(const std::filesystem::path& collection);

    /// Refuses a folder that holds files, but none by which this program knows its own folders: its files have plain
    /// names, and would take the place of others.
    /// @throws std::invalid_argument, StoreError if the folder cannot be looked at
    void refuse_if_foreign() const;
    /// Makes the folder if it is not there. @throws as refuse_if_foreign, StoreError if it cannot be made
    void create() const;

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    [[nodiscard]] std::filesystem::path store() const { return path_ / "study.sqlite"; }
    [[nodiscard]] std::filesystem::path lock() const { return path_ / "study.lock"; }
    [[nodiscard]] std::filesystem::path paths() const { return path_ / "paths"; }

    /// Writes a file of the study so that a reader sees the old or the new one, never a half.
    /// @param name  relative to the study folder; folders are made
    /// @throws StoreError if the disk is full or the folder may not be written
    void write(const std::filesystem::path& name, std::string_view bytes) const;
    /// Writes the files of a run: if one of them cannot be written, those of an earlier run all stay. The last one is
    /// there only if the others are of the same run. @throws StoreError as write does
    void write_together(const RunFiles& files) const;

private:
    [[nodiscard]] bool has_store() const;
    void remove(const std::filesystem::path& name) const;
    void write_part(const std::filesystem::path& name, std::string_view bytes, bool kept) const;
    void put_in_place(const std::filesystem::path& name, bool kept) const;

    std::filesystem::path path_;
};

/// A store that is no file, or that lost all it held, must not be taken for one that is about to be made. One that a
/// stop at its very beginning left is empty, too, but nothing was written beside it yet.
/// @throws StoreError if a folder stands in its place, or if it is empty beside results of the study
void refuse_lost_store(const std::filesystem::path& store);

/// Held by the one process that works on a study, or writes into another folder of results. A second one is told who is
/// at work and ends; when a process dies, its lock goes with it. The file stays: it is the first one in a folder, so it
/// tells whose folder that is also where everything else is missing.
class StudyLock {
public:
    /// @throws StoreError if another process holds the lock or the folder may not be written
    explicit StudyLock(const StudyFolder& folder);
    ~StudyLock();
    StudyLock(const StudyLock&) = delete;
    StudyLock& operator=(const StudyLock&) = delete;

private:
    int descriptor_ = -1;
};

}  // namespace morphodesic::pipeline
