#include "sensitivity/redundancy.hpp"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <set>

#include "core/engine/shared_forces.hpp"
#include "core/model/stencil.hpp"
#include "sensitivity/force_search.hpp"

namespace stickslip {
namespace {

/// Share of its norm below which the independent part of a row counts as zero. Coordinates are rounded at 1e-16, and
/// angles of distinct constraints differ by more.
constexpr double independent = 1e-8;

/// A constraint of a point: its place among all multipliers, and its weights on the free dofs (node * D + i, in the
/// frame of a support).
struct Row {
  int multiplier = 0;
  std::map<int, double> weights;
};
using Rows = std::vector<Row>;

/// The rows of the first `components` constraints of a point. Those that are `decided` elsewhere are left out.
Rows rows_of(const Model& model, const Slots<double>& slots, const PointGeometry<double>& geometry, int p,
             int components, const std::vector<int>& nodes, const std::vector<char>& decided) {
  const auto& point = model.points[p];
  const int D = model.dimension;
  Rows rows;
  for (int c = 0; c < components; ++c) {
    if (!decided.empty() && decided[point.multiplier + c]) continue;
    const Vector<double> direction = c == 0 ? geometry.normal : geometry.tangents.col(c - 1);
    auto& row = rows.emplace_back(Row{point.multiplier + c, {}}).weights;
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
bool are_independent(const Rows& rows, Counts&& counts) {
  std::map<int, int> column;
  for (const auto& row : rows)
    for (const auto& [dof, weight] : row.weights)
      if (counts(dof)) column.try_emplace(dof, static_cast<int>(column.size()));
  const auto height = static_cast<Eigen::Index>(rows.size()), width = static_cast<Eigen::Index>(column.size());
  if (height == 0) return true;
  if (height > width) return false;
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(height, width);
  for (Eigen::Index k = 0; k < height; ++k) {
    for (const auto& [dof, weight] : rows[k].weights)
      if (counts(dof)) matrix(k, column.at(dof)) = weight;
    if (matrix.row(k).norm() > 0) matrix.row(k).normalize();
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factor(matrix.transpose());
  factor.setThreshold(independent);
  return factor.rank() == height;
}

/// Removes points whose rows are independent on nodes of their own, repeatedly: they depend on no others. Returns the
/// rest.
std::vector<int> without_lone_points(std::vector<int> left, const std::vector<Rows>& rows,
                                     const std::vector<std::vector<int>>& nodes, const Model& model) {
  std::vector<int> users(model.node_count, 0);
  for (int p : left)
    for (int node : nodes[p]) ++users[node];
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
  return left;
}

/// Combinations of rows that vanish: factors of the rows, one combination a column. None if there are none. `bare`:
/// rows of normal constraints that bear nothing and can only come to press; where there is one combination alone, it
/// must not have these with both signs.
Matrix<double> vanishing_combinations(const Rows& rows, const std::vector<char>& bare) {
  std::map<int, int> column;
  for (const auto& row : rows)
    for (const auto& [dof, weight] : row.weights) column.try_emplace(dof, static_cast<int>(column.size()));
  const auto height = static_cast<Eigen::Index>(rows.size());
  if (height == 0) return {};
  Matrix<double> matrix = Matrix<double>::Zero(static_cast<Eigen::Index>(column.size()), height);  // transposed
  for (Eigen::Index k = 0; k < height; ++k)
    for (const auto& [dof, weight] : rows[k].weights) matrix(column.at(dof), k) = weight;
  const Vector<double> sizes = matrix.colwise().norm();
  Eigen::FullPivLU<Eigen::MatrixXd> factor(matrix * sizes.cwiseInverse().asDiagonal());
  factor.setThreshold(independent);
  if (factor.dimensionOfKernel() == 0) return {};
  Matrix<double> kernel = factor.kernel();
  const double least = independent * kernel.cwiseAbs().maxCoeff();
  kernel = (kernel.array().abs() > least).select(kernel, 0.0).eval();
  bool pushes = false, pulls = false;
  for (Eigen::Index k = 0; k < height; ++k) {
    pushes |= bare[k] && kernel(k, 0) > 0;
    pulls |= bare[k] && kernel(k, 0) < 0;
  }
  if (kernel.cols() == 1 && pushes && pulls) return {};
  return sizes.cwiseInverse().asDiagonal() * kernel;
}

/// Nodes of a slave and a master that face one another at the start.
struct FacingSides {
  std::set<int> slave, master;
};

/// By contact: its sides, where more slave nodes face a deformable master than nodes of it. Constraints repeat one
/// another there, but for what the slave yields.
std::map<int, FacingSides> crowded_sides(const Model& model) {
  std::map<int, FacingSides> sides;
  for (const auto& point : model.points) {
    const auto faced = point.nodes.begin() + point.slave_nodes;
    if (point.obstacle >= 0 || faced == point.nodes.end()) continue;
    auto& side = sides[point.contact];
    side.slave.insert(point.nodes[0]);
    side.master.insert(faced, point.nodes.end());
  }
  std::erase_if(sides, [](const auto& side) { return side.second.slave.size() <= side.second.master.size(); });
  return sides;
}

/// Per contact node: mean stiffness over all directions.
std::vector<double> mean_stiffness(const Model& model, const Slots<double>& slots) {
  std::vector<double> stiffness;
  for (const auto& block : nodal_stiffness(model, slots)) stiffness.push_back(block.trace() / model.dimension);
  return stiffness;
}

/// A node that is stiffer than its master by more is as good as held. Why: gaps are met to 1e-10 (Uzawa's default
/// tolerance) of what the softer side yields; of the pressures that the stiff side alone shares out, that leaves more
/// than 1e-4.
constexpr double stiffer = 1e6;

/// Per node: whether it is as good as held for the master of its contact. Empty if there is no such node.
std::vector<char> stiff_nodes(const Model& model, const Slots<double>& slots) {
  const auto sides = crowded_sides(model);
  if (sides.empty()) return {};
  const auto stiffness = mean_stiffness(model, slots);
  std::vector<char> stiff;
  for (const auto& [contact, side] : sides) {
    double softest = std::numeric_limits<double>::infinity();
    for (int node : side.master) softest = std::min(softest, stiffness[model.place_of(node)]);
    for (int node : side.slave)
      if (stiffness[model.place_of(node)] > stiffer * softest) {
        stiff.resize(model.node_count);
        stiff[node] = 1;
      }
  }
  return stiff;
}

/// Drops what stands at dofs of stiff nodes, and rows of which nothing is left.
void drop_stiff(const std::vector<char>& stiff, int dimension, Rows& rows) {
  if (!stiff.empty())
    for (auto& row : rows)
      std::erase_if(row.weights, [&](const auto& entry) { return stiff[entry.first / dimension] != 0; });
  std::erase_if(rows, [](const auto& row) { return row.weights.empty(); });
}

/// Rows of several points, one below the other.
struct JoinedRows {
  Rows rows;
  std::vector<int> point;  ///< of each row
  std::vector<char> bare;  ///< per row: as vanishing_combinations() takes it
};

/// The forces that combinations of rows leave open. `pressed`: largest pressure.
UndeterminedForces forces_of(const Model& model, const Slots<double>& slots, const ContactField<double>& field,
                             const JoinedRows& joined, double pressed) {
  const Matrix<double> combinations = vanishing_combinations(joined.rows, joined.bare);
  if (combinations.size() == 0) return {};
  UndeterminedForces found{std::vector<char>(model.scene.contacts.size(), 0),
                           Matrix<double>::Zero(model.multiplier_count, combinations.cols())};
  for (std::size_t k = 0; k < joined.rows.size(); ++k) {
    const auto factors = combinations.row(static_cast<Eigen::Index>(k));
    if (factors.isZero(0)) continue;
    found.contacts[model.points[joined.point[k]].contact] = 1;
    found.changes.row(joined.rows[k].multiplier) = factors / geometry_in(field, slots, joined.point[k]).area;
  }
  for (auto change : found.changes.colwise()) change *= pressed / change.cwiseAbs().maxCoeff();
  return found;
}

}  // namespace

bool constraints_repeat(const Model& model, const Slots<double>& slots, const ContactField<double>& field,
                        const std::vector<char>& decided) {
  // Largest number of rows of a dense factorisation; with more, constraints count as repeated.
  constexpr std::size_t most = 500;
  std::vector<int> closed;
  std::vector<Rows> rows(model.points.size());
  std::vector<std::vector<int>> nodes(model.points.size());
  for (int p = 0; p < static_cast<int>(model.points.size()); ++p) {
    if (field.state[p] == ContactState::open) continue;
    nodes[p] = nodes_in(model, field, p);
    const int components = field.state[p] == ContactState::stick ? model.points[p].components() : 1;
    rows[p] = rows_of(model, slots, geometry_in(field, slots, p), p, components, nodes[p], decided);
    closed.push_back(p);
  }
  Rows joined;
  for (int p : without_lone_points(std::move(closed), rows, nodes, model))
    joined.insert(joined.end(), rows[p].begin(), rows[p].end());
  return joined.size() > most || !are_independent(joined, [](int) { return true; });
}

std::vector<double> slave_shares(const Model& model, const Slots<double>& slots) {
  const auto sides = crowded_sides(model);
  if (sides.empty()) return {};
  const auto stiffness = mean_stiffness(model, slots);
  std::vector<double> shares;
  for (const auto& point : model.points)
    shares.push_back(sides.count(point.contact) ? stiffness[model.place_of(point.nodes[0])] : 0);
  return shares;
}

ForceSearch::ForceSearch(const Model& model, const Slots<double>& slots)
    : model_(model), slots_(slots), stiff_(stiff_nodes(model, slots)) {
  std::vector<int> as_slave(model.node_count, 0), as_master(model.node_count, 0);
  for (const auto& point : model.points) {
    ++as_slave[point.nodes[0]];
    for (std::size_t n = point.slave_nodes; n < point.nodes.size(); ++n) ++as_master[point.nodes[n]];
    if (point.surface >= 0)
      for (int node : model.surfaces[point.surface].nodes) ++as_master[node];
  }
  const auto yields = [&](int node) {
    const auto first = model.free_index.begin() + static_cast<long>(node) * model.dimension;
    return std::all_of(first, first + model.dimension, [](int index) { return index >= 0; }) &&
           (stiff_.empty() || !stiff_[node]);
  };
  for (int p = 0; p < static_cast<int>(model.points.size()); ++p) {
    const auto& point = model.points[p];
    const int node = point.nodes[0];
    const bool shared = as_slave[node] > 1 || as_master[node] > 0;
    if (shared || (point.obstacle < 0 && !yields(node))) suspects_.push_back(p);
  }
}

UndeterminedForces ForceSearch::undetermined(const State<double>& state, const std::vector<double>& compliance) const {
  constexpr double nothing = 1e-9;   // of the largest traction and displacement: what solving leaves of none
  constexpr double elastic = 10;     // springs of a penalty slip by compliance times traction, and a little more
  constexpr std::size_t most = 200;  // rows of a dense factorisation; more are not searched
  const auto& field = state.contact;
  const auto& points = model_.points;
  double pressed = 0, reach = state.displacement.cwiseAbs().maxCoeff();
  for (std::size_t p = 0; p < points.size(); ++p) {
    const double pressure = -field.traction[points[p].multiplier];
    pressed = std::max(pressed, pressure);
    reach = std::max(reach, pressure * slots_.geometry[p].area / slots_.stiffness[p]);  // what the node alone yields
  }
  const auto presses = [&](int p) {
    // (a stiff node that is as near as the softer side makes the stiff one yield may press as well as not)
    if (!stiff_.empty() && stiff_[points[p].nodes[0]]) return std::abs(field.gap[p]) <= reach / stiffer;
    return field.state[p] != ContactState::open && -field.traction[points[p].multiplier] > nothing * pressed;
  };
  if (std::none_of(suspects_.begin(), suspects_.end(), presses)) return {};
  const double still = nothing * reach;
  const auto touches = [&](int p) {  // and may press as well, if another point presses more
    return !presses(p) && -field.traction[points[p].multiplier] >= -nothing * pressed &&
           std::abs(field.gap[p]) <= still;
  };
  const auto sticks = [&](int p) {  // a point on its cone may stick as well, if it does not move
    if (field.state[p] == ContactState::stick || points[p].tangents == 0) return points[p].tangents > 0;
    if (slots_.friction[points[p].contact].bears_nothing()) return false;
    const auto slip = field.slip.segment(tangential_offset(model_, p), points[p].tangents);
    const auto pull = field.traction.segment(points[p].multiplier + 1, points[p].tangents);
    return slip.norm() <= still + (compliance.empty() ? 0 : elastic * compliance[p] * pull.norm());
  };
  const auto decided = decided_elsewhere(model_, slots_, &field);
  std::vector<int> closed;
  std::vector<Rows> rows(points.size());
  std::vector<std::vector<int>> nodes(points.size());
  for (int p = 0; p < static_cast<int>(points.size()); ++p) {
    if (!presses(p) && !touches(p)) continue;
    nodes[p] = nodes_in(model_, field, p);
    rows[p] = rows_of(model_, slots_, geometry_in(field, slots_, p), p,
                      presses(p) && sticks(p) ? points[p].components() : 1, nodes[p], decided);
    drop_stiff(stiff_, model_.dimension, rows[p]);
    closed.push_back(p);
  }
  JoinedRows joined;
  for (int p : without_lone_points(std::move(closed), rows, nodes, model_)) {
    joined.rows.insert(joined.rows.end(), rows[p].begin(), rows[p].end());
    joined.point.resize(joined.rows.size(), p);
    joined.bare.resize(joined.rows.size(), !presses(p));
  }
  if (joined.rows.size() > most) return {};
  return forces_of(model_, slots_, field, joined, pressed);
}

}  // namespace stickslip
