#pragma once

#include <string>
#include <vector>

namespace morphodesic::pipeline {

/// How a query of which a part may be hidden is compared with templates. One list of fields feeds command line and
/// output.
struct ClassifyOptions {
    std::string correction = "visible";  ///< visible | cut | filled | none: against the bias of hidden parts
    double largest_hidden = 0.6;         ///< share of a shape that may be hidden, in [0, 0.95]
    double hidden_cost = 0.35;      ///< mask auto: what hiding a part costs, per root of the area that was hidden, >= 0
    int alignments = 2;             ///< alignments per template that coarse geodesics decide between, >= 1
    std::string mirror = "auto";    ///< auto | no | yes: do templates stand for their mirror images as well
    bool screening = true;          ///< finer levels only for templates that can still be the answer
    int templates_per_class = 0;    ///< a class is represented by so many medoids; 0: all its members
    int neighbours = 1;             ///< distance to a class: mean of that to its so many nearest templates, >= 1
    bool calibrate = true;          ///< classify the templates themselves to learn how sure an answer is
    double false_rejection = 0.05;  ///< share of true members that "none of these" may turn away, in [0, 1)
    double least_confidence = 0.0;  ///< answers that are less sure are rejected, in [0, 1]

    template <class Self, class Visitor>
    static void for_each_field(Self& self, Visitor&& visit) {
        visit("correction", self.correction,
              "what makes distances of partly hidden queries comparable, all per visible share: visible (mismatch "
              "masked as "
              "in the paper), cut (the template is cut as the query is), filled (the hidden part is as stiff as the "
              "template's); or none (the masked path length of the paper)");
        visit("largest-hidden", self.largest_hidden,
              "share of a shape that may be hidden: bounds what is estimated (--mask auto) and, with --normalize each, "
              "the sizes that are tried; what a mask says is believed");
        visit("hidden-cost", self.hidden_cost,
              "--mask auto: what hiding a part costs, as a distance per root of its area");
        visit("alignments", self.alignments, "alignments per template that coarse geodesics decide between");
        visit("mirror-images", self.mirror,
              "whether a mirror image is the same shape: no, yes, or auto: yes if the templates' classes hold mirror "
              "images of "
              "their members");
        visit("screening", self.screening, "finer levels only for templates that can still be the answer");
        visit("templates-per-class", self.templates_per_class, "medoids that represent a class; 0: all its members");
        visit("neighbours", self.neighbours, "distance to a class: mean over its so many nearest templates");
        visit("calibrate", self.calibrate, "learn from the templates how sure an answer is");
        visit("false-rejection", self.false_rejection,
              "share of true members that the answer \"none of these\" may turn away; 0: no query is rejected");
        visit("least-confidence", self.least_confidence, "answers that are less sure are rejected");
    }
    [[nodiscard]] std::vector<std::string> problems() const;  ///< every violated constraint; empty if usable
};

}  // namespace morphodesic::pipeline
