#include "pipeline/classify_options.h"

namespace morphodesic::pipeline {

std::vector<std::string> ClassifyOptions::problems() const {
    std::vector<std::string> result;
    if (correction != "filled" && correction != "none" && correction != "visible" && correction != "cut") {
        result.push_back("--correction must be visible, cut, filled or none, not \"" + correction + "\"");
    }
    if (!(largest_hidden >= 0.0 && largest_hidden <= 0.95))
        result.emplace_back("--largest-hidden must be from 0 to 0.95");
    if (!(hidden_cost >= 0.0 && hidden_cost < 1e6)) result.emplace_back("--hidden-cost must not be negative");
    if (alignments < 1 || alignments > 16) result.emplace_back("--alignments must be from 1 to 16");
    if (mirror != "auto" && mirror != "no" && mirror != "yes")
        result.push_back("--mirror-images must be auto, no or yes, not \"" + mirror + "\"");
    if (templates_per_class < 0) result.emplace_back("--templates-per-class must not be negative");
    if (neighbours < 1) result.emplace_back("--neighbours must be at least 1");
    if (!(false_rejection >= 0.0 && false_rejection < 1.0))
        result.emplace_back("--false-rejection must be at least 0 and below 1");
    if (!(least_confidence >= 0.0 && least_confidence <= 1.0))
        result.emplace_back("--least-confidence must be from 0 to 1");
    if (!calibrate && least_confidence > 0.0)
        result.emplace_back(
            "--least-confidence needs the confidences that --no-calibrate leaves out; give one of the two");
    if (!calibrate && false_rejection != ClassifyOptions().false_rejection)
        result.emplace_back(
            "--false-rejection has no effect with --no-calibrate, which rejects nothing; give one of the two");
    return result;
}

}  // namespace morphodesic::pipeline
