#include "reduced/mesh_pair.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "numeric/interruption.hpp"
#include "reduced/node_rules.hpp"
#include "simd/dispatch.hpp"
#include "surface/panel.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

/// Returns the other body in coordinates in which this one is at the origin and has scale 1.
PlacedBody seen_from(const PlacedBody& body, const PlacedBody& other) {
  return {other.shape, other.scale / body.scale,
          body.axes.transpose() * (other.centre - body.centre) / body.scale,
          body.axes.transpose() * other.axes};
}

/// Returns the distance from a point to a plate or box.
double distance_to(const PlacedBody& body, const Vector3d& point) {
  const Vector3d local = body.axes.transpose() * (point - body.centre);
  return (local.cwiseAbs() - body.scale * body.shape->half_sides()).cwiseMax(0).norm();
}

double distance_to(const std::vector<std::array<Vector3d, 2>>& edges, const Vector3d& point) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [from, to] : edges)
    least = std::min(least, segment_distance(point, from, to));
  return least;
}

/// Returns a lower bound of the distance of a cluster's panels from a body's edges, given that they are at
/// least `away` from the body.
double edge_distance(const PreparedMesh& mesh, const PanelCluster& cluster,
                     const std::vector<std::array<Vector3d, 2>>& edges, double away) {
  /// Distance in panel radii beyond which edges do not matter.
  constexpr double far_panels = 8;
  if (away > far_panels * cluster.panel_radius)
    return away;
  const double centre = distance_to(edges, cluster.centre);
  if (centre > 2 * cluster.radius)
    return centre - cluster.radius;
  double least = std::numeric_limits<double>::infinity();
  for (std::ptrdiff_t place = cluster.first; place < cluster.first + cluster.count; ++place)
    least = std::min(least, distance_to(edges, mesh.point(place)));
  return least;
}

/// Returns the largest ratio of a panel's part's radius to its distance. With one point for each panel the
/// error is like the square of this ratio; a fraction of `digits` suffices, because the errors of many panels
/// differ in sign.
double coarsest_ratio(QuadratureDigits digits) {
  return 1.4 * std::exp(-digits.outer / 2);
}

/// Relative error of the nodes of panels beside faces, per square of that ratio. It is larger than the error
/// that was measured with three bodies above a plate at a twentieth of their size.
constexpr double error_per_square = 0.004;

/// The same between two bodies of triangles, larger because panels of both may lie above each other.
constexpr double error_per_square_between_meshes = 0.02;

/// Error that skeletons may have, averaged over the other body, relative to that of the panels' nodes. A
/// change, whose error is up to five times as large, then still has the quadratures' share.
constexpr double skeleton_errors = 4;

/// Returns the part of a skeleton's error that is left in the interaction with a body at a distance. The
/// error of the potential changes its sign within about the distance, so that it averages out over a larger
/// body.
double averaged_part(double gap, const PlacedBody& other) {
  /// This part makes the stated error of a change at least twice the true one before a hand at 0.2 to 2.4
  /// half sides of a covered sensor.
  constexpr double part_per_distance = 0.25;
  std::array<double, 3> half_sides{};
  Eigen::Map<Vector3d>(half_sides.data()) = other.scale * other.shape->half_sides();
  // The error averages out along the shorter side of a plate, the middle one of the three.
  std::sort(half_sides.begin(), half_sides.end());
  return std::min(1.0, part_per_distance * gap / half_sides[1]);
}

/// Distances from the other body, in its largest half sides, that separate the bands of clusters.
constexpr std::array<double, 2> band_ends{0.35, 1.0};

}  // namespace

void MeshSide::set(const PreparedMesh& mesh, const ChargedPanels& nodes, std::ptrdiff_t functions,
                   double factor) {
  mesh_ = &mesh;
  nodes_ = &nodes;
  functions_ = functions;
  factor_ = static_cast<float>(factor);
  charges.resize(static_cast<std::size_t>(nodes.places()));
  // While charges are spread they are sums of functions, which may be more than a skeleton's nodes.
  potentials.resize(static_cast<std::size_t>(std::max(nodes.places(), whole_blocks(functions))));
  unused_.assign(static_cast<std::size_t>(nodes.places()), 0.0F);
  coefficients_.assign(static_cast<std::size_t>(whole_blocks(functions)), 0.0F);
}

void MeshSide::spread(const float* coefficients) {
  for (std::ptrdiff_t k = 0; k < functions_; ++k)
    coefficients_[static_cast<std::size_t>(k)] = factor_ * coefficients[k];
  std::fill(unused_.begin(), unused_.end(), 0.0F);
  std::vector<float>& sums = potentials;
  best_kernels<NodeKernels>().apply(nodes_->functions(functions_), coefficients_.data(), unused_.data(),
                                    sums.data(), charges.data());
}

void MeshSide::gather(float* moments) {
  std::fill(coefficients_.begin(), coefficients_.end(), 0.0F);
  best_kernels<NodeKernels>().apply(nodes_->functions(functions_), coefficients_.data(), potentials.data(),
                                    moments, unused_.data());
  for (std::ptrdiff_t k = 0; k < functions_; ++k)
    moments[k] *= factor_;
  std::fill(moments + functions_, moments + whole_blocks(functions_), 0.0F);
}

void MeshPair::place(const PlacedBody& a, int functions_a, const PlacedBody& b, int functions_b, double gap,
                     const BodySmoothness& of_faces, QuadratureDigits digits) {
  a_is_outer_ = a.shape->mesh() != nullptr;
  const PlacedBody &first = a_is_outer_ ? a : b, &second = a_is_outer_ ? b : a;
  const PlacedBody other = seen_from(first, second);
  frame_.translation() = first.centre;
  frame_.linear() = first.axes;
  scale_ = first.scale;
  const PreparedMesh& mesh = *first.shape->mesh();
  const int functions = a_is_outer_ ? functions_a : functions_b;
  inner_has_faces_ = second.shape->mesh() == nullptr;
  used_ = 0;
  coarsest_ = 0;
  is_cut_short_ = false;
  const double allowed = skeleton_errors *
                         (error_left(digits.inner) + error_per_square * std::pow(coarsest_ratio(digits), 2)),
               part = averaged_part(gap, second);
  if (const ChargeSkeleton* const skeleton = mesh.skeleton(gap / first.scale, functions, allowed / part)) {
    relative_error_ = part * skeleton->error;
    note_parts(*skeleton);
    outer_.set(mesh, skeleton->nodes, functions, 1 / first.scale);
    next_band().outer.parts.push_back({skeleton->nodes.panels.clusters.data(), 0});
    if (inner_has_faces_) {
      place_skeleton_beside_faces(other, a_is_outer_ ? functions_b : functions_a, of_faces, digits);
      return;
    }
    if (place_skeletons(other, functions_b, gap / second.scale, allowed / averaged_part(gap, first),
                        averaged_part(gap, first)))
      return;
    used_ = 0;
    is_cut_short_ = false;
  }
  outer_.set(mesh, mesh.charged_panels(), functions, 1 / first.scale);
  if (inner_has_faces_) {
    place_beside_faces(other, a_is_outer_ ? functions_b : functions_a, digits);
  } else {
    inner_.set(*second.shape->mesh(), second.shape->mesh()->charged_panels(), functions_b, 1);
    place_beside_mesh(other, digits);
  }
}

MeshPair::Band& MeshPair::next_band() {
  if (used_ == bands_.size())
    bands_.emplace_back();
  Band& band = bands_[used_++];
  band.outer.parts.clear();
  return band;
}

/// Returns how often panels at a distance must be quartered for the points to be near enough to each other.
int MeshPair::fineness(double panel_radius, double distance, QuadratureDigits digits) {
  const double most = coarsest_ratio(digits);
  int result = 0;
  double ratio = panel_radius / std::max(distance, 1e-9);
  for (; ratio > most && result < PanelClusters::finest; ++result)
    ratio /= 2;
  coarsest_ = std::max(coarsest_, ratio);
  is_cut_short_ |= ratio > most;
  return result;
}

/// Adds the error of the points on panels whose potentials a skeleton has. Where it is the largest part, more
/// digits are in vain.
void MeshPair::note_parts(const ChargeSkeleton& skeleton) {
  const double of_parts = (inner_has_faces_ ? error_per_square : error_per_square_between_meshes) *
                          skeleton.ratio * skeleton.ratio;
  is_cut_short_ |= of_parts > relative_error_;
  relative_error_ += of_parts;
}

/// Lays the nodes of faces beside the skeleton in the first band.
void MeshPair::place_skeleton_beside_faces(const PlacedBody& faces, int functions,
                                           const BodySmoothness& smooth, QuadratureDigits digits) {
  // The skeleton's potentials are exact wherever the faces' nodes are, so that these are those of an outer
  // body.
  Band& band = bands_.front();
  double missing = 0;
  band.faces.choose_grids(faces, functions, smooth, digits.outer, most_node_points, missing);
  is_cut_short_ |= missing > 0;
  band.faces.lay(faces, Vector3d::Zero());
  fill(band, band.faces.points());
  relative_error_ += error_left(2 * (digits.outer - missing));
}

/// Lays a skeleton of the other body, which is at least `distance` away in its own unit, beside that in the
/// first band; `part` of its error counts. Returns false if it has none of this error.
bool MeshPair::place_skeletons(const PlacedBody& other, int functions, double distance, double error,
                               double part) {
  const PreparedMesh& mesh = *other.shape->mesh();
  const ChargeSkeleton* const skeleton = mesh.skeleton(distance, functions, error);
  if (skeleton == nullptr)
    return false;
  inner_.set(mesh, skeleton->nodes, functions, 1);
  inner_nodes_.parts.assign(1, {skeleton->nodes.panels.clusters.data(), 0});
  lay_inner(other);
  fill(bands_.front(), inner_nodes_.points());
  relative_error_ += part * skeleton->error;
  note_parts(*skeleton);
  return true;
}

void MeshPair::place_beside_faces(const PlacedBody& faces, int functions, QuadratureDigits digits) {
  const PreparedMesh& mesh = outer_.mesh();
  const std::vector<std::array<Vector3d, 2>> edges = placed_edges(faces, Vector3d::Zero());
  std::array<std::vector<MeshPart>, band_ends.size() + 1> parts;
  for (const PanelCluster& cluster : mesh.panels().clusters) {
    const double away = distance_to(faces, cluster.centre) - cluster.radius;
    std::size_t at = 0;
    while (at < band_ends.size() && away > band_ends[at] * faces.scale)
      ++at;
    parts[at].push_back(
        {&cluster, fineness(cluster.panel_radius, edge_distance(mesh, cluster, edges, away), digits)});
  }
  double missing = 0;
  std::vector<NodePoints> points;
  for (std::vector<MeshPart>& here : parts) {
    if (here.empty())
      continue;
    points.clear();
    for (const MeshPart& part : here)
      points.push_back(part.points(mesh.panels()));
    Band& band = next_band();
    band.outer.parts.swap(here);
    band.faces.choose_grids(faces, functions, smoothness_at(faces, points, Vector3d::Zero()), digits.inner,
                            most_node_points, missing);
    band.faces.lay(faces, Vector3d::Zero());
    fill(band, band.faces.points());
  }
  is_cut_short_ |= missing > 0;
  relative_error_ = error_left(digits.inner - missing) + error_per_square * coarsest_ * coarsest_;
}

void MeshPair::place_beside_mesh(const PlacedBody& other, QuadratureDigits digits) {
  const PreparedMesh &mesh = outer_.mesh(), &second = inner_.mesh();
  const auto& clusters = mesh.panels().clusters;
  const auto& others = second.panels().clusters;
  std::vector<double> from_here(clusters.size(), std::numeric_limits<double>::infinity());
  std::vector<double> from_there(others.size(), std::numeric_limits<double>::infinity());
  for (std::size_t l = 0; l < others.size(); ++l) {
    const Vector3d centre = other.centre + other.axes * (other.scale * others[l].centre);
    for (std::size_t k = 0; k < clusters.size(); ++k) {
      const double away =
          (clusters[k].centre - centre).norm() - clusters[k].radius - other.scale * others[l].radius;
      from_here[k] = std::min(from_here[k], away);
      from_there[l] = std::min(from_there[l], away);
    }
  }
  Band& band = next_band();
  for (std::size_t k = 0; k < clusters.size(); ++k)
    band.outer.parts.push_back({&clusters[k], fineness(clusters[k].panel_radius, from_here[k], digits)});
  inner_nodes_.parts.clear();
  for (std::size_t l = 0; l < others.size(); ++l)
    inner_nodes_.parts.push_back(
        {&others[l], fineness(other.scale * others[l].panel_radius, from_there[l], digits)});
  lay_inner(other);
  fill(band, inner_nodes_.points());
  relative_error_ = error_left(16) + error_per_square_between_meshes * coarsest_ * coarsest_;
}

void MeshPair::lay_inner(const PlacedBody& other) {
  inner_nodes_.lay(inner_.panels(), (other.scale * other.axes).cast<float>(), other.centre.cast<float>());
}

void MeshPair::fill(Band& band, const NodePoints& inner) {
  check_interruption();
  band.outer.lay(outer_.panels(), Eigen::Matrix3f::Identity(), Eigen::Vector3f::Zero());
  const std::size_t size =
      static_cast<std::size_t>(band.outer.count) * static_cast<std::size_t>(whole_blocks(inner.count));
  band.matrix.resize(std::max(band.matrix.size(), size));
  best_kernels<NodeKernels>().fill(band.outer.points(), inner, band.matrix.data());
}

void MeshNodes::lay(const PanelClusters& panels, const Eigen::Matrix3f& axes, const Eigen::Vector3f& centre) {
  count = 0;
  for (const MeshPart& part : parts)
    count += part.count();
  const auto enlarge = [&](std::vector<float>& array) {
    array.resize(std::max(array.size(), static_cast<std::size_t>(count)));
  };
  for (std::vector<float>& array : coordinates)
    enlarge(array);
  enlarge(charges);
  enlarge(potentials);
  std::ptrdiff_t at = 0;
  for (const MeshPart& part : parts) {
    const NodePoints points = part.points(panels);
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      float* const to = coordinates[static_cast<std::size_t>(axis)].data() + at;
      for (std::ptrdiff_t k = 0; k < points.count; ++k)
        to[k] = centre[axis] + axes(axis, 0) * points.x[k] + axes(axis, 1) * points.y[k] +
                axes(axis, 2) * points.z[k];
    }
    at += points.count;
  }
}

void MeshNodes::spread(const MeshSide& body) {
  float* to = charges.data();
  for (const MeshPart& part : parts) {
    const float share = 1.0F / static_cast<float>(part.repeats());
    const float* const from = body.charges.data() + part.cluster->first;
    for (std::ptrdiff_t repeat = 0; repeat < part.repeats(); ++repeat, to += part.cluster->count)
      for (std::ptrdiff_t k = 0; k < part.cluster->count; ++k)
        to[k] = share * from[k];
  }
}

void MeshNodes::gather(MeshSide& body) const {
  const float* from = potentials.data();
  for (const MeshPart& part : parts) {
    const float share = 1.0F / static_cast<float>(part.repeats());
    float* const to = body.potentials.data() + part.cluster->first;
    std::fill(to, to + part.cluster->count, 0.0F);
    for (std::ptrdiff_t repeat = 0; repeat < part.repeats(); ++repeat, from += part.cluster->count)
      for (std::ptrdiff_t k = 0; k < part.cluster->count; ++k)
        to[k] += share * from[k];
  }
}

ChargedNodes MeshNodes::charged(MeshSide& body, const Eigen::MatrixXf& coefficients) {
  ChargedNodes result{points(), Eigen::MatrixXf(count, coefficients.cols())};
  for (Eigen::Index column = 0; column < coefficients.cols(); ++column) {
    body.spread(coefficients.col(column).data());
    spread(body);
    result.charges.col(column) = Eigen::Map<const Eigen::VectorXf>(charges.data(), count);
  }
  return result;
}

void MeshPair::potentials(const float* charges_a, const float* charges_b, float* moments_a,
                          float* moments_b) {
  const float* const inner_charges = a_is_outer_ ? charges_b : charges_a;
  float* const inner_moments = a_is_outer_ ? moments_b : moments_a;
  outer_.spread(a_is_outer_ ? charges_a : charges_b);
  if (!inner_has_faces_) {
    inner_.spread(inner_charges);
    inner_nodes_.spread(inner_);
  }
  bool is_first = true;
  for (std::size_t k = 0; k < used_; ++k) {
    Band& band = bands_[k];
    band.outer.spread(outer_);
    if (inner_has_faces_) {
      NodeSide& faces = band.faces;
      faces.spread(inner_charges);
      best_kernels<NodeKernels>().apply({band.matrix.data(), band.outer.count, faces.count},
                                        band.outer.charges.data(), faces.charges.data(),
                                        band.outer.potentials.data(), faces.potentials.data());
      if (is_first) {
        faces.gather(inner_moments);
      } else {
        const std::ptrdiff_t padded =
            whole_blocks(faces.functions * faces.functions * static_cast<std::ptrdiff_t>(faces.grids.size()));
        moments_.resize(static_cast<std::size_t>(padded + node_block));
        faces.gather(moments_.data());
        best_kernels<NodeKernels>().add(1, moments_.data(), inner_moments, padded);
      }
      is_first = false;
    } else {
      best_kernels<NodeKernels>().apply({band.matrix.data(), band.outer.count, inner_nodes_.count},
                                        band.outer.charges.data(), inner_nodes_.charges.data(),
                                        band.outer.potentials.data(), inner_nodes_.potentials.data());
      inner_nodes_.gather(inner_);
      inner_.gather(inner_moments);
    }
    band.outer.gather(outer_);
  }
  outer_.gather(a_is_outer_ ? moments_a : moments_b);
}

std::vector<Wrench> MeshPair::forces(const Eigen::MatrixXf& charges_a, const Eigen::MatrixXf& charges_b) {
  std::vector<Wrench> result(static_cast<std::size_t>(charges_a.cols()) / 2);
  for (std::size_t k = 0; k < used_; ++k) {
    Band& band = bands_[k];
    const Eigen::MatrixXf& on_inner = a_is_outer_ ? charges_b : charges_a;
    const ChargedNodes outer = band.outer.charged(outer_, a_is_outer_ ? charges_a : charges_b);
    const ChargedNodes inner =
        inner_has_faces_ ? band.faces.charged(on_inner) : inner_nodes_.charged(inner_, on_inner);
    const std::vector<Wrench> of_band =
        node_forces({band.matrix.data(), outer.points.count, inner.points.count}, outer, inner);
    for (std::size_t form = 0; form < result.size(); ++form)
      result[form] += of_band[form];
  }
  for (Wrench& wrench : result) {
    wrench.force /= scale_;
    wrench = in_outer_frame((a_is_outer_ ? 1.0 : -1.0) * wrench, frame_);
  }
  return result;
}

}  // namespace fringe::detail
