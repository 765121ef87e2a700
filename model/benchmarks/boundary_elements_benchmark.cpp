/// Measures boundary elements by rtol: time, true error and estimated error over set-ups whose Maxwell matrix
/// is known from another boundary-element method, and time over boxes and bodies of triangles. Times are
/// processor times of this thread, the least of five (of two for bodies of triangles), without the data that
/// are computed once per process. At the end it prints the tables of model/BOUNDARY_ELEMENTS.md, to be pasted
/// as they are.

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "fringe/boundary_elements.hpp"
#include "fringe/triangulation.hpp"
#include "processor_time.hpp"

namespace {

using namespace fringe;

constexpr std::array rtols{1e-2, 1e-3, 1e-4, 1e-5};
constexpr std::array mesh_rtols{1e-2, 1e-3};

struct SetUp {
  std::string name;
  Scene scene;
  Eigen::MatrixXd truth;      ///< F; empty when not known
  double relative_error = 0;  ///< relative error of the truth
};

Eigen::Vector3d vector(const nlohmann::json& value) {
  return Eigen::Vector3d(value.get<std::array<double, 3>>().data());
}

/// Reads the set-ups. Every conductor is read as a sensor, since a sensor may consist of several rectangles.
std::vector<SetUp> known_set_ups() {
  std::ifstream file(FRINGE_SET_UPS);
  const nlohmann::json document = nlohmann::json::parse(file);
  std::vector<SetUp> set_ups;
  for (const auto& known : document["cases"]) {
    SetUp& set_up = set_ups.emplace_back();
    set_up.name = known["name"];
    for (const auto& name : known["conductors"])
      set_up.scene.sensors.push_back({name, {}, 2.5, 5e-12, {}});
    for (const auto& plate : known["rectangles"])
      set_up.scene.sensors[plate["conductor"].get<std::size_t>()].plates.push_back(
          {vector(plate["corner"]), vector(plate["edge_u"]), vector(plate["edge_v"])});
    const auto rows = known["maxwell_pF"].get<std::vector<std::vector<double>>>();
    const auto size = static_cast<Eigen::Index>(rows.size());
    set_up.truth.resize(size, size);
    for (Eigen::Index i = 0; i < size; ++i)
      set_up.truth.row(i) =
          1e-12 * Eigen::Map<const Eigen::RowVectorXd>(rows[static_cast<std::size_t>(i)].data(), size);
    set_up.relative_error = known["relative_error"];
  }
  return set_ups;
}

/// Makes a set-up of a plate of 10 cm and a body in front of it.
SetUp body_set_up(const std::string& name, const Shape& body, const Eigen::Vector3d& centre, double degrees) {
  SetUp set_up;
  set_up.name = name;
  set_up.scene.sensors.push_back({"sensor", {}, 2.5, 5e-12, {{{-0.05, -0.05, 0}, {0.1, 0, 0}, {0, 0.1, 0}}}});
  Object object{"body", {}, body, Eigen::Isometry3d::Identity(), Grounded{}, true};
  object.pose.translate(centre);
  object.pose.rotate(Eigen::AngleAxisd(degrees * EIGEN_PI / 180, Eigen::Vector3d(1, 0.5, 0.2).normalized()));
  set_up.scene.objects.push_back(object);
  return set_up;
}

std::vector<SetUp> box_set_ups() {
  std::vector<SetUp> set_ups;
  const auto add = [&](const std::string& name, const Cuboid& box, const Eigen::Vector3d& centre,
                       double degrees) { set_ups.push_back(body_set_up(name, box, centre, degrees)); };
  add("cube 5 cm, 2 cm above", {0.05, 0.05, 0.05}, {0, 0, 0.045}, 0);
  add("cube 10 cm, 1 cm above", {0.1, 0.1, 0.1}, {0, 0, 0.06}, 0);
  add("box 4 x 8 x 2 cm, turned", {0.04, 0.08, 0.02}, {0.03, 0.02, 0.06}, 35);
  add("box 20 x 20 x 1 cm, beside", {0.2, 0.2, 0.01}, {0.17, 0, 0.03}, 0);
  return set_ups;
}

/// Fills in unknown true values by the answer at the strictest rtol that is reached quickly.
void solve_unknown(std::vector<SetUp>& set_ups, double rtol) {
  for (SetUp& set_up : set_ups)
    if (set_up.truth.size() == 0) {
      const MaxwellMatrix best = maxwell(set_up.scene, {.rtol = rtol});
      set_up.truth = best.values;
      set_up.relative_error = (best.errors.array() / best.values.array().abs()).maxCoeff();
    }
}

/// Makes bodies of triangles; the true values of a cube are computed with its square faces as elements.
std::vector<SetUp> mesh_set_ups() {
  const Cuboid cube{0.05, 0.05, 0.05};
  std::vector<SetUp> cubes{body_set_up("", cube, {0, 0, 0.045}, 0)};
  solve_unknown(cubes, 1e-5);
  std::vector<SetUp> set_ups{
      body_set_up("cube of 12 triangles, 2 cm above", Mesh{"", 1, triangulate(cube)}, {0, 0, 0.045}, 0),
      body_set_up("cylinder of 96 triangles, 1 cm above", Cylinder{0.02, 0.06, 24}, {0, 0, 0.04}, 0),
      body_set_up("ball of 1,088 triangles, 2 cm above", Sphere{0.03, 34}, {0, 0, 0.05}, 0),
      body_set_up("ball of 5,040 triangles, 2 cm above", Sphere{0.03, 72}, {0, 0, 0.05}, 0)};
  set_ups[0].truth = cubes[0].truth;
  set_ups[0].relative_error = cubes[0].relative_error;
  solve_unknown(set_ups, 1e-3);
  return set_ups;
}

/// The results of one set-up at one rtol; errors are relative to the entries.
struct Measurement {
  std::string name;
  double rtol;
  std::size_t unknowns;
  double milliseconds;
  double error;
  double known_to;
  double stated;
  bool covered;  ///< whether the estimated error plus the uncertainty of the truth covers the error
};

Measurement measure(const SetUp& set_up, double rtol, int repeats) {
  const BoundaryElementOptions options{.rtol = rtol};
  MaxwellMatrix answer = maxwell(set_up.scene, options);
  const double seconds =
      benchmarks::least_seconds_of([&] { answer = maxwell(set_up.scene, options); }, repeats);
  const Eigen::ArrayXXd error = (answer.values - set_up.truth).array() / set_up.truth.array();
  const double estimate = (answer.errors.array() / answer.values.array().abs()).maxCoeff();
  fmt::print("{:<40} {:>8.0e} {:>9} {:>8} {:>10.2f} {:>12.5f} {:>12.5f} {:>12.5f}\n", set_up.name, rtol,
             answer.unknowns, answer.reached ? "yes" : "no", 1e3 * seconds, 100 * error.abs().maxCoeff(),
             100 * set_up.relative_error, 100 * estimate);
  const bool covered = ((answer.values - set_up.truth).array().abs() <=
                        answer.errors.array() + set_up.relative_error * set_up.truth.array().abs())
                           .all();
  return {set_up.name,           rtol,     answer.unknowns, 1e3 * seconds, error.abs().maxCoeff(),
          set_up.relative_error, estimate, covered};
}

std::string written(double rtol) {
  const int power = static_cast<int>(std::lround(std::log10(rtol)));
  return fmt::format("1e{}", power);
}

/// Formats a value with two significant digits.
std::string rounded(double value) {
  const double power = std::floor(std::log10(value)), unit = std::pow(10, power - 1);
  return fmt::format("{:.{}f}", std::round(value / unit) * unit, std::max(0, 1 - static_cast<int>(power)));
}

/// Prints the rows of a group of set-ups, one for every rtol.
void print_rows(const std::string& what, const std::vector<Measurement>& measured,
                std::span<const double> asked) {
  for (const double rtol : asked) {
    std::vector<double> times, errors;
    for (const Measurement& one : measured)
      if (one.rtol == rtol) {
        times.push_back(one.milliseconds);
        errors.push_back(100 * one.error);
      }
    std::sort(times.begin(), times.end());
    std::sort(errors.begin(), errors.end());
    fmt::print("| {} | {} | {} / {} | {} / {} |\n", rtol == asked.front() ? what : "", written(rtol),
               rounded(errors[errors.size() / 2]), rounded(errors.back()), rounded(times[times.size() / 2]),
               rounded(times.back()));
  }
}

/// Prints a row for each body of triangles; omits the true error if the truth is not known more accurately
/// than that.
void print_rows(const std::vector<Measurement>& measured) {
  for (const Measurement& one : measured)
    fmt::print("| {} | {} | {} | {} / {} / {} | {} |\n", one.name, written(one.rtol), one.unknowns,
               one.known_to < one.error ? rounded(100 * one.error) : "–", rounded(100 * one.known_to),
               rounded(100 * one.stated), rounded(one.milliseconds));
}

std::ptrdiff_t count_covered(const std::vector<Measurement>& measured) {
  return std::count_if(measured.begin(), measured.end(), [](const Measurement& one) { return one.covered; });
}

}  // namespace

int main() {
  const std::vector<SetUp> plates = known_set_ups();
  std::vector<SetUp> boxes = box_set_ups();
  solve_unknown(boxes, 1e-5);
  const std::vector<SetUp> meshes = mesh_set_ups();
  fmt::print("{:<40} {:>8} {:>9} {:>8} {:>10} {:>12} {:>12} {:>12}\n", "set-up", "rtol", "unknowns",
             "reached", "ms", "error %", "known to %", "estimate %");
  std::vector<Measurement> of_plates, of_boxes, of_meshes;
  for (const double rtol : rtols) {
    for (const SetUp& set_up : plates)
      of_plates.push_back(measure(set_up, rtol, 5));
    for (const SetUp& set_up : boxes)
      of_boxes.push_back(measure(set_up, rtol, 5));
  }
  for (const double rtol : mesh_rtols)
    for (const SetUp& set_up : meshes)
      of_meshes.push_back(measure(set_up, rtol, 2));
  fmt::print("\n| | rtol | error %, median / worst | ms, median / longest |\n|---|---|---|---|\n");
  print_rows("plates", of_plates, rtols);
  print_rows("boxes", of_boxes, std::span(rtols).first(3));
  fmt::print("\n| | rtol | unknowns | error %, true / known to / stated | ms |\n|---|---|---|---|---|\n");
  print_rows(of_meshes);
  fmt::print("\n{} of {} answers within their stated error\n",
             count_covered(of_plates) + count_covered(of_boxes) + count_covered(of_meshes),
             of_plates.size() + of_boxes.size() + of_meshes.size());
}
