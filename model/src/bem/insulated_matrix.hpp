#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "bem/panel_operator.hpp"
#include "surface/insulators.hpp"

/// The matrix of the equations of conductors, dielectric bodies and films (model/BOUNDARY_ELEMENTS.md,
/// section 13).
namespace fringe::detail {

/// A space of fewer functions: one charge, or one potential, for all functions that have the same place.
struct CombinedFunctions {
  std::vector<Eigen::Index> place;  ///< of each function
  Eigen::VectorXd shares;           ///< of each function, its part of the area of all that have its place
  Eigen::VectorXd parts;            ///< what a function has of the value at its place: its share of a charge,
                                    ///< all of a potential
  Eigen::Index size = 0;

  /// Returns the means of potentials over the functions of each place.
  Eigen::MatrixXd means(const Eigen::MatrixXd& potentials) const;
  /// Returns the value at each place that goes with those of the functions: the sum of charges, the mean of
  /// potentials.
  Eigen::MatrixXd combined(const Eigen::MatrixXd& values) const;
  /// Returns what each function has of the values at the places.
  Eigen::MatrixXd spread(const Eigen::MatrixXd& values) const;
};

/// The unknowns of a set of bodies, one for each panel that is there, in the order of the operator's tree.
struct InsulatedUnknowns {
  std::vector<Eigen::Index> panels;  ///< of each unknown
  std::vector<Eigen::Index> places;  ///< of each unknown, its panel's in the tree
  std::vector<PartState> states;     ///< of each unknown
  std::vector<Eigen::Index> body;    ///< of each unknown
  Eigen::VectorXd areas;             ///< of each unknown's panel
  Eigen::Matrix3Xd centres;          ///< the same
  CombinedFunctions coarse;  ///< the coarse space: one function for the panels of a group that are alike

  Eigen::Index size() const { return index_of(panels.size()); }
  PartKind kind(Eigen::Index k) const { return states[static_cast<std::size_t>(k)].kind; }
  /// Tells if the unknown is a charge; else it is the potential of an interface.
  bool is_charge(Eigen::Index k) const { return kind(k) != PartKind::interface; }
};

/// The matrix: charges act by the single layer, a hierarchical matrix, and potentials of interfaces by
/// columns of the double layer, of which there are few beside large machines.
class InsulatedMatrix {
 public:
  InsulatedMatrix() = default;
  /// `dipoles` has a column for each interface, in the order of the unknowns. The operator has to live as
  /// long as this.
  InsulatedMatrix(const PanelOperator& single_layer, const InsulatedUnknowns& unknowns,
                  Eigen::MatrixXd dipoles, std::size_t threads);

  /// Adds a matrix between some unknowns, which are charges of films, in their order.
  void add_films(std::vector<Eigen::Index> films, Eigen::MatrixXd compliance);

  Eigen::MatrixXd times(const Eigen::MatrixXd& values) const;

  /// Returns the matrix of a space of fewer functions, with all its elements: means over the places.
  Eigen::MatrixXd combined(const CombinedFunctions& space) const;

  std::size_t leaves() const { return leaves_.size(); }
  /// Returns the unknowns in a leaf of the operator's tree.
  ClusterRange leaf(std::size_t leaf) const { return leaves_[leaf]; }
  /// Returns the leaves near a leaf, and itself.
  std::vector<std::size_t> leaves_near(std::size_t leaf) const { return single_layer_->leaves_near(leaf); }
  /// Returns the block of some unknowns with each other, in which charges far from each other are points.
  Eigen::MatrixXd block(const std::vector<Eigen::Index>& unknowns) const;

 private:
  /// Writes the part of a block between unknowns of two leaves.
  void write_block(std::span<const Eigen::Index> rows, std::span<const Eigen::Index> columns,
                   Eigen::Ref<Eigen::MatrixXd> block) const;
  std::size_t leaf_of(Eigen::Index unknown) const {
    return single_layer_->tree().leaf_of(places_[static_cast<std::size_t>(unknown)]);
  }

  const PanelOperator* single_layer_ = nullptr;
  std::vector<Eigen::Index> places_;  ///< of the unknowns, in the tree
  Eigen::Matrix3Xd centres_;          ///< of the unknowns' panels
  std::vector<Eigen::Index> charges_, interfaces_, films_;
  std::vector<Eigen::Index> columns_;  ///< of each unknown, in `dipoles_`; negative: none
  Eigen::MatrixXd dipoles_, compliance_;
  std::vector<ClusterRange> leaves_;
  std::size_t threads_ = 1;
};

}  // namespace fringe::detail
