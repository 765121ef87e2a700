#include "export/matrix_files.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <fmt/format.h>

#include "csv_text.hpp"
#include "fringe/error.hpp"
#include "unique_names.hpp"

namespace fringe::cli {
namespace {

using Eigen::Index;

/// Programs differ in how long a line may be.
constexpr std::size_t nodes_in_a_line = 8;

/// Makes names that SPICE takes: they begin with a letter, and do not differ in the case of letters alone.
class SpiceNames {
 public:
  SpiceNames() {
    // Another name of node 0.
    names_.take("gnd");
  }

  std::string take(const std::string& wanted) {
    const std::string plain = plain_name(wanted);
    return names_.take(std::isalpha(static_cast<unsigned char>(plain.front())) != 0 ? plain : "n" + plain);
  }

 private:
  UniqueNames names_{"_", UniqueNames::Case::does_not_count};
};

/// Writes capacitors, numbered one after the other.
class Capacitors {
 public:
  /// Appends a capacitor between two nodes, unless its capacitance (F) is 0.
  void add(const std::string& about, const std::string& from, const std::string& to, double capacitance,
           double error) {
    if (capacitance == 0)
      return;
    text_ += fmt::format("* {}, stated error {:.2g} F{}\nC{} {} {} {}\n", about, error,
                         capacitance < 0 ? "; negative by the error of the matrix" : "", ++count_, from, to,
                         capacitance);
  }

  const std::string& text() const { return text_; }

 private:
  std::string text_;
  std::size_t count_ = 0;
};

/// Returns the node of each conductor.
std::vector<std::string> nodes_of(const MaxwellMatrix& matrix, const std::vector<bool>& grounded) {
  SpiceNames names;
  std::vector<std::string> nodes;
  for (std::size_t k = 0; k < matrix.conductors.size(); ++k)
    nodes.push_back(grounded[k] ? "0" : names.take(matrix.conductors[k]));
  return nodes;
}

std::string capacitors(const MaxwellMatrix& matrix, const std::vector<std::string>& nodes) {
  const Eigen::MatrixXd values = (matrix.values + matrix.values.transpose()) / 2;
  const Eigen::MatrixXd errors = matrix.errors.cwiseMax(matrix.errors.transpose());
  Capacitors result;
  for (Index i = 0; i < values.rows(); ++i) {
    const auto a = static_cast<std::size_t>(i);
    if (nodes[a] == "0")
      continue;
    const std::string name = on_one_line(matrix.conductors[a]);
    for (Index j = 0; j < values.cols(); ++j) {
      const auto b = static_cast<std::size_t>(j);
      // Each pair of nodes once; grounded conductors, which have no turn of their own, with every node.
      if (nodes[b] == "0" || j > i)
        result.add(fmt::format("{} and {}", name, on_one_line(matrix.conductors[b])), nodes[a], nodes[b],
                   -values(i, j), errors(i, j));
    }
    result.add(fmt::format("{} and infinity", name), nodes[a], "0", values.row(i).sum(), errors.row(i).sum());
  }
  return result.text();
}

}  // namespace

void require_finite(const MaxwellMatrix& matrix) {
  for (Index i = 0; i < matrix.values.rows(); ++i)
    for (Index j = 0; j < matrix.values.cols(); ++j)
      if (!std::isfinite(matrix.values(i, j)))
        throw InputError(fmt::format(R"(the entry of "{}" and "{}" in the Maxwell matrix is not finite)",
                                     matrix.conductors[static_cast<std::size_t>(i)],
                                     matrix.conductors[static_cast<std::size_t>(j)]));
}

std::vector<bool> grounded_conductors(const Scene& scene, const MaxwellMatrix& matrix) {
  std::vector<bool> grounded(matrix.conductors.size(), false);
  for (std::size_t k = matrix.sensors; k < grounded.size(); ++k) {
    const auto member = std::find_if(scene.objects.begin(), scene.objects.end(), [&](const Object& object) {
      return object.name == matrix.members[k].front();
    });
    grounded[k] = member == scene.objects.end() || !std::holds_alternative<Electrode>(member->role);
  }
  return grounded;
}

std::string spice_subcircuit(const MaxwellMatrix& matrix, const std::vector<bool>& grounded,
                             const std::string& name, const std::string& remark) {
  require_finite(matrix);
  const std::vector<std::string> nodes = nodes_of(matrix, grounded);
  std::string text = fmt::format(
      "* {}\n* A capacitance for every pair of conductors, in F. Node 0 is the ground, grounded conductors "
      "and\n"
      "* infinity. Floating conductors, which carry no net charge, are eliminated: they have no node.\n",
      on_one_line(remark));
  for (const std::string& floating : matrix.floating)
    text += fmt::format("* floating: {}\n", on_one_line(floating));
  std::string head = fmt::format(".subckt {}", SpiceNames().take(name));
  std::size_t count = 0;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    if (nodes[k] != "0")
      head += fmt::format("{}{}", ++count % nodes_in_a_line == 0 ? "\n+ " : " ", nodes[k]);
    text += fmt::format("* node {}: {}\n", nodes[k], on_one_line(matrix.conductors[k]));
  }
  if (count == 0)
    throw InputError("all conductors are grounded: a circuit needs a sensor or an electrode");
  return text + head + '\n' + capacitors(matrix, nodes) + ".ends\n";
}

std::string matrix_csv(const MaxwellMatrix& matrix) {
  require_finite(matrix);
  std::string text = "row,column,value_F,error_F\n";
  for (Eigen::Index i = 0; i < matrix.values.rows(); ++i)
    for (Eigen::Index j = 0; j < matrix.values.cols(); ++j)
      text += fmt::format("{},{},{},{}\n", csv_field(matrix.conductors[static_cast<std::size_t>(i)]),
                          csv_field(matrix.conductors[static_cast<std::size_t>(j)]),
                          matrix.values(i, j) + 0.0, matrix.errors(i, j));
  return text;
}

}  // namespace fringe::cli
