// SPDX-License-Identifier: GPL-3.0-or-later
#include "wrap.hpp"

#include <CGAL/IO/OFF.h>

#include <fstream>
#include <limits>
#include <stdexcept>

namespace wrap {

std::vector<Triangle> Soup::triangles() const {
  std::vector<Triangle> found;
  found.reserve(faces.size());
  for (const auto& face : faces) {
    const Triangle triangle{points[face[0]], points[face[1]], points[face[2]]};
    if (!triangle.is_degenerate())
      found.push_back(triangle);
  }
  return found;
}

Soup read_soup(const std::string& file) {
  Soup soup;
  if (!CGAL::IO::read_OFF(file, soup.points, soup.faces))
    throw std::runtime_error{file + ": is not an OFF file"};
  for (const auto& face : soup.faces)
    if (face.size() != 3)
      throw std::runtime_error{file + ": has a face that is not a triangle"};
  return soup;
}

void write_mesh(const std::string& file, const Mesh& mesh) {
  std::ofstream out{file};
  out.precision(std::numeric_limits<double>::max_digits10);
  if (!CGAL::IO::write_OFF(out, mesh,
                           CGAL::parameters::stream_precision(std::numeric_limits<double>::max_digits10)))
    throw std::runtime_error{file + ": cannot be written"};
}

}  // namespace wrap
