#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "export/matrix_files.hpp"

/// Reads Maxwell matrices and writes their subcircuits, by the function of `fringe export`. A matrix is its
/// name, its size, and for each conductor its name, 1 if it is grounded or else 0, and its row in F; words
/// are separated by spaces.
int main() {
  using namespace fringe;
  try {
    std::string name;
    for (std::size_t size = 0; std::cin >> name >> size;) {
      MaxwellMatrix matrix;
      const auto rows = static_cast<Eigen::Index>(size);
      matrix.values.resize(rows, rows);
      matrix.errors = Eigen::MatrixXd::Zero(rows, rows);
      matrix.conductors.resize(size);
      std::vector<bool> grounded(size);
      for (std::size_t i = 0; i < size; ++i) {
        bool is_grounded = false;
        std::cin >> matrix.conductors[i] >> is_grounded;
        grounded[i] = is_grounded;
        for (Eigen::Index j = 0; j < rows; ++j) {
          std::string entry;
          std::cin >> entry;
          matrix.values(static_cast<Eigen::Index>(i), j) = std::stod(entry);
        }
      }
      std::cout << cli::spice_subcircuit(matrix, grounded, name, "random");
    }
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 2;
  }
}
