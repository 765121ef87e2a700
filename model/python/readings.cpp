#include "readings.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

namespace py = pybind11;

namespace fringe::python {
namespace {

using namespace pybind11::literals;

constexpr double picofarads_per_farad = 1e12;

/// The quantities of a reading, in the order in which they are listed.
constexpr std::array quantities{"value", "background", "change"};

/// Writes a capacitance with its error, in pF.
std::string in_picofarads(const std::optional<double>& value, const std::optional<double>& error) {
  if (!value)
    return "not known";
  const std::string number = fmt::format("{:.6g}", *value * picofarads_per_farad);
  // The infinite value of contact is certain.
  if (std::isinf(*value))
    return number + " pF";
  return error ? fmt::format("{} ± {:.2g} pF", number, *error * picofarads_per_farad)
               : fmt::format("{} pF, error not known", number);
}

std::optional<double> quantity(const PythonReading& reading, const std::string& name) {
  return name == "value" ? reading.value : name == "background" ? reading.background : reading.change;
}

std::string printed(const PythonReading& reading) {
  std::string text = fmt::format("<fringe.Reading {}", reading.name);
  for (const std::string name : quantities)
    text += fmt::format("{} {} {}", name == quantities.front() ? ":" : ",", name,
                        in_picofarads(quantity(reading, name), reading.error.at(name)));
  return text + fmt::format(", by {}>", reading.answered_by);
}

/// Returns text that may stand in an HTML page.
std::string escaped(const std::string& text) {
  return py::module_::import("html").attr("escape")(text).cast<std::string>();
}

std::string html(const PythonReading& reading) {
  std::string text =
      fmt::format("<table><caption>{}, by {}</caption>", escaped(reading.name), reading.answered_by);
  for (const std::string name : quantities)
    text += fmt::format("<tr><th>{}</th><td>{}</td></tr>", name,
                        in_picofarads(quantity(reading, name), reading.error.at(name)));
  return text + "</table>";
}

const Eigen::MatrixXd& numbers_of(const MotionTable& table, const std::string& name) {
  return name == "value" ? table.value : name == "background" ? table.background : table.change;
}

/// Returns a row for each frame and reading, with the columns of the tables of fringe sweep.
py::object to_pandas(const MotionTable& table) {
  py::dict columns;
  py::list frames, readings, answered_by, reached;
  for (std::size_t frame = 0; frame < table.frames.size(); ++frame)
    for (std::size_t reading = 0; reading < table.readings.size(); ++reading) {
      frames.append(table.frames[frame]);
      readings.append(table.readings[reading]);
      answered_by.append(table.answered_by[frame][reading]);
      reached.append(table.reached[frame]);
    }
  columns["name"] = frames;
  columns["reading"] = readings;
  columns["answered_by"] = answered_by;
  const auto flat = [](const Eigen::MatrixXd& array) { return py::cast(array).attr("ravel")(); };
  for (const std::string name : quantities) {
    columns[py::str(name + "_F")] = flat(numbers_of(table, name));
    columns[py::str(name + "_error_F")] = flat(table.error.at(name));
  }
  columns["reached"] = reached;
  return py::module_::import("pandas").attr("DataFrame")(columns);
}

py::object to_xarray(const MotionTable& table) {
  const py::tuple dimensions = py::make_tuple("frame", "reading");
  py::dict variables;
  for (const std::string name : quantities) {
    variables[py::str(name)] = py::make_tuple(dimensions, numbers_of(table, name), py::dict("units"_a = "F"));
    variables[py::str(name + "_error")] =
        py::make_tuple(dimensions, table.error.at(name), py::dict("units"_a = "F"));
  }
  variables["answered_by"] = py::make_tuple(dimensions, table.answered_by);
  variables["reached"] = py::make_tuple("frame", table.reached);
  return py::module_::import("xarray").attr("Dataset")(
      variables, "coords"_a = py::dict("frame"_a = table.frames, "reading"_a = table.readings));
}

py::object plot(const MotionTable& table, const std::string& name, py::object axes) {
  if (!table.error.contains(name))
    throw py::value_error(
        fmt::format("there is no quantity \"{}\": it must be one of {}", name, fmt::join(quantities, ", ")));
  if (axes.is_none())
    axes = py::module_::import("matplotlib.pyplot").attr("subplots")().cast<py::tuple>()[1];
  const Eigen::MatrixXd values = picofarads_per_farad * numbers_of(table, name),
                        errors = picofarads_per_farad * table.error.at(name);
  py::list frames;
  for (std::size_t frame = 0; frame < table.frames.size(); ++frame)
    frames.append(frame + 1);
  for (std::size_t reading = 0; reading < table.readings.size(); ++reading) {
    const auto column = static_cast<Eigen::Index>(reading);
    const Eigen::VectorXd middle = values.col(column), error = errors.col(column);
    const auto drawn = axes.attr("plot")(frames, middle, "label"_a = table.readings[reading]);
    axes.attr("fill_between")(frames, Eigen::VectorXd(middle - error), Eigen::VectorXd(middle + error),
                              "alpha"_a = 0.3, "color"_a = drawn.attr("__getitem__")(0).attr("get_color")());
  }
  axes.attr("set_xlabel")("frame");
  axes.attr("set_ylabel")(name + " (pF)");
  axes.attr("legend")();
  return axes;
}

std::string printed(const MotionTable& table) {
  std::string text = fmt::format("<fringe.MotionReadings of {} frames: {}>", table.frames.size(),
                                 fmt::join(table.readings, ", "));
  constexpr std::size_t most_lines = 12;
  for (std::size_t frame = 0; frame < table.frames.size(); ++frame) {
    if (frame == most_lines) {
      text += fmt::format("\n  … {} more frames", table.frames.size() - frame);
      break;
    }
    text += fmt::format("\n  {}: change", table.frames[frame]);
    for (Eigen::Index reading = 0; reading < table.change.cols(); ++reading) {
      const auto known = [&](const Eigen::MatrixXd& array) {
        const double number = array(static_cast<Eigen::Index>(frame), reading);
        return std::isnan(number) ? std::nullopt : std::optional(number);
      };
      text += fmt::format("{} {}", reading == 0 ? "" : ",",
                          in_picofarads(known(table.change), known(table.error.at("change"))));
    }
  }
  return text;
}

/// Returns estimates of readings (columns) in frames (rows); NaN for those that are not known.
template <std::optional<double> Estimate::*part>
Eigen::MatrixXd table_of(const std::vector<std::vector<ReadingAnswer>>& answers, std::size_t readings,
                         Estimate ReadingAnswer::*estimate) {
  Eigen::MatrixXd table(static_cast<Eigen::Index>(answers.size()), static_cast<Eigen::Index>(readings));
  for (Eigen::Index frame = 0; frame < table.rows(); ++frame)
    for (Eigen::Index reading = 0; reading < table.cols(); ++reading)
      table(frame, reading) =
          (answers[static_cast<std::size_t>(frame)][static_cast<std::size_t>(reading)].*estimate.*part)
              .value_or(std::numeric_limits<double>::quiet_NaN());
  return table;
}

}  // namespace

std::map<std::string, PythonReading> python_readings(const std::vector<ReadingAnswer>& answers) {
  std::map<std::string, PythonReading> result;
  for (const ReadingAnswer& reading : answers) {
    PythonReading& entry = result[reading.name] = {reading.name,
                                                   reading.value.value,
                                                   reading.background.value,
                                                   reading.change.value,
                                                   {{"value", reading.value.error},
                                                    {"background", reading.background.error},
                                                    {"change", reading.change.error}},
                                                   reading.answered_by,
                                                   {},
                                                   {},
                                                   reading.reached};
    for (const LinkDerivatives& of_link : reading.derivatives) {
      entry.derivatives[of_link.link] = of_link.change;
      entry.derivative_errors[of_link.link] = of_link.error;
    }
  }
  return result;
}

MotionTable motion_table(std::vector<std::string> frames, const std::vector<std::string>& readings,
                         const std::vector<std::vector<ReadingAnswer>>& answers) {
  MotionTable table{.frames = std::move(frames),
                    .readings = readings,
                    .answered_by = {},
                    .reached = {},
                    .value = table_of<&Estimate::value>(answers, readings.size(), &ReadingAnswer::value),
                    .background =
                        table_of<&Estimate::value>(answers, readings.size(), &ReadingAnswer::background),
                    .change = table_of<&Estimate::value>(answers, readings.size(), &ReadingAnswer::change),
                    .error = {}};
  table.error["value"] = table_of<&Estimate::error>(answers, readings.size(), &ReadingAnswer::value);
  table.error["background"] =
      table_of<&Estimate::error>(answers, readings.size(), &ReadingAnswer::background);
  table.error["change"] = table_of<&Estimate::error>(answers, readings.size(), &ReadingAnswer::change);
  for (const std::vector<ReadingAnswer>& frame : answers) {
    table.answered_by.emplace_back();
    table.reached.push_back(frame.empty() ? std::nullopt : frame.front().reached);
    for (const ReadingAnswer& reading : frame)
      table.answered_by.back().push_back(reading.answered_by);
  }
  return table;
}

void add_readings(py::module_& module) {
  py::class_<PythonReading>(module, "Reading",
                            "The answer of a reading (F); None is what the method does not know.")
      .def_readonly("name", &PythonReading::name)
      .def_readonly("value", &PythonReading::value)
      .def_readonly("background", &PythonReading::background)
      .def_readonly("change", &PythonReading::change)
      .def_readonly("error", &PythonReading::error,
                    R"(Estimates of the errors: {"value", "background", "change"}.)")
      .def_readonly("answered_by", &PythonReading::answered_by, "The method.")
      .def_readonly(
          "reached", &PythonReading::reached,
          "Whether the answer, with all its readings, reached the accuracy asked for; None of methods "
          "that state no errors.")
      .def_readonly(
          "derivatives", &PythonReading::derivatives,
          R"(The derivatives of the change by the pose of each link, {link: (6,) array}, if asked for.)")
      .def_readonly("derivative_errors", &PythonReading::derivative_errors,
                    "Estimates of their errors, {link: (6,) array}; None where the method states none.")
      .def("__repr__", [](const PythonReading& reading) { return printed(reading); })
      .def("_repr_html_", &html);
  py::class_<MotionTable>(
      module, "MotionReadings",
      "The readings in the frames of a motion (F): arrays with a row for each frame and a "
      "column for each reading; NaN is what the method does not know.")
      .def_readonly("frames", &MotionTable::frames, "The names of the frames.")
      .def_readonly("readings", &MotionTable::readings, "The names of the readings.")
      .def_readonly("answered_by", &MotionTable::answered_by, "The methods, a list for each frame.")
      .def_readonly("reached", &MotionTable::reached,
                    "Whether each frame reached the accuracy asked for; None where it has no answer, and of "
                    "methods that state no errors.")
      .def_readonly("value", &MotionTable::value)
      .def_readonly("background", &MotionTable::background)
      .def_readonly("change", &MotionTable::change)
      .def_readonly("error", &MotionTable::error,
                    R"(Estimates of the errors: {"value", "background", "change"}, an array each.)")
      .def("__len__", [](const MotionTable& table) { return table.frames.size(); })
      .def("__repr__", [](const MotionTable& table) { return printed(table); })
      .def("_repr_html_", [](const MotionTable& table) { return to_pandas(table).attr("_repr_html_")(); })
      .def("to_pandas", &to_pandas,
           "A table with a row for each frame and reading, and the columns of the tables of `fringe sweep`.")
      .def("to_xarray", &to_xarray, R"(A dataset with the dimensions "frame" and "reading".)")
      .def("plot", &plot, "quantity"_a = "change", "axes"_a = py::none(),
           "Draws a quantity over the frames with its error, in pF; returns the axes of matplotlib.");
}

}  // namespace fringe::python
