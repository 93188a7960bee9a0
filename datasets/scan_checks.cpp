#include "datasets/scan_checks.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "datasets/interruption.h"
#include "datasets/note_text.h"
#include "datasets/principal_axes.h"
#include "datasets/read_error.h"

namespace morphodesic::datasets {
namespace {

constexpr double largest_new_share = 0.3;  // of the surface: beyond it the other side of the object is a guess

/// Extent along the thinnest direction over the extent along the longest.
double flatness(const std::vector<Vector3>& points) {
    const PrincipalAxes axes = principal_axes(points.size(), [&](std::size_t i) { return points[i]; });
    Eigen::Vector3d low = Eigen::Vector3d::Constant(1e300), high = -low;
    for (const auto& p : points) {
        const Eigen::Vector3d q = axes.along(p - axes.mean);
        low = low.cwiseMin(q);
        high = high.cwiseMax(q);
    }
    const Eigen::Vector3d extent = high - low;
    return extent.maxCoeff() > 0 ? extent.minCoeff() / extent.maxCoeff() : 0.0;
}

/// About so many pieces, evenly spread over the triangles.
std::vector<Piece> pieces_of(const TriangleMesh& mesh, std::size_t wanted) {
    std::vector<Piece> result;
    for (std::size_t t = 0; t < mesh.triangles.size(); t += mesh.triangles.size() / wanted + 1) {
        const auto c = mesh.corners(t);
        const Vector3 n = area_vector(c);
        if (norm(n) > 0) result.push_back({(1.0 / 3.0) * (c[0] + c[1] + c[2]), (1.0 / norm(n)) * n, 0.5 * norm(n)});
    }
    return result;
}

}  // namespace

void refuse_flat(const std::vector<Vector3>& points, const std::filesystem::path& file) {
    if (flatness(points) < 1e-5) {
        throw ReadError(file, "the surface is flat (all points lie in one plane), so it encloses no volume",
                        "use a scan of a solid, or draw the outline as an image for a study in 2D");
    }
}

void note_strays(const Strays& strays, const char* noun, const char* whole, std::vector<std::string>& notes) {
    if (strays.count == 0) return;
    notes.push_back("Left out " + count(strays.count, noun) + " far from the object (" +
                    number(100.0 * strays.share, "%.2g") + " % of the " + whole + ").");
}

NewSurface new_surface(const TriangleMesh& rebuilt, const std::function<bool(const Piece&, double&)>& is_new) {
    const std::vector<Piece> pieces = pieces_of(rebuilt, 6000);
    std::vector<double> gap(pieces.size(), -1.0);
    tbb::parallel_for(std::size_t{0}, pieces.size(), [&](std::size_t i) {
        interruption_point();
        double distance = 0.0;
        if (is_new(pieces[i], distance)) gap[i] = 2.0 * distance;
    });
    NewSurface result;
    double area = 0.0, new_area = 0.0;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        area += pieces[i].area;
        if (gap[i] >= 0) new_area += pieces[i].area, result.gap = std::max(result.gap, gap[i]);
    }
    result.share = area > 0 ? new_area / area : 0.0;
    return result;
}

double least_gap(double cell, double spacing) {
    return std::max(1.5 * cell, 2.0 * spacing);
}

void judge_new_surface(const NewSurface& made, double size, const std::filesystem::path& file,
                       const SolidifyOptions& options, std::vector<std::string>& notes) {
    if (made.share > largest_new_share && options.close_gaps < 1.0) {
        throw ReadError(file,
                        "the scan shows one side only, or has too wide openings: closing it would invent " +
                            percent(made.share) + " of the surface (limit " + percent(largest_new_share) + ")",
                        "use a scan from all sides or join the views first; --close-gaps 1 closes it all the same");
    }
    if (made.gap > options.close_gaps * size) {
        throw ReadError(file,
                        "the surface has a hole " + percent(made.gap / size) +
                            " of the object's size wide, more than " + "--close-gaps allows (" +
                            percent(options.close_gaps) + ")",
                        "repair the scan, or raise --close-gaps if the hole may be closed smoothly");
    }
    if (made.share > 0.0005) {
        notes.push_back("Holes were closed: " + percent(made.share) + " of the surface is new, the widest gap is " +
                        percent(made.gap / size) + " of the object's size.");
    }
}

}  // namespace morphodesic::datasets
