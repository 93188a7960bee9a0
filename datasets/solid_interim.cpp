#include "datasets/import.h"
namespace morphodesic::datasets {
template <>
RawShape<3> read_shape<3>(const ShapeSource& source, const ImportOptions&) {
    throw ReadError(source.path, "this build reads no 3D shapes", "use one that does");
}
}  // namespace morphodesic::datasets
