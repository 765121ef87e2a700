#include "import/panel_statement.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>

#include <fmt/format.h>

#include "fringe/error.hpp"
#include "geometry/polygon.hpp"
#include "io/input_file.hpp"

namespace fringe::cli {
namespace {

using Eigen::Vector3d;

/// Takes the parts of a statement from its line, one after the other.
class Parts {
 public:
  Parts(std::string_view line, std::string_view form) : rest_(line), form_(form) { detail::take_word(rest_); }

  std::string word() {
    const std::string_view found = detail::take_word(rest_);
    if (found.empty())
      throw InputError(fmt::format("ends too early; it must be {}", form_));
    return std::string(found);
  }

  double number() { return detail::parse_number(word()); }

  Vector3d point() {
    const double x = number(), y = number();
    return {x, y, number()};
  }

  /// Takes a place in a list of files. One without z is that of a two-dimensional list.
  Vector3d place() {
    const double x = number(), y = number();
    const std::string z = std::string(detail::take_word(rest_));
    if (z.empty() || z == "+")
      throw InputError("has x and y only, as two-dimensional lists do, which are not read");
    return {x, y, detail::parse_number(z)};
  }

  double permittivity() {
    const std::string found = word();
    if (found.find_first_of("jJ") != std::string::npos)
      throw InputError(fmt::format("has the complex permittivity {}, which is not read", found));
    const double value = detail::parse_number(found);
    if (value <= 0)
      throw InputError(fmt::format("has the permittivity {}, which is not greater than 0", found));
    return value;
  }

  /// Returns what follows; empty at the end.
  std::string_view next() { return detail::take_word(rest_); }

 private:
  std::string_view rest_;
  std::string_view form_;
};

/// Divides a quadrilateral inside it.
std::vector<Triangle> divided(const std::array<Vector3d, 4>& corners) {
  std::vector<Triangle> triangles;
  detail::FaceDefects defects;
  detail::append_face(triangles, corners, defects);
  if (defects.crossing > 0)
    throw InputError("has corners that do not follow each other around the quadrilateral");
  return triangles;
}

IncludedConductor included(std::string_view line) {
  Parts parts(line, "C FILE PERMITTIVITY X Y Z, or this and a +");
  IncludedConductor result{parts.word(), parts.permittivity(), parts.place()};
  result.continues = parts.next() == "+";
  return result;
}

IncludedConductor included_interface(std::string_view line) {
  Parts parts(line, "B FILE PERMITTIVITY PERMITTIVITY X Y Z XR YR ZR, or this and +, - or +-");
  IncludedConductor result{parts.word(), parts.permittivity()};
  parts.permittivity();
  result.offset = parts.point();
  parts.point();
  const std::string_view signs = parts.next();
  result.continues = signs == "+" || signs == "+-" || signs == "-+";
  result.is_interface = true;
  return result;
}

Panel triangle(std::string_view line) {
  Parts parts(line, "T CONDUCTOR and the coordinates of three corners");
  Panel panel{parts.word(), {}};
  const Vector3d a = parts.point(), b = parts.point();
  panel.triangles.push_back({a, b, parts.point()});
  return panel;
}

Panel quadrilateral(std::string_view line) {
  Parts parts(line, "Q CONDUCTOR and the coordinates of four corners");
  Panel panel{parts.word(), {}};
  const Vector3d a = parts.point(), b = parts.point(), c = parts.point();
  panel.triangles = divided({a, b, c, parts.point()});
  return panel;
}

Renamed renamed(std::string_view line) {
  Parts parts(line, "N CONDUCTOR NAME");
  const std::string from = parts.word();
  return {from, parts.word()};
}

/// Returns whether a word in capitals is the beginning of a keyword, of which the first letter is needed.
bool abbreviates(std::string_view word, std::string_view keyword) {
  return !word.empty() && keyword.starts_with(word);
}

}  // namespace

PanelStatement parse_panel_statement(std::string_view line, bool is_first) {
  std::string_view rest = line;
  std::string first(detail::take_word(rest));
  std::transform(first.begin(), first.end(), first.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::toupper(letter)); });
  if (first.empty() || first[0] == '*' || first[0] == '%' || first[0] == '#')
    return Comment{};
  if (first == "C")
    return included(line);
  if (first == "B")
    return included_interface(line);
  if (first == "D")
    return DielectricInterface{};
  if (first == "G")
    return GroupName{Parts(line, "G NAME").word()};
  if (first == "T")
    return triangle(line);
  if (first == "Q")
    return quadrilateral(line);
  if (first == "N")
    return renamed(line);
  if (first == "S")
    throw InputError("is a segment of a two-dimensional list, which is not read");
  if (is_first)
    return Comment{};
  if (abbreviates(first, "END"))
    return EndOfFile{};
  if (abbreviates(first, "FILE"))
    return EndOfFile{Parts(line, "File NAME").word()};
  throw InputError(fmt::format("begins with {}, which is no statement of FastCap's lists and panels",
                               detail::quoted(detail::take_word(line))));
}

}  // namespace fringe::cli
