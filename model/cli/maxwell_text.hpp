#pragma once

#include <string>

#include "fringe/boundary_elements.hpp"

/// Writes a Maxwell matrix as a JSON document and as a table for people.
namespace fringe::cli {

/// The method and the accuracy that were requested for a Maxwell matrix.
struct MaxwellRequest {
  std::string method;  ///< "boundary-elements" or "reduced:K"
  double rtol;
};

std::string maxwell_json(const Scene& scene, const MaxwellMatrix& matrix, const MaxwellRequest& request,
                         double seconds);

/// Formats the matrix as a table in pF.
std::string maxwell_table(const MaxwellMatrix& matrix, const MaxwellRequest& request, double seconds);

}  // namespace fringe::cli
