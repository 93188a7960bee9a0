#pragma once

#include "datasets/content_digest.h"
#include "datasets/folder_scan.h"
#include "datasets/import_options.h"
#include "datasets/normalize.h"
#include "datasets/raw_shape.h"
#include "datasets/read_error.h"
#include "datasets/shape.h"

/// Front door of datasets. A collection is imported in two passes, because one scale is common to all its shapes:
///   scan_folder -> read_shape each -> common_scale of the extent radii -> normalize each.
namespace morphodesic::datasets {

/// Reads a file: an image for Dim = 2; a mesh, point cloud or volume for Dim = 3.
/// @throws ReadError if the file cannot be used; the message says why and what to do
/// @throws std::invalid_argument if the options have problems
template <int Dim>
RawShape<Dim> read_shape(const ShapeSource& source, const ImportOptions& options = {});
template <>
RawShape<2> read_shape<2>(const ShapeSource& source, const ImportOptions& options);
template <>
RawShape<3> read_shape<3>(const ShapeSource& source, const ImportOptions& options);

/// read_shape and normalize in one call, for a shape that needs no scale common with others (or whose scale is known).
template <int Dim>
Shape<Dim> import_shape(const ShapeSource& source, const ImportOptions& import_options,
                        const NormalizeOptions& normalize_options) {
    return normalize(read_shape<Dim>(source, import_options), normalize_options);
}

}  // namespace morphodesic::datasets
