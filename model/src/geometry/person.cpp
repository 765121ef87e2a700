#include "geometry/person.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <set>
#include <utility>

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

/// A point (i, j, k) of the lattice, i towards the left, j forwards, k upwards; or a cell by its lowest
/// corner.
using LatticePoint = std::array<int, 3>;

/// The proportions of an age, over the height; the widths are cross-sections over the adult's.
struct Build {
  double ankle, knee, crotch, shoulder, chin;
  double upper_arm, forearm, hand;
  double trunk_width, head_width, limb_width;
};

Build build_of(PersonAge age) {
  switch (age) {
  case PersonAge::adult:
    break;
  case PersonAge::child:
    return {0.039, 0.265, 0.450, 0.795, 0.840, 0.175, 0.135, 0.100, 1.03, 1.4, 1.03};
  case PersonAge::infant:
    return {0.039, 0.200, 0.350, 0.705, 0.750, 0.165, 0.130, 0.100, 1.16, 2.15, 1.16};
  }
  return {0.039, 0.285, 0.475, 0.818, 0.870, 0.186, 0.146, 0.108, 1.05, 1.0, 1.05};
}

// The rings of the lattice, by the tables of geometries/scene/person.py; lengths over the height.

struct TrunkRing {
  double share;  ///< of the way from crotch to shoulder
  double half_breadth, half_depth;
};
constexpr std::array<TrunkRing, 7> trunk_rings{{{0.0, 0.088, 0.060},
                                                {0.16, 0.0955, 0.070},
                                                {0.42, 0.088, 0.063},
                                                {0.62, 0.092, 0.066},
                                                {0.78, 0.098, 0.070},
                                                {0.9, 0.098, 0.066},
                                                {1.0, 0.080, 0.045}}};

struct HeadRing {
  double neck, head;  ///< shares of the ways from shoulder to chin and from chin to top
  double half_breadth, half_depth, forwards;
};
constexpr std::array<HeadRing, 5> head_rings{{{0.35, 0.0, 0.031, 0.033, 0.0},
                                              {1.0, 0.0, 0.030, 0.037, 0.010},
                                              {1.0, 0.35, 0.0437, 0.054, 0.006},
                                              {1.0, 0.7, 0.0437, 0.0555, 0.004},
                                              {1.0, 1.0, 0.022, 0.028, 0.0}}};

struct LegRing {
  double thigh, shank, foot;  ///< shares of the ways from crotch to knee, to ankle and to sole
  double half_breadth, half_depth, left, forwards;
};
constexpr std::array<LegRing, 7> leg_rings{{{0.16, 0.0, 0.0, 0.0435, 0.046, 0.046, 0.0},
                                            {0.5, 0.0, 0.0, 0.038, 0.040, 0.047, 0.0},
                                            {1.0, 0.0, 0.0, 0.030, 0.032, 0.047, 0.0},
                                            {1.0, 0.3, 0.0, 0.031, 0.033, 0.047, -0.004},
                                            {1.0, 0.95, 0.0, 0.019, 0.022, 0.047, -0.008},
                                            {1.0, 1.0, 0.3, 0.025, 0.058, 0.049, 0.026},
                                            {1.0, 1.0, 1.0, 0.0275, 0.076, 0.050, 0.035}}};

struct ArmRing {
  double down, ahead;    ///< shares of the upper arm down from the shoulder, and forwards if stretched out
  double forearm, hand;  ///< shares of these
  double half_forwards, half_outwards;
};
constexpr std::array<ArmRing, 8> arm_rings{{{0.18, 0.05, 0.0, 0.0, 0.034, 0.032},
                                            {0.39, 0.24, 0.0, 0.0, 0.027, 0.026},
                                            {0.63, 0.54, 0.0, 0.0, 0.025, 0.025},
                                            {1.0, 1.0, 0.0, 0.0, 0.022, 0.021},
                                            {1.0, 1.0, 0.3, 0.0, 0.023, 0.021},
                                            {1.0, 1.0, 1.0, 0.0, 0.016, 0.012},
                                            {1.0, 1.0, 1.0, 0.35, 0.024, 0.009},
                                            {1.0, 1.0, 1.0, 1.0, 0.012, 0.006}}};

/// The centre of a ring of an arm to the left, and sine and cosine by which it has turned from facing left.
struct ArmTurn {
  double left, sine, cosine;
};
constexpr std::array<ArmTurn, 8> hanging{{{0.125, 0.6, 0.8},
                                          {0.137, 0.8, 0.6},
                                          {0.143, 1, 0},
                                          {0.150, 1, 0},
                                          {0.153, 1, 0},
                                          {0.158, 1, 0},
                                          {0.160, 1, 0},
                                          {0.162, 1, 0}}};
constexpr std::array<ArmTurn, 8> stretched{{{0.122, 0.6, 0.8},
                                            {0.140, 0.96, 0.28},
                                            {0.142, 1, 0},
                                            {0.142, 1, 0},
                                            {0.142, 1, 0},
                                            {0.142, 1, 0},
                                            {0.142, 1, 0},
                                            {0.142, 1, 0}}};
/// Half the breadth of an adult's trunk where the arms begin, over the height.
constexpr double shoulder_breadth = 0.098;

// The lattice: the trunk is trunk_across cells wide and trunk_levels high, everything is two cells deep, and
// limbs are two by two cells.
constexpr int trunk_across = 5, trunk_levels = 6, deep = 2;

/// Maps the square [−1, 1]² to the unit disc, its sides to arcs of the circle.
std::pair<double, double> on_disc(double u, double v) {
  return {u * std::sqrt(1 - v * v / 2), v * std::sqrt(1 - u * u / 2)};
}

/// Returns where a point of the left arm lies above the soles; j and k are from −1 to 1.
Vector3d place_on_arm(const Build& build, int number, int j, int k, bool is_stretched) {
  const auto index = static_cast<std::size_t>(number);
  const ArmRing& ring = arm_rings[index];
  const ArmTurn& turn = (is_stretched ? stretched : hanging)[index];
  const auto [v, w] = on_disc(j, k);
  const double h = build.limb_width * ring.half_forwards * v, n = build.limb_width * ring.half_outwards * w;
  const double y = shoulder_breadth * build.trunk_width + (turn.left - shoulder_breadth) * build.limb_width;
  const double beyond = ring.forearm * build.forearm + ring.hand * build.hand;
  if (is_stretched)
    return {ring.ahead * build.upper_arm + beyond + turn.cosine * h, y - turn.sine * h,
            build.shoulder - arm_rings[0].down * build.upper_arm + n};
  return {h, y + turn.sine * n, build.shoulder - ring.down * build.upper_arm - beyond + turn.cosine * n};
}

/// Returns where a point of trunk, head, left leg or left arm lies above the soles, for a height of 1.
Vector3d place_on_left(const Build& build, const LatticePoint& point, bool is_stretched) {
  const auto [i, j, k] = point;
  if (i > trunk_across)
    return place_on_arm(build, i - trunk_across - 1, j - 1, k - trunk_levels + 1, is_stretched);
  if (k < 0) {
    const LegRing& ring = leg_rings[static_cast<std::size_t>(-k - 1)];
    double z = build.crotch - ring.thigh * (build.crotch - build.knee);
    z -= ring.shank * (build.knee - build.ankle) + ring.foot * build.ankle;
    const auto [u, v] = on_disc(i - 4, j - 1);
    return {build.limb_width * (ring.forwards + ring.half_depth * v),
            build.limb_width * (ring.left + ring.half_breadth * u), z};
  }
  if (k > trunk_levels) {
    const HeadRing& ring = head_rings[static_cast<std::size_t>(k - trunk_levels - 1)];
    const double z =
        build.shoulder + ring.neck * (build.chin - build.shoulder) + ring.head * (1 - build.chin);
    const auto [u, v] = on_disc((2 * i - trunk_across) / 3.0, j - 1);
    return {build.head_width * (ring.forwards + ring.half_depth * v),
            build.head_width * ring.half_breadth * u, z};
  }
  const TrunkRing& ring = trunk_rings[static_cast<std::size_t>(k)];
  const auto [u, v] = on_disc((2 * i - trunk_across) / 5.0, j - 1);
  return {build.trunk_width * ring.half_depth * v, build.trunk_width * ring.half_breadth * u,
          build.crotch + ring.share * (build.shoulder - build.crotch)};
}

/// Returns where a point of the lattice lies, for a height of 1; the right side mirrors the left one.
Vector3d place(const Build& build, const LatticePoint& point, Posture posture) {
  const auto [i, j, k] = point;
  const bool is_right = i < 0 || (k < 0 && i < 3);
  const bool is_stretched = i < 0 && posture == Posture::arm_stretched;
  Vector3d result = is_right ? place_on_left(build, {trunk_across - i, j, k}, is_stretched)
                             : place_on_left(build, point, false);
  if (is_right)
    result.y() = -result.y();
  result.z() -= 0.5;
  return posture == Posture::lying ? Vector3d(-result.z(), result.y(), result.x()) : result;
}

/// Returns the cells of trunk, head, right and left leg, right and left arm.
std::vector<LatticePoint> cells() {
  std::vector<LatticePoint> result;
  const int arms = static_cast<int>(arm_rings.size()), legs = static_cast<int>(leg_rings.size()),
            head = static_cast<int>(head_rings.size());
  for (int k = 0; k < trunk_levels; ++k)
    for (int j = 0; j < deep; ++j)
      for (int i = 0; i < trunk_across; ++i)
        result.push_back({i, j, k});
  for (int k = trunk_levels; k < trunk_levels + head; ++k)
    for (int j = 0; j < deep; ++j)
      for (int i = 1; i < 4; ++i)
        result.push_back({i, j, k});
  for (const int side : {0, 3})
    for (int k = -1; k >= -legs; --k)
      for (int j = 0; j < deep; ++j)
        for (int i = side; i < side + 2; ++i)
          result.push_back({i, j, k});
  for (const bool is_right : {true, false})
    for (int ring = 0; ring < arms; ++ring)
      for (int j = 0; j < deep; ++j)
        for (int k = trunk_levels - 2; k < trunk_levels; ++k)
          result.push_back({is_right ? -1 - ring : trunk_across + ring, j, k});
  return result;
}

/// The neighbour (i, j, k) across a face of a cell, and the face's corners: bit 1 is a step forwards, 2 one
/// to the left, 4 one up.
struct CellFace {
  LatticePoint neighbour;
  std::array<int, 4> corners;
};
constexpr std::array<CellFace, 6> faces_of_cell{{{{0, 0, -1}, {0, 2, 3, 1}},
                                                 {{0, 0, 1}, {4, 5, 7, 6}},
                                                 {{-1, 0, 0}, {0, 1, 5, 4}},
                                                 {{1, 0, 0}, {2, 6, 7, 3}},
                                                 {{0, -1, 0}, {0, 4, 6, 2}},
                                                 {{0, 1, 0}, {1, 3, 7, 5}}}};

}  // namespace

std::vector<Triangle> triangles_of_person(double height, PersonAge age, Posture posture) {
  const Build build = build_of(age);
  const std::vector<LatticePoint> body = cells();
  const std::set<LatticePoint> inside(body.begin(), body.end());
  std::vector<Triangle> triangles;
  for (const auto& [i, j, k] : body)
    for (const CellFace& face : faces_of_cell) {
      const auto& [di, dj, dk] = face.neighbour;
      if (inside.contains({i + di, j + dj, k + dk}))
        continue;
      std::array<Vector3d, 4> quad;
      for (std::size_t c = 0; c < quad.size(); ++c) {
        const int corner = face.corners[c];
        quad[c] =
            height * place(build, {i + (corner >> 1 & 1), j + (corner & 1), k + (corner >> 2)}, posture);
      }
      triangles.push_back({quad[0], quad[1], quad[2]});
      triangles.push_back({quad[0], quad[2], quad[3]});
    }
  return triangles;
}

}  // namespace fringe::detail
