// SPDX-License-Identifier: GPL-3.0-or-later
// fringe-wrap: a closed surface around any triangles, by CGAL's alpha wrap, for the field reference. CGAL's
// alpha wrap is under the GPL, and so is this program, which nothing else is linked with.

#include "simplify.hpp"
#include "surfaces.hpp"

#include <CGAL/alpha_wrap_3.h>

#include <cmath>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

namespace {

constexpr int answered = 0, failed = 1, wrong_input = 2;

constexpr const char* usage = "Usage: fringe-wrap IN.off OTHERS.off OUT.off ALPHA OFFSET ALLOWED SHARE MOST\n"
                              "Write a closed surface that strictly contains the triangles of IN and has the "
                              "distance OFFSET from them; ALPHA is the width of\n"
                              "the holes and gaps that it closes. The surface is then simplified: it stays "
                              "within ALLOWED of the triangles, or within SHARE of\n"
                              "the distance to the triangles of OTHERS where that is more, but within MOST. "
                              "Lengths are in the unit of the files. The file OUT\n"
                              "is written only if exact predicates show that the surface contains the "
                              "triangles and does not meet itself.\n";

double positive(const std::string& text) {
  const double value = std::stod(text);
  if (!(value > 0) || !std::isfinite(value))
    throw std::invalid_argument{text};
  return value;
}

int run(const std::vector<std::string>& words) {
  const double alpha = positive(words[3]), offset = positive(words[4]);
  wrap::Allowance allowance{positive(words[5]), positive(words[6]), positive(words[7])};
  const wrap::Soup soup = wrap::read_soup(words[0]);
  const std::vector<wrap::Triangle> triangles = soup.triangles(),
                                    near = wrap::read_soup(words[1]).triangles();
  if (triangles.empty())
    throw std::invalid_argument{words[0] + ": has no triangle with an area"};
  const wrap::Tree inside{triangles.begin(), triangles.end()}, others{near.begin(), near.end()};

  wrap::Mesh wrapped;
  CGAL::alpha_wrap_3(soup.points, soup.faces, alpha, offset, wrapped);
  // A simplified surface may meet itself where two of its sheets are close: then less is simplified, at last
  // nothing.
  for (int attempt = 0; attempt < 3; ++attempt) {
    wrap::Mesh simplified = wrapped;
    wrap::simplify(simplified, inside, others, allowance);
    if (wrap::contains(simplified, triangles, inside)) {
      wrap::write_mesh(words[2], simplified);
      return answered;
    }
    allowance = {offset + (allowance.everywhere - offset) / 4, allowance.share / 4, allowance.most / 4};
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
  if (count != 9) {
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
