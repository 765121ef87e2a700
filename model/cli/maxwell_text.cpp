#include "maxwell_text.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "json_writer.hpp"
#include "units.hpp"

namespace fringe::cli {
namespace {

void write_texts(Writer& writer, const char* key, const std::vector<std::string>& texts) {
  writer.Key(key);
  writer.StartArray();
  for (const std::string& text : texts)
    write_text(writer, text);
  writer.EndArray();
}

void write_matrix(Writer& writer, const char* key, const Eigen::MatrixXd& matrix) {
  writer.Key(key);
  writer.StartArray();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    writer.StartArray();
    for (Eigen::Index j = 0; j < matrix.cols(); ++j)
      write_number(writer, matrix(i, j));
    writer.EndArray();
  }
  writer.EndArray();
}

void write_sensor(Writer& writer, const SensorCapacitance& felt, const MaxwellMatrix& matrix,
                  Eigen::Index sensor) {
  writer.StartObject();
  writer.Key("name");
  write_text(writer, felt.name);
  write_number(writer, "total", felt.total);
  write_number(writer, "voltage", felt.voltage);
  write_number(writer, "delta_voltage", felt.delta_voltage);
  writer.Key("contact");
  writer.Bool(felt.contact);
  write_number(writer, "self", matrix.values(sensor, sensor));
  write_number(writer, "self_error", matrix.errors(sensor, sensor));
  write_number(writer, "delta_self", matrix.delta_self[sensor]);
  write_number(writer, "delta_self_error", matrix.delta_self_errors[sensor]);
  writer.Key("objects");
  writer.StartArray();
  for (std::size_t k = 0; k < felt.objects.size(); ++k) {
    const ObjectCapacitance& object = felt.objects[k];
    writer.StartObject();
    writer.Key("name");
    write_text(writer, object.name);
    write_number(writer, "capacitance", object.capacitance);
    write_number(writer, "error", matrix.errors(sensor, static_cast<Eigen::Index>(matrix.conductor_of(k))));
    write_number(writer, "bound", object.bound);
    writer.Key("skipped");
    writer.Bool(object.skipped);
    writer.EndObject();
  }
  writer.EndArray();
  writer.EndObject();
}

}  // namespace

std::string maxwell_json(const Scene& scene, const MaxwellMatrix& matrix, const MaxwellRequest& request,
                         double seconds) {
  rapidjson::StringBuffer buffer;
  Writer writer(buffer);
  start_document(writer);
  writer.Key("options");
  writer.StartObject();
  writer.Key("method");
  write_text(writer, request.method);
  write_number(writer, "rtol", request.rtol);
  writer.EndObject();
  write_number(writer, "seconds", seconds);
  writer.Key("reached");
  writer.Bool(matrix.reached);
  writer.Key("unknowns");
  writer.Uint64(matrix.unknowns);
  write_texts(writer, "conductors", matrix.conductors);
  write_texts(writer, "floating", matrix.floating);
  write_matrix(writer, "maxwell", matrix.values);
  write_matrix(writer, "error", matrix.errors);
  writer.Key("lower_bounds");
  writer.StartArray();
  for (const bool bound : matrix.lower_bounds)
    writer.Bool(bound);
  writer.EndArray();
  writer.Key("sensors");
  writer.StartArray();
  Eigen::Index sensor = 0;
  for (const SensorCapacitance& felt : capacitance(scene, matrix).sensors)
    write_sensor(writer, felt, matrix, sensor++);
  writer.EndArray();
  writer.EndObject();
  return buffer.GetString();
}

std::string maxwell_table(const MaxwellMatrix& matrix, const MaxwellRequest& request, double seconds) {
  std::string text = fmt::format(
      "Maxwell matrix by boundary elements{}, pF: charge on the row's conductor per volt on the column's\n"
      "rtol {} {}, {} unknowns, {:.3g} s\n\n{:<12}",
      request.method == "boundary-elements" ? "" : fmt::format(" ({})", request.method), request.rtol,
      matrix.reached ? "reached" : "NOT reached", matrix.unknowns, seconds, "");
  for (const std::string& name : matrix.conductors)
    text += fmt::format("{:>24}", name);
  text += '\n';
  for (Eigen::Index i = 0; i < matrix.values.rows(); ++i) {
    text += fmt::format("{:<12}", matrix.conductors[static_cast<std::size_t>(i)]);
    for (Eigen::Index j = 0; j < matrix.values.cols(); ++j)
      text += fmt::format("{:>12.6f} ± {:<9.6f}", matrix.values(i, j) * picofarads_per_farad,
                          matrix.errors(i, j) * picofarads_per_farad);
    text += '\n';
  }
  text += "\ndelta_self, pF: the sensor's own entry less what it is without the objects\n";
  for (Eigen::Index s = 0; s < matrix.delta_self.size(); ++s)
    text += fmt::format("{:<12}{:>12.6f} ± {:<9.6f}\n", matrix.conductors[static_cast<std::size_t>(s)],
                        matrix.delta_self[s] * picofarads_per_farad,
                        matrix.delta_self_errors[s] * picofarads_per_farad);
  text += "The errors are estimates.";
  const bool any_bound =
      std::find(matrix.lower_bounds.begin(), matrix.lower_bounds.end(), true) != matrix.lower_bounds.end();
  for (std::size_t k = 0; k < matrix.conductors.size(); ++k)
    if (any_bound && !matrix.lower_bounds[k])
      text += fmt::format(" The diagonal entry of {} may be above the truth.", matrix.conductors[k]);
  text += any_bound ? " Entries of the diagonal are otherwise not above the truth.\n" : "\n";
  for (const std::string& name : matrix.floating)
    text += fmt::format("floating, without charge and so without a row: {}\n", name);
  return text;
}

}  // namespace fringe::cli
