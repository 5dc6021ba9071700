#include "sensitivity/redundancy.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <map>

namespace stickslip {
namespace {

/// Share of its norm below which the independent part of a row counts as zero. Coordinates are rounded at 1e-16, and
/// angles of distinct constraints differ by more.
constexpr double independent = 1e-8;

/// Constraint rows of a closed point over the free dofs (node * D + i, in the frame of a support).
std::vector<std::map<int, double>> rows_of(const Model& model, const Slots<double>& slots,
                                           const ContactField<double>& field, int p, const std::vector<int>& nodes,
                                           const std::vector<char>& decided) {
  const auto& point = model.points[p];
  const auto& geometry = geometry_in(field, slots, p);
  const ContactState state = field.state[p];
  const int D = model.dimension, components = state == ContactState::stick ? point.components() : 1;
  std::vector<std::map<int, double>> rows;
  for (int c = 0; c < components; ++c) {
    if (!decided.empty() && decided[point.multiplier + c]) continue;
    const Vector<double> direction = c == 0 ? geometry.normal : geometry.tangents.col(c - 1);
    auto& row = rows.emplace_back();
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      const int node = nodes[n], framed = framed_index(model, node);
      for (int i = 0; i < D; ++i) {
        const double along = framed < 0 ? direction[i] : slots.frames[framed].col(i).dot(direction);
        if (model.free_index[node * D + i] >= 0 && along != 0) row[node * D + i] += geometry.weights[n] * along;
      }
    }
  }
  return rows;
}

/// Whether rows are linearly independent on the dofs with counts(dof).
template <class Counts>
bool are_independent(const std::vector<std::map<int, double>>& rows, Counts&& counts) {
  std::map<int, int> column;
  for (const auto& row : rows)
    for (const auto& [dof, weight] : row)
      if (counts(dof)) column.try_emplace(dof, static_cast<int>(column.size()));
  const auto height = static_cast<Eigen::Index>(rows.size()), width = static_cast<Eigen::Index>(column.size());
  if (height == 0) return true;
  if (height > width) return false;
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(height, width);
  for (Eigen::Index k = 0; k < height; ++k) {
    for (const auto& [dof, weight] : rows[k])
      if (counts(dof)) matrix(k, column.at(dof)) = weight;
    if (matrix.row(k).norm() > 0) matrix.row(k).normalize();
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factor(matrix.transpose());
  factor.setThreshold(independent);
  return factor.rank() == height;
}

}  // namespace

bool constraints_repeat(const Model& model, const Slots<double>& slots, const ContactField<double>& field,
                        const std::vector<char>& decided) {
  constexpr std::size_t most =
      500;  // largest number of rows of a dense factorisation; with more, constraints count as repeated
  std::vector<int> left, users(model.node_count, 0);
  std::vector<std::vector<std::map<int, double>>> rows(model.points.size());
  std::vector<std::vector<int>> nodes(model.points.size());
  for (int p = 0; p < static_cast<int>(model.points.size()); ++p) {
    if (field.state[p] == ContactState::open) continue;
    nodes[p] = nodes_in(model, field, p);
    rows[p] = rows_of(model, slots, field, p, nodes[p], decided);
    left.push_back(p);
    for (int node : nodes[p]) ++users[node];
  }
  // Rows that are independent on nodes of their own depend on no others. They are removed, repeatedly.
  const auto stands_alone = [&](int p) {
    return are_independent(rows[p], [&](int dof) { return users[dof / model.dimension] == 1; });
  };
  for (std::size_t before = left.size() + 1; left.size() < before;) {
    before = left.size();
    std::vector<int> rest;
    for (int p : left) {
      if (!stands_alone(p)) {
        rest.push_back(p);
        continue;
      }
      for (int node : nodes[p]) --users[node];
    }
    left = std::move(rest);
  }
  std::vector<std::map<int, double>> joined;
  for (int p : left) joined.insert(joined.end(), rows[p].begin(), rows[p].end());
  return joined.size() > most || !are_independent(joined, [](int) { return true; });
}

}  // namespace stickslip
