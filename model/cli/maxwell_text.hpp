#pragma once

#include <string>

#include "fringe/boundary_elements.hpp"

/// What boundary elements find, as a JSON document and as a table for people.
namespace fringe::cli {

/// How a Maxwell matrix was asked for.
struct MaxwellRequest {
  std::string method;  ///< "boundary-elements" or "reduced:K"
  double rtol;
};

std::string maxwell_json(const Scene& scene, const MaxwellMatrix& matrix, const MaxwellRequest& request,
                         double seconds);

std::string maxwell_table(const MaxwellMatrix& matrix, const MaxwellRequest& request, double seconds);

}  // namespace fringe::cli
