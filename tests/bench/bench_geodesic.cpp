// Times the solver with Google Benchmark. Every case states what it reached: energy E of (14), path length, error bar.
// Usage: bench_geodesic [--benchmark_filter=REGEX] [--benchmark_out=FILE --benchmark_out_format=json]
#include <benchmark/benchmark.h>
#include <oneapi/tbb/global_control.h>

#include "datasets/synthetic.h"
#include "geodesic/discrete_geodesic.h"
#include "tests/support/path_problems.h"

namespace {

using namespace morphodesic;

/// Letters of DejaVu Sans Bold in the unit square, height about 0.6, as signed distances.
std::vector<LevelSet<2>> letters_of(const std::string& characters, const std::vector<std::filesystem::path>& fonts,
                                    int level) {
    datasets::LettersOptions options;
    options.characters = characters;
    options.fonts = fonts;
    options.count = static_cast<int>(characters.size() * fonts.size());
    options.variation = 0.0;
    std::vector<LevelSet<2>> shapes;
    for (const auto& drawing : datasets::letters(options)) {
        shapes.push_back(datasets::shape_of(drawing, level).level_set);
    }
    return shapes;
}

const std::filesystem::path dejavu = "/usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf";

template <int Dim>
void state_result(benchmark::State& state, const GeodesicResult<Dim>& result) {
    state.counters["E"] = result.total_energy;
    state.counters["length"] = result.path_length;
    state.counters["error_bar"] = result.error;
    state.counters["extrapolated"] = result.extrapolated_length;
    state.counters["min_det"] = result.min_det;
    double evaluations = 0.0;
    for (const auto& l : result.levels) evaluations += l.level == result.options.level ? l.evaluations : 0;
    state.counters["evaluations"] = evaluations;
    if (result.termination != Termination::converged) state.SkipWithError(to_string(result.termination));
}

/// Energy and gradient on dense cells, one core, in double precision and in that of the minimiser: the counter is the
/// time per quadrature point.
template <int Dim, class T>
void energy_and_gradient(benchmark::State& state) {
    const oneapi::tbb::global_control one(oneapi::tbb::global_control::max_allowed_parallelism, 1);
    const int level = static_cast<int>(state.range(0)), steps = 4;
    tests::PathProblem<Dim> problem(level, steps, GeodesicOptions{});
    std::vector<T> gradient(problem.x.size());
    for (auto _ : state) {
        if constexpr (std::is_same_v<T, float>) {
            benchmark::DoNotOptimize(problem.energy.evaluate_single(problem.x, gradient).total);
        } else {
            benchmark::DoNotOptimize(problem.energy.evaluate(problem.x, gradient).total);
        }
    }
    const double points =
        steps * static_cast<double>(problem.energy.layout().grid.cell_count() *
                                    kernels::quadrature_points<Dim>(problem.energy.quadrature()).size());
    state.counters["per_point"] =
        benchmark::Counter(points, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK_TEMPLATE(energy_and_gradient, 2, double)->Arg(6)->Arg(8)->Unit(benchmark::kMillisecond);
BENCHMARK_TEMPLATE(energy_and_gradient, 2, float)->Arg(6)->Arg(8)->Unit(benchmark::kMillisecond);
BENCHMARK_TEMPLATE(energy_and_gradient, 3, double)->Arg(5)->Arg(6)->Unit(benchmark::kMillisecond);
BENCHMARK_TEMPLATE(energy_and_gradient, 3, float)->Arg(5)->Arg(6)->Unit(benchmark::kMillisecond);

/// A to B: level, time steps, 10^5 times the tolerance; all cores.
void letters_a_to_b(benchmark::State& state) {
    const auto shapes = letters_of("AB", {dejavu}, static_cast<int>(state.range(0)));
    GeodesicOptions options;
    options.level = static_cast<int>(state.range(0));
    options.time_steps = static_cast<int>(state.range(1));
    options.tolerance = 1e-5 * static_cast<double>(state.range(2));
    GeodesicResult<2> result;
    for (auto _ : state) result = compute_discrete_geodesic<2>(shapes[0], shapes[1], options);
    state_result(state, result);
}
BENCHMARK(letters_a_to_b)
    ->Args({5, 8, 300})
    ->Args({6, 8, 300})
    ->Args({7, 8, 300})
    ->Args({8, 8, 300})
    ->Args({8, 8, 200})
    ->Args({8, 8, 100})
    ->Args({8, 8, 20})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

/// All pairs of A, B, M, X in three fonts, L = 6, on one core: time steps, 10^5 times the tolerance.
void letters_throughput(benchmark::State& state) {
    const oneapi::tbb::global_control one(oneapi::tbb::global_control::max_allowed_parallelism, 1);
    const std::filesystem::path folder = "/usr/share/fonts/truetype/";
    const auto shapes = letters_of(
        "ABMX", {dejavu, folder / "dejavu/DejaVuSerif.ttf", folder / "liberation/LiberationSans-Regular.ttf"}, 7);
    GeodesicOptions options;
    options.time_steps = static_cast<int>(state.range(0));
    options.tolerance = 1e-5 * static_cast<double>(state.range(1));
    double energy = 0.0;
    int pairs = 0;
    for (auto _ : state) {
        energy = 0.0;
        pairs = 0;
        for (std::size_t i = 0; i < shapes.size(); ++i) {
            for (std::size_t j = 0; j < i; ++j, ++pairs) {
                energy += compute_discrete_geodesic<2>(shapes[i], shapes[j], options).total_energy;
            }
        }
    }
    state.counters["mean_E"] = energy / pairs;
    state.counters["pairs_per_core_second"] = benchmark::Counter(pairs, benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(letters_throughput)  // few steps, and the preset standard
    ->Args({4, 100})
    ->Args({8, 500})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);

/// Two boxes turned against each other and stretched, 3D: level, K = 4; all cores.
void solids(benchmark::State& state) {
    const int level = static_cast<int>(state.range(0));
    const auto a = tests::turned_box<3>(level, {0.25, 0.12, 0.1}, {0.5, 0.5, 0.5}, 0.0);
    const auto b = tests::turned_box<3>(level, {0.2, 0.16, 0.14}, {0.5, 0.5, 0.5}, 0.4);
    GeodesicOptions options;
    options.level = level;
    options.time_steps = 4;
    options.tolerance = 1e-3;
    GeodesicResult<3> result;
    for (auto _ : state) result = compute_discrete_geodesic<3>(a, b, options);
    state_result(state, result);
}
BENCHMARK(solids)->Arg(5)->Arg(6)->Arg(7)->UseRealTime()->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
