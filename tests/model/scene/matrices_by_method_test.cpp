/// Tests what holds of every Maxwell matrix, by boundary elements and by the reduced method, of bodies with
/// functions on their faces and of bodies of triangles.

#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <gmock/gmock.h>

#include "fringe/boundary_elements.hpp"
#include "fringe/triangulation.hpp"
#include "reduced/reduced_capacitance.hpp"
#include "scenes.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using namespace test;
using testing::HasSubstr;

MaxwellMatrix by_boundary_elements(const Scene& scene, double rtol) {
  return maxwell(scene, {.rtol = rtol});
}

MaxwellMatrix by_the_reduced_method(const Scene& scene, double rtol) {
  return reduced_capacitance(scene, {.rtol = rtol});
}

struct Way {
  const char* name;
  MaxwellMatrix (*solve)(const Scene&, double rtol);
  bool of_triangles;
  bool is_lower_bound;
  std::vector<double> rtols;
  double rounding;    ///< relative error that rounding leaves in an invariance
  double reordering;  ///< and another order of the conductors

  /// Returns the accuracy at which properties are tested that hold at any.
  double rtol() const { return rtols.size() > 1 ? rtols[1] : rtols[0]; }
};

/// GoogleTest would print the bytes, of which some have no value.
void PrintTo(const Way& way, std::ostream* out) {
  *out << way.name;
}

class MatricesByMethod : public testing::TestWithParam<Way> {
 protected:
  /// Solves a scene, whose objects have triangles in place of faces where the method is tested with these.
  static MaxwellMatrix solve(Scene scene, double rtol = GetParam().rtol()) {
    if (GetParam().of_triangles)
      for (Object& object : scene.objects)
        object.shape = Mesh{"", 1, triangulate(object.shape)};
    return GetParam().solve(scene, rtol);
  }

  /// Returns the answer for the hand above the sensors, which every way computes once.
  static const MaxwellMatrix& of_the_hand(double rtol = GetParam().rtol()) {
    static std::map<std::pair<std::string, double>, MaxwellMatrix> known;
    const auto [place, is_new] = known.try_emplace({GetParam().name, rtol});
    if (is_new)
      place->second = solve(hand_above_sensors(), rtol);
    return place->second;
  }
};

double relative_difference(const MatrixXd& a, const MatrixXd& b) {
  return ((a - b).array() / b.array()).abs().maxCoeff();
}

const MaxwellMatrix& truth() {
  static const MaxwellMatrix answer = maxwell(hand_above_sensors(), {.rtol = 1e-4});
  return answer;
}

TEST_P(MatricesByMethod, AreWithinTheirErrorsOfTheTruth) {
  for (const double rtol : GetParam().rtols) {
    SCOPED_TRACE(rtol);
    const MaxwellMatrix& answer = of_the_hand(rtol);
    EXPECT_EQ(answer.conductors, truth().conductors);
    EXPECT_TRUE(answer.reached);
    EXPECT_TRUE(covers(answer, truth()));
    for (Eigen::Index i = 0; i < answer.values.rows(); ++i)
      if (answer.lower_bounds[static_cast<std::size_t>(i)]) {
        EXPECT_LE(answer.values(i, i), truth().values(i, i) + truth().errors(i, i));
      }
  }
}

/// C/4πεa of the square plate, to one unit in the last place (two independent boundary-element computations;
/// HierBEM 0.3667874), and of the cube (Helsing and Perfekt 2013).
TEST_P(MatricesByMethod, AreTheKnownCapacitancesOfASquareAndOfACube) {
  for (const auto& [shape, length, known] :
       {std::tuple(Shape(Plate{0.1, 0.1}), 0.1, 0.366788), std::tuple(Shape(Cuboid{2, 2, 2}), 2.0, 0.660678)})
    for (const double rtol : GetParam().rtols) {
      SCOPED_TRACE(rtol);
      Scene scene;
      scene.objects = {object("body", shape, at(0.3, 0, 0))};
      const MaxwellMatrix answer = solve(scene, rtol);
      const double value = per_length(answer.values(0, 0), length),
                   error = per_length(answer.errors(0, 0), length);
      constexpr double known_to = 1e-6;
      EXPECT_TRUE(answer.reached);
      EXPECT_LE(error, rtol * value);
      EXPECT_NEAR(value, known, error + known_to);
      EXPECT_EQ(answer.lower_bounds[0], GetParam().is_lower_bound);
      EXPECT_TRUE(!answer.lower_bounds[0] || value <= known + known_to);
    }
}

TEST_P(MatricesByMethod, AreReciprocalAndPositiveDefinite) {
  const MaxwellMatrix& answer = of_the_hand();
  EXPECT_LT(relative_difference(answer.values, answer.values.transpose()), 1e-12);
  EXPECT_EQ(answer.values.llt().info(), Eigen::Success);
  for (Eigen::Index i = 0; i < answer.values.rows(); ++i)
    EXPECT_GT(answer.values.row(i).sum(), 0) << "all at one potential, every charge is positive";
}

TEST_P(MatricesByMethod, DoNotDependOnPlaceScaleAndMedium) {
  // Powers of two round nothing, so that nothing is divided in another way.
  for (const double scale : {0x1p-20, 0x1p13}) {
    Scene moved = hand_above_sensors(scale);
    Eigen::Isometry3d motion = at(0.3 * scale, -0.2 * scale, 0.1 * scale);
    motion.rotate(Eigen::AngleAxisd(1.1, Vector3d(0.3, -1, 0.4).normalized()));
    moved.links.push_back({"everything", {}, motion});
    moved.links[0].parent = 1;
    for (Sensor& sensor : moved.sensors)
      sensor.link = 1;
    moved.objects[1].link = 1;
    moved.medium.relative_permittivity = 3;
    EXPECT_LT(relative_difference(solve(moved).values, 3 * scale * of_the_hand().values),
              GetParam().rounding);
  }
}

TEST_P(MatricesByMethod, ExchangeTheirEntriesWithTheConductors) {
  Scene exchanged = hand_above_sensors();
  std::swap(exchanged.sensors[0], exchanged.sensors[1]);
  std::swap(exchanged.objects[0], exchanged.objects[1]);
  Eigen::PermutationMatrix<4> order;
  order.indices() << 1, 0, 3, 2;
  const MatrixXd permuted = order * solve(exchanged).values * order;
  EXPECT_LT(relative_difference(permuted, of_the_hand().values), GetParam().reordering);
}

TEST_P(MatricesByMethod, HaveNoRowOfAFloatingObjectWhichHasNoCharge) {
  Scene scene = hand_above_sensors();
  scene.objects[0].role = Floating{};
  const MaxwellMatrix answer = solve(scene, GetParam().rtols.back());
  EXPECT_EQ(answer.conductors, (std::vector<std::string>{"left", "right", "plate"}));
  EXPECT_EQ(answer.floating, std::vector<std::string>{"box"});
  const MatrixXd& all = truth().values;
  const MatrixXd without = all - all.col(2) * all.row(2) / all(2, 2);
  constexpr Eigen::Index kept[] = {0, 1, 3};
  for (Eigen::Index i = 0; i < 3; ++i)
    for (Eigen::Index j = 0; j < 3; ++j) {
      const double expected = without(kept[i], kept[j]);
      EXPECT_NEAR(answer.values(i, j), expected, answer.errors(i, j) + 3e-4 * std::abs(expected));
    }
}

TEST_P(MatricesByMethod, DeltaSelfIsWhatTheObjectsAdd) {
  const MaxwellMatrix& with = of_the_hand();
  Scene scene = hand_above_sensors();
  scene.objects.clear();
  const MaxwellMatrix without = solve(scene);
  for (Eigen::Index s = 0; s < 2; ++s) {
    EXPECT_GT(with.delta_self[s], 0);
    EXPECT_NEAR(with.delta_self[s], with.values(s, s) - without.values(s, s),
                with.errors(s, s) + without.errors(s, s));
    EXPECT_NEAR(without.delta_self[s], 0, 1e-5 * without.values(s, s));
  }
}

INSTANTIATE_TEST_SUITE_P(
    By, MatricesByMethod,
    testing::Values(
        Way{"BoundaryElements", by_boundary_elements, false, true, {0.1, 1e-3, 1e-4}, 1e-9, 1e-7},
        // Rounding may change a decision of the refinement, and so the mesh.
        Way{"BoundaryElementsOfTriangles", by_boundary_elements, true, true, {3e-2, 1e-2}, 2e-4, 2e-4},
        Way{"ReducedMethod", by_the_reduced_method, false, false, {1e-2, 1e-3, 3e-4}, 1e-5, 1e-4},
        Way{"ReducedMethodOfTriangles", by_the_reduced_method, true, false, {0.1}, 1e-5, 1e-4}),
    [](const testing::TestParamInfo<Way>& info) { return info.param.name; });

// Scenes of triangles take half a minute to prepare for 1e-2, a cube two seconds.
TEST(ReducedTriangles, HaveTheKnownCapacitanceOfACube) {
  Scene scene;
  scene.objects = {object("cube", Mesh{"", 1, triangulate(Cuboid{2, 2, 2})}, at(0.3, 0, 0))};
  const MaxwellMatrix answer = by_the_reduced_method(scene, 1e-2);
  EXPECT_TRUE(answer.reached);
  EXPECT_NEAR(per_length(answer.values(0, 0), 2), 0.660678, per_length(answer.errors(0, 0), 2));
}

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// A change of a plate above a sensor of 10 cm that makes a scene of which there is no matrix, and the
/// reason.
struct Refusal {
  std::function<void(Object& target, Scene& scene)> change;
  const char* reason;
};

const Refusal refused_by_both[] = {
    {[](Object&, Scene& scene) { scene.has_room = true; }, "room"},
    {[](Object& target, Scene&) { target.role = Dielectric{3}; },
     "object \"target\" is dielectric, but its surface encloses no volume"},
    {[](Object&, Scene& scene) {
       scene.objects.push_back(object("other", Cuboid{1, 1, 1}, at(0, 0, 2), Electrode{}));
       for (Object& object : scene.objects)
         object.conductor = "arm";
     },
     "object \"other\": conductor \"arm\" has one potential, but its objects differ"},
    {[](Object& target, Scene&) {
       target.shape = Sphere{0.5, 16};
     },
     "sensor \"front\" plates[0] is inside object \"target\""},
    // The cube reaches from 3 cm below the plate to 7 cm above it.
    {[](Object& target, Scene&) {
       target.shape = Cuboid{0.1, 0.1, 0.1};
     },
     "sensor \"front\" plates[0] is clear of it when moved by more than 0.03 m along (0, 0, -1)"},
    {[](Object&, Scene& scene) {
       scene.sensors[0].plates[0].edge_v = {0.05, 0.1, 0};
     },
     "sensor \"front\" plates[0]: edge_u and edge_v are not at right angles"},
    {[](Object&, Scene& scene) {
       scene.sensors[0].plates[0].edge_u = {1e-100, 0, 0};
     },
     "sensor \"front\" plates[0]: a length of 1e-100 m is shorter than 1e-30 m"},
    {[](Object& target, Scene&) {
       target.shape = Plate{0.1, 0};
     },
     "object \"target\": a size of 0 is not positive"},
    {[](Object& target, Scene&) { target.pose = at(0, 0, not_a_number); },
     "object \"target\": its pose is not finite"},
    {[](Object& target, Scene&) { target.pose = at(0, 0, 1e15); },
     "object \"target\": it is 0.141 m long and"},
    {[](Object& target, Scene&) {
       const Triangle flat{Vector3d(0, 0, 0), Vector3d(0.01, 0, 0), Vector3d(0.02, 0, 0)};
       const Triangle needle{Vector3d(0, 0, 0), Vector3d(0.01, 0, 0), Vector3d(0.004, 5e-11, 0)};
       target.shape = Mesh{"", 1, {flat, needle}};
     },
     "object \"target\": no triangle has an area"},
    {[](Object& target, Scene& scene) {
       scene.sensors.clear();
       target.role = Floating{};
     },
     "neither a sensor nor a grounded object"},
    {[](Object&, Scene& scene) {
       scene.readings = {{"hum", "front", {"front", "target"}}};
     },
     "reading \"hum\": \"target\" is neither a sensor nor the conductor of an electrode"},
    {[](Object&, Scene& scene) { scene = {}; }, ""},
};

std::string refusal(const std::function<void(Object&, Scene&)>& change,
                    const std::function<void(const Scene&)>& solve) {
  return test::refusal([&](Scene& scene) { change(scene.objects[0], scene); }, solve);
}

void expect_refused(const std::function<void(Object&, Scene&)>& change, const std::string& reason) {
  for (const auto solve : {by_boundary_elements, by_the_reduced_method}) {
    const std::string told = refusal(change, [&](const Scene& scene) { solve(scene, 0.1); });
    EXPECT_THAT(told, HasSubstr(reason));
    EXPECT_NE(told, "accepted");
  }
}

TEST(MatrixRefusals, NameTheElementAndTheReason) {
  for (const auto& [change, reason] : refused_by_both)
    expect_refused(change, reason);
  const std::string crossing = "sensor \"front\" plates[0] and object \"target\" touch or cross";
  for (const Eigen::Isometry3d& pose :
       {at(0.02, 0, 0), at(0.1, 0, 0), Eigen::Isometry3d(Eigen::AngleAxisd(0.5, Vector3d::UnitX()))})
    expect_refused([&](Object& target, Scene&) { target.pose = pose; }, crossing);
  for (const Shape& shape : {Shape(Cuboid{0.3, 0.3, 0.1}), Shape(Cylinder{0.03, 0.04, 16})})
    expect_refused([&](Object& target, Scene&) { target.shape = shape; }, crossing);
  for (const Shape& shape :
       {Shape(Sphere{1e-100, 16}), Shape(Cylinder{1e-100, 0.1, 16}), Shape(Disc{1e-100, 16})})
    expect_refused([&](Object& target, Scene&) { target.shape = shape; }, "object \"target\": a length of");
  for (const ElectricalRole& role : {ElectricalRole(Floating{}), ElectricalRole(Electrode{})})
    expect_refused(
        [&](Object&, Scene& scene) {
          scene.objects.push_back(object("other", Cuboid{0.02, 0.02, 0.02}, at(0, 0, 0.03), role));
        },
        "touch or cross: they may have different potentials");
}

TEST(MatrixRefusals, OfOptionsNameTheirLimits) {
  const auto refused = [&](const BoundaryElementOptions& options) {
    return refusal([](Object&, Scene&) {}, [&](const Scene& scene) { maxwell(scene, options); });
  };
  for (const double rtol : {0.0, -1e-3, 1e-7, 0.6, not_a_number})
    EXPECT_THAT(refused({.rtol = rtol}), HasSubstr("must be from 1e-06 to 0.5"));
  for (const double rtol : {1e-5, 0.6, not_a_number})
    EXPECT_THAT(
        refusal([](Object&, Scene&) {}, [&](const Scene& scene) { by_the_reduced_method(scene, rtol); }),
        HasSubstr("must be from 0.0001 to 0.5"));
  EXPECT_THAT(refused({.rtol = 1e-3, .most_unknowns = 90}), HasSubstr("needs at least 98 unknowns"));
  const auto ball = [](int segments) {
    return [=](Object& target, Scene&) { target.shape = Sphere{0.01, segments}; };
  };
  EXPECT_THAT(
      refusal(ball(48), [](const Scene& scene) { maxwell(scene, {.rtol = 1e-3, .most_unknowns = 2000}); }),
      HasSubstr("the scene needs at least 2257 unknowns: boundary elements take at most 2000"));
  EXPECT_THAT(refusal(ball(72), [](const Scene& scene) { by_the_reduced_method(scene, 1e-2); }),
              HasSubstr("object \"target\" has 5040 triangles"));
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
