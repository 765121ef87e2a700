#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "fringe/triangle.hpp"

/// The statements of the files of FastCap and FasterCap, a line each.
namespace fringe::cli {

/// C or B: a conductor's file, in which further files may be named.
struct IncludedConductor {
  std::string file;
  double outer_permittivity = 1;
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< m
  bool continues = false;     ///< whether the next file belongs to the same group of conductors
  bool is_interface = false;  ///< B: it lies on the interface of two dielectrics
};

/// D: a file with an interface of two dielectrics.
struct DielectricInterface {};

/// G: the name of the present group of conductors.
struct GroupName {
  std::string name;
};

/// T or Q: a triangle, or a quadrilateral divided into two.
struct Panel {
  std::string conductor;
  std::vector<Triangle> triangles;
};

/// N: another name of a conductor.
struct Renamed {
  std::string from, to;
};

/// E or F: the end of a file within a file, or the beginning of the next one.
struct EndOfFile {
  std::optional<std::string> next;  ///< the name of the file that begins
};

struct Comment {};

using PanelStatement =
    std::variant<Comment, IncludedConductor, DielectricInterface, GroupName, Panel, Renamed, EndOfFile>;

/// Reads a line. The first line of a file is a title if it does not begin with the letter of a statement.
/// Throws InputError with the reason.
PanelStatement parse_panel_statement(std::string_view line, bool is_first);

}  // namespace fringe::cli
