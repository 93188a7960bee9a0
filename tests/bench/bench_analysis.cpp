// Times every part of a study of n items with 20 planted groups: one JSON line per part, with the processor time of all
// threads beside the wall clock, which says little on a busy machine.
// usage: bench_analysis [n] [share of missing distances in per cent]
#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>

#include "analysis/comparison.h"
#include "analysis/random.h"
#include "analysis/study.h"

int main(int argc, char** argv) {
    using namespace morphodesic::analysis;
    const std::size_t n = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 2000;
    const double missing_share = argc > 2 ? std::atof(argv[2]) / 100.0 : 0.0;
    constexpr std::size_t groups = 20, dimensions = 8;
    Random random(1);
    std::vector<double> centre(groups * dimensions), point(n * dimensions);
    for (double& c : centre) c = 3.0 * random.normal();
    std::vector<std::string> labels;
    AnalysisInput input;
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t a = 0; a < dimensions; ++a) {
            point[i * dimensions + a] = centre[i % groups * dimensions + a] + random.normal();
        }
        labels.push_back("shape" + std::to_string(i) + ".png");
        input.classes.push_back("class" + std::to_string(i % groups));
    }
    DistanceMatrix matrix(labels);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = i + 1; j < n; ++j) {
            double square = 0.0;
            for (std::size_t a = 0; a < dimensions; ++a) {
                square += std::pow(point[i * dimensions + a] - point[j * dimensions + a], 2);
            }
            const double d = std::sqrt(square) * (1.0 + 0.1 * random.uniform());
            if (random.uniform() >= missing_share) matrix.set(i, j, d, 0.05 * d);
        }
    }
    AnalysisOptions options;
    options.diffuse = true;
    const auto print = [&](const std::string& part, double seconds, double processor_seconds) {
        std::printf(
            "{\"case\":\"analysis/%s\",\"size\":%zu,\"median_ns\":%.0f,\"processor_ns\":%.0f,\"compiler\":\"%s\"}\n",
            part.c_str(), n, 1e9 * seconds, 1e9 * processor_seconds, __VERSION__);
    };
    const auto processor = [] { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; };
    std::vector<double> marks;  // processor time at the beginning of each part
    input.proceed = [&](const char*) {
        marks.push_back(processor());
        return true;
    };
    const auto begin = std::chrono::steady_clock::now();
    const auto since = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(); };
    const AnalysisResult result = analyse(matrix, options, input);
    const double all = since();
    marks.push_back(processor());
    for (std::size_t p = 0; p < result.seconds.size(); ++p) {
        print(result.seconds[p].part, result.seconds[p].seconds, marks[p + 1] - marks[p]);
    }
    print("all", all, marks.back() - marks.front());
    (void)compare(matrix, result.distances, 5, 99, 1);
    print("comparison, 99 permutations", since() - all, processor() - marks.back());
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    std::printf("{\"case\":\"analysis/memory\",\"size\":%zu,\"peak_megabytes\":%.0f}\n", n,
                static_cast<double>(usage.ru_maxrss) / 1024.0);
    for (const std::string& remark : result.remarks) std::fprintf(stderr, "%s\n", remark.c_str());
    for (const EmbeddingResult& e : result.embeddings) {
        std::fprintf(stderr, "%s %zuD stress %.4f after %zu iterations\n", e.method.c_str(), e.embedding.dimensions,
                     e.stress, e.iterations);
    }
    std::fprintf(stderr, "clusters %zu, 1-NN %.3f, stability %.3f\n", cluster_count(result.clusterings[0].clusters),
                 result.class_results.empty() ? 0.0 : result.class_results[0].nearest[0].accuracy,
                 result.stability.mean_rand);
}
