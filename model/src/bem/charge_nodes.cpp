#include "bem/charge_nodes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include <Eigen/Geometry>

#include "bem/jacobi_basis.hpp"
#include "numeric/quadrature_rules.hpp"
#include "surface/panel.hpp"

namespace fringe::detail {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

/// Relative error of forces that the nodes aim at.
constexpr double node_tolerance = 1e-4;

/// Number of times that a panel is quartered at most.
constexpr int most_divisions = 5;

/// Part of a link's charge that may be left out with the panels that lie close to another link: where both
/// have one potential, as at a joint, hardly any charge lies there, and nodes would be the more the closer
/// they are.
constexpr double negligible_charge = 1e-3;

/// A face or a panel: a flat piece of charged surface.
struct Element {
  std::size_t group;  ///< index of the link's charges
  Vector3d centre;
  double radius;
  AlignedBox3d box;
  const ChargedFace* face;  ///< null: a panel
  Index row;                ///< of a panel's charges, or the number of the face
};

/// Returns the shortest distance from a point to a face.
double distance(const ChargedFace& face, const Vector3d& point) {
  const Vector3d from_centre = point - face.centre;
  const double u = from_centre.dot(face.axis_u), v = from_centre.dot(face.axis_v);
  const double beside_u = std::max(std::abs(u) - face.half_u, 0.0),
               beside_v = std::max(std::abs(v) - face.half_v, 0.0);
  const double height = from_centre.dot(face.axis_u.cross(face.axis_v));
  return std::sqrt(beside_u * beside_u + beside_v * beside_v + height * height);
}

/// Bounds the distance from a point to an element from below; exact for faces.
double least_distance(const Element& element, const Vector3d& point) {
  if (element.face != nullptr)
    return distance(*element.face, point);
  return std::max((point - element.centre).norm() - element.radius, element.box.exteriorDistance(point));
}

/// Consecutive elements in one box, so that distant ones are passed over together.
struct Chunk {
  std::size_t first, count;
  std::size_t group;
  AlignedBox3d box;
};

/// Finds the nearest element of another link, of those that are not too close.
class Neighbours {
 public:
  Neighbours(const std::vector<Element>& elements, std::size_t groups)
      : elements_(elements), are_too_close_(groups, std::vector<bool>(groups)) {
    constexpr std::size_t together = 32;
    for (std::size_t k = 0; k < elements.size(); ++k) {
      if (chunks_.empty() || chunks_.back().count == together || chunks_.back().group != elements[k].group)
        chunks_.push_back({k, 0, elements[k].group, {}});
      ++chunks_.back().count;
      chunks_.back().box.extend(elements[k].box);
    }
  }

  struct Nearest {
    double distance = std::numeric_limits<double>::infinity();
    std::size_t group = 0;
  };

  /// Returns the distance from a point to the nearest element that is not in the group.
  Nearest nearest(const Vector3d& point, std::size_t group) const {
    Nearest result;
    for (const Chunk& chunk : chunks_) {
      if (chunk.group == group || are_too_close_[group][chunk.group] ||
          chunk.box.exteriorDistance(point) >= result.distance)
        continue;
      for (std::size_t k = chunk.first; k < chunk.first + chunk.count; ++k)
        if (const double found = least_distance(elements_[k], point); found < result.distance)
          result = {found, chunk.group};
    }
    return result;
  }

  /// Leaves a pair of links out from now on.
  void leave_out(std::size_t a, std::size_t b) { are_too_close_[a][b] = are_too_close_[b][a] = true; }

  /// Returns the pairs that are left out, the smaller number first.
  std::vector<std::pair<std::size_t, std::size_t>> left_out() const {
    std::vector<std::pair<std::size_t, std::size_t>> pairs;
    for (std::size_t a = 0; a < are_too_close_.size(); ++a)
      for (std::size_t b = a + 1; b < are_too_close_.size(); ++b)
        if (are_too_close_[a][b])
          pairs.emplace_back(a, b);
    return pairs;
  }

 private:
  const std::vector<Element>& elements_;
  std::vector<Chunk> chunks_;
  std::vector<std::vector<bool>> are_too_close_;
};

/// Collects the nodes of the links.
class NodeBuilder {
 public:
  NodeBuilder(Neighbours& neighbours, std::size_t groups)
      : neighbours_(neighbours), points_(groups), charges_(groups) {}

  /// Adds nodes on a triangle with an evenly spread charge.
  void add(const Triangle& triangle, const Eigen::RowVectorXd& charge, std::size_t group, int divisions = 0) {
    const Panel panel = make_panel(triangle);
    const Neighbours::Nearest nearest = neighbours_.nearest(panel.centre, group);
    if (const TriangleRule* const rule = rule_for(panel.radius / nearest.distance)) {
      place(triangle, charge, group, *rule);
      return;
    }
    if (divisions == most_divisions) {
      neighbours_.leave_out(group, nearest.group);
      place(triangle, charge, group, triangle_rules()[0]);
      return;
    }
    for (const Triangle& quarter : quarters(triangle))
      add(quarter, charge / 4, group, divisions + 1);
  }

  /// Tells whether a panel has to be divided, since another link is close.
  bool is_divided(const Panel& panel, std::size_t group) const {
    return rule_for(panel.radius / neighbours_.nearest(panel.centre, group).distance) == nullptr;
  }

  /// Adds nodes on a face. `charges` are those of its functions.
  void add(const ChargedFace& face, FaceFunctions functions, const MatrixXd& charges, std::size_t group) {
    const double gap = distance_of_face(face, group);
    const DirectionRule& u = whole_rule(face.edge, points_along(gap / face.half_u, functions.u));
    const DirectionRule& v = whole_rule(face.edge, points_along(gap / face.half_v, functions.v));
    for (Index i = 0; i < u.nodes.size(); ++i)
      for (Index j = 0; j < v.nodes.size(); ++j) {
        Eigen::RowVectorXd charge = Eigen::RowVectorXd::Zero(charges.cols());
        for (int k = 0; k < functions.u; ++k)
          for (int l = 0; l < functions.v; ++l)
            charge += u.weights(k, i) * v.weights(l, j) * charges.row(k * functions.v + l);
        points_[group].push_back(face.centre + u.nodes[i] * face.half_u * face.axis_u +
                                 v.nodes[j] * face.half_v * face.axis_v);
        charges_[group].push_back(std::move(charge));
      }
  }

  LinkCharges charges_of(std::size_t group, std::optional<std::size_t> link, Index columns) const {
    LinkCharges result{link, Eigen::Matrix3Xd(3, index_of(points_[group].size())),
                       MatrixXd(index_of(points_[group].size()), columns)};
    for (std::size_t k = 0; k < points_[group].size(); ++k) {
      result.points.col(index_of(k)) = points_[group][k];
      result.charges.row(index_of(k)) = charges_[group][k];
    }
    return result;
  }

  /// Leaves out the pairs of links that come closer to each other at a panel's middle than its finest nodes
  /// resolve.
  void leave_out_close_links(const Panel& panel, std::size_t group) {
    while (true) {
      const Neighbours::Nearest nearest = neighbours_.nearest(panel.centre, group);
      if (rule_for(std::ldexp(panel.radius, -most_divisions) / nearest.distance) != nullptr)
        return;
      neighbours_.leave_out(group, nearest.group);
    }
  }

 private:
  static constexpr int most_points_of_a_panel = 7;

  /// Returns the rule of fewest points whose nodes suffice for a triangle, by the ratio of its radius to the
  /// distance of another link; null: none does.
  static const TriangleRule* rule_for(double ratio) {
    for (const TriangleRule& rule : triangle_rules()) {
      if (rule.points > most_points_of_a_panel)
        break;
      if (ratio < 1 &&
          rule.bound_constant * (rule.degree + 2) * std::pow(ratio, rule.degree + 1) <= node_tolerance)
        return &rule;
    }
    return nullptr;
  }

  /// Returns the number of points of a Gauss rule for functions of a face whose potential is singular at
  /// a distance, in half sides.
  static int points_along(double distance, int functions) {
    const double growth = std::log(distance + std::sqrt(1 + distance * distance));
    const double points = functions / 2.0 + 1 - std::log(node_tolerance) / (2 * std::max(growth, 1e-6));
    return static_cast<int>(std::clamp(std::ceil(points), 2.0, static_cast<double>(most_points)));
  }

  /// Returns the shortest distance from points of a face, closer together towards its edges, to other links.
  double distance_of_face(const ChargedFace& face, std::size_t group) const {
    constexpr int rows = 12;
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= rows; ++i)
      for (int j = 0; j <= rows; ++j) {
        const double x = std::sin(std::numbers::pi * (static_cast<double>(i) / rows - 0.5)),
                     y = std::sin(std::numbers::pi * (static_cast<double>(j) / rows - 0.5));
        const Vector3d point = face.centre + x * face.half_u * face.axis_u + y * face.half_v * face.axis_v;
        least = std::min(least, neighbours_.nearest(point, group).distance);
      }
    return least;
  }

  void place(const Triangle& triangle, const Eigen::RowVectorXd& charge, std::size_t group,
             const TriangleRule& rule) {
    for (const TriangleNode& node : std::span(rule.nodes, static_cast<std::size_t>(rule.points))) {
      points_[group].push_back(triangle[0] + node.second * (triangle[1] - triangle[0]) +
                               node.third * (triangle[2] - triangle[0]));
      charges_[group].push_back(node.weight * charge);
    }
  }

  Neighbours& neighbours_;
  std::vector<std::vector<Vector3d>> points_;
  std::vector<std::vector<Eigen::RowVectorXd>> charges_;
};

/// Returns which panels are left out: of those close to other links the ones of least charge.
std::vector<bool> left_out(const std::vector<Element>& elements, const std::vector<Panel>& panels,
                           const MatrixXd& charges, std::size_t groups, const NodeBuilder& builder) {
  MatrixXd totals = MatrixXd::Zero(index_of(groups), charges.cols());
  for (const Element& element : elements)
    if (element.face == nullptr)
      totals.row(index_of(element.group)) += charges.row(element.row).cwiseAbs();
  // Charges over those of the link, the largest ratio of all columns.
  std::vector<std::pair<double, const Element*>> close;
  for (const Element& element : elements)
    if (element.face == nullptr &&
        builder.is_divided(panels[static_cast<std::size_t>(element.row)], element.group))
      close.emplace_back(
          (totals.row(index_of(element.group)).array() > 0)
              .select(charges.row(element.row).array().abs() / totals.row(index_of(element.group)).array(),
                      0.0)
              .maxCoeff(),
          &element);
  std::sort(close.begin(), close.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<bool> result(panels.size());
  std::vector<double> parts(groups);
  for (const auto& [share, element] : close) {
    double& part = parts[element->group];
    part += share;
    result[static_cast<std::size_t>(element->row)] = part <= negligible_charge;
  }
  return result;
}

AlignedBox3d box_of(std::span<const Vector3d> corners) {
  AlignedBox3d box;
  for (const Vector3d& corner : corners)
    box.extend(corner);
  return box;
}

}  // namespace

ChargeNodes charge_nodes(const PanelSystem& system, const PanelSolution& solution,
                         const ChargedBodies& bodies) {
  std::vector<std::optional<std::size_t>> links;
  std::vector<std::size_t> group_of_body;
  for (const ChargedBody& body : bodies.bodies) {
    const auto found = std::find(links.begin(), links.end(), body.link);
    group_of_body.push_back(static_cast<std::size_t>(found - links.begin()));
    if (found == links.end())
      links.push_back(body.link);
  }
  std::vector<Element> elements;
  Index face = 0;
  for (std::size_t body = 0; body < bodies.bodies.size(); ++body)
    for (const ChargedFace& one : faces_of(bodies.bodies[body].surface))
      elements.push_back({group_of_body[body], one.centre, std::hypot(one.half_u, one.half_v),
                          box_of(corners_of(one)), &one, face++});
  const std::vector<Panel>& panels = system.mesh().panels();
  for (const PanelGroup& group : system.mesh().groups())
    for (std::size_t k = group.first; k < group.first + group.count; ++k)
      elements.push_back({group_of_body[group.body], panels[k].centre, panels[k].radius,
                          box_of(panels[k].corners), nullptr, index_of(k)});

  Neighbours neighbours(elements, links.size());
  NodeBuilder builder(neighbours, links.size());
  for (const Element& element : elements)
    if (element.face == nullptr)
      builder.leave_out_close_links(panels[static_cast<std::size_t>(element.row)], element.group);
  const std::vector<bool> are_left_out =
      left_out(elements, panels, solution.reading_charges, links.size(), builder);
  for (const Element& element : elements)
    if (element.face != nullptr)
      builder.add(*element.face, system.functions(static_cast<std::size_t>(element.row)),
                  solution.face_reading_charges[static_cast<std::size_t>(element.row)], element.group);
    else if (!are_left_out[static_cast<std::size_t>(element.row)])
      builder.add(panels[static_cast<std::size_t>(element.row)].corners,
                  solution.reading_charges.row(element.row), element.group);

  ChargeNodes result;
  const auto columns = 4 * index_of(bodies.readings.size());
  for (std::size_t group = 0; group < links.size(); ++group)
    result.links.push_back(builder.charges_of(group, links[group], columns));
  result.too_close = neighbours.left_out();
  return result;
}

}  // namespace fringe::detail
