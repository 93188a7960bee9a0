#include "pipeline/shape_cache.h"

#include <utility>

namespace morphodesic::pipeline {

template <int Dim>
void ShapeCache<Dim>::insert(const std::string& digest, ImportedShape<Dim> shape) {
    const std::size_t bytes =
        sizeof(double) * (shape.level_set->values.size() + (shape.mask ? shape.mask->values.size() : 0));
    const std::scoped_lock lock(mutex_);
    if (entries_.contains(digest)) return;
    order_.push_front(digest);
    entries_.emplace(digest, Entry{std::move(shape), bytes, order_.begin()});
    bytes_ += bytes;
    while (bytes_ > limit_ && order_.size() > 1) {
        const auto last = entries_.find(order_.back());
        bytes_ -= last->second.bytes;
        entries_.erase(last);
        order_.pop_back();
    }
}

template <int Dim>
void ShapeCache<Dim>::keep(const ImportedShape<Dim>& shape) {
    ImportedShape<Dim> kept;
    kept.row.content_digest = shape.row.content_digest;
    kept.level_set = shape.level_set;
    kept.mask = shape.mask;
    insert(kept.row.content_digest, std::move(kept));
}

template <int Dim>
ImportedShape<Dim> ShapeCache<Dim>::get(const std::string& digest) {
    {
        const std::scoped_lock lock(mutex_);
        const auto found = entries_.find(digest);
        if (found != entries_.end()) {
            order_.splice(order_.begin(), order_, found->second.used);
            return found->second.shape;
        }
    }
    ImportedShape<Dim> shape;
    shape.row.content_digest = digest;
    ScalarField<Dim> mask;
    shape.level_set = std::make_shared<const LevelSet<Dim>>(store_.level_set<Dim>(digest, &mask));
    if (!mask.values.empty()) shape.mask = std::make_shared<const ScalarField<Dim>>(std::move(mask));
    insert(digest, shape);
    return shape;
}

template class ShapeCache<2>;
template class ShapeCache<3>;

}  // namespace morphodesic::pipeline
