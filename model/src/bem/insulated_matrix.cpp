#include "bem/insulated_matrix.hpp"

#include <algorithm>
#include <utility>

#include "numeric/parallel.hpp"
#include "numeric/products.hpp"

namespace fringe::detail {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd CombinedFunctions::means(const MatrixXd& potentials) const {
  MatrixXd result = MatrixXd::Zero(size, potentials.cols());
  for (Index c = 0; c < potentials.cols(); ++c)
    for (Index k = 0; k < potentials.rows(); ++k)
      result(place[static_cast<std::size_t>(k)], c) += shares[k] * potentials(k, c);
  return result;
}

MatrixXd CombinedFunctions::combined(const MatrixXd& values) const {
  return means(parts.cwiseInverse().asDiagonal() * values);
}

MatrixXd CombinedFunctions::spread(const MatrixXd& values) const {
  return parts.asDiagonal() * values(place, Eigen::all);
}

InsulatedMatrix::InsulatedMatrix(const PanelOperator& single_layer, const InsulatedUnknowns& unknowns,
                                 MatrixXd dipoles, std::size_t threads)
    : single_layer_(&single_layer), places_(unknowns.places), centres_(unknowns.centres),
      dipoles_(std::move(dipoles)), leaves_(single_layer.tree().leaves().size()), threads_(threads) {
  Index first = 0;
  for (std::size_t leaf = 0; leaf < leaves_.size(); ++leaf) {
    leaves_[leaf] = {first, 0};
    for (; first < unknowns.size() &&
           single_layer.tree().leaf_of(unknowns.places[static_cast<std::size_t>(first)]) == leaf;
         ++first)
      ++leaves_[leaf].count;
  }
  for (Index k = 0; k < unknowns.size(); ++k) {
    columns_.push_back(unknowns.is_charge(k) ? -1 : index_of(interfaces_.size()));
    (unknowns.is_charge(k) ? charges_ : interfaces_).push_back(k);
  }
}

void InsulatedMatrix::add_films(std::vector<Index> films, MatrixXd compliance) {
  films_ = std::move(films);
  compliance_ = std::move(compliance);
}

MatrixXd InsulatedMatrix::times(const MatrixXd& values) const {
  /// Number of rows that one thread multiplies at a time.
  constexpr Index together = 256;
  const HierarchicalMatrix& single_layer = single_layer_->matrix();
  MatrixXd charges = MatrixXd::Zero(single_layer.size(), values.cols());
  for (const Index k : charges_)
    charges.row(places_[static_cast<std::size_t>(k)]) = values.row(k);
  MatrixXd result = single_layer.apply(charges)(places_, Eigen::all);
  const MatrixXd potentials = values(interfaces_, Eigen::all);
  // Eigen cannot take rows of a matrix without columns.
  const Index rows_of_dipoles = interfaces_.empty() ? 0 : result.rows();
  parallel_for(static_cast<std::size_t>((rows_of_dipoles + together - 1) / together), threads_,
               [&](std::size_t part) {
                 const Index first = index_of(part) * together;
                 const Index rows = std::min(together, result.rows() - first);
                 add_product(MatrixReference<double>(dipoles_.middleRows(first, rows)), potentials,
                             result.middleRows(first, rows));
               });
  if (!films_.empty()) {
    const MatrixXd along = compliance_ * values(films_, Eigen::all);
    result(films_, Eigen::all) += along;
  }
  return result;
}

MatrixXd InsulatedMatrix::combined(const CombinedFunctions& space) const {
  Restriction restriction{std::vector<Index>(static_cast<std::size_t>(single_layer_->matrix().size()), -1),
                          VectorXd::Zero(single_layer_->matrix().size())};
  for (std::size_t k = 0; k < space.place.size(); ++k) {
    restriction.target[static_cast<std::size_t>(places_[k])] = space.place[k];
    restriction.weights[places_[k]] = space.shares[index_of(k)];
  }
  MatrixXd result = single_layer_->matrix().dense_restricted(restriction, space.size);
  for (const Index k : interfaces_)
    result.col(space.place[static_cast<std::size_t>(k)]).setZero();
  const MatrixXd means = space.means(dipoles_);
  for (std::size_t k = 0; k < interfaces_.size(); ++k)
    result.col(space.place[static_cast<std::size_t>(interfaces_[k])]) += means.col(index_of(k));
  for (std::size_t column = 0; column < films_.size(); ++column)
    for (std::size_t row = 0; row < films_.size(); ++row)
      result(space.place[static_cast<std::size_t>(films_[row])],
             space.place[static_cast<std::size_t>(films_[column])]) +=
          space.shares[films_[row]] * compliance_(index_of(row), index_of(column)) *
          space.shares[films_[column]];
  return result;
}

void InsulatedMatrix::write_block(std::span<const Index> rows, std::span<const Index> columns,
                                  Eigen::Ref<MatrixXd> block) const {
  const std::size_t leaf = leaf_of(rows.front());
  const HierarchicalMatrix& matrix = single_layer_->matrix();
  const DenseBlock* const near = single_layer_->near_block(leaf, leaf_of(columns.front()));
  const bool as_rows = near != nullptr && matrix.leaves()[leaf] == near->a;
  for (std::size_t column = 0; column < columns.size(); ++column) {
    const auto source = static_cast<std::size_t>(columns[column]);
    if (columns_[source] >= 0)
      continue;
    for (std::size_t row = 0; row < rows.size(); ++row) {
      double& element = block(index_of(row), index_of(column));
      if (near == nullptr) {
        element = 1 / (centres_.col(rows[row]) - centres_.col(columns[column])).norm();
        continue;
      }
      const Index a = places_[static_cast<std::size_t>(rows[row])], b = places_[source];
      element = near->values((as_rows ? a : b) - matrix.range(near->a).first,
                             (as_rows ? b : a) - matrix.range(near->b).first);
    }
  }
}

MatrixXd InsulatedMatrix::block(const std::vector<Index>& unknowns) const {
  const auto size = index_of(unknowns.size());
  MatrixXd result(size, size);
  for (Index column = 0; column < size; ++column)
    if (const Index own = columns_[static_cast<std::size_t>(unknowns[static_cast<std::size_t>(column)])];
        own >= 0)
      result.col(column) = dipoles_.col(own)(unknowns);
  // The unknowns of a leaf follow each other.
  std::vector<std::size_t> begins;
  for (std::size_t k = 0; k < unknowns.size(); ++k)
    if (k == 0 || leaf_of(unknowns[k]) != leaf_of(unknowns[k - 1]))
      begins.push_back(k);
  begins.push_back(unknowns.size());
  const std::span<const Index> all(unknowns);
  for (std::size_t a = 0; a + 1 < begins.size(); ++a)
    for (std::size_t b = 0; b + 1 < begins.size(); ++b) {
      const std::size_t rows = begins[a + 1] - begins[a], columns = begins[b + 1] - begins[b];
      write_block(all.subspan(begins[a], rows), all.subspan(begins[b], columns),
                  result.block(index_of(begins[a]), index_of(begins[b]), index_of(rows), index_of(columns)));
    }
  std::vector<Index> films, own;
  for (Index k = 0; k < size; ++k) {
    const Index unknown = unknowns[static_cast<std::size_t>(k)];
    const auto film = std::lower_bound(films_.begin(), films_.end(), unknown);
    if (film != films_.end() && *film == unknown) {
      films.push_back(film - films_.begin());
      own.push_back(k);
    }
  }
  if (!films.empty())
    result(own, own) += compliance_(films, films);
  return result;
}

}  // namespace fringe::detail
