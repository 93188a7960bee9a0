#include "pipeline/pair_graph.h"

#include <tbb/flow_graph.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <new>
#include <optional>
#include <set>

#include "datasets/interruption.h"
#include "pipeline/shape_cache.h"
#include "pipeline/whole_tasks.h"

namespace morphodesic::pipeline {
namespace {

/// What the serial node `schedule` knows: the shapes that have arrived. Once all have, it lists what is missing.
template <int Dim>
class Scheduler {
public:
    Scheduler(const Collection& collection, ResultStore& store, const PairGraphOptions& options, Progress& progress,
              PairGraphSummary& summary)
        : store_(store),
          options_(options),
          progress_(progress),
          summary_(summary),
          waiting_(collection.entries.size()),
          cache_(store, options.shape_bytes) {}

    /// Returns the missing geodesics with the last shape, before that nothing.
    std::vector<GeodesicKey> arrive(const ImportedShape<Dim>& shape) {
        if (shape.level_set) {
            begin();
            if (shape.fresh) {
                const ScalarField<Dim> no_mask;
                store_.put_level_set<Dim>(shape.row.content_digest, *shape.level_set,
                                          shape.mask ? *shape.mask : no_mask);
            }
            ++summary_.shapes;
            add_shape(shapes_, shape.row.content_digest, traits_of(shape.row, shape.mask != nullptr));
            cache_.keep(shape);
        } else {
            ++summary_.shapes_failed;
            summary_.unusable.push_back(shape.row);
            progress_.message("left out: " + shape.row.problem);
        }
        if (begun_) put(shape.row);
        return --waiting_ == 0 ? missing() : std::vector<GeodesicKey>();
    }

    [[nodiscard]] ImportedShape<Dim> shape(const std::string& digest) { return cache_.get(digest); }

private:
    void begin() {
        if (begun_) return;
        begun_ = true;
        if (options_.begin) options_.begin();
        for (const StoredShape& row : summary_.unusable) put(row);
    }

    /// A damaged row stays as it is until its file is read again: sealed anew it would pass for sound.
    void put(const StoredShape& row) {
        if (!row.damaged) store_.put_shape(row);
    }

    std::vector<GeodesicKey> missing() {
        if (!begun_) return {};
        end_reading(store_);
        store_.remove_unused_level_sets();
        if (!options_.solve) return {};
        std::size_t damaged = 0;
        const auto stored = store_.stored_pairs(settings_hash(options_.geodesic),
                                                [&](const std::string&, const std::string&) { ++damaged; });
        if (damaged > 0) {
            progress_.message(store_.file().string() + ": the stored results of " + std::to_string(damaged) +
                              (damaged == 1 ? " pair are damaged; it is" : " pairs are damaged; they are") +
                              " computed again");
        }
        std::vector<GeodesicKey> missing;
        for (GeodesicKey& key : wanted_geodesics(shapes_, options_.both_directions)) {
            if (options_.only && !options_.only->contains(key)) continue;
            ++summary_.pairs_total;
            if (stored.contains(key)) {
                ++summary_.pairs_stored;
            } else {
                missing.push_back(std::move(key));
            }
        }
        const auto count = static_cast<long>(missing.size());
        progress_.begin_pairs(summary_.pairs_total, summary_.pairs_stored, count, options_.pairs_in_flight);
        return missing;
    }

    ResultStore& store_;
    const PairGraphOptions& options_;
    Progress& progress_;
    PairGraphSummary& summary_;
    std::size_t waiting_;
    bool begun_ = false;  // the store may be changed
    DifferentShapes shapes_;
    ShapeCache<Dim> cache_;
};

/// Comes after all nodes of a graph, so that nothing runs any more when they go. An exception that leaves the thread
/// which waits, such as that of a thread that cannot be started, does not wait for the tasks by itself.
class EndOfGraph {
public:
    explicit EndOfGraph(tbb::flow::graph& graph) : graph_(graph) {}
    ~EndOfGraph() {
        graph_.cancel();
        for (bool idle = false; !idle;) {
            try {
                graph_.wait_for_all();
                idle = true;
            } catch (...) {
                // Of a task, or another thread that cannot be started. The tasks that are left only end.
            }
        }
    }
    EndOfGraph(const EndOfGraph&) = delete;
    EndOfGraph& operator=(const EndOfGraph&) = delete;

private:
    tbb::flow::graph& graph_;
};

}  // namespace

template <int Dim>
StoredGeodesic solve_pair(const ImportedShape<Dim>& a, const ImportedShape<Dim>& b, const GeodesicOptions& options,
                          const std::function<bool()>& stop, GeodesicResult<Dim>* path) {
    StoredGeodesic failed;
    failed.a = a.row.content_digest;
    failed.b = b.row.content_digest;
    failed.settings_hash = settings_hash(options);
    if (failed.a == failed.b) {  // nothing to solve: the distance of a shape to itself is 0
        StoredGeodesic zero = failed;
        zero.message = "the two shapes are equal";
        zero.min_det = 1.0;
        zero.deformation_energy.assign(static_cast<std::size_t>(options.time_steps), 0.0);
        zero.mismatch_energy = zero.deformation_energy;
        return zero;
    }
    try {
        const ScalarField<Dim> known_everywhere;
        GeodesicResult<Dim> result = run_whole([&] {
            return compute_discrete_geodesic<Dim>(*a.level_set, *b.level_set, options,
                                                  a.mask ? *a.mask : known_everywhere,
                                                  [&](const LevelReport&) { return !(stop && stop()); });
        });
        StoredGeodesic record = to_record(result, failed.a, failed.b, failed.settings_hash);
        if (path) *path = std::move(result);
        return record;
    } catch (const std::bad_alloc&) {
        failed.failure = "not enough memory; choose a lower --level or fewer --threads, and --retry-failed";
    } catch (const std::exception& error) {
        failed.failure = error.what();
    }
    return failed;
}

template <int Dim>
PairGraphSummary run_pair_graph(const Collection& collection, ResultStore& store, const PairGraphOptions& options,
                                Progress& progress) {
    namespace flow = tbb::flow;
    PairGraphSummary summary;
    std::atomic<bool> abandoned{false};
    const auto stop = [&] { return abandoned.load() || (options.stop && options.stop()); };
    // A store that fails must not leave threads busy with pairs that nobody can record.
    const auto guarded = [&](auto&& body) {
        try {
            return body();
        } catch (...) {
            abandoned = true;
            throw;
        }
    };

    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(options.threads));
    tbb::task_arena arena(options.threads);
    arena.execute([&] {
        Scheduler<Dim> scheduler(collection, store, options, progress, summary);
        const std::size_t count = collection.entries.size();
        std::size_t next = 0;

        flow::graph graph;
        flow::input_node<std::size_t> input(graph, [&](tbb::flow_control& control) -> std::size_t {
            if (next == count || stop()) {
                control.stop();
                return 0;
            }
            return next++;
        });
        using MaybeShape = std::optional<ImportedShape<Dim>>;
        flow::function_node<std::size_t, MaybeShape> import(
            graph, static_cast<std::size_t>(options.threads), [&](std::size_t index) {
                return guarded([&]() -> MaybeShape {
                    try {
                        return run_whole([&] { return import_entry<Dim>(collection, index, store); });
                    } catch (const datasets::Interrupted&) {
                        return std::nullopt;  // given up on request, as is all that is not begun yet
                    }
                });
            });
        flow::multifunction_node<MaybeShape, std::tuple<GeodesicKey>> schedule(
            graph, flow::serial, [&](const MaybeShape& shape, auto& ports) {
                guarded([&] {
                    if (!shape) return;
                    for (const GeodesicKey& task : scheduler.arrive(*shape)) std::get<0>(ports).try_put(task);
                });
            });
        flow::queue_node<GeodesicKey> queue(graph);
        flow::limiter_node<GeodesicKey> limiter(graph, static_cast<std::size_t>(options.pairs_in_flight));
        flow::function_node<GeodesicKey, std::optional<StoredGeodesic>> solve(
            graph, flow::unlimited, [&](const GeodesicKey& task) -> std::optional<StoredGeodesic> {
                if (stop()) return std::nullopt;
                StoredGeodesic record = guarded([&] {
                    return solve_pair<Dim>(scheduler.shape(task.first), scheduler.shape(task.second), options.geodesic,
                                           stop);
                });
                // A pair that was dropped on request is not a failure; it is simply not there yet.
                if (record.failure.empty() && record.termination == Termination::cancelled) return std::nullopt;
                return record;
            });
        flow::function_node<std::optional<StoredGeodesic>, flow::continue_msg> record(
            graph, flow::serial, [&](const std::optional<StoredGeodesic>& geodesic) {
                guarded([&] {
                    if (!geodesic) return;
                    store.put_geodesic(*geodesic);
                    ++summary.pairs_solved;
                    const bool good = geodesic->problem().empty();
                    if (!good) ++summary.pairs_failed;
                    progress.pair_done(good, geodesic->seconds);
                });
                return flow::continue_msg();
            });
        const EndOfGraph end(graph);
        flow::make_edge(input, import);
        flow::make_edge(import, schedule);
        flow::make_edge(flow::output_port<0>(schedule), queue);
        flow::make_edge(queue, limiter);
        flow::make_edge(limiter, solve);
        flow::make_edge(solve, record);
        flow::make_edge(record, limiter.decrementer());
        input.activate();
        graph.wait_for_all();
    });
    if (options.solve) progress.end_pairs();
    summary.stopped = options.stop && options.stop();
    return summary;
}

template PairGraphSummary run_pair_graph<2>(const Collection&, ResultStore&, const PairGraphOptions&, Progress&);
template PairGraphSummary run_pair_graph<3>(const Collection&, ResultStore&, const PairGraphOptions&, Progress&);
template StoredGeodesic solve_pair<2>(const ImportedShape<2>&, const ImportedShape<2>&, const GeodesicOptions&,
                                      const std::function<bool()>&, GeodesicResult<2>*);
template StoredGeodesic solve_pair<3>(const ImportedShape<3>&, const ImportedShape<3>&, const GeodesicOptions&,
                                      const std::function<bool()>&, GeodesicResult<3>*);

}  // namespace morphodesic::pipeline
