#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <pybind11/pybind11.h>

#include "fringe/reading_answer.hpp"

/// The readings of a scene as objects of Python.
namespace fringe::python {

/// The answer of a reading: `Reading`.
struct PythonReading {
  std::string name;
  std::optional<double> value, background, change;
  std::map<std::string, std::optional<double>> error;
  std::string answered_by;
  std::map<std::string, PoseDerivatives> derivatives;  ///< by link
  std::map<std::string, std::optional<PoseDerivatives>> derivative_errors;
  std::optional<bool> reached;
};

/// Returns readings by their names.
std::map<std::string, PythonReading> python_readings(const std::vector<ReadingAnswer>& answers);

/// The readings of a motion: `MotionReadings`. Arrays have a row for each frame and a column for each
/// reading; NaN is what the method does not know.
struct MotionTable {
  std::vector<std::string> frames, readings;
  std::vector<std::vector<std::string>> answered_by;  ///< in each frame
  std::vector<std::optional<bool>> reached;           ///< in each frame
  Eigen::MatrixXd value, background, change;
  std::map<std::string, Eigen::MatrixXd> error;
};

/// Returns the table of the answers in frames of these names.
MotionTable motion_table(std::vector<std::string> frames, const std::vector<std::string>& readings,
                         const std::vector<std::vector<ReadingAnswer>>& answers);

/// Adds both types to the module.
void add_readings(pybind11::module_& module);

}  // namespace fringe::python
