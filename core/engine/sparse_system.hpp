/// Bodies and contact points in one sparse matrix over the bodies' dofs and the multipliers. Its pattern is fixed for
/// every contact state. Where points slide along curves it holds the patches next to those that they face too, and is
/// laid out anew where a point gets further.
#pragma once

#include <optional>

#include "core/engine/body_matrix.hpp"
#include "core/engine/tangent_system.hpp"

namespace stickslip {

template <class T>
class SparseSystem : public TangentSystem<T> {
 public:
  using Places = std::vector<std::vector<int>>;  ///< per point: places of its nodes (Model::contact_nodes)

  /// `row_of_dof`, `dofs`: rows of the bodies; both must outlive it.
  SparseSystem(const Model& model, const Slots<T>& slots, bool unknown_multipliers, Symmetry symmetry, Backend backend,
               const std::vector<int>& row_of_dof, const std::vector<int>& dofs)
      : model_(model),
        slots_(slots),
        unknown_multipliers_(unknown_multipliers),
        symmetry_(symmetry),
        row_of_dof_(row_of_dof),
        dofs_(dofs),
        size_(static_cast<int>(dofs.size()) + (unknown_multipliers ? model.multiplier_count : 0)),
        solver_(backend) {}

  /// Those of the points where nothing has slid.
  Places places_at_start() const;
  /// Makes the pattern of these blocks of the bodies and of points with these places. Returns all blocks.
  RowLists lay_out(RowLists bodies, const Places& places);
  /// Places that have room for these tangents; none where the pattern has.
  std::optional<Places> places_for(const std::vector<PointTangent<T>>& tangents) const;
  const Places& places() const { return places_; }  ///< that the pattern has; none slides: empty

  /// Makes the factor anew. `bodies`: their matrix on the pattern. `hold`: as of Engine::factorise().
  bool factorise(const std::vector<T>& bodies, const std::vector<PointTangent<T>>& tangents, const Vector<double>& hold,
                 Counters& counters);
  /// Whether the factor is that of these tangents up to rounding, as long as the bodies' matrix is the same.
  bool is_factor_of(const std::vector<PointTangent<T>>& tangents, const Vector<double>& hold) const {
    return valid_ && detail::same_values(hold, held_) && detail::same_tangents(tangents, factorised_);
  }
  /// In place of factorise(), where few points changed since and the bodies' matrix is the same.
  bool update(const std::vector<PointTangent<T>>& tangents, const Vector<double>& hold, Counters& counters);
  void drop_update() { update_.clear(); }
  int solves() const { return update_.empty() ? 1 : 2; }

  const std::vector<int>& row_of_dof() const override { return row_of_dof_; }
  const std::vector<int>& dofs() const override { return dofs_; }
  const Pattern& pattern() const override { return *pattern_; }
  BlockVector<T> solve(const BlockVector<T>& rows, Solving how) override;
  bool reversed() const override;
  double condition_estimate() override { return solver_.condition_estimate(); }
  const std::string& message() const override { return solver_.message(); }
  std::string name() const override { return solver_.name(); }
  void add_holdings(EngineHoldings& held) const override;
  int size() const { return size_; }

  FactorRecipe<T> recipe() const { return {valid_, factorised_, held_, update_}; }
  /// Goes back to a factor that was made from `recipe`: later solves have the same bits as they had then.
  void restore(const FactorRecipe<T>& recipe, const std::vector<T>& bodies, Counters& counters);

 private:
  /// Rows of a point's entries.
  std::vector<int> rows_of(std::size_t p, const std::vector<int>& places) const;
  /// Places of a point whose tangent it is, with those of the patches around.
  std::vector<int> places_around(std::size_t p, const PointTangent<T>& tangent) const;
  void add_points(const std::vector<PointTangent<T>>& tangents);

  const Model& model_;
  const Slots<T>& slots_;
  bool unknown_multipliers_;
  Symmetry symmetry_;
  const std::vector<int>&row_of_dof_, &dofs_;
  int size_;
  Places places_;
  std::shared_ptr<Pattern> pattern_;
  std::vector<std::vector<int>> point_map_;  ///< per point: entry of each (row, column) pair of its rows, -1 if fixed
  std::vector<T> values_;
  LinearSolver<T> solver_;
  bool analysed_ = false, valid_ = false;
  std::vector<PointTangent<T>> factorised_;
  TangentUpdate update_;
  Vector<double> held_;
};

extern template class SparseSystem<double>;

}  // namespace stickslip
