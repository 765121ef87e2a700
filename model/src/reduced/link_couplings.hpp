#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "reduced/charge_functions.hpp"
#include "reduced/node_kernels.hpp"
#include "reduced/table_forces.hpp"

/// Potentials between the charge functions of two groups of bodies that move against each other
/// (model/CORRECTIONS.md, section 8, "Links that move").
namespace fringe::detail {

/// The potentials of each of two groups' charges on the functions of the other.
struct LinkCoupling {
  Eigen::Isometry3d relative;  ///< from the frame of the first group to that of the second
  Eigen::MatrixXf functions;   ///< of the first one's functions (columns) on the second one's (rows)
  /// Potentials of the first one's given charges (columns) on the second one's functions, and below these the
  /// energies of these charges with those that the second one carries for loads.
  TrianglePotentials given_first;
  TrianglePotentials given_second;  ///< the same of the second one's given charges and the first one
};

/// Points whose unit charges have limited potentials, in whole blocks once they are filled up.
struct LimitedPoints {
  std::vector<float> x, y, z;
  std::vector<float> limits;  ///< largest potentials of unit charges
  std::size_t count = 0;

  void clear();
  void add(const Eigen::Vector3f& at, float limit);
  /// Adds points far away until the last block is whole.
  void fill_up();
  NodePoints points() const { return {x.data(), y.data(), z.data(), index_of(count)}; }
};

/// Finds the forces on points in the fields of point charges, where their potentials are not limited, with
/// arrays that are used again.
class PointForces {
 public:
  /// A point on which forces act, a part of a function.
  struct Point {
    Eigen::Vector3f at;
    Eigen::Index function;
    float share;
    float limit;  ///< largest 1/r; infinite where it is not limited, also not by the sources
  };
  /// Begins with sources, and returns their charges, zeros yet: for every point those of all fields.
  std::vector<float>& start(const LimitedPoints& sources, std::size_t fields);
  /// Adds the forces on a point, at the latest when finish() is called.
  void add(const Point& point, Forces& forces);
  void finish(Forces& forces);

 private:
  const LimitedPoints* sources_ = nullptr;
  std::size_t fields_count_ = 0;
  std::vector<float> charges_;
  std::vector<Point> points_;  ///< up to one block
  std::vector<float> inverse_distances_;
  std::array<std::vector<float>, 3> gradients_;  ///< of 1/r, for some sources a block each
  std::vector<float> fields_;                    ///< a block for each component and field
  std::vector<float> sums_;
};

/// Evaluates couplings, with arrays that are used again. Charges are points, the finer the nearer the other
/// group is. Points that are closer than their parts of the surface are large count as spheres of the parts'
/// own potential: surfaces of two links of one conductor may cross at a joint.
class LinkCoupler {
 public:
  /// Finds the potentials of the functions of one group (columns) on those of another (rows).
  /// @param relative from the frame of the rows' group to that of the columns'
  void couple(const ChargeFunctions& rows, const ChargeFunctions& columns, const Eigen::Isometry3d& relative,
              Eigen::MatrixXf& functions);

  /// Finds the forces on unit charges of the functions of one group, in the frame of the other, in the fields
  /// of charges on the other's functions: the derivatives of the potentials that couple() finds.
  /// @param relative from the frame of the group on which they act to that of the other
  /// @param charges of the other's functions (rows), for each field (column)
  void find_forces(const ChargeFunctions& on, const ChargeFunctions& of, const Eigen::Isometry3d& relative,
                   const Eigen::MatrixXf& charges, Forces& forces);

 private:
  void place(const ChargeFunctions& functions, const Eigen::Isometry3d& to_other,
             std::span<const Eigen::AlignedBox3d> others);
  void gather(const ChargeFunctions& functions, float* of_functions) const;

  std::vector<std::size_t> levels_;  ///< of the placed functions
  LimitedPoints points_, of_row_;
  std::vector<float> shares_, potentials_;  ///< of the placed points
  PointForces forces_;
};

}  // namespace fringe::detail
