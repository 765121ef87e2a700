#include "fringe/surface_tree.hpp"

#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "fringe/error.hpp"
#include "integral/tree/build.hpp"
#include "integral/tree/evaluate.hpp"

namespace fringe {
namespace {

void validate(std::span<const Triangle> triangles) {
  if (triangles.empty())
    throw InputError("a surface needs triangles");
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (std::size_t j = 0; j < 3; ++j)
      if (!triangles[i][j].allFinite())
        throw InputError(fmt::format("triangle {}: vertex {} is not finite", i, j));
}

void validate(const detail::TreeAccuracy& accuracy) {
  for (const auto& [name, error] :
       {std::pair("tolerance", accuracy.tolerance), std::pair("allowance", accuracy.allowance)})
    if (!std::isfinite(error) || error < 0)
      throw InputError(fmt::format("{} {} must be finite and not negative", name, error));
}

}  // namespace

SurfaceTree::SurfaceTree(std::span<const Triangle> triangles) : triangle_count_(triangles.size()) {
  validate(triangles);
  nodes_ = std::make_unique<const detail::SurfaceNodes>(detail::build_nodes(triangles));
}

SurfaceTree::~SurfaceTree() = default;
SurfaceTree::SurfaceTree(SurfaceTree&&) noexcept = default;
SurfaceTree& SurfaceTree::operator=(SurfaceTree&&) noexcept = default;

TreeIntegral SurfaceTree::integrate(const Rectangle& plate, double tolerance, double allowance,
                                    FaceRule faces) const {
  fringe::validate(plate);
  const detail::TreeAccuracy accuracy{tolerance, allowance};
  validate(accuracy);
  TreeIntegral integral = detail::evaluate(*nodes_, plate, accuracy, faces);
  integral.counts.triangles_skipped += triangle_count_ - nodes_->triangles.size();
  return integral;
}

}  // namespace fringe
