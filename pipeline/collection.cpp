#include "pipeline/collection.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "datasets/interruption.h"
#include "datasets/solid_reader.h"
#include "pipeline/digest.h"
#include "pipeline/stop_signals.h"
#include "pipeline/whole_tasks.h"

namespace morphodesic::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr const char* files_to_read = "files_to_read";      // fact: how many; "0" once all were
constexpr const char* reading_command = "reading_command";  // fact: the command that reads them

/// The folder as the store knows it.
std::string folder_text(const fs::path& folder) {
    return fs::absolute(folder).lexically_normal().string();
}

/// Everything that decides what is read from a file.
std::string reading_digest(const datasets::ShapeSource& source, const std::string& file_digest,
                           const datasets::ImportOptions& options) {
    std::string text = file_digest + "\n" + canonical_text(options);
    if (source.dimension == 3) text += "solid reader " + std::to_string(datasets::solid_reader_revision);
    if (!source.mask_path.empty()) text += "mask " + datasets::file_digest(source.mask_path);
    // Images of which nothing is hidden once had masks, too.
    if (source.dimension == 2 && !(options.occluder.empty() && source.mask_path.empty())) text += "masks 2";
    return digest(text);
}

/// Everything that decides what is stored of a shape. Its notes are about the level of the solver.
std::string placing_digest(const std::string& reading, const datasets::NormalizeOptions& placement) {
    std::string text =
        reading + "\n" + placement.mode + " " + exact_text(placement.scale) + " " + std::to_string(placement.level);
    if (placement.solved_level != placement.level) text += " seen on " + std::to_string(placement.solved_level);
    return digest(text);
}

/// A file that is larger than anything that would be accepted is refused before all of it is read.
void check_size(const CollectionEntry& entry, const datasets::ImportOptions& options) {
    std::error_code error;
    const auto bytes = static_cast<double>(fs::file_size(entry.source.path, error));
    if (error) return;                           // reading it says what is wrong
    constexpr double most_bytes_per_pixel = 32;  // four channels of doubles, not compressed
    const bool image = entry.source.dimension == 2;
    const double limit = 1e6 * (image ? most_bytes_per_pixel * options.max_megapixels + 1 : options.max_megabytes);
    if (bytes <= limit) return;
    char size[60];
    std::snprintf(size, sizeof size, "the file has %.0f MB, more than the limit", bytes / 1e6);
    throw datasets::ReadError(
        entry.source.path, size,
        image ? "use a smaller image or raise --max-megapixels" : "use a smaller file or raise --max-megabytes");
}

/// Digests of the files, and what the store knows of them.
void look_at_file(CollectionEntry& entry, const StoredShape* known, const datasets::ImportOptions& options) {
    StoredShape& row = entry.row;
    if (known) row = *known;
    row.name = entry.source.name;
    row.path = entry.source.path.string();
    row.label = entry.source.label;
    row.dimension = entry.source.dimension;
    row.problem.clear();
    row.damaged = false;  // nothing of it is used: `reading` is empty
    try {
        check_size(entry, options);
        row.file_digest = datasets::file_digest(entry.source.path);
        const std::string reading = reading_digest(entry.source, row.file_digest, options);
        if (reading == row.reading) return;
        row.reading = reading;
    } catch (const datasets::ReadError& error) {
        row.problem = error.what();
        row.reading.clear();
    }
    row.extent_radius = 0.0;
    row.content_digest.clear();
    row.placing.clear();
}

constexpr std::size_t most_kept_bytes = std::size_t{128} << 20;  // some sixty scans rebuilt on a grid

/// In the cube, or where there is no common scale yet in units of the file.
SolidReach reach_when_placed(const datasets::RawShape<3>& raw, const datasets::NormalizeOptions& options) {
    datasets::NormalizeOptions fitting;
    const auto large = datasets::placement_of<3>(raw, fitting, nullptr);
    constexpr int level = 5;
    const SolidReach reach = reach_of(raw.geometry->signed_distance(DyadicGrid<3>(level), large));
    const bool common = options.mode == "common";
    return reach.scaled((common ? 1.0 : datasets::placement_of<3>(raw, options, nullptr).scale) / large.scale);
}

/// @param placement   without its scale, which is not known yet
/// @param kept_bytes  of the solids that were kept so far
template <int Dim>
void measure(CollectionEntry& entry, const datasets::ImportOptions& options,
             const datasets::NormalizeOptions& placement, std::atomic<std::size_t>& kept_bytes) {
    try {
        datasets::RawShape<Dim> raw = datasets::read_shape<Dim>(entry.source, options);
        entry.row.extent_radius = raw.extent_radius;
        if constexpr (Dim == 3) {
            entry.reach = std::make_shared<const SolidReach>(reach_when_placed(raw, placement));
            if (kept_bytes.fetch_add(raw.bytes) + raw.bytes > most_kept_bytes) return;
            entry.measured = std::make_shared<std::optional<datasets::RawShape<3>>>(std::move(raw));
        }
    } catch (const datasets::Interrupted&) {
        return;  // the whole collection is given up
    } catch (const std::exception&) {
        entry.row.problem = problem_of_file(entry.row.path, " to read it; use a smaller file");
    }
}

/// Sizes that differ so much are rather a matter of units (mm, cm, m) or of resolution than of shape.
std::string size_warning_of(const Collection& collection) {
    std::vector<SizedName> sizes;
    for (const CollectionEntry& entry : collection.entries) {
        if (entry.row.problem.empty()) sizes.push_back({entry.row.name, entry.row.extent_radius});
    }
    return size_warning(sizes);
}

/// The common scale for the shapes that can be used.
CommonScale common_scale_of(const Collection& collection, const ResultStore& store) {
    std::vector<SizedFile> files;
    for (const CollectionEntry& entry : collection.entries) {
        const StoredShape& row = entry.row;
        if (row.problem.empty()) files.push_back({row.name, row.file_digest, row.extent_radius});
    }
    return choose_common_scale(files, collection.import, collection.dimension, store);
}

/// Says so if the study was made from a folder of other shapes; else empty.
/// @param known  what the store has
std::string remark_on_origin(const fs::path& folder, const Collection& collection,
                             const std::map<std::string, StoredShape>& known, const ResultStore& store) {
    std::set<std::string> digests;
    for (const auto& [name, shape] : known) digests.insert(shape.file_digest);
    const std::string before = store.fact("folder").value_or("");
    const bool shared = std::any_of(collection.entries.begin(), collection.entries.end(),
                                    [&](const auto& entry) { return digests.contains(entry.row.file_digest); });
    if (known.empty() || before.empty() || shared || before == folder_text(folder)) return "";
    return "This study was made from the folder " + before + ", and " + folder.string() +
           " has none of its shapes. If a study of its own is meant, choose another folder with --out.";
}

[[noreturn]] void refuse_without_shapes(const ResultStore& store) {
    throw std::invalid_argument(store.file().string() +
                                ": the study has no shapes yet; take them in with: morphodesic ingest FOLDER");
}

}  // namespace

int choose_dimension(const fs::path& folder, const std::string& wanted, std::vector<datasets::ShapeSource>& sources,
                     std::vector<std::string>& left_out, std::vector<std::string>& remarks) {
    const auto solids = static_cast<std::size_t>(
        std::count_if(sources.begin(), sources.end(), [](const auto& s) { return s.dimension == 3; }));
    const std::size_t images = sources.size() - solids;
    const int dimension = wanted == "2" ? 2 : wanted == "3" ? 3 : solids > 0 && solids >= images ? 3 : 2;
    if (solids > 0 && images > 0 && wanted == "auto") {
        remarks.push_back(folder.string() + " holds " + std::to_string(images) + " images and " +
                          std::to_string(solids) + " solids; taken are the " +
                          (dimension == 2 ? "images. To take the solids, or to say that the images are meant, give "
                                            "--dimension 3 or 2."
                                          : "solids. To take the images, or to say that the solids are meant, give "
                                            "--dimension 2 or 3."));
    }
    std::erase_if(sources, [&](const datasets::ShapeSource& s) {
        if (s.dimension == dimension) return false;
        if (wanted != "auto") return true;
        left_out.push_back(s.path.string() + ": is " + (dimension == 2 ? "a 3D" : "a 2D") + " shape among " +
                           (dimension == 2 ? "images" : "3D shapes") + "; put the two kinds into folders of their own");
        return true;
    });
    return dimension;
}

std::string problem_of_file(const std::string& path, const char* less_memory) {
    try {
        throw;
    } catch (const datasets::ReadError& error) {
        return error.what();
    } catch (const std::bad_alloc&) {
        return path + ": not enough memory" + less_memory;
    } catch (const std::exception& error) {
        return path + ": cannot be read (" + error.what() + "); open and save it again in another format";
    }
}

std::string size_warning(const std::vector<SizedName>& sizes) {
    if (sizes.size() < 2) return "";
    const auto by_size = [](const SizedName& a, const SizedName& b) { return a.size < b.size; };
    const auto [small, large] = std::minmax_element(sizes.begin(), sizes.end(), by_size);
    constexpr double comparable = 5.0;
    if (!(large->size > comparable * small->size)) return "";
    char factor[32];
    std::snprintf(factor, sizeof factor, "%.3g", large->size / small->size);
    return "The sizes differ by a factor of " + std::string(factor) + ": " + small->name + " is the smallest, " +
           large->name +
           " the largest. If they are in different units or their size does not matter, use --normalize each; as it "
           "is, all are placed at one scale and the distances are mostly those of the sizes.";
}

Collection prepare_collection(const fs::path& folder, const RunSettings& settings, const ResultStore& store,
                              Progress& progress) {
    datasets::ScanResult scan = datasets::scan_folder(folder, {settings.labels});
    Collection collection;
    for (const auto& problem : scan.problems) collection.left_out.push_back(problem.message());
    collection.remarks = scan.notes;
    collection.dimension =
        choose_dimension(folder, settings.dimension, scan.sources, collection.left_out, collection.remarks);
    if (std::string remark = datasets::mirror_remark(settings.import.mirror, scan.sources); !remark.empty()) {
        collection.remarks.push_back(std::move(remark));
    }
    if (const auto before = store.fact("dimension"); before && *before != std::to_string(collection.dimension)) {
        const std::string kind = *before == "3" ? "solids" : "images";
        collection.remarks.push_back("So far this study was one of " + kind +
                                     "; its results stay in the store and come back with the " + kind +
                                     " (--dimension " + *before + ").");
    }
    collection.import = settings.import;
    collection.placement.mode = settings.normalize;
    collection.placement.level = shape_level(collection.dimension, settings.geodesic);
    collection.placement.solved_level = settings.geodesic.level;

    std::map<std::string, StoredShape> known;
    for (StoredShape& shape : store.shapes()) known.emplace(shape.name, std::move(shape));
    for (datasets::ShapeSource& source : scan.sources) collection.entries.push_back({std::move(source), {}, false});

    if (!collection.entries.empty())
        progress.message(std::to_string(collection.entries.size()) +
                         (collection.entries.size() == 1 ? " shape in " : " shapes in ") + folder.string());
    std::atomic<std::size_t> kept_bytes{0};
    for_each_whole(collection.entries.size(), [&](std::size_t i) {
        if (StopSignals::caught() != 0) return;
        CollectionEntry& entry = collection.entries[i];
        const auto found = known.find(entry.source.name);
        look_at_file(entry, found == known.end() ? nullptr : &found->second, settings.import);
        if (!entry.row.problem.empty() || entry.row.extent_radius > 0) return;
        // Images need a size only for the common scale; how far solids reach says how much memory their pairs need. For
        // that alone no file is read twice.
        const bool new_solid = collection.dimension == 3 && entry.row.content_digest.empty();
        if (settings.normalize != "common" && !(new_solid && kept_bytes < most_kept_bytes)) return;
        with_dimension(collection.dimension,
                       [&]<int Dim>() { measure<Dim>(entry, settings.import, collection.placement, kept_bytes); });
    });
    if (StopSignals::caught() != 0) return collection;  // not all files were looked at: nothing is settled by that
    if (const std::string remark = remark_on_origin(folder, collection, known, store); !remark.empty()) {
        collection.remarks.push_back(remark);
    }
    if (settings.normalize == "common") {
        collection.common = common_scale_of(collection, store);
        collection.placement.scale = collection.common.scale;
        if (!collection.common.remark.empty()) collection.remarks.push_back(collection.common.remark);
        collection.size_warning = size_warning_of(collection);
        if (!collection.size_warning.empty()) collection.remarks.push_back(collection.size_warning);
    }
    std::set<std::string> names;
    const double cell = std::pow(0.5, collection.dimension * collection.placement.level);
    for (CollectionEntry& entry : collection.entries) {
        names.insert(entry.row.name);
        if (!entry.row.problem.empty()) {
            entry.row.content_digest.clear();
            continue;
        }
        const std::string placing = placing_digest(entry.row.reading, collection.placement);
        // Older programs took shapes smaller than a cell: reading says what is wrong with them.
        entry.needs_import =
            entry.row.placing != placing || entry.row.content_digest.empty() || entry.row.volume < cell;
        entry.row.placing = placing;
    }
    for (const auto& [name, shape] : known) {
        if (!names.contains(name)) collection.gone.push_back(name);
    }
    std::vector<std::string> gone;  // those of the other dimension may well be there
    std::copy_if(collection.gone.begin(), collection.gone.end(), std::back_inserter(gone),
                 [&](const std::string& name) { return known.at(name).dimension == collection.dimension; });
    if (!gone.empty()) {
        collection.remarks.push_back(std::to_string(gone.size()) +
                                     (gone.size() > 1 ? " files of the last run are no longer in the folder ("
                                                      : " file of the last run is no longer in the folder (") +
                                     gone.front() + (gone.size() > 1 ? ", ...); their" : "); its") +
                                     " results stay in the store.");
    }
    return collection;
}

void settle_collection(const fs::path& folder, const Collection& collection, ResultStore& store) {
    keep_common_scale(collection.common, store);
    store.set_fact("size_warning", collection.size_warning);
    if (!collection.gone.empty()) store.remove_shapes(collection.gone);
    store.set_fact("dimension", std::to_string(collection.dimension));
    store.set_fact("folder", folder_text(folder));
}

void begin_reading(ResultStore& store, std::size_t files, const std::string& command) {
    store.set_fact(reading_command, command);
    store.set_fact(files_to_read, std::to_string(files));
}

void end_reading(ResultStore& store) {
    if (store.fact(files_to_read).value_or("0") == "0") return;
    store.seal_shape_count();
    store.set_fact(files_to_read, "0");
}

std::string unfinished_reading(const ResultStore& store) {
    const std::string study = store.file().parent_path().string();
    const auto command = [&] {
        const std::string given = store.fact(reading_command).value_or("");
        return !given.empty() ? given
                              : "morphodesic ingest " + store.fact("folder").value_or("FOLDER") + " --out " + study +
                                    " (and the options that the study was made with)";
    };
    if (const std::string files = store.fact(files_to_read).value_or("0"); files != "0") {
        return study + ": reading its " + files +
               " files was stopped before all were taken in; finish it with: " + command();
    }
    if (const long lost = store.lost_shapes(); lost > 0) {
        return study + ": the store has lost " + std::to_string(lost) + (lost == 1 ? " shape" : " shapes") +
               " of the study; read the files again with: " + command();
    }
    return "";
}

void refuse_unfinished_reading(const ResultStore& store) {
    if (const std::string unfinished = unfinished_reading(store); !unfinished.empty()) {
        throw std::invalid_argument(unfinished);
    }
}

Collection stored_collection(const ResultStore& store) {
    Collection collection;
    collection.dimension = store.fact("dimension") == "3" ? 3 : 2;
    for (StoredShape& shape : store.shapes()) collection.entries.push_back({{}, std::move(shape), false});
    refuse_unfinished_reading(store);
    if (collection.entries.empty()) refuse_without_shapes(store);
    return collection;
}

RunSettings settings_of_study(const ResultStore& store) {
    if (const auto text = store.fact("settings")) return settings_from_text(*text);
    if (store.shapes().empty()) refuse_without_shapes(store);
    throw StoreError(
        store.file(),
        "the settings of the study are lost; give the command that made it again (morphodesic run FOLDER)");
}

namespace {

/// Rounds to the 32-bit floats that the store keeps.
void round_as_stored(std::vector<double>& values) {
    for (double& x : values) x = static_cast<double>(static_cast<float>(x));
}

/// The fields of a shape, rounded: whoever computes with it sees the numbers of the store.
template <int Dim>
void take_fields(ImportedShape<Dim>& result, LevelSet<Dim> level_set, ScalarField<Dim> mask) {
    round_as_stored(level_set.values);
    round_as_stored(mask.values);
    result.level_set = std::make_shared<const LevelSet<Dim>>(std::move(level_set));
    if (!mask.values.empty()) result.mask = std::make_shared<const ScalarField<Dim>>(std::move(mask));
}

/// The shape of an entry before it is placed: as it was measured, or read anew.
template <int Dim>
datasets::RawShape<Dim> raw_shape(const CollectionEntry& entry, const datasets::ImportOptions& options) {
    if constexpr (Dim == 3) {
        if (entry.measured) {
            if (auto raw = std::exchange(*entry.measured, std::nullopt)) return std::move(*raw);
        }
    }
    return datasets::read_shape<Dim>(entry.source, options);
}

}  // namespace

template <int Dim>
void take_shape(ImportedShape<Dim>& result, datasets::Shape<Dim> shape) {
    result.row.content_digest = shape.digest;
    result.row.volume = shape.volume;
    result.row.fullness = shape.fullness;
    result.row.scale = shape.scale;
    result.row.notes = shape.notes;
    take_fields(result, std::move(shape.level_set), std::move(shape.occlusion_mask));
}

template <int Dim>
ImportedShape<Dim> import_entry(const Collection& collection, std::size_t index, const ResultStore& store) {
    const CollectionEntry& entry = collection.entries[index];
    ImportedShape<Dim> result{index, entry.row, entry.needs_import, nullptr, nullptr};
    if (!entry.row.problem.empty()) {
        result.fresh = true;
        return result;
    }
    if (!entry.needs_import) {
        try {
            ScalarField<Dim> mask;
            LevelSet<Dim> level_set = store.level_set<Dim>(entry.row.content_digest, &mask);
            take_fields(result, std::move(level_set), std::move(mask));
            return result;
        } catch (const StoreError&) {
            // Missing or damaged: the file itself still has everything, if it is there.
            if (entry.source.path.empty()) throw;
            result.fresh = true;
        }
    }
    try {
        datasets::Shape<Dim> shape = [&] {
            const datasets::RawShape<Dim> raw = raw_shape<Dim>(entry, collection.import);
            result.row.extent_radius = raw.extent_radius;
            return normalize(raw, collection.placement);
        }();
        if (datasets::file_digest(entry.source.path) != entry.row.file_digest) {
            throw datasets::ReadError(entry.source.path, "the file changed while the study was reading it",
                                      "give the same command again");
        }
        take_shape(result, std::move(shape));
    } catch (const std::exception&) {
        result.row.problem = problem_of_file(entry.row.path, "; use a smaller file or a lower --level");
    }
    if (!result.row.problem.empty()) result.row.content_digest.clear();
    return result;
}

std::vector<SolidReach> solid_reaches(const Collection& collection, const ResultStore& store) {
    std::vector<SolidReach> reaches;
    if (collection.dimension != 3) return reaches;
    const bool common = collection.placement.mode == "common";
    for (const CollectionEntry& entry : collection.entries) {
        const StoredShape& row = entry.row;
        if (!row.problem.empty()) continue;
        if (entry.reach) {
            reaches.push_back(common ? entry.reach->scaled(collection.placement.scale) : *entry.reach);
            continue;
        }
        if (!entry.needs_import) {
            try {
                reaches.push_back(reach_of(store.level_set<3>(row.content_digest)));
                continue;
            } catch (const StoreError&) {
                // Read again from its file later.
            }
        }
        const double radius = row.extent_radius * collection.placement.scale;
        reaches.push_back(reach_of_ball(common && radius > 0 ? radius : datasets::largest_extent_radius));
    }
    return reaches;
}

template void take_shape<2>(ImportedShape<2>&, datasets::Shape<2>);
template void take_shape<3>(ImportedShape<3>&, datasets::Shape<3>);
template ImportedShape<2> import_entry<2>(const Collection&, std::size_t, const ResultStore&);
template ImportedShape<3> import_entry<3>(const Collection&, std::size_t, const ResultStore&);

}  // namespace morphodesic::pipeline
