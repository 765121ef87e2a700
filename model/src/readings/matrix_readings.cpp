#include "readings/matrix_readings.hpp"

#include "fringe/reading.hpp"
#include "readings/readings.hpp"
#include "surface/charged_readings.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;

/// Returns the value of a reading by a Maxwell matrix, and its error.
Estimate estimate(const ChargedReading& reading, const MaxwellMatrix& matrix) {
  return {reading.sense.dot(matrix.values * reading.drive),
          reading.sense.cwiseAbs().dot(matrix.errors * reading.drive)};
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

std::vector<ReadingAnswer> readings_of_sensors(const MaxwellMatrix& matrix) {
  std::vector<ReadingAnswer> answers;
  for (std::size_t sensor = 0; sensor < matrix.sensors; ++sensor) {
    const auto row = static_cast<Index>(sensor);
    Estimate value{matrix.values(row, row), matrix.errors(row, row)};
    if (matrix.lower_bounds[sensor])
      value.lower = value.value;
    const Estimate change{matrix.delta_self[row], matrix.delta_self_errors[row]};
    const Estimate background{*value.value - *change.value, *value.error + *change.error};
    answers.push_back({matrix.conductors[sensor], value, background, change});
  }
  return answers;
}

std::vector<ReadingAnswer> readings_of_matrices(const std::vector<Reading>& readings,
                                                const MaxwellMatrix& all, const MaxwellMatrix& background) {
  const std::vector<ChargedReading> with = charged_readings(readings, all.conductors);
  const std::vector<ChargedReading> without = charged_readings(readings, background.conductors);
  std::vector<ReadingAnswer> answers;
  for (std::size_t k = 0; k < readings.size(); ++k) {
    const Estimate value = estimate(with[k], all), alone = estimate(without[k], background);
    const Estimate change{*value.value - *alone.value, *value.error + *alone.error};
    answers.push_back({readings[k].name, value, alone, change});
  }
  return answers;
}

}  // namespace fringe::detail
