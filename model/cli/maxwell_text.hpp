#pragma once

#include <string>

#include "fringe/boundary_elements.hpp"

/// What boundary elements find, as a JSON document and as a table for people.
namespace fringe::cli {

std::string maxwell_json(const Scene& scene, const MaxwellMatrix& matrix,
                         const BoundaryElementOptions& options, double seconds);

std::string maxwell_table(const MaxwellMatrix& matrix, const BoundaryElementOptions& options, double seconds);

}  // namespace fringe::cli
