#include "pipeline/shape_cache.h"

#include <utility>

namespace morphodesic::pipeline {

template <int Dim>
ImportedShape<Dim> stored_shape(StoredShape row, const ResultStore& store) {
    ImportedShape<Dim> shape;
    shape.row = std::move(row);
    ScalarField<Dim> mask;
    shape.level_set = std::make_shared<const LevelSet<Dim>>(store.level_set<Dim>(shape.row.content_digest, &mask));
    if (!mask.values.empty()) shape.mask = std::make_shared<const ScalarField<Dim>>(std::move(mask));
    return shape;
}

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
    StoredShape row;
    row.content_digest = digest;
    ImportedShape<Dim> shape = stored_shape<Dim>(std::move(row), store_);
    insert(digest, shape);
    return shape;
}

template ImportedShape<2> stored_shape<2>(StoredShape, const ResultStore&);
template ImportedShape<3> stored_shape<3>(StoredShape, const ResultStore&);
template class ShapeCache<2>;
template class ShapeCache<3>;

}  // namespace morphodesic::pipeline
