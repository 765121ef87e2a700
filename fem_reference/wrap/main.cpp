// SPDX-License-Identifier: GPL-3.0-or-later
// fringe-wrap: a closed surface around any triangles, by CGAL's alpha wrap, for the field reference. CGAL's
// alpha wrap is under the GPL, and so is this program, which nothing else is linked with.

#include "wrap.hpp"

#include <CGAL/IO/OFF.h>

#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

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

namespace {

constexpr int answered = 0, failed = 1, wrong_input = 2;

constexpr const char* usage = "Usage: fringe-wrap IN.off OTHERS.off OUT.off ALPHA ALPHA_SHARE ALPHA_MOST "
                              "OFFSET OFFSET_SHARE OFFSET_MOST ALLOWED\n"
                              "Write a closed surface that strictly contains the triangles of IN. Its "
                              "distance from them is OFFSET_SHARE of the\n"
                              "distance to the triangles of OTHERS, but at least OFFSET and at most "
                              "OFFSET_MOST. It closes holes and gaps that are\n"
                              "narrower than twice ALPHA_SHARE of the distance to OTHERS, but at least ALPHA "
                              "and at most ALPHA_MOST. The surface is\n"
                              "then simplified: it stays within ALLOWED times its offset. Lengths are in the "
                              "unit of the files. The file OUT is\n"
                              "written only if exact predicates show that the surface contains the triangles "
                              "and does not meet itself.\n";

double positive(const std::string& text) {
  const double value = std::stod(text);
  if (!(value > 0) || !std::isfinite(value))
    throw std::invalid_argument{text};
  return value;
}

int run(const std::vector<std::string>& words) {
  const wrap::Soup soup = wrap::read_soup(words[0]);
  const std::vector<wrap::Triangle> triangles = soup.triangles(),
                                    near = wrap::read_soup(words[1]).triangles();
  if (triangles.empty())
    throw std::invalid_argument{words[0] + ": has no triangle with an area"};
  const wrap::Tree inside{triangles.begin(), triangles.end()}, others{near.begin(), near.end()};

  wrap::Lengths lengths{&others,
                        {positive(words[4]), positive(words[3]), positive(words[5])},
                        {positive(words[7]), positive(words[6]), positive(words[8])},
                        positive(words[9])};
  const wrap::Mesh wrapped = wrap::alpha_wrap(soup, lengths);
  // A simplified surface may meet itself where two of its sheets are close: then less is simplified, at last
  // nothing.
  for (int attempt = 0; attempt < 3; ++attempt) {
    wrap::Mesh simplified = wrapped;
    wrap::simplify(simplified, inside, lengths);
    if (wrap::contains(simplified, triangles, inside)) {
      wrap::write_mesh(words[2], simplified);
      return answered;
    }
    lengths.allowed_over_offset = 1 + (lengths.allowed_over_offset - 1) / 4;
  }
  if (!wrap::contains(wrapped, triangles, inside)) {
    std::fputs("fringe-wrap: the surface does not contain all triangles\n", stderr);
    return failed;
  }
  wrap::write_mesh(words[2], wrapped);
  return answered;
}

}  // namespace

int main(int count, char** words) {
  if (count != 11) {
    std::fputs(usage, stderr);
    return wrong_input;
  }
  try {
    return run({words + 1, words + count});
  } catch (const std::invalid_argument& wrong) {
    std::fprintf(stderr, "fringe-wrap: wrong input: %s\n", wrong.what());
    return wrong_input;
  } catch (const std::exception& failure) {
    std::fprintf(stderr, "fringe-wrap: %s\n", failure.what());
    return failed;
  }
}
