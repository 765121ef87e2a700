#include "bem/matrix_readings.hpp"

#include <algorithm>
#include <string>

#include "fringe/reading.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;

/// Returns the row of a conductor.
Index row_of(const MaxwellMatrix& matrix, const std::string& conductor) {
  const auto found = std::find(matrix.conductors.begin(), matrix.conductors.end(), conductor);
  return found - matrix.conductors.begin();
}

/// Returns the value of a reading by a Maxwell matrix, and its error.
Estimate estimate(const Reading& reading, const MaxwellMatrix& matrix) {
  const Index sense = row_of(matrix, reading.sense);
  double value = 0, error = 0;
  bool is_driven = false;
  for (const std::string& name : reading.drive) {
    const Index driven = row_of(matrix, name);
    value += matrix.values(sense, driven);
    error += matrix.errors(sense, driven);
    is_driven = is_driven || name == reading.sense;
  }
  return {is_driven ? value : -value, error};
}

}  // namespace

Scene without_targets(const Scene& scene) {
  const std::vector<bool> are_targets = targets(scene);
  Scene result = scene;
  result.objects.clear();
  for (std::size_t k = 0; k < scene.objects.size(); ++k)
    if (!are_targets[k])
      result.objects.push_back(scene.objects[k]);
  return result;
}

bool changes_are_delta_self(const Scene& scene) {
  const std::vector<bool> are_targets = targets(scene);
  return scene.readings.empty() &&
         std::find(are_targets.begin(), are_targets.end(), false) == are_targets.end();
}

std::vector<ReadingAnswer> readings_of_sensors(const MaxwellMatrix& matrix) {
  std::vector<ReadingAnswer> answers;
  for (std::size_t sensor = 0; sensor < matrix.sensors; ++sensor) {
    const auto row = static_cast<Index>(sensor);
    const Estimate value{matrix.values(row, row), matrix.errors(row, row)};
    const Estimate change{matrix.delta_self[row], matrix.delta_self_errors[row]};
    const Estimate background{*value.value - *change.value, *value.error + *change.error};
    answers.push_back({matrix.conductors[sensor], value, background, change});
  }
  return answers;
}

std::vector<ReadingAnswer> readings_of_matrices(const std::vector<Reading>& readings,
                                                const MaxwellMatrix& all, const MaxwellMatrix& background) {
  std::vector<ReadingAnswer> answers;
  for (const Reading& reading : readings) {
    const Estimate with = estimate(reading, all), without = estimate(reading, background);
    const Estimate change{*with.value - *without.value, *with.error + *without.error};
    answers.push_back({reading.name, with, without, change});
  }
  return answers;
}

}  // namespace fringe::detail
