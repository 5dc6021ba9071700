/// Bodies and contact points in one sparse matrix over the bodies' dofs and the multipliers. Its pattern is fixed for
/// every contact state. Where points slide along surfaces it holds the patches next to those that they face too, and is
/// laid out anew where a point gets further.
#pragma once

#include <cmath>
#include <numeric>

#include "core/algebra/inertia.hpp"
#include "core/engine/full_bodies.hpp"
#include "core/engine/point_system.hpp"

namespace stickslip {

template <class T>
class SparseSystem : public PointSystem<T> {
 public:
  /// `bodies` must outlive it.
  SparseSystem(const Model& model, const Slots<T>& slots, const SystemKind& kind, const FullBodies<T>& bodies);

  void take_over() override { lay_out({}); }
  void take_bodies() override { matrix_.values = bodies_.tangent(matrix_); }
  Matrix<T> times(const Matrix<T>& u, Taken taken) const override { return matrix_.times(u, taken); }
  double stiffness() const override { return matrix_.largest_diagonal(); }
  std::optional<int> motions_unresisted(const std::vector<PointTangent<T>>& springs, Counters& counters) override;
  double condition_estimate() override { return solver_.condition_estimate(); }
  EngineMemory<T> memory() const override { return {places_, model_.effects.linear_bulk ? made_ : FactorRecipe<T>{}}; }
  void restore(const EngineMemory<T>& memory, Counters& counters) override {
    if (memory.places != places_) lay_out(memory.places);
    this->restore_factor(memory.factor, counters);
  }

  bool is_free(Eigen::Index row) const override { return matrix_.row_of_dof[row] >= 0; }
  const std::string& message() const override { return solver_.message(); }
  std::string name() const override {
    const std::string by = solver_.name();
    return by.empty() ? "sparse" : "sparse, " + by;
  }
  long nonzeros() const override { return matrix_.pattern->nonzeros(); }
  void add_to_report(EngineReport& report) const override;

 private:
  using PointSystem<T>::model_, PointSystem<T>::kind_, PointSystem<T>::displacements_, PointSystem<T>::multipliers_,
      PointSystem<T>::row_of_contact_, PointSystem<T>::row_of_multiplier_, PointSystem<T>::made_;
  using Places = std::vector<std::vector<int>>;  ///< per point: places of its nodes (Model::contact_nodes)

  /// Makes the pattern for points with these places, and assembles the bodies. `places`: empty: where nothing has slid.
  void lay_out(Places places);
  const std::vector<int>& places_with_room(std::size_t p) const {
    return places_.empty() ? model_.points[p].places : places_[p];
  }
  bool has_room(const std::vector<PointTangent<T>>& tangents) const;
  /// Places of a point whose tangent it is, with those of the patches around.
  std::vector<int> places_around(std::size_t p, const PointTangent<T>& tangent) const;
  /// Entry of each (row, column) pair of these rows; -1: of a row that is not there.
  std::vector<int> entries_of(const std::vector<int>& rows) const;
  T& diagonal(std::vector<T>& values, int row) const { return values[locate(*matrix_.pattern, row, row)]; }
  /// Adds points to the values of a matrix of this pattern.
  void add_points(const std::vector<PointTangent<T>>& tangents, Multipliers multipliers, std::vector<T>& values) const;

  bool make_factor(Counters& counters) override;
  Matrix<T> solve_factor(const Matrix<T>& b, Taken taken) override { return solver_.solve(b, taken); }
  Matrix<T> multiply(const Matrix<T>& x, Taken taken) const override;
  int determinant_sign() const override { return solver_.determinant_sign(); }

  const FullBodies<T>& bodies_;
  BodyMatrix<T> matrix_;  ///< of the bodies alone
  Places places_;         ///< that the pattern has room for; empty: those of the points where nothing has slid
  std::vector<std::vector<int>> point_map_;  ///< per point: entries_of its rows; none where points slide along surfaces
  std::vector<T> values_;                    ///< that are factorised
  LinearSolver<T> solver_;
  std::optional<Symmetry> analysed_ = std::nullopt;  ///< for tangents of this symmetry
  std::optional<Inertia> inertia_ = std::nullopt;    ///< of motions_unresisted(), analysed for this pattern
};

template <class T>
SparseSystem<T>::SparseSystem(const Model& model, const Slots<T>& slots, const SystemKind& kind,
                              const FullBodies<T>& bodies)
    : PointSystem<T>(model, slots, kind),
      bodies_(bodies),
      matrix_{bodies.row_of_dof(), bodies.dofs()},
      solver_(kind.backend) {
  displacements_ = matrix_.dofs;
  multipliers_.resize(kind.has_unknown_multipliers() ? model.multiplier_count : 0);
  std::iota(multipliers_.begin(), multipliers_.end(), 0);
  row_of_multiplier_.resize(multipliers_.size());
  std::iota(row_of_multiplier_.begin(), row_of_multiplier_.end(), static_cast<int>(displacements_.size()));
  row_of_contact_.reserve(model.contact_nodes.size() * model.dimension);
  for (int node : model.contact_nodes)
    for (int i = 0; i < model.dimension; ++i) row_of_contact_.push_back(matrix_.row_of_dof[node * model.dimension + i]);
}

template <class T>
void SparseSystem<T>::lay_out(Places places) {
  places_ = std::move(places);
  const bool slides = model_.slides_on_surfaces();
  auto lists = bodies_.blocks(matrix_.row_of_dof);
  for (std::size_t p = 0; p < model_.points.size(); ++p) lists.add(this->rows_of(p, places_with_room(p)));
  matrix_.pattern = make_pattern(static_cast<int>(this->size()), lists);
  matrix_.lists = std::move(lists);
  take_bodies();
  if (model_.effects.linear_bulk) matrix_.lists = {};
  point_map_.clear();
  if (!slides) point_map_.reserve(model_.points.size());
  for (std::size_t p = 0; p < model_.points.size() && !slides; ++p)
    point_map_.push_back(entries_of(this->rows_of(p, model_.points[p].places)));
  analysed_.reset();
  inertia_.reset();
}

template <class T>
std::vector<int> SparseSystem<T>::entries_of(const std::vector<int>& rows) const {
  std::vector<int> map;
  map.reserve(rows.size() * rows.size());
  for (int row : rows)
    for (int column : rows) map.push_back(row < 0 || column < 0 ? -1 : locate(*matrix_.pattern, row, column));
  return map;
}

template <class T>
std::vector<int> SparseSystem<T>::places_around(std::size_t p, const PointTangent<T>& tangent) const {
  std::vector<int> places = tangent.places;
  std::sort(places.begin(), places.end());
  if (model_.points[p].surface < 0) return places;
  const auto& curve = model_.surfaces[model_.points[p].surface];
  const auto is_faced = [&](const Patch<2>& patch) {
    const auto holds = [&](int vertex) {
      return std::find(tangent.places.begin(), tangent.places.end(), curve.places[vertex]) != tangent.places.end();
    };
    return holds(patch.corner(0)) || holds(patch.corner(1));
  };
  if (model_.dimension == 2 && curve.obstacle < 0 && tangent.places.size() > 1)
    for (const auto& patch : curve.template patches<2>())
      for (int vertex : is_faced(patch) ? std::span<const int>(patch.vertices) : std::span<const int>())
        if (vertex != no_vertex) places.push_back(curve.places[vertex]);
  std::sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end()), places.end());
  return places;
}

/// Whether the pattern has room for these tangents.
template <class T>
bool SparseSystem<T>::has_room(const std::vector<PointTangent<T>>& tangents) const {
  for (std::size_t p = 0; p < tangents.size(); ++p) {
    const auto& room = places_with_room(p);
    for (int place : tangents[p].places)
      if (!std::binary_search(room.begin(), room.end(), place)) return false;
  }
  return true;
}

template <class T>
void SparseSystem<T>::add_points(const std::vector<PointTangent<T>>& tangents, Multipliers multipliers,
                                 std::vector<T>& values) const {
  for (std::size_t p = 0; p < tangents.size(); ++p) {
    const auto own =
        point_map_.empty() ? entries_of(this->rows_of(p, this->places_of(p, tangents[p]))) : std::vector<int>();
    const auto& map = point_map_.empty() ? own : point_map_[p];
    const int n = static_cast<int>(std::lround(std::sqrt(static_cast<double>(map.size()))));
    this->for_each_entry_of(p, tangents[p], multipliers, [&](int row, int column, const T& x) {
      if (const int entry = map[row * n + column]; entry >= 0) values[entry] += x;
    });
  }
}

/// By a factorisation on the same pattern, in which each multiplier has a row of its own. Left out where it is dear.
template <class T>
std::optional<int> SparseSystem<T>::motions_unresisted(const std::vector<PointTangent<T>>& springs,
                                                       Counters& counters) {
  constexpr double dear = 1e9;  // additions and multiplications
  if constexpr (std::is_same_v<T, double>) {
    if (!has_room(springs)) return std::nullopt;
    if (!inertia_) {
      inertia_.emplace(matrix_.pattern);
      ++counters.analyses;
    }
    if (inertia_->size().flops > dear) return std::nullopt;
    std::vector<double> values = matrix_.values;
    add_points(springs, Multipliers::given, values);
    const int displacements = static_cast<int>(displacements_.size());
    for (int row = 0; row < displacements; ++row) diagonal(values, row) *= PointSystem<T>::raised;
    for (int row = displacements; row < this->size(); ++row) diagonal(values, row) = 1;
    return inertia_->negative_eigenvalues(values, counters.factorizations);
  }
  return std::nullopt;
}

template <class T>
bool SparseSystem<T>::make_factor(Counters& counters) {
  if (model_.slides_on_surfaces() && !has_room(made_.tangents)) {
    Places places;
    for (std::size_t p = 0; p < made_.tangents.size(); ++p)
      places.push_back(made_.tangents[p].places.empty() ? places_with_room(p) : places_around(p, made_.tangents[p]));
    lay_out(std::move(places));
  }
  values_ = matrix_.values;
  this->for_each_hold([&](int row, const T& x) { diagonal(values_, row) += x; });
  add_points(made_.tangents, kind_.multipliers, values_);
  if (const Symmetry now = this->symmetry(); analysed_ != now) {
    solver_.analyse(matrix_.pattern, now);
    analysed_ = now;
    ++counters.analyses;
  }
  const long before = solver_.counters().factorizations;
  const bool valid = solver_.factorise(values_.data());
  counters.factorizations += solver_.counters().factorizations - before;
  return valid;
}

template <class T>
Matrix<T> SparseSystem<T>::multiply(const Matrix<T>& x, Taken taken) const {
  const bool transposed = taken == Taken::transposed;
  const Pattern& pattern = *matrix_.pattern;
  Matrix<T> product = Matrix<T>::Zero(x.rows(), x.cols());
  for (int j = 0; j < pattern.size; ++j)
    for (int k = pattern.column_start[j]; k < pattern.column_start[j + 1]; ++k)
      product.row(transposed ? j : pattern.row[k]) += values_[k] * x.row(transposed ? pattern.row[k] : j);
  return product;
}

template <class T>
void SparseSystem<T>::add_to_report(EngineReport& report) const {
  report.bodies = static_cast<long>(matrix_.values.size() * sizeof(T));
  report.unsymmetric = this->symmetry() == Symmetry::general;
  report.matrix = static_cast<long>(values_.size() * sizeof(T)) + matrix_.pattern->bytes();
  for (const auto& map : point_map_) report.matrix += static_cast<long>(map.size() * sizeof(int));
  report.factor = solver_.factor_bytes();
  report.matrix_entries = static_cast<long>(matrix_.pattern->nonzeros());
  report.factor_entries = solver_.factor_nonzeros();
}

extern template class SparseSystem<double>;

}  // namespace stickslip
