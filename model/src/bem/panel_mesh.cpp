#include "bem/panel_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

#include <Eigen/Geometry>

#include "bem/graded_triangles.hpp"
#include "geometry/surface_mesh.hpp"
#include "numeric/parallel.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::Vector3d;

/// Number of triangles in a group: as many as a triangle has quarters.
constexpr std::size_t group_size = 4;

/// Groups a few neighbouring, nearly coplanar triangles each; a triangle that is left alone is a group of
/// one.
std::vector<std::vector<std::size_t>> grouped(std::span<const Triangle> triangles) {
  /// Least cosine of the angle between the planes of triangles in one group: a sharp edge separates groups.
  constexpr double same_plane = 0.7;
  const auto neighbours = SurfaceMesh(triangles).neighbours();
  std::vector<Vector3d> normals, centres;
  for (const Triangle& triangle : triangles) {
    normals.push_back(unit_normal(triangle));
    centres.push_back(centre_of(triangle));
  }
  const std::size_t none = triangles.size();
  std::vector<std::size_t> group_of(triangles.size(), none);
  std::vector<std::vector<std::size_t>> groups;
  const auto flat = [&](std::size_t a, std::size_t b) {
    return std::abs(normals[a].dot(normals[b])) >= same_plane;
  };
  for (std::size_t seed = 0; seed < triangles.size(); ++seed) {
    if (group_of[seed] != none)
      continue;
    std::vector<std::size_t> members{seed};
    group_of[seed] = groups.size();
    Vector3d centre = centres[seed];
    while (members.size() < group_size) {
      std::size_t next = none;
      double nearest = 0;
      for (const std::size_t member : members)
        for (const std::size_t candidate : neighbours[member]) {
          const double away = (centres[candidate] - centre).norm();
          if (group_of[candidate] == none && flat(seed, candidate) && (next == none || away < nearest)) {
            next = candidate;
            nearest = away;
          }
        }
      if (next == none)
        break;
      group_of[next] = groups.size();
      members.push_back(next);
      centre += (centres[next] - centre) / static_cast<double>(members.size());
    }
    groups.push_back(std::move(members));
  }
  // Triangles of groups of one or two join other groups, so that each group can resolve changes of its
  // density along two directions.
  for (auto& members : groups) {
    if (members.empty() || members.size() > 2)
      continue;
    for (const std::size_t member : std::vector<std::size_t>(members))
      for (const std::size_t other : neighbours[member]) {
        auto& wider = groups[group_of[other]];
        if (group_of[other] == group_of[member] || wider.size() + 1 > group_size + 2 || !flat(member, other))
          continue;
        std::erase(members, member);
        group_of[member] = group_of[other];
        wider.push_back(member);
        break;
      }
  }
  std::erase_if(groups, [](const auto& members) { return members.empty(); });
  return groups;
}

/// Returns the triangle whose quarters are the panels of a group.
Triangle quartered_triangle(const std::vector<Panel>& panels, const PanelGroup& group) {
  return {panels[group.first].corners[0], panels[group.first + 1].corners[1],
          panels[group.first + 2].corners[2]};
}

/// Returns the middles of the sides of the triangle whose quarters are the panels of a group.
std::array<Vector3d, 3> middles_of_quartered(const std::vector<Panel>& panels, const PanelGroup& group) {
  return {panels[group.first].corners[1], panels[group.first + 1].corners[2],
          panels[group.first + 2].corners[0]};
}

/// Returns the barycentric coordinates of a triangle's quarters (rows), from those of its corners (rows).
std::array<Matrix3d, 4> quarters_of_places(const Matrix3d& corners) {
  const auto middle = [&](Index from, Index to) {
    return Eigen::RowVector3d((corners.row(from) + corners.row(to)) / 2);
  };
  const Eigen::RowVector3d a = corners.row(0), b = corners.row(1), c = corners.row(2);
  const Eigen::RowVector3d ab = middle(0, 1), bc = middle(1, 2), ca = middle(2, 0);
  std::array<Matrix3d, 4> result;
  result[0] << a, ab, ca;
  result[1] << ab, b, bc;
  result[2] << ca, bc, c;
  result[3] << ab, bc, ca;
  return result;
}

}  // namespace

/// Charges that go over to the parts of triangles, by densities that are linear on each triangle.
class PanelMesh::Carried {
 public:
  /// `choosing` are the charges by which sides are chosen, `carried` further ones.
  Carried(const MatrixXd& choosing, const MatrixXd& carried)
      : choosing_(choosing.cols()), charges_(choosing.rows(), choosing.cols() + carried.cols()) {
    charges_.leftCols(choosing_) = choosing;
    if (carried.cols() > 0)
      charges_.rightCols(carried.cols()) = carried;
  }

  /// Returns the charges of four panels in the columns that choose sides.
  MatrixXd choosing(std::size_t first) const { return charges_.block(index_of(first), 0, 4, choosing_); }

  /// Keeps the charge of a panel.
  void keep(std::size_t panel) { rows_.emplace_back(charges_.row(index_of(panel))); }

  /// Takes the densities of a panel, or of the quarters of a triangle.
  void begin(const std::vector<Panel>& panels, std::size_t first, bool is_quartered) {
    const auto density = [&](std::size_t k) {
      return RowVectorXd(charges_.row(index_of(first + k)) / panels[first + k].area);
    };
    slopes_ = MatrixXd::Zero(3, charges_.cols());
    mean_ = density(0);
    if (!is_quartered)
      return;
    // The least squares of a linear function through the means of the quarters.
    const RowVectorXd at_corners = (density(0) + density(1) + density(2)) / 3;
    for (std::size_t k = 0; k < 3; ++k)
      slopes_.row(index_of(k)) = 2 * (density(k) - at_corners);
    mean_ = (3 * at_corners + density(3)) / 4;
  }

  /// Adds the charges of a triangle's part, by the barycentric coordinates of its corners (rows).
  void add(const Matrix3d& corners, double area) { rows_.emplace_back(area * density(corners)); }

  /// Returns the charges of quarters in the columns that choose sides.
  MatrixXd of_quarters(const std::array<Triangle, 4>& quarters, const Matrix3d& places) const {
    MatrixXd result(4, choosing_);
    const std::array<Matrix3d, 4> parts = quarters_of_places(places);
    for (std::size_t k = 0; k < 4; ++k)
      result.row(index_of(k)) = twice_area(quarters[k]) / 2 * density(parts[k]).head(choosing_);
    return result;
  }

  /// Returns the further charges of the panels that were added.
  MatrixXd result() const {
    MatrixXd result(index_of(rows_.size()), charges_.cols() - choosing_);
    for (std::size_t k = 0; k < rows_.size() && result.cols() > 0; ++k)
      result.row(index_of(k)) = rows_[k].tail(result.cols());
    return result;
  }

 private:
  RowVectorXd density(const Matrix3d& corners) const {
    const Eigen::RowVector3d centre = corners.colwise().mean();
    return mean_ + centre * slopes_;
  }

  Index choosing_;
  MatrixXd charges_;
  std::vector<RowVectorXd> rows_;
  RowVectorXd mean_;
  MatrixXd slopes_;  ///< their sum vanishes
};

/// Returns points near the middles of a panel's sides, on the round shape where the body stands for one: but
/// of the sides themselves where that would make a sliver of a quarter or a half. If the corners
/// lie on a circle of the shape, the third may be where the middle of the opposite arc is.
std::array<Vector3d, 3> PanelMesh::middles(const Triangle& triangle, std::size_t body) const {
  /// Least area of a part, relative to one of a flat triangle.
  constexpr double least_area = 0.2;
  std::array<Vector3d, 3> straight = middles_of_sides(triangle);
  if (!follows_shape(body))
    return straight;
  std::array<Vector3d, 3> result;
  for (std::size_t side = 0; side < 3; ++side) {
    // The same order on both sides of an edge, so that rounding is the same too.
    const Vector3d &a = triangle[side], &b = triangle[(side + 1) % 3];
    const bool is_turned = std::lexicographical_compare(b.begin(), b.end(), a.begin(), a.end());
    result[side] = is_turned ? followed_[body]->middle(b, a) : followed_[body]->middle(a, b);
  }
  const auto is_sliver = [&](const Triangle& part, int parts) {
    return parts * twice_area(part) < least_area * twice_area(triangle);
  };
  for (const Triangle& quarter : quarters(triangle, result))
    if (is_sliver(quarter, 4))
      return straight;
  for (std::size_t side = 0; side < 3; ++side)
    for (const Triangle& half : halves(triangle, side, result[side]))
      if (is_sliver(half, 2))
        return straight;
  return result;
}

/// Returns what the distances of a panel's sides from the round shape cost, per square of its charge: as if
/// all of the panel were as far from it, in the mean along the side.
std::array<double, 3> PanelMesh::bends(const Triangle& triangle, const std::array<Vector3d, 3>& middles,
                                       std::size_t body) const {
  std::array<double, 3> result{};
  // This is the cost per charge; the panels of dielectric bodies have potentials instead.
  if (!follows_shape(body) || is_kept_closed(body))
    return result;
  const std::array<Vector3d, 3> straight = middles_of_sides(triangle);
  const double per_distance =
      followed_[body]->error_per_lack() * 4 * std::numbers::pi * 2 / 3 * 2 / twice_area(triangle);
  for (std::size_t side = 0; side < 3; ++side)
    result[side] = per_distance * (middles[side] - straight[side]).norm();
  return result;
}

void PanelMesh::add_group(const std::array<Triangle, 4>& quarters, std::size_t body) {
  groups_.push_back({panels_.size(), quarters.size(), body, true});
  for (const Triangle& quarter : quarters)
    panels_.push_back(make_panel(quarter));
  places_before_.resize(panels_.size(), no_place);
}

void PanelMesh::add_quartered(const Triangle& triangle, std::size_t body) {
  if (!is_hidden(triangle, body))
    add_group(quarters(triangle, middles(triangle, body)), body);
}

/// Adds the quarters of a triangle that is halved so many times. `places` are the barycentric coordinates of
/// its corners (rows) in the triangle with the densities.
void PanelMesh::add_parts(const Triangle& triangle, const Matrix3d& places, std::size_t body, int steps,
                          Carried& carried) {
  const std::array<Vector3d, 3> middle = middles(triangle, body);
  const std::array<Triangle, 4> parts = quarters(triangle, middle);
  if (steps == 0) {
    if (is_hidden(triangle, body))
      return;
    add_group(parts, body);
    const std::array<Matrix3d, 4> quarters = quarters_of_places(places);
    for (std::size_t k = 0; k < 4; ++k)
      carried.add(quarters[k], panels_[panels_.size() - 4 + k].area);
    return;
  }
  const std::size_t side =
      side_to_halve(triangle, carried.of_quarters(parts, places), bends(triangle, middle, body));
  add_halves(triangle, places, side, middle[side], body, steps - 1, carried);
}

void PanelMesh::add_halves(const Triangle& triangle, const Matrix3d& places, std::size_t side,
                           const Vector3d& middle, std::size_t body, int steps, Carried& carried) {
  const auto from = index_of(side), to = index_of((side + 1) % 3);
  const std::array<Triangle, 2> parts = halves(triangle, side, middle);
  for (std::size_t k = 0; k < 2; ++k) {
    Matrix3d own;
    own.row(k == 0 ? 0 : 1) = places.row(k == 0 ? from : to);
    own.row(k == 0 ? 1 : 0) = (places.row(from) + places.row(to)) / 2;
    own.row(2) = places.row(index_of((side + 2) % 3));
    add_parts(parts[k], own, body, steps, carried);
  }
}

void PanelMesh::add(std::size_t body, std::span<const Triangle> surface, const PanelGrading& grading,
                    const RoundShape* round, std::size_t threads) {
  if (round != nullptr && round->is_followed()) {
    followed_.resize(std::max(followed_.size(), body + 1));
    followed_[body] = *round;
  }
  std::vector<char> are_bare(surface.size());
  parallel_for(surface.size(), threads,
               [&](std::size_t k) { are_bare[k] = is_hidden(surface[k], body) ? 0 : 1; });
  std::vector<Triangle> triangles;
  for (std::size_t k = 0; k < surface.size(); ++k)
    if (are_bare[k] != 0)
      triangles.push_back(surface[k]);
  if (triangles.size() <= few_triangles) {
    for (Triangle& triangle :
         graded_triangles(triangles, grading.missing, grading.most_panels / group_size)) {
      if (follows_shape(body))
        for (Vector3d& corner : triangle)
          corner = followed_[body]->on_shape(corner);
      add_quartered(triangle, body);
    }
    return;
  }
  for (const std::vector<std::size_t>& members : grouped(triangles)) {
    if (members.size() == 1) {
      add_quartered(triangles[members[0]], body);
      continue;
    }
    groups_.push_back({panels_.size(), members.size(), body, false});
    for (const std::size_t member : members)
      panels_.push_back(make_panel(triangles[member]));
    places_before_.resize(panels_.size(), no_place);
  }
}

std::vector<Index> PanelMesh::group_of_panels() const {
  std::vector<Index> result(panels_.size());
  for (std::size_t group = 0; group < groups_.size(); ++group)
    for (std::size_t k = 0; k < groups_[group].count; ++k)
      result[groups_[group].first + k] = index_of(group);
  return result;
}

std::vector<Triangle> PanelMesh::triangles(const PanelGroup& group) const {
  if (group.is_quartered)
    return {quartered_triangle(panels_, group)};
  std::vector<Triangle> triangles;
  for (std::size_t member = group.first; member < group.first + group.count; ++member)
    triangles.push_back(panels_[member].corners);
  return triangles;
}

void PanelMesh::keep_closed(std::size_t body) {
  if (follows_shape(body))
    closed_.push_back(body);
}

/// Returns how to divide triangles of closed bodies of which a neighbour's side has been halved, so that its
/// middle is off their own side.
std::vector<PanelMesh::Division> PanelMesh::cracks() const {
  const auto comes_before = [](const Vector3d& a, const Vector3d& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  };
  std::set<Vector3d, decltype(comes_before)> corners(comes_before);
  for (const PanelGroup& group : groups_)
    if (is_kept_closed(group.body)) {
      const Triangle whole = quartered_triangle(panels_, group);
      corners.insert(whole.begin(), whole.end());
    }
  std::vector<Division> result(groups_.size());
  bool are_there = false;
  for (std::size_t k = 0; k < groups_.size(); ++k) {
    if (!is_kept_closed(groups_[k].body))
      continue;
    const std::array<Vector3d, 3> middles = middles_of_quartered(panels_, groups_[k]);
    for (std::size_t side = 0; side < 3; ++side)
      if (corners.contains(middles[side]))
        result[k] = {1, side};
    are_there = are_there || result[k].steps > 0;
  }
  return are_there ? result : std::vector<Division>{};
}

MatrixXd PanelMesh::refine(const std::vector<int>& steps, const MatrixXd& charges, const MatrixXd& carried) {
  std::vector<Division> divisions(steps.size());
  for (std::size_t k = 0; k < steps.size(); ++k)
    divisions[k].steps = steps[k];
  MatrixXd moved = divide(divisions, charges, carried);
  for (divisions = cracks(); !divisions.empty(); divisions = cracks()) {
    const std::vector<Index> before = std::move(places_before_);
    moved = divide(divisions, MatrixXd(index_of(panels_.size()), 0), moved);
    for (Index& place : places_before_)
      if (place != no_place)
        place = before[static_cast<std::size_t>(place)];
  }
  return moved;
}

MatrixXd PanelMesh::divide(const std::vector<Division>& divisions, const MatrixXd& charges,
                           const MatrixXd& carried) {
  const std::vector<Panel> panels = std::move(panels_);
  const std::vector<PanelGroup> groups = std::move(groups_);
  panels_.clear();
  groups_.clear();
  places_before_.clear();
  // A triangle whose charges are unknown is halved across its longest side, like one whose charges are zero.
  Carried moving(charges.cols() > 0 ? charges : MatrixXd::Zero(index_of(panels.size()), 1), carried);
  for (std::size_t k = 0; k < groups.size(); ++k) {
    const PanelGroup& group = groups[k];
    const auto& [steps, chosen] = divisions[k];
    if (steps == 0) {
      groups_.push_back({panels_.size(), group.count, group.body, group.is_quartered});
      for (std::size_t member = group.first; member < group.first + group.count; ++member) {
        panels_.push_back(panels[member]);
        places_before_.push_back(static_cast<Index>(member));
        moving.keep(member);
      }
    } else if (group.is_quartered) {
      const Triangle whole = quartered_triangle(panels, group);
      const std::array<Vector3d, 3> middles = middles_of_quartered(panels, group);
      const std::size_t side =
          chosen ? *chosen
                 : side_to_halve(whole, moving.choosing(group.first), bends(whole, middles, group.body));
      moving.begin(panels, group.first, true);
      add_halves(whole, Matrix3d::Identity(), side, middles[side], group.body, steps - 1, moving);
    } else {
      for (std::size_t member = group.first; member < group.first + group.count; ++member) {
        moving.begin(panels, member, false);
        add_parts(panels[member].corners, Matrix3d::Identity(), group.body, steps - 1, moving);
      }
    }
  }
  return moving.result();
}

}  // namespace fringe::detail
