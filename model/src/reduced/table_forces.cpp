#include "reduced/table_forces.hpp"

#include <algorithm>

#include "reduced/node_kernels.hpp"
#include "simd/dispatch.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXf;
using Eigen::Vector3d;

constexpr std::size_t no_place = static_cast<std::size_t>(-1);

}  // namespace

void add_wrenches(const std::vector<OfReading>& readings, const MatrixXf& charges, const Forces& forces,
                  std::vector<Wrench>& wrenches) {
  const auto on = [&](Index load, Index field) {
    const Eigen::Map<const Eigen::Matrix<double, 6, Eigen::Dynamic>> of_functions(forces.col(field).data(), 6,
                                                                                  charges.rows());
    const Eigen::Matrix<double, 6, 1> sum = of_functions * charges.col(load).cast<double>();
    return Wrench{sum.head<3>(), sum.tail<3>()};
  };
  for (std::size_t k = 0; k < readings.size(); ++k) {
    const auto [sense, drive, sign] = readings[k];
    wrenches[k] += sign * on(sense, drive);
    wrenches[k] += sign * on(drive, sense);
  }
}

void TablePotentials::start(const PotentialTable& table, TrianglePotentials& rows) {
  table_ = &table;
  rows_ = &rows;
  cells_.clear();
  none_.assign(table.width(), 0.0F);
  sums_.resize(table.width());
}

bool TablePotentials::add(const Vector3d& point, Index row, float factor) {
  if (row != row_)
    finish();
  row_ = row;
  // Points of a function follow each other in space, so that most are in the cell before.
  if (cells_.empty() || !table_->contains(cells_[in_cell_], point)) {
    const std::optional<std::size_t> cell = table_->find(point);
    if (!cell)
      return false;
    in_cell_ = static_cast<std::size_t>(std::find(cells_.begin(), cells_.end(), *cell) - cells_.begin());
    if (in_cell_ == most_cells) {
      finish();
      in_cell_ = 0;
    }
    if (in_cell_ == cells_.size()) {
      cells_.push_back(*cell);
      weights_[in_cell_].fill(0);
    }
  }
  table_->add_weights(cells_[in_cell_], point, factor, weights_[in_cell_]);
  return true;
}

void TablePotentials::finish() {
  const auto& kernels = best_kernels<NodeKernels>();
  for (std::size_t k = 0; k < cells_.size(); ++k) {
    kernels.apply({table_->values(cells_[k]), PotentialTable::nodes, index_of(table_->width())},
                  weights_[k].data(), none_.data(), unused_.data(), sums_.data());
    kernels.add(1, sums_.data(), rows_->row(row_).data(), index_of(table_->width()));
  }
  cells_.clear();
}

void TableForces::start(const PotentialTable& table, const MatrixXf& factors) {
  table_ = &table;
  factors_ = factors;
  places_.assign(table.count(), no_place);
  at_nodes_.clear();
  cell_.reset();
}

/// Returns the fields at the nodes of a cell, one field after the other.
const float* TableForces::nodes_of(std::size_t cell) {
  constexpr std::size_t nodes = PotentialTable::nodes;
  const auto fields = static_cast<std::size_t>(factors_.cols());
  if (places_[cell] == no_place) {
    places_[cell] = at_nodes_.size();
    at_nodes_.resize(at_nodes_.size() + nodes * fields);
    unused_.resize(nodes + table_->width(), 0.0F);
    float* const values = at_nodes_.data() + places_[cell];
    for (std::size_t field = 0; field < fields; ++field)
      best_kernels<NodeKernels>().apply({table_->values(cell), nodes, factors_.rows()}, unused_.data(),
                                        factors_.col(static_cast<Index>(field)).data(),
                                        values + nodes * field, unused_.data() + nodes);
  }
  return at_nodes_.data() + places_[cell];
}

bool TableForces::add(const Vector3d& point, std::size_t function, float share, Forces& forces) {
  // Points of a function follow each other in space, so that most are in the cell before.
  if (!cell_ || function != function_ || !table_->contains(*cell_, point)) {
    finish(forces);
    function_ = function;
    cell_ = table_->find(point);
    if (!cell_)
      return false;
  }
  table_->add_wrench_weights(*cell_, point, share, weights_);
  return true;
}

void TableForces::finish(Forces& forces) {
  constexpr auto nodes = static_cast<Index>(PotentialTable::nodes);
  if (!cell_)
    return;
  using Weights = Eigen::Matrix<float, nodes, 6>;
  const Eigen::Map<const Weights> weights(weights_.front().data());
  const Eigen::Map<const Eigen::Matrix<float, nodes, Eigen::Dynamic>> fields(nodes_of(*cell_), nodes,
                                                                             factors_.cols());
  const Vector3d& centre = table_->centre(*cell_);
  for (Index field = 0; field < fields.cols(); ++field) {
    const Eigen::Matrix<double, 6, 1> own = (weights.transpose() * fields.col(field)).template cast<double>();
    auto sum = forces.col(field).segment<6>(6 * index_of(function_));
    sum += own;
    sum.tail<3>() += centre.cross(own.head<3>());
  }
  for (auto& component : weights_)
    component.fill(0);
  cell_.reset();
}

}  // namespace fringe::detail
