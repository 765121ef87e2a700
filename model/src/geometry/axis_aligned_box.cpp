#include <fmt/format.h>

#include "fringe/bounding_volume.hpp"
#include "fringe/error.hpp"

namespace fringe {

Eigen::AlignedBox3d axis_aligned_box(std::span<const Eigen::Vector3d> vertices) {
  if (vertices.empty())
    throw InputError("there are no vertices to bound");
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (!vertices[i].allFinite())
      throw InputError(fmt::format("vertex {} is not finite", i));
    box.extend(vertices[i]);
  }
  return box;
}

}  // namespace fringe
