#pragma once

#include <string>
#include <vector>

#include "fringe/boundary_elements.hpp"
#include "fringe/scene.hpp"

/// A Maxwell matrix in the formats of other programs: a circuit of SPICE, and comma-separated values.
namespace fringe::cli {

/// Throws InputError, with the names of its row and column, for an entry of a Maxwell matrix that is not
/// finite.
void require_finite(const MaxwellMatrix& matrix);

/// Returns for each conductor of a scene's Maxwell matrix whether it is grounded: neither a sensor nor an
/// electrode.
std::vector<bool> grounded_conductors(const Scene& scene, const MaxwellMatrix& matrix);

/// Writes a Maxwell matrix as a SPICE subcircuit of capacitors. Each conductor that is not grounded is a
/// node, in the order of the matrix; grounded ones and infinity are node 0. Capacitances that are 0 are left
/// out; an entry and its mirror image count by their mean. `name` is the subcircuit's, `remark` a line about
/// the matrix. Names get other characters where SPICE does not take theirs. Throws InputError for an entry
/// that is not finite and if all conductors are grounded.
std::string spice_subcircuit(const MaxwellMatrix& matrix, const std::vector<bool>& grounded,
                             const std::string& name, const std::string& remark);

/// Writes a Maxwell matrix as comma-separated values: a line for each entry with the names of its row and
/// column, the value and the stated error in F. Throws InputError for an entry that is not finite.
std::string matrix_csv(const MaxwellMatrix& matrix);

}  // namespace fringe::cli
