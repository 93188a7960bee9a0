#include "datasets/folder_scan.h"

#include <algorithm>
#include <deque>
#include <initializer_list>
#include <map>
#include <set>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "datasets/csv_rows.h"
#include "datasets/read_error.h"
#include "datasets/text_scan.h"

namespace morphodesic::datasets {

namespace fs = std::filesystem;

namespace {

constexpr const char* mask_ending = ".mask.png";
constexpr const char* label_file = "labels.csv";

/// Label by the file's name: before the last '-' or '_'; without them before the digits at the end.
std::string label_of_name(const std::string& stem) {
    const std::size_t separator = stem.find_last_of("-_");
    if (separator != std::string::npos && separator > 0) return stem.substr(0, separator);
    const std::size_t last = stem.find_last_not_of("0123456789");
    return last == std::string::npos ? std::string() : stem.substr(0, last + 1);
}

std::set<std::string> names_of(const std::vector<fs::directory_entry>& entries) {
    std::set<std::string> names;
    for (const fs::directory_entry& entry : entries) names.insert(entry.path().filename().string());
    return names;
}

class Scan {
public:
    Scan(const fs::path& top, const ScanOptions& options) : top_(top), options_(options) {}

    ScanResult run() {
        std::error_code error;
        if (!fs::exists(top_, error)) throw ReadError(top_, "there is no such folder", "check the path");
        if (!fs::is_directory(top_, error))
            throw ReadError(top_, "this is not a folder", "name the folder the files lie in");
        fs::directory_iterator readable(top_, error);
        if (error)
            throw ReadError(top_, "the folder cannot be read (" + error.message() + ")", "check its permissions");
        // Real folders before linked ones, so that what lies in the collection keeps its own name.
        waiting_.push_back({top_, ""});
        while (!waiting_.empty() || !linked_.empty()) {
            std::deque<Folder>& queue = waiting_.empty() ? linked_ : waiting_;
            const Folder folder = queue.front();
            queue.pop_front();
            read_folder(folder);
        }
        std::sort(result_.sources.begin(), result_.sources.end(),
                  [](const ShapeSource& a, const ShapeSource& b) { return a.name < b.name; });
        std::sort(result_.problems.begin(), result_.problems.end(),
                  [](const ScanProblem& a, const ScanProblem& b) { return a.path < b.path; });
        attach_masks();
        attach_labels();
        say_other_kinds();
        return std::move(result_);
    }

private:
    struct Folder {
        fs::path path;
        std::string prefix;  // of the names: "" or "a/b/"
    };

    void problem(const fs::path& path, const std::string& what, const std::string& remedy) {
        result_.problems.push_back({path, what, remedy});
    }

    void unreachable(const fs::path& path, const std::string& what, const std::error_code& error) {
        problem(
            path, what + " (" + error.message() + ")",
            error == std::errc::filename_too_long ? "move it to a place with a shorter path" : "check its permissions");
    }

    void read_folder(const Folder& folder) {
        std::error_code error;
        const fs::path real = fs::canonical(folder.path, error);
        if (error) return unreachable(folder.path, "the folder cannot be read", error);
        if (!seen_.insert(real).second) return;
        std::vector<fs::directory_entry> entries;
        fs::directory_iterator it(folder.path, error);
        for (; !error && it != fs::directory_iterator(); it.increment(error)) entries.push_back(*it);
        if (error) return unreachable(folder.path, "the folder cannot be read", error);
        std::sort(entries.begin(), entries.end(),
                  [](const auto& a, const auto& b) { return a.path().native() < b.path().native(); });
        if (!folder.prefix.empty()) {  // whoever names such a folder itself means its pictures
            if (const std::string results = results_in(names_of(entries)); !results.empty()) {
                result_.notes.push_back("Skipped the folder " + folder.path.string() + ": it holds " + results + ".");
                return;
            }
        }
        for (const fs::directory_entry& entry : entries) read_entry(folder, entry);
    }

    void read_entry(const Folder& folder, const fs::directory_entry& entry) {
        const std::string file_name = entry.path().filename().string();
        if (file_name.starts_with('.')) return;
        std::error_code error, ignored;
        const bool link = entry.is_symlink(ignored);
        const fs::file_status status = entry.status(error);
        if (error && !link && !fs::status_known(status)) {
            const bool folder_or_shape = entry.is_directory(ignored) || shape_dimension(entry.path()) != 0;
            if (folder_or_shape) unreachable(entry.path(), "it cannot be looked at", error);
            return;
        }
        if (fs::is_directory(status)) {
            (link ? linked_ : waiting_).push_back({entry.path(), folder.prefix + file_name + "/"});
            return;
        }
        // Opening a pipe waits for whoever writes to it, a device may never end: neither is touched.
        if (fs::exists(status) && !fs::is_regular_file(status)) {
            if (shape_dimension(entry.path()) == 0) return;
            problem(entry.path(), "this is a pipe, a socket or a device, not a file", "copy what it holds into a file");
            return;
        }
        if (lower_case(file_name).ends_with(mask_ending)) {
            masks_.push_back({folder.prefix + file_name.substr(0, file_name.size() - 9), entry.path()});
            return;
        }
        if (fs::is_regular_file(status)) {
            const int dimension = shape_dimension(entry.path());
            if (dimension != 0) result_.sources.push_back({entry.path(), folder.prefix + file_name, "", dimension, {}});
            if (dimension == 0) note_other_kind(entry.path());
        } else if (link && shape_dimension(entry.path()) != 0) {
            problem(entry.path(), "the link leads nowhere", "repair or remove it");
        }
    }

    /// Counts files that may be meant as shapes: all but those that belong to others or tell of them.
    void note_other_kind(const fs::path& file) {
        constexpr std::string_view companions =
            " .csv .tsv .txt .md .rst .json .xml .html .htm .pdf .toml .yaml .yml .ini .log .mtl .raw .zraw .bib "
            ".doc .docx .odt .xls .xlsx .ods .py .r .m .sh .bat .sqlite .db .bak .tmp .lock .sqlite-wal "
            ".sqlite-shm .sqlite-journal .tps .lnk .url ";
        const std::string ending = ending_of(file);
        const bool is_companion = ending.empty() || companions.find(" " + ending + " ") != std::string_view::npos;
        if (!is_companion) ++other_kinds_[ending];
    }

    void say_other_kinds() {
        if (other_kinds_.empty()) return;
        std::size_t count = 0;
        std::string kinds;
        for (const auto& [ending, files] : other_kinds_) {
            count += files;
            kinds += (kinds.empty() ? "" : ", ") + ending + (files > 1 ? " (" + std::to_string(files) + ")" : "");
        }
        result_.notes.push_back("Passed over " + std::to_string(count) + (count == 1 ? " file" : " files") +
                                " of kinds that are not read: " + kinds + ".");
    }

    void attach_masks() {
        for (const auto& [stem, mask] : masks_) {
            bool used = false;
            for (ShapeSource& source : result_.sources) {
                if (source.name.substr(0, source.name.rfind('.')) == stem) {
                    source.mask_path = mask;
                    used = true;
                }
            }
            if (!used) result_.notes.push_back("No shape beside the mask " + mask.string() + ".");
        }
    }

    void attach_labels() {
        std::error_code error;
        std::string rule = options_.labels;
        if (rule == "auto") {
            const auto in_folder = [](const ShapeSource& s) { return s.name.find('/') != std::string::npos; };
            if (fs::exists(top_ / label_file, error)) {
                rule = "csv";
            } else {
                rule = std::any_of(result_.sources.begin(), result_.sources.end(), in_folder) ? "folder" : "name";
            }
        }
        if (rule == "csv") labels_from_csv();
        for (ShapeSource& source : result_.sources) {
            const std::size_t slash = source.name.rfind('/');
            if (rule == "folder" && slash != std::string::npos) {
                const std::string parent = source.name.substr(0, slash);
                source.label = parent.substr(parent.rfind('/') + 1);  // npos + 1 is 0
            } else if (rule == "name" || (rule == "folder" && options_.labels == "auto")) {
                source.label = label_of_name(fs::path(source.name).stem().string());
            }
        }
        if (rule == "name" && options_.labels == "auto") forget_labels_without_classes();
    }

    /// If no two files share the beginning of their names, the names do not tell classes.
    void forget_labels_without_classes() {
        std::set<std::string> labels;
        for (const ShapeSource& source : result_.sources) {
            if (!source.label.empty() && !labels.insert(source.label).second) return;
        }
        for (ShapeSource& source : result_.sources) source.label.clear();
    }

    void labels_from_csv() {
        const fs::path file = top_ / label_file;
        std::map<std::string, std::string> label_of = read_labels(file);
        std::size_t unlabelled = 0;
        for (ShapeSource& source : result_.sources) {
            const auto found = label_of.find(source.name);
            if (found == label_of.end()) {
                ++unlabelled;
            } else {
                source.label = found->second;
                label_of.erase(found);
            }
        }
        if (unlabelled > 0) {
            result_.notes.push_back(std::to_string(unlabelled) + " of " + std::to_string(result_.sources.size()) +
                                    " files have no label in " + file.string() + ".");
        }
        for (const auto& [name, label] : label_of) {
            result_.notes.push_back(file.string() + " labels " + name + ", which is not there.");
        }
    }

    fs::path top_;
    ScanOptions options_;
    ScanResult result_;
    std::deque<Folder> waiting_, linked_;
    std::set<fs::path> seen_;
    std::map<std::string, std::size_t> other_kinds_;       // by ending
    std::vector<std::pair<std::string, fs::path>> masks_;  // name without ".mask.png", file
};

}  // namespace

std::vector<std::string> ScanOptions::problems() const {
    for (const char* known : {"auto", "csv", "folder", "name", "none"}) {
        if (labels == known) return {};
    }
    return {"labels must be auto, csv, folder, name or none, not \"" + labels + "\""};
}

std::map<std::string, std::string> read_labels(const fs::path& file) {
    std::error_code error;
    if (fs::exists(file, error) && !fs::is_regular_file(file, error)) {
        throw ReadError(file, "this is not a file", "write a table with the two columns file,label");
    }
    std::map<std::string, std::string> label_of;
    bool first = true;
    for (const CsvRow& row : read_csv(file)) {
        const bool header = first && row.fields.size() >= 2 && row.fields[0] == "file" && row.fields[1] == "label";
        first = false;
        if (header || (row.fields.size() == 1 && row.fields[0].empty())) continue;
        if (row.fields.size() < 2) {
            const bool other = row.fields[0].find_first_of(";\t") != std::string::npos;
            throw ReadError(
                file,
                "line " + std::to_string(row.line) + (other ? " has no comma between its columns" : " has no label"),
                "write two columns: file,label");
        }
        std::string name = fs::path(row.fields[0]).lexically_normal().generic_string();
        const auto [it, fresh] = label_of.emplace(name, row.fields[1]);
        if (!fresh && it->second != row.fields[1]) {
            throw ReadError(file, "line " + std::to_string(row.line) + " gives " + name + " a second label",
                            "keep one line per file");
        }
    }
    return label_of;
}

std::string results_in(const std::set<std::string>& names) {
    const auto all = [&](std::initializer_list<const char*> files) {
        return std::all_of(files.begin(), files.end(), [&](const char* file) { return names.contains(file); });
    };
    if (all({"study.sqlite"})) return "a study";
    if (all({"clusters.csv", "linkage.csv", "embedding.csv"})) return "the analysis of a table of distances";
    if (all({"colours.json", "step-00.png"})) return "the path of a geodesic";
    if (all({"classification.csv", "ranking.csv"})) return "results of classify";
    if (all({"heat_map.svg", "heat_map.pdf", "heat_map.png"})) return "figures of a report";
    // Of `figures` the names differ, but each picture comes with its drawing and its numbers.
    const bool figure = std::any_of(names.begin(), names.end(), [&](const std::string& name) {
        const std::string stem = fs::path(name).stem().string();
        return name == stem + ".png" && names.contains(stem + ".svg") && names.contains(stem + ".csv");
    });
    return figure && all({"gallery.html"}) ? "results of figures" : "";
}

ScanResult scan_folder(const fs::path& folder, const ScanOptions& options) {
    for (const std::string& problem : options.problems()) throw std::invalid_argument(problem);
    return Scan(folder, options).run();
}

}  // namespace morphodesic::datasets
