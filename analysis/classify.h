#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/calibration.h"
#include "analysis/distance_matrix.h"

namespace morphodesic::analysis {

struct ClassifyOptions {
    std::size_t neighbours =
        1;  ///< distance to a class = mean of that to its k nearest templates (all, if it has fewer)
    double false_rejection =
        0.05;  ///< share of true members that "none of these" may turn away, 0 <= x < 1; 0: never reject
    double least_confidence = 0.0;  ///< answers with less confidence are rejected as well, 0 .. 1
    CalibrationKind calibration = CalibrationKind::logistic;
};

struct RankedTemplate {
    std::size_t item;  ///< number among the templates
    double distance;
    double error;  ///< NaN if not known
};

struct RankedClass {
    std::string name;
    double distance;      ///< mean over its nearest templates, see ClassifyOptions::neighbours
    double error;         ///< mean of their error bars; NaN if one is not known
    std::size_t nearest;  ///< its nearest template
};

enum class Rejection { accepted, no_known_distance, too_far, too_uncertain };
[[nodiscard]] const char* to_string(Rejection rejection);

struct Classification {
    std::string label;  ///< best class, also if rejected; "" only if no distance is known
    Rejection rejection = Rejection::accepted;
    double margin = 0.0;          ///< (d2 - d1) / (d2 + d1) of the two best classes, 0 .. 1; 1 if there is only one
    bool separated = false;       ///< the error bars of the two best classes do not overlap (false if not known)
    double confidence = missing;  ///< probability that the label is right; NaN without calibration
    /// How little it belongs to any class: d1 / usual distance of members of that class to their nearest, times
    /// (d1 / d2)^Calibration::novelty_exponent for the distance d2 of the second class; NaN without calibration.
    double novelty = missing;
    std::vector<RankedClass> classes;       ///< nearest first; equal ones by name
    std::vector<RankedTemplate> templates;  ///< nearest first; those without distance are left out
};

/// What the templates tell about answers, by leaving out one after the other.
struct Calibration {
    ClassifyOptions options;
    std::size_t queries = 0, right = 0;  ///< templates of classes with two or more members
    std::size_t members = 0;             ///< of these with a distance: what the limit of the novelty is learned from
    double accuracy = missing;
    ConfidenceCurve confidence;
    /// Usual distance of a member to the nearest other member: mean over the members, drawn towards the median of all
    /// classes as if by one more member, and the geometric mean of that and the median.
    struct ClassScale {
        std::string name;
        double scale;
    };
    std::vector<ClassScale> scales;  ///< alphabetical
    /// Of the ratio of the two best classes' distances in the novelty: that of a few values with which most templates
    /// are turned away if their own class is left out. 0 with fewer than three classes.
    double novelty_exponent = 0.0;
    std::size_t strangers = 0, strangers_rejected = 0;  ///< templates with their class left out; of these turned away
    double novelty_limit =
        missing;              ///< larger novelty: "none of these"; NaN: too few templates for this rate, never reject
    Reliability reliability;  ///< of confidences from curves that were fitted without the answer (five folds)
};

/// @param classes of the templates, "" for templates that are in no class (never an answer)
[[nodiscard]] Calibration calibrate(const DistanceMatrix& templates, std::span<const std::string> classes,
                                    const ClassifyOptions& options = {});

/// @param distances of the query to each template, >= 0, NaN where not known
/// @param classes of the templates
/// @param calibration from the same kind of distances, or nothing: then only no_known_distance rejects
/// @param errors error bars of the distances, or empty
/// @throws std::invalid_argument if lengths differ
[[nodiscard]] Classification classify(std::span<const double> distances, std::span<const std::string> classes,
                                      const ClassifyOptions& options = {}, const Calibration* calibration = nullptr,
                                      std::span<const double> errors = {});

}  // namespace morphodesic::analysis
