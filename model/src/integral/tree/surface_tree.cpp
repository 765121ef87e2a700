#include "fringe/surface_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "fringe/error.hpp"
#include "fringe/plate_integral.hpp"
#include "integral/batch/choices.hpp"
#include "integral/batch/chunks.hpp"
#include "integral/facing.hpp"
#include "integral/tree/build.hpp"
#include "integral/tree/node.hpp"
#include "integral/tree/node_bound.hpp"
#include "integral/tree/point_sum.hpp"
#include "simd/dispatch.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

/// The accuracy required of an integral over a surface.
struct TreeAccuracy {
  double tolerance;  ///< largest error relative to the integral
  double allowance;  ///< additional error allowed, m
};

/// An open node: neither replaced by a quadrature (lumped) nor split yet.
struct Visit {
  std::size_t node;
  Placement placement;
  double share;  ///< lower bound of the node's integral, provided that all of its faces count
  bool mixed;    ///< whether some of its faces may not count
};

/// Sums of the shares of open nodes.
struct Shares {
  double all = 0;
  double certain = 0;  ///< sum over the nodes all of whose faces count

  void add(const Visit& visit) {
    all += visit.share;
    certain += visit.mixed ? 0 : visit.share;
  }
  void remove(const Visit& visit) {
    all -= visit.share;
    certain -= visit.mixed ? 0 : visit.share;
  }
};

/// Computes the corners of a plate.
std::array<Vector3d, 4> corners(const Rectangle& plate) {
  return {plate.corner, plate.corner + plate.edge_u, plate.corner + plate.edge_v,
          plate.corner + plate.edge_u + plate.edge_v};
}

/// How many of a node's faces see the plate.
enum class Seen { all, some, none };

/// Decides how many of a node's faces see the plate, from the node's sphere and the cone of its normals n.
/// For a point p of the surface and a corner q of the plate, n·(q − p) differs from |q − centre|·cos(angle
/// between n and q − centre) by at most the radius.
Seen seen(const Node& node, const std::array<Vector3d, 4>& plate_corners) {
  /// Relative safety margin: far above the rounding of the angles and lengths, and small enough not to change
  /// the decision for most nodes.
  constexpr double margin = 1e-9;
  if (node.normals.cosine <= -1)
    return Seen::some;
  const double spread = std::acos(std::min(node.normals.cosine, 1.0)) + margin;
  const double radius = node.radius * (1 + margin);
  bool none = true;
  for (const Vector3d& corner : plate_corners) {
    const Vector3d towards = corner - node.centre;
    const double distance = towards.norm();
    const double slack = margin * (distance + node.centre.norm());
    const double angle =
        distance > 0 ? std::acos(std::clamp(node.normals.axis.dot(towards) / distance, -1.0, 1.0)) : 0;
    if (distance * std::cos(std::min(angle + spread, std::numbers::pi)) > radius + slack)
      return Seen::all;
    none = none && distance * std::cos(std::max(angle - spread, 0.0)) < -(radius + slack);
  }
  return none ? Seen::none : Seen::some;
}

class Evaluation {
 public:
  Evaluation(const SurfaceNodes& tree, const Rectangle& plate, const TreeAccuracy& accuracy, FaceRule faces)
      : tree_(tree), plate_(plate), frame_(plate_frame(plate)), corners_(corners(plate)), accuracy_(accuracy),
        faces_(faces), points_(kernels_, frame_) {}

  TreeIntegral run() && {
    if (tree_.nodes.empty())
      return result_;
    if (accuracy_.tolerance == 0 && accuracy_.allowance == 0) {
      add_direct({0, tree_.triangles.size()}, faces_ == FaceRule::facing);
      integrate_direct(0);
      return result_;
    }
    visit(0, open_);
    while (!open_.empty())
      descend();
    finish_leaves();
    result_.value += points_.sum();
    return result_;
  }

 private:
  /// Appends a node to the visits unless none of its faces sees the plate.
  void visit(std::size_t index, std::vector<Visit>& visits) {
    const Node& node = tree_.nodes[index];
    ++result_.counts.nodes_visited;
    Seen faces = Seen::all;
    if (faces_ == FaceRule::facing)
      faces = seen(node, corners_);
    if (faces == Seen::none) {
      result_.counts.triangles_skipped += node.triangles.count;
      return;
    }
    const Placement placement = place(frame_, node.centre);
    visits.push_back({index, placement, node.area / (placement.distance + node.radius), faces == Seen::some});
  }

  /// Computes the error that open nodes may still add, per unit of their shares.
  double error_per_share(const Shares& open) const {
    return (accuracy_.allowance + accuracy_.tolerance * (lumped_share_ + open.certain) - result_.bound) /
           open.all;
  }

  /// Lumps the open nodes whose errors are within their shares of the tolerance, and opens the children of
  /// the others.
  void descend() {
    Shares shares = leaf_shares_;
    for (const Visit& visit : open_)
      shares.add(visit);
    const double rate = error_per_share(shares);
    next_.clear();
    for (const Visit& current : open_) {
      const Node& node = tree_.nodes[current.node];
      if (!current.mixed && lump_within(current, rate * current.share))
        continue;
      if (node.first_child == no_child) {
        leaves_.push_back(current);
        leaf_shares_.add(current);
        continue;
      }
      visit(node.first_child, next_);
      visit(node.first_child + 1, next_);
    }
    std::swap(open_, next_);
  }

  /// Replaces a node by a quadrature whose error is at most `allowed`. Returns false if there is none.
  bool lump_within(const Visit& current, double allowed) {
    const Node& node = tree_.nodes[current.node];
    const std::optional<Lump> found = lump(frame_, current.placement, node, allowed);
    if (!found)
      return false;
    const Range& quadrature = node.quadratures[found->quadrature];
    result_.counts.points += quadrature.count;
    if (quadrature_degrees[found->quadrature] == 1)
      result_.value += node.area / current.placement.distance;
    else
      points_.add(tree_.points, quadrature);
    settle(current.share, found->error);
    ++result_.counts.nodes_lumped;
    result_.counts.triangles_lumped += node.triangles.count;
    return true;
  }

  /// Accounts for a lumped node with this share and error.
  void settle(double share, double error) {
    result_.bound += error;
    lumped_share_ += share;
  }

  /// Integrates the leaves that could not be lumped: by the points of their triangles where the remaining
  /// tolerance allows, otherwise triangle by triangle. Leaves at the plate's borders come last, because they
  /// can use whatever tolerance remains.
  void finish_leaves() {
    Shares open = leaf_shares_;
    std::vector<Visit> at_borders;
    for (const Visit& current : leaves_) {
      const Node& leaf = tree_.nodes[current.node];
      const double error = trianglewise_error(current.placement, leaf);
      if (current.mixed || !(error <= error_per_share(open) * current.share)) {
        add_direct(leaf.triangles, current.mixed);
        direct_share_ += current.mixed ? 0 : current.share;
      } else if (std::min(current.placement.border_u, current.placement.border_v) <
                 leaf.trianglewise.reach + leaf.trianglewise.largest_radius) {
        at_borders.push_back(current);
      } else {
        settle(current.share, error);
        open.remove(current);
        add_points(leaf.triangles);
        ++result_.counts.nodes_lumped;
      }
    }
    for (const Visit& current : at_borders)
      finish_at_border(current, open);
    integrate_direct(remaining_tolerance());
  }

  /// Integrates a leaf that a border plane crosses. Triangles whose errors exceed the leaf's part of the
  /// tolerance are integrated one by one, and their own part of the tolerance is not available to the others.
  void finish_at_border(const Visit& current, Shares& open) {
    const Node& leaf = tree_.nodes[current.node];
    const auto& [first, count] = leaf.triangles;
    std::array<double, most_triangles_in_leaf> errors;
    border_errors(frame_, current.placement, leaf, tree_.triangle_points, errors.data());
    const double share_each = current.share / static_cast<double>(count);
    const double allowed_each = error_per_share(open) * share_each;
    double error = trianglewise_error(current.placement, leaf),
           allowed = allowed_each * static_cast<double>(count);
    std::size_t run = 0, direct = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (error + errors[i] <= allowed) {
        error += errors[i];
        continue;
      }
      allowed -= allowed_each;
      ++direct;
      add_points({first + run, i - run});
      add_direct({first + i, 1}, false);
      run = i + 1;
    }
    add_points({first + run, count - run});
    Visit lumped = current;
    lumped.share = share_each * static_cast<double>(count - direct);
    direct_share_ += current.share - lumped.share;
    settle(lumped.share, error);
    open.remove(lumped);
  }

  /// Adds the points of triangles to the sum.
  void add_points(const Range& triangles) {
    if (triangles.count == 0)
      return;
    const Range range{points_per_triangle * triangles.first, points_per_triangle * triangles.count};
    points_.add(tree_.triangle_points, range);
    result_.counts.points += range.count;
    result_.counts.triangles_lumped += triangles.count;
  }

  /// Computes the tolerance that the lumped nodes have not used, relative to the whole integral. Any part of
  /// the integral may use it.
  double remaining_tolerance() const {
    const double used = std::max(result_.bound - accuracy_.allowance, 0.0);
    return used > 0 ? std::max(accuracy_.tolerance - used / (lumped_share_ + direct_share_), 0.0)
                    : accuracy_.tolerance;
  }

  /// Appends triangles to those that are integrated one by one. `mixed` means that some of them may not
  /// count.
  void add_direct(const Range& triangles, bool mixed) {
    if (mixed) {
      for (std::size_t i = triangles.first; i < triangles.first + triangles.count; ++i) {
        if (counts(tree_.triangles[i]))
          add_direct({i, 1}, false);
        else
          ++result_.counts.triangles_skipped;
      }
      return;
    }
    result_.counts.triangles_evaluated += triangles.count;
    if (!direct_.empty() && direct_.back().first + direct_.back().count == triangles.first)
      direct_.back().count += triangles.count;
    else
      direct_.push_back(triangles);
  }

  void integrate_direct(double tolerance) {
    const auto& [relative_error, choices] = sum_choices(tolerance);
    const double sum = sum_ranges(kernels_, tree_.triangles, direct_, frame_, choices.choices());
    result_.value += sum;
    result_.bound = std::isinf(sum) ? 0.0 : result_.bound + bound_of_sum(sum, relative_error);
  }

  bool counts(const Triangle& triangle) const {
    const Sight sight = detail::sight(triangle, plate_);
    return sight == Sight::outward ||
           (sight == Sight::grazing && std::isinf(plate_integral(triangle, plate_)));
  }

  const SurfaceNodes& tree_;
  const Rectangle& plate_;
  const BatchKernels& kernels_ = best_kernels<BatchKernels>();
  PlateFrame frame_;
  std::array<Vector3d, 4> corners_;
  TreeAccuracy accuracy_;
  FaceRule faces_;
  PointSum points_;
  TreeIntegral result_;
  double lumped_share_ = 0;
  double direct_share_ = 0;  ///< share of the triangles that are integrated one by one and certainly count
  Shares leaf_shares_;
  std::vector<Visit> open_, next_, leaves_;
  std::vector<Range> direct_;
};

TreeIntegral evaluate(const SurfaceNodes& tree, const Rectangle& plate, const TreeAccuracy& accuracy,
                      FaceRule faces) {
  return Evaluation(tree, plate, accuracy, faces).run();
}

}  // namespace
}  // namespace fringe::detail

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
