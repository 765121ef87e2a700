#include "scene/expected_seconds.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <variant>
#include <vector>

#include "bem/mesh_size.hpp"
#include "bem/panel_mesh.hpp"
#include "fringe/error.hpp"
#include "fringe/triangulation.hpp"
#include "surface/bodies.hpp"
#include "surface/insulators.hpp"
#include "surface/simplification.hpp"

namespace fringe::detail {
namespace {

double seconds_of_formula(const SceneSize& size) {
  constexpr double per_triangle = 4e-6;
  return per_triangle * size.triangles * size.sensors;
}

/// Counts what boundary elements begin with on bodies that are joined where they touch.
FirstUnknowns first_unknowns(ChargedBodies bodies, int least) {
  /// Panels that a surface gets where others are close, in the mean of 318 random scenes.
  constexpr double added_panels = 210;
  double undivided = 0, divided = 0, surfaces = 0;
  std::erase_if(bodies.bodies, [&](const ChargedBody& body) {
    const std::size_t count = triangles_of(body.surface).size();
    if (count == 0)
      return false;
    if (count > PanelMesh::few_triangles)
      undivided += static_cast<double>(count);
    else
      divided += 4 * static_cast<double>(count);
    divided += added_panels;
    ++surfaces;
    return true;
  });
  const std::vector<double> functions = numbers_of_functions(bodies, std::array{1.0, 2.0}, least);
  return {functions[0], functions[1],
          divided + std::min(undivided, static_cast<double>(Simplification::few_triangles)), surfaces};
}

/// Returns what boundary elements take for their functions. Fitted, with the panels, to 318 random scenes of
/// conductors (`analysis honesty`, seeds 0 to 415) at 1e-2. Of 104 other scenes (seeds 624 to 727), some with
/// insulators, 71 % took half to twice as long. The functions that would resolve the charge twice tell how
/// many refinements there are.
double seconds_of_functions(const SceneSize& size) {
  constexpr double of_some = 0.021, some = 300, by_functions = 1.16, by_features = 2.7;
  const FirstUnknowns& first = size.unknowns;
  return first.functions > 0 ? of_some * std::pow(first.functions / some, by_functions) *
                                   std::pow(first.finer_functions / first.functions, by_features)
                             : 0;
}

/// That of panels was fitted to the same scenes. What insulators add hardly depends on their size.
double seconds_of_boundary_elements(const SceneSize& size, const Effort& effort) {
  constexpr double of_panels = 0.125, many = 1000, by_panels = 1.2, of_coupling = 0.107, some = 300;
  /// Of 22 random scenes whose dielectric bodies are boxes (seeds 4 to 199) 17 took half to twice as long as
  /// that, of ten with curved ones (seeds 18 to 200) eight.
  constexpr double of_boxes = 1.6, of_curved = 3.3;
  constexpr double usual_rtol = 1e-2, by_rtol = 0.4;
  const double panels = size.unknowns.panels / many, functions = size.unknowns.functions / some;
  double seconds =
      seconds_of_functions(size) + of_panels * std::pow(panels, by_panels) + of_coupling * functions * panels;
  if (size.has_insulators)
    seconds += size.has_curved_insulators ? of_curved : of_boxes;
  return seconds * std::pow(usual_rtol / effort.rtol, by_rtol);
}

/// Fitted to 190 random scenes of 2 to 9 bodies (`analysis honesty`): the preparation of plates and boxes
/// takes twice what boundary elements take, that of other bodies and of those that touch at one potential
/// most of it. That of machines was measured on seven of 28 to 32,548 triangles.
double seconds_of_reduction(const SceneSize& size, const Effort& effort) {
  constexpr double per_pair = 2e-6, per_solution = 2.2, per_curved_body = 2, per_joined_body = 6;
  constexpr double per_pose = 1e-3, machine = 2, per_triangle = 1e-3;
  constexpr double rough_machine = 0.6, rough_triangle = 9e-5;
  if (effort.is_rough)
    return rough_machine + rough_triangle * size.prepared_triangles;
  if (effort.is_by_matrix) {
    const double preparation = per_solution * seconds_of_functions(size) + per_curved_body * size.curved +
                               per_joined_body * std::max(size.unknowns.surfaces - size.curved, 0.0);
    return per_pair * size.bodies() * size.bodies() + (effort.is_prepared ? 0 : preparation);
  }
  return effort.is_prepared ? per_pose : machine + per_triangle * size.prepared_triangles;
}

}  // namespace

SceneSize::SceneSize(const Scene& scene)
    : sensors(static_cast<double>(scene.sensors.size())), has_insulators(detail::has_insulators(scene)) {
  for (const Sensor& sensor : scene.sensors)
    plates += static_cast<double>(sensor.plates.size());
  for (const Object& object : scene.objects) {
    const auto count = static_cast<double>(triangulate(object.shape).size());
    triangles += count;
    if (std::holds_alternative<Plate>(object.shape))
      ++plates;
    else if (std::holds_alternative<Cuboid>(object.shape))
      ++boxes;
    else {
      has_curved_insulators |= std::holds_alternative<Dielectric>(object.role);
      prepared_triangles += count;
      ++curved;
    }
  }
}

void SceneSize::count_unknowns(const Scene& scene) {
  /// Number of faces above which counting would take as long as the first solution.
  constexpr double most_faces = 200, faces_of_box = 6;
  constexpr int least = 5;
  if (are_counted)
    return;
  are_counted = true;
  const double faces = plates + faces_of_box * boxes;
  unknowns = {least * least * faces, least * least * faces,
              std::min(prepared_triangles, static_cast<double>(Simplification::few_triangles)), curved};
  if (faces > most_faces || has_insulators || prepared_triangles > Simplification::few_triangles)
    return;
  try {
    unknowns = first_unknowns(charged_bodies(scene), least);
  } catch (const InputError&) {
    // Boundary elements refuse the scene at once.
  }
}

double expected_seconds(const Method& method, const SceneSize& size, const Effort& effort) {
  constexpr double per_integral = 3e-7;
  if (std::holds_alternative<Formula>(method))
    return seconds_of_formula(size);
  if (std::holds_alternative<Reduced>(method))
    return seconds_of_reduction(size, effort);
  if (std::holds_alternative<BoundaryElements>(method))
    return seconds_of_boundary_elements(size, effort);
  const auto* split = std::get_if<Split>(&method);
  return per_integral * size.triangles * size.sensors * (split != nullptr ? std::pow(4, split->levels) : 1);
}

}  // namespace fringe::detail
