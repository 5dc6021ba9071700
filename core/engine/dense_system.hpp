/// The tangent of condensed bodies and contact points: a dense system of the contact dofs and the multipliers.
///
///   [ S + C_uu  C_ul ]
///   [ C_lu      C_ll ]      S: the bodies on their contact dofs (engine/condensation.hpp); C: of the points
///
/// Rows of the multipliers of open points hold nothing but these, and are left out of the factor. In a large system
/// what single points determine is eliminated before it is factorised (engine/point_elimination.hpp). Vectors u are
/// over the contact dofs (NodalLayout::compact), l over the multipliers.
#pragma once

#include <optional>

#include "core/algebra/dense_factor.hpp"
#include "core/algebra/symmetric_modes.hpp"
#include "core/engine/point_elimination.hpp"
#include "core/engine/point_system.hpp"

namespace stickslip {

template <class T>
class DenseSystem : public PointSystem<T> {
 public:
  /// `stiffness`: S; must outlive the system.
  DenseSystem(const Model& model, const Slots<T>& slots, const SystemKind& kind, const Matrix<T>& stiffness);

  /// From the next factorise() on the system has these displacements alone: of the free ones, all that points touch.
  void take_rows(const std::vector<int>& rows) {
    displacements_ = rows;
    std::fill(row_of_contact_.begin(), row_of_contact_.end(), -1);
    for (std::size_t i = 0; i < rows.size(); ++i) row_of_contact_[rows[i]] = static_cast<int>(i);
  }

  // (S stays as it is, or is looked after by whoever changes it)
  void take_over() override {}
  void take_bodies() override {}
  Matrix<T> times(const Matrix<T>& u, Taken /*symmetric*/) const override { return stiffness_ * u; }
  double stiffness() const override {
    double largest = 0;
    for (Eigen::Index i = 0; i < stiffness_.rows(); ++i) largest = std::max(largest, value(stiffness_(i, i)));
    return largest;
  }
  BlockVector<T> solve(const BlockVector<T>& rows, Solving how) override;
  std::optional<int> motions_unresisted(const std::vector<PointTangent<T>>& springs, Counters& counters) override;
  double condition_estimate() override { return made_.valid ? factor_.condition_estimate() : 0; }
  EngineMemory<T> memory() const override { return {.factor = made_}; }
  void restore(const EngineMemory<T>& memory, Counters& counters) override {
    this->restore_factor(memory.factor, counters);
  }

  bool is_free(Eigen::Index row) const override { return free_[row]; }
  bool has_costly_factors() const override { return false; }
  const std::string& message() const override { return factor_.message(); }
  std::string factor_name() const { return this->symmetry() == Symmetry::positive_definite ? "LL^T" : "LU"; }
  std::string name() const override { return "condensed, dense " + factor_name(); }
  long nonzeros() const override { return static_cast<long>(this->unknowns()) * this->unknowns(); }
  void add_to_report(EngineReport& report) const override {
    report.unsymmetric = this->symmetry() == Symmetry::general;
    report.factor = factor_.bytes();
    report.matrix_entries = report.factor_entries = static_cast<long>(matrix_.size());
    report.matrix = static_cast<long>(matrix_.size() * sizeof(T));
    if (!points_) return;
    report.matrix_entries = points_->entries();
    report.matrix = points_->bytes();
    report.factor_entries = report.factor / static_cast<long>(sizeof(T));
  }

 private:
  using PointSystem<T>::model_, PointSystem<T>::kind_, PointSystem<T>::displacements_, PointSystem<T>::multipliers_,
      PointSystem<T>::row_of_contact_, PointSystem<T>::row_of_multiplier_, PointSystem<T>::made_;

  bool make_factor(Counters& counters) override;
  void take_multipliers();
  void put_bodies(Matrix<T>& K) const;
  void add_points(const std::vector<PointTangent<T>>& tangents, Multipliers multipliers, Matrix<T>& K) const;
  std::optional<PointElimination<T>> eliminated() const;
  Matrix<T> solve_factor(const Matrix<T>& b, Taken taken) override {
    const auto with_factor = [&](const Matrix<T>& rows) { return factor_.solve(rows, taken); };
    return points_ ? points_->solve(b, taken, with_factor) : with_factor(b);
  }
  Matrix<T> multiply(const Matrix<T>& x, Taken taken) const override {
    if (points_) return points_->times(x, taken);
    return taken == Taken::transposed ? Matrix<T>(matrix_.transpose() * x) : Matrix<T>(matrix_ * x);
  }
  int determinant_sign() const override { return factor_.determinant_sign() * (points_ ? points_->sign() : 1); }
  bool leaves_out(const PointTangent<T>& tangent) const override {
    return kind_.has_unknown_multipliers() && tangent.row_w.cwiseAbs().maxCoeff() == 0;
  }

  const Matrix<T>& stiffness_;
  std::vector<char> free_;                     ///< per contact dof
  Vector<T> open_diagonal_;                    ///< of the multiplier rows that are not in the factor
  Matrix<T> matrix_;                           ///< the one that is factorised; empty where points are eliminated
  std::optional<PointElimination<T>> points_;  ///< what was eliminated of points; none in a small system
  DenseFactor<T> factor_;
};

template <class T>
DenseSystem<T>::DenseSystem(const Model& model, const Slots<T>& slots, const SystemKind& kind,
                            const Matrix<T>& stiffness)
    : PointSystem<T>(model, slots, kind), stiffness_(stiffness) {
  const auto contacts = model.contact_nodes.size() * model.dimension;
  free_.reserve(contacts);
  row_of_contact_.reserve(contacts);
  displacements_.reserve(contacts);
  for (int node : model.contact_nodes)
    for (int i = 0; i < model.dimension; ++i) {
      free_.push_back(model.free_index[node * model.dimension + i] >= 0);
      row_of_contact_.push_back(free_.back() ? static_cast<int>(displacements_.size()) : -1);
      if (free_.back()) displacements_.push_back(static_cast<int>(free_.size()) - 1);
    }
}

/// Leaves out those of open points.
template <class T>
void DenseSystem<T>::take_multipliers() {
  multipliers_.clear();
  row_of_multiplier_.assign(model_.multiplier_count, -1);
  open_diagonal_ = Vector<T>::Constant(model_.multiplier_count, T(1));
  if (!kind_.has_unknown_multipliers()) return;
  for (std::size_t p = 0; p < made_.tangents.size(); ++p) {
    const bool open = leaves_out(made_.tangents[p]);
    for (int c = 0; c < model_.points[p].components(); ++c) {
      const int k = model_.points[p].multiplier + c;
      if (open) {
        open_diagonal_[k] = made_.tangents[p].row_l(c, c);
      } else {
        row_of_multiplier_[k] = static_cast<int>(this->size());
        multipliers_.push_back(k);
      }
    }
  }
}

template <class T>
void DenseSystem<T>::put_bodies(Matrix<T>& K) const {
  const auto free = static_cast<Eigen::Index>(displacements_.size());
  for (Eigen::Index j = 0; j < free; ++j)
    for (Eigen::Index i = 0; i < free; ++i) K(i, j) = stiffness_(displacements_[i], displacements_[j]);
}

template <class T>
void DenseSystem<T>::add_points(const std::vector<PointTangent<T>>& tangents, Multipliers multipliers,
                                Matrix<T>& K) const {
  for (std::size_t p = 0; p < tangents.size(); ++p) {
    const auto rows = this->rows_of(p, this->places_of(p, tangents[p]));
    this->for_each_entry_of(p, tangents[p], multipliers, [&](int row, int column, const T& x) {
      if (rows[row] >= 0 && rows[column] >= 0) K(rows[row], rows[column]) += x;
    });
  }
}

template <class T>
std::optional<int> DenseSystem<T>::motions_unresisted(const std::vector<PointTangent<T>>& springs,
                                                      Counters& /*counters: those of dense factors count nothing*/) {
  if constexpr (std::is_same_v<T, double>) {
    const auto free = static_cast<Eigen::Index>(displacements_.size());
    Matrix<double> K(free, free);
    put_bodies(K);
    add_points(springs, Multipliers::given, K);
    K.diagonal() *= PointSystem<T>::raised;
    if (K.llt().info() == Eigen::Success) return 0;
    return count_negative_eigenvalues(K);
  }
  return std::nullopt;
}

/// The system with what single points determine eliminated; none if no point can be.
template <class T>
std::optional<PointElimination<T>> DenseSystem<T>::eliminated() const {
  const auto free = static_cast<Eigen::Index>(displacements_.size());
  Matrix<T> K(free, free);
  put_bodies(K);
  this->for_each_hold([&](int row, const T& x) { K(row, row) += x; });
  std::vector<Eigen::Triplet<T>> border;
  std::vector<typename PointElimination<T>::Point> points;
  std::vector<int> touching(free, 0);  // per displacement: how many points
  for (std::size_t p = 0; p < made_.tangents.size(); ++p) {
    if (leaves_out(made_.tangents[p])) continue;
    const auto& places = this->places_of(p, made_.tangents[p]);
    const auto rows = this->rows_of(p, places);
    this->for_each_entry_of(p, made_.tangents[p], kind_.multipliers, [&](int i, int j, const T& x) {
      if (rows[i] < 0 || rows[j] < 0) return;
      if (rows[i] < free && rows[j] < free)
        K(rows[i], rows[j]) += x;
      else
        border.emplace_back(rows[i], rows[j], x);
    });
    auto& point = points.emplace_back();
    const int slave = model_.points[p].places[0];
    for (std::size_t k = 0; k < rows.size(); ++k) {
      if (rows[k] >= free) point.multipliers.push_back(rows[k]);
      if (rows[k] < 0 || rows[k] >= free) continue;
      ++touching[rows[k]];
      if (places[k / model_.dimension] == slave) point.slave.push_back(rows[k]);
    }
  }
  for (auto& point : points) std::erase_if(point.slave, [&](int row) { return touching[row] > 1; });
  typename PointElimination<T>::Sparse sparse(this->size(), this->size());
  sparse.setFromTriplets(border.begin(), border.end());
  PointElimination<T> elimination(std::move(K), std::move(sparse), points);
  if (elimination.is_empty()) return std::nullopt;
  return elimination;
}

template <class T>
bool DenseSystem<T>::make_factor(Counters& counters) {
  take_multipliers();
  points_.reset();
  if (kind_.has_unknown_multipliers() && this->size() >= large_dense_system) points_ = eliminated();
  if (points_) {
    matrix_.resize(0, 0);
    const bool is_symmetric = this->symmetry() == Symmetry::indefinite && points_->keeps_symmetry();
    const Symmetry symmetry = is_symmetric ? Symmetry::positive_definite : Symmetry::general;
    const bool valid = factor_.factorise(points_->reduced(), symmetry, counters.factorizations);
    points_->let_reduced_go();
    return valid;
  }
  Matrix<T>& K = matrix_;
  K = Matrix<T>::Zero(this->size(), this->size());
  put_bodies(K);
  this->for_each_hold([&](int row, const T& x) { K(row, row) += x; });
  add_points(made_.tangents, kind_.multipliers, K);
  return factor_.factorise(K, this->symmetry(), counters.factorizations);
}

template <class T>
BlockVector<T> DenseSystem<T>::solve(const BlockVector<T>& rows, Solving how) {
  auto out = PointSystem<T>::solve(rows, how);
  if (kind_.has_unknown_multipliers())
    for (int k = 0; k < model_.multiplier_count; ++k)
      if (row_of_multiplier_[k] < 0) out.l.row(k) = rows.l.row(k) / open_diagonal_[k];
  return out;
}

extern template class DenseSystem<double>;

}  // namespace stickslip
