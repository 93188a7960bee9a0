#include "reports/json.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

#include "reports/json_number.h"
#include "reports/report.h"

namespace morphodesic::reports {
namespace {

using Json = nlohmann::ordered_json;

Json numbers(const std::vector<double>& values, int digits = 0) {
    Json result = Json::array();
    for (double v : values) {
        if (digits > 0 && std::isfinite(v)) {
            char buffer[40];
            std::snprintf(buffer, sizeof buffer, "%.*g", digits, v);
            v = std::strtod(buffer, nullptr);
        }
        result.push_back(json_number(v));
    }
    return result;
}

template <class Items, class Make>
Json list(const Items& items, Make&& make) {
    Json result = Json::array();
    for (const auto& item : items) result.push_back(make(item));
    return result;
}

Json tree_json(const LinkageTree& tree) {
    return {{"method", tree.method},
            {"merges", list(tree.merges,
                            [](const Merge& m) {
                                return Json{m.first, m.second, json_number(m.height), m.size};
                            })},
            {"leaf_order", tree.leaf_order},
            {"cophenetic_correlation", json_number(tree.cophenetic_correlation)}};
}

Json edge_json(const Edge& e) {
    return {{"a", e.a}, {"b", e.b}, {"length", json_number(e.length)}};
}

Json setting_json(const Setting& s) {
    return {{"name", s.name}, {"value", s.value}, {"description", s.description}};
}

Json class_json(const ClassTable& t) {
    return {{"name", t.name},
            {"nearest_neighbour", json_number(t.nearest_neighbour)},
            {"k_nearest", list(t.k_nearest,
                               [](const auto& k) {
                                   return Json{{"k", k.first}, {"accuracy", json_number(k.second)}};
                               })},
            {"bulls_eye", json_number(t.bulls_eye)},
            {"bulls_eye_window", t.bulls_eye_window},
            {"mean_average_precision", json_number(t.mean_average_precision)},
            {"precision_recall",
             list(t.precision_recall,
                  [](const PrecisionRecall& p) {
                      return Json{{"recall", json_number(p.recall)}, {"precision", json_number(p.precision)}};
                  })},
            {"classes", t.classes},
            {"confusion", t.confusion},
            {"class_medoids", t.class_medoids},
            {"adjusted_rand", json_number(t.adjusted_rand)},
            {"adjusted_mutual_information", json_number(t.adjusted_mutual_information)},
            {"permanova_f", json_number(t.permanova_f)},
            {"permanova_p", json_number(t.permanova_p)},
            {"permanova_r2", json_number(t.permanova_r2)},
            {"permutations", t.permutations}};
}

Json trust_json(const Trust& t) {
    Json result;
    result["triangles_checked"] = t.triangles_checked;
    result["triangles_violated"] = t.triangles_violated;
    result["triangles_beyond_error"] = t.triangles_beyond_error;
    result["worst_triangles"] = list(t.worst_triangles, [](const TriangleViolation& v) {
        return Json{
            {"a", v.a}, {"via", v.via}, {"b", v.b}, {"excess", json_number(v.excess)}, {"error", json_number(v.error)}};
    });
    result["median_asymmetry"] = json_number(t.median_asymmetry);
    result["max_asymmetry"] = json_number(t.max_asymmetry);
    result["asymmetries"] = list(t.asymmetries, [](const Asymmetry& v) {
        return Json{{"a", v.a}, {"b", v.b}, {"forward", json_number(v.forward)}, {"backward", json_number(v.backward)}};
    });
    result["silhouettes"] = numbers(t.silhouettes);
    result["stability"] = list(t.stability, [](const ClusterStability& s) {
        return Json{{"cluster", s.cluster}, {"jaccard", json_number(s.jaccard)}};
    });
    result["stability_rand"] = json_number(t.stability_rand);
    result["perturbations"] = t.perturbations;
    result["seed"] = t.seed;
    result["not_converged"] = list(t.not_converged, [](const PairRemark& p) {
        return Json{{"a", p.a}, {"b", p.b}, {"remark", p.remark}};
    });
    result["close_clusters"] = list(t.close_clusters, [](const CloseClusters& c) {
        return Json{
            {"first", c.first}, {"second", c.second}, {"gap", json_number(c.gap)}, {"error", json_number(c.error)}};
    });
    result["graph_correlation"] = json_number(t.graph_correlation);
    result["remarks"] = t.remarks;
    return result;
}

Json volumes_json(const std::optional<VolumeComparison>& v) {
    if (!v) return nullptr;
    return {{"tree", tree_json(v->tree)},
            {"assignment", v->assignment},
            {"rank_correlation", json_number(v->rank_correlation)},
            {"adjusted_rand", json_number(v->adjusted_rand)}};
}

Json compare_json(const std::optional<Comparison>& c) {
    if (!c) return nullptr;
    return {{"other", c->other},
            {"common_shapes", c->common_shapes},
            {"common_pairs", c->common_pairs},
            {"spearman", json_number(c->spearman)},
            {"kendall", json_number(c->kendall)},
            {"pearson", json_number(c->pearson)},
            {"neighbours", c->neighbours},
            {"mean_overlap", json_number(c->mean_overlap)},
            {"moved", list(c->moved,
                           [](const MovedNeighbour& m) {
                               return Json{{"shape", m.shape},
                                           {"here", m.here},
                                           {"there", m.there},
                                           {"overlap", json_number(m.overlap)}};
                           })},
            {"distances", list(c->distances,
                               [](const auto& d) {
                                   return Json{json_number(d.first), json_number(d.second)};
                               })},
            {"different_settings", list(c->different_settings, setting_json)}};
}

}  // namespace

Json path_json(const PathReport& p) {
    Json result;
    result["a"] = p.a;
    result["b"] = p.b;
    result["path_length"] = json_number(p.path_length);
    result["error"] = json_number(p.error);
    result["extrapolated_length"] = json_number(p.extrapolated_length);
    result["path_energy"] = json_number(p.path_energy);
    result["total_energy"] = json_number(p.total_energy);
    result["min_det"] = json_number(p.min_det);
    result["termination"] = p.termination;
    result["message"] = p.message;
    result["level"] = p.level;
    result["time_steps"] = p.time_steps;
    result["seconds"] = json_number(p.seconds);
    result["motion"] = p.motion;
    result["frames"] = list(p.frames, [](const Frame& f) {
        return Json{{"time", json_number(f.time)},
                    {"deformation_energy", json_number(f.deformation_energy)},
                    {"mismatch_energy", json_number(f.mismatch_energy)}};
    });
    result["colour_bar"] = {{"quantity", p.colour_bar.quantity},
                            {"unit", p.colour_bar.unit},
                            {"low", json_number(p.colour_bar.low)},
                            {"high", json_number(p.colour_bar.high)},
                            {"colours", p.colour_bar.colours}};
    return result;
}

Json model_json(const ReportModel& m, int digits) {
    Json result;
    result["format"] = "morphodesic report";
    result["schema"] = report_schema;
    result["study"] = m.study;
    result["created"] = m.created;
    result["dimension"] = m.dimension;
    result["given_matrix"] = m.given_matrix;
    result["collection"] = m.collection;
    result["study_folder"] = m.study_folder;
    result["geodesic_options"] = m.geodesic_options;
    result["shapes_found"] = m.shapes_found;
    result["pairs_total"] = m.pairs_total;
    result["pairs_done"] = m.pairs_done;
    result["seconds"] = json_number(m.seconds);
    result["cpu_seconds"] = json_number(m.cpu_seconds);
    result["preset"] = m.preset;
    result["distance_unit"] = m.distance_unit;
    result["command"] = m.command;
    result["failures"] = list(m.failures, [](const Failure& f) {
        return Json{{"a", f.a}, {"b", f.b}, {"reason", f.reason}};
    });
    result["warnings"] = m.warnings;
    result["pictures_at_one_scale"] = m.pictures_at_one_scale;
    result["shapes"] = list(m.shapes, [](const ReportShape& s) {
        return Json{{"name", s.name}, {"label", s.label}, {"volume", json_number(s.volume)}, {"notes", s.notes}};
    });
    result["distances"] = numbers(m.distances, digits);
    result["errors"] = numbers(m.errors, digits > 0 ? std::min(digits, 3) : 0);
    result["refined"] = m.refined;
    result["linkages"] = list(m.linkages, tree_json);
    result["clusterings"] = list(m.clusterings, [](const Clustering& c) {
        return Json{{"method", c.method},
                    {"cut", c.cut},
                    {"assignment", c.assignment},
                    {"medoids", c.medoids},
                    {"silhouette", json_number(c.silhouette)},
                    {"agreement", json_number(c.agreement)}};
    });
    result["embeddings"] = list(m.embeddings, [&](const Embedding& e) {
        return Json{{"method", e.method},
                    {"dimension", e.dimension},
                    {"coordinates", numbers(e.coordinates, digits)},
                    {"stress", json_number(e.stress)},
                    {"stress_per_shape", numbers(e.stress_per_shape, digits)},
                    {"disparities", numbers(e.disparities, digits)}};
    });
    result["placed"] = list(m.placed, [&](const PlacedQuery& q) {
        return Json{{"name", q.name},
                    {"nearest", q.nearest < 0 ? Json(nullptr) : Json(q.nearest)},
                    {"distance", json_number(q.distance)},
                    {"positions", list(q.positions, [&](const auto& p) { return numbers(p, digits); })},
                    {"stress", numbers(q.stress, digits)}};
    });
    result["spanning_tree"] = list(m.spanning_tree, edge_json);
    result["neighbour_graph"] = list(m.neighbour_graph, edge_json);
    result["graph_neighbours"] = m.graph_neighbours;
    result["neighbours"] = m.neighbours;
    result["classes"] = list(m.classes, class_json);
    result["trust"] = trust_json(m.trust);
    result["paths"] = list(m.paths, path_json);
    result["volumes"] = volumes_json(m.volumes);
    result["volume_spread"] = json_number(m.volume_spread);
    result["compare"] = compare_json(m.compare);
    result["settings"] = list(m.settings, setting_json);
    result["versions"] = list(m.versions, setting_json);
    result["links"] = list(m.links, [](const Link& l) {
        return Json{{"href", l.href}, {"title", l.title}, {"description", l.description}};
    });
    return result;
}

std::string to_json(const ReportModel& model) {
    if (const auto found = problems(model); !found.empty()) throw std::invalid_argument("report: " + found.front());
    return model_json(model).dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace morphodesic::reports
