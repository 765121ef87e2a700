#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include <Eigen/Core>

#include "fringe/capacitance.hpp"
#include "fringe/rectangle.hpp"
#include "fringe/triangle.hpp"

namespace fringe {

namespace detail {
struct SurfaceNodes;
}

/// The work done for an integral over a surface. Every triangle is evaluated, lumped or skipped.
struct TreeCounts {
  std::size_t triangles_evaluated = 0;  ///< triangles integrated one by one
  std::size_t triangles_lumped = 0;     ///< triangles represented by the quadrature of a node
  std::size_t triangles_skipped = 0;    ///< triangles without area, or not among the faces that count
  std::size_t nodes_lumped = 0;         ///< nodes whose quadrature was used
  std::size_t nodes_visited = 0;        ///< nodes visited
  std::size_t points = 0;               ///< points of all quadratures used
};

/// ∫dA/d over a surface.
struct TreeIntegral {
  double value = 0;  ///< m; +infinity if the surface touches the plate so that the integral diverges
  double bound = 0;  ///< m; the error of the value is at most this, besides rounding
  TreeCounts counts;
};

/// A surface of many triangles, prepared once for ∫dA/d to any plates: distant or small groups of triangles
/// are replaced by a few quadrature points each, as far as a proven error bound allows (model/NUMERICS.md,
/// section 11).
///
/// The tree is stored in the surface's own frame. When the surface moves, give the plate in that frame; the
/// tree does not change.
class SurfaceTree {
 public:
  /// Builds the tree. Throws InputError when there are no triangles, or a vertex is not finite.
  explicit SurfaceTree(std::span<const Triangle> triangles);
  ~SurfaceTree();
  SurfaceTree(SurfaceTree&&) noexcept;
  SurfaceTree& operator=(SurfaceTree&&) noexcept;
  SurfaceTree(const SurfaceTree&) = delete;
  SurfaceTree& operator=(const SurfaceTree&) = delete;

  /// Computes the sum of plate_integral over the triangles whose faces count, with bound ≤ tolerance·(the
  /// sum)
  /// + allowance (m). If both are zero, every triangle is integrated on its own. Throws InputError when the
  /// plate is not a rectangle, or tolerance or allowance are negative or not finite.
  TreeIntegral integrate(const Rectangle& plate, double tolerance, double allowance = 0,
                         FaceRule faces = FaceRule::all) const;

  std::size_t triangle_count() const { return triangle_count_; }

 private:
  std::size_t triangle_count_;
  std::unique_ptr<const detail::SurfaceNodes> nodes_;
};

}  // namespace fringe
