#include "bem/panel_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "bem/graded_triangles.hpp"
#include "geometry/surface_mesh.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

/// Largest number of triangles of a surface that are quartered. A larger surface has triangles enough of its
/// own to group them for the coarse space.
constexpr std::size_t few_triangles = 400;

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
    normals.push_back((triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).normalized());
    centres.emplace_back((triangle[0] + triangle[1] + triangle[2]) / 3);
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

}  // namespace

void PanelMesh::add_quartered(const Triangle& triangle, std::size_t body) {
  if (is_hidden(triangle, body))
    return;
  groups_.push_back({panels_.size(), 4, body, true});
  for (const Triangle& quarter : quarters(triangle))
    panels_.push_back(make_panel(quarter));
  places_before_.resize(panels_.size(), no_place);
}

void PanelMesh::add(std::size_t body, std::span<const Triangle> surface, const PanelGrading& grading) {
  std::vector<Triangle> triangles(surface.begin(), surface.end());
  std::erase_if(triangles, [&](const Triangle& triangle) { return is_hidden(triangle, body); });
  if (triangles.size() <= few_triangles) {
    for (const Triangle& triangle :
         graded_triangles(triangles, grading.missing, grading.most_panels / group_size))
      add_quartered(triangle, body);
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

std::size_t PanelMesh::growth(const PanelGroup& group) {
  return group.is_quartered ? group.count : 3 * group.count;
}

PanelMesh PanelMesh::of_first(std::size_t bodies) const {
  PanelMesh mesh;
  for (const PanelGroup& group : groups_)
    if (group.body < bodies)
      mesh.groups_.push_back(group);
  const std::size_t panels = mesh.groups_.empty() ? 0 : mesh.groups_.back().first + mesh.groups_.back().count;
  mesh.panels_.assign(panels_.begin(), panels_.begin() + static_cast<std::ptrdiff_t>(panels));
  mesh.places_before_.resize(panels, no_place);
  return mesh;
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

void PanelMesh::refine(const std::vector<bool>& marked, const MatrixXd& charges) {
  const std::vector<Panel> panels = std::move(panels_);
  const std::vector<PanelGroup> groups = std::move(groups_);
  panels_.clear();
  groups_.clear();
  places_before_.clear();
  for (std::size_t k = 0; k < groups.size(); ++k) {
    const PanelGroup& group = groups[k];
    if (!marked[k]) {
      groups_.push_back({panels_.size(), group.count, group.body, group.is_quartered});
      for (std::size_t member = group.first; member < group.first + group.count; ++member) {
        panels_.push_back(panels[member]);
        places_before_.push_back(static_cast<Index>(member));
      }
    } else if (group.is_quartered) {
      const Triangle whole = quartered_triangle(panels, group);
      const MatrixXd own =
          charges.middleRows(static_cast<Index>(group.first), static_cast<Index>(group.count));
      for (const Triangle& half : halves(whole, side_to_halve(whole, own)))
        add_quartered(half, group.body);
    } else {
      for (std::size_t member = 0; member < group.count; ++member)
        add_quartered(panels[group.first + member].corners, group.body);
    }
  }
}

}  // namespace fringe::detail
