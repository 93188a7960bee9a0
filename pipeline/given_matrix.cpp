#include "pipeline/given_matrix.h"

#include <limits>
#include <map>
#include <stdexcept>

#include "analysis/matrix_csv.h"
#include "datasets/folder_scan.h"
#include "pipeline/study_folder.h"

namespace morphodesic::pipeline {

namespace fs = std::filesystem;

StudyData read_given_matrix(const fs::path& table, const GivenMatrixOptions& options) {
    analysis::CsvReadOptions reading;
    std::vector<analysis::DirectedPair> both_ways;
    if (options.asymmetric) {
        reading.asymmetry_tolerance = 1.0;
        reading.both_ways = &both_ways;
    }
    StudyData data;
    data.given = true;
    data.distances = analysis::read_distance_csv(table, reading);
    data.given_directions = std::move(both_ways);
    const std::size_t n = data.distances.size();
    if (!options.errors.empty()) {
        const analysis::DistanceMatrix errors = analysis::read_distance_csv(options.errors);
        if (errors.labels() != data.distances.labels()) {
            throw std::invalid_argument(options.errors.string() + ": its labels are not those of " + table.string() +
                                        "; give the error bars as a table of the same rows and columns");
        }
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t j = i + 1; j < n; ++j) {
                if (data.distances.known(i, j)) data.distances.set(i, j, data.distances(i, j), errors(i, j));
            }
        }
    }
    for (const std::string& label : data.distances.labels()) {
        StoredShape shape;
        shape.name = label;
        shape.volume = std::numeric_limits<double>::quiet_NaN();
        data.shapes.push_back(std::move(shape));
    }
    data.pairs_missing = static_cast<long>(data.distances.missing_count());
    return data;
}

void label_shapes(StudyData& data, const fs::path& table) {
    std::map<std::string, std::string> label_of = datasets::read_labels(table);
    std::size_t labelled = 0;
    for (StoredShape& shape : data.shapes) {
        const auto found = label_of.find(fs::path(shape.name).lexically_normal().generic_string());
        shape.label = found == label_of.end() ? "" : found->second;
        if (found == label_of.end()) continue;
        ++labelled;
        label_of.erase(found);
    }
    if (labelled == 0) {
        throw std::invalid_argument(table.string() + ": names none of the " + std::to_string(data.shapes.size()) +
                                    " shapes; write two columns, file,label, with the names of distances.csv");
    }
    label_of.erase("name");  // a heading of another kind than file,label
    if (!label_of.empty()) {
        data.remarks.push_back(table.filename().string() + " has a class for " + label_of.begin()->first +
                               (label_of.size() > 1 ? " and " + std::to_string(label_of.size() - 1) + " more, which are"
                                                    : std::string(", which is")) +
                               " not among the shapes.");
    }
}

StudyData load_study_or_table(const fs::path& source, const GivenMatrixOptions& options) {
    if (fs::is_regular_file(source)) return read_given_matrix(source, options);
    return load_study(ResultStore(StudyFolder(source).store(), ResultStore::Access::read));
}

}  // namespace morphodesic::pipeline
