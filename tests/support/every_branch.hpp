/// Independent of the solver: all solutions of one increment of a small 2D scene, by a linear system of all free
/// displacements and tractions for every combination of branches, and the error of a state in the equations of
/// Signorini and Coulomb. It reads geometry, stiffness and loads of the model, and none of the code that solves.
#pragma once

#include <Eigen/LU>

#include "core/model/loading.hpp"
#include "tests/support/largest.hpp"
#include "tests/support/scenes.hpp"

namespace stickslip::scenes {

/// A solution: displacements of all dofs, and tractions (t_N, t_T) of each point.
struct FoundSolution {
  Vector<double> u;
  std::vector<std::array<double, 2>> traction;
};

/// The bodies' stiffness, dense, all dofs.
inline Matrix<double> dense_stiffness(const Model& model, const Slots<double>& slots) {
  Matrix<double> K = Matrix<double>::Zero(model.dof_count(), model.dof_count());
  for (int b = 0; b < static_cast<int>(model.bodies.size()); ++b)
    for_each_element_tangent(model, slots, b, nullptr, [&](const auto& nodes, const auto& k) {
      for (std::size_t i = 0; i < 2 * nodes.size(); ++i)
        for (std::size_t j = 0; j < 2 * nodes.size(); ++j)
          K(2 * nodes[i / 2] + i % 2, 2 * nodes[j / 2] + j % 2) += k(i, j);
    });
  return K;
}

/// Rows that give a point's relative displacement along a direction.
inline Vector<double> along(const Model& model, const Slots<double>& slots, int p, const Eigen::Vector2d& direction) {
  Vector<double> row = Vector<double>::Zero(model.dof_count());
  for (std::size_t n = 0; n < model.points[p].nodes.size(); ++n)
    row.segment<2>(2 * model.points[p].nodes[n]) += slots.geometry[p].weights[n] * direction;
  return row;
}

/// Displacements without any contact; 0 where the bodies could move as a whole. A scale for displacements that are
/// zero.
inline double free_motion(const Model& model, const Slots<double>& slots, double time) {
  Matrix<double> K = dense_stiffness(model, slots);
  Vector<double> f = dead_forces(model, slots, time);
  for (int dof = 0; dof < model.dof_count(); ++dof)
    if (model.free_index[dof] < 0) {
      K.row(dof) = Vector<double>::Unit(K.rows(), dof);
      f[dof] = 0;
    }
  const Eigen::FullPivLU<Matrix<double>> lu(K);
  return lu.isInvertible() ? lu.solve(f).norm() : 0;
}

/// A law as the least of a multiple of the pressure and a constant; infinity: no such piece.
struct LeastOf {
  double coefficient, limit;
};
inline LeastOf pieces_of(const FrictionLaw<double>& friction) {
  constexpr double none = std::numeric_limits<double>::infinity();
  if (const auto* tresca = std::get_if<Tresca<double>>(&friction.law)) return {none, tresca->limit};
  const auto& coulomb = std::get<Coulomb<double>>(friction.law);
  return {coulomb.coefficient, coulomb.limit.value_or(none)};
}

/// Tangential traction that a law of friction bears under a pressure.
inline double most_friction(const FrictionLaw<double>& law, double pressure) {
  const auto [coefficient, limit] = pieces_of(law);
  return std::min(std::isfinite(coefficient) ? coefficient * pressure : coefficient, limit);
}

/// All solutions of the first increment, every point with friction, supports held, obstacles at rest.
inline std::vector<FoundSolution> every_solution(const Model& model, const Slots<double>& slots, double time) {
  const int n = static_cast<int>(model.points.size()), dofs = model.dof_count(), size = dofs + 2 * n;
  const Matrix<double> K = dense_stiffness(model, slots);
  const Vector<double> f = dead_forces(model, slots, time);
  Matrix<double> base = Matrix<double>::Zero(size, size);
  Vector<double> right = Vector<double>::Zero(size);
  base.topLeftCorner(dofs, dofs) = K;
  right.head(dofs) = f;
  std::vector<Vector<double>> normal, tangent;
  for (int p = 0; p < n; ++p) {
    const auto& g = slots.geometry[p];
    normal.push_back(along(model, slots, p, g.normal));
    tangent.push_back(along(model, slots, p, g.tangents.col(0)));
    base.col(dofs + 2 * p).head(dofs) = g.area * normal[p];
    base.col(dofs + 2 * p + 1).head(dofs) = g.area * tangent[p];
  }
  for (int dof = 0; dof < dofs; ++dof)
    if (model.free_index[dof] < 0) {
      base.row(dof) = Vector<double>::Unit(size, dof);
      right[dof] = 0;
    }
  long combinations = 1;
  for (int p = 0; p < n; ++p) combinations *= 6;
  std::vector<FoundSolution> found;
  const double scale = free_motion(model, slots, time);
  for (long c = 0; c < combinations; ++c) {
    Matrix<double> A = base;
    Vector<double> b = right;
    long rest = c;
    std::vector<int> branch;  // 0 open, 1 stick, 2 and 3 slip with t_T of sign -1 and 1, 4 and 5 likewise at the limit
    bool exists = true;
    for (int p = 0; p < n; ++p, rest /= 6) {
      branch.push_back(static_cast<int>(rest % 6));
      const int N = dofs + 2 * p, T = N + 1;
      const auto law = pieces_of(slots.friction[model.points[p].contact]);
      const bool at_limit = branch[p] > 3;
      exists &= branch[p] < 2 || std::isfinite(at_limit ? law.limit : law.coefficient);
      if (!exists) break;
      if (branch[p] == 0)
        A(N, N) = 1;
      else {
        A.row(N).head(dofs) = normal[p];
        b[N] = -slots.geometry[p].gap;
      }
      if (branch[p] == 1)
        A.row(T).head(dofs) = tangent[p];
      else
        A(T, T) = 1;
      if (at_limit)
        b[T] = branch[p] == 4 ? -law.limit : law.limit;
      else if (branch[p] > 1)
        A(T, N) = branch[p] == 2 ? -law.coefficient : law.coefficient;
    }
    if (!exists) continue;
    const Eigen::FullPivLU<Matrix<double>> lu(A);
    if (!lu.isInvertible()) continue;
    const Vector<double> x = lu.solve(b);
    FoundSolution solution{x.head(dofs), {}};
    const double force = 1e-10 * largest_entry(x.tail(2 * n)), length = 1e-10 * largest_entry(x.head(dofs));
    bool valid = true;
    for (int p = 0; p < n; ++p) {
      const double t_N = x[dofs + 2 * p], t_T = x[dofs + 2 * p + 1];
      const double gap = slots.geometry[p].gap + normal[p].dot(solution.u), slip = tangent[p].dot(solution.u);
      valid &= branch[p] == 0 ? gap >= -length : t_N <= force;
      if (branch[p] > 0) valid &= std::abs(t_T) <= most_friction(slots.friction[model.points[p].contact], -t_N) + force;
      if (branch[p] > 1) valid &= (branch[p] % 2 == 0 ? -slip : slip) >= -length;
      solution.traction.push_back({t_N, t_T});
    }
    const auto same = [&](const FoundSolution& other) {
      return (other.u - solution.u).norm() <= 1e-8 * std::max(solution.u.norm(), scale);
    };
    if (valid && std::none_of(found.begin(), found.end(), same)) found.push_back(std::move(solution));
  }
  return found;
}

/// Largest |t - P_mu(t + k g)| of the points, over the largest traction of any kind: 0 for an exact solution. k: local
/// stiffness over area; in space, too. `before`: the last increment's state.
inline double coulomb_error(const Model& model, const Slots<double>& slots, const State<double>& before,
                            const State<double>& after) {
  double worst = 0, scale = 0;
  for (int p = 0; p < static_cast<int>(model.points.size()); ++p) {
    const auto& point = model.points[p];
    const double k = slots.stiffness[p] / slots.geometry[p].area, t_N = after.contact.traction[point.multiplier];
    const double z_N = t_N + k * after.contact.gap[p], pressed = std::min(z_N, 0.0);
    worst = larger(worst, std::abs(t_N - pressed));
    scale = larger(scale, larger(std::abs(t_N), k * std::abs(after.contact.gap[p] - slots.geometry[p].gap)));
    if (point.tangents == 0) continue;
    const int offset = tangential_offset(model, p);
    const Vector<double> t = after.contact.traction.segment(point.multiplier + 1, point.tangents);
    const Vector<double> slip = after.history.placement.segment(offset, point.tangents) -
                                before.history.placement.segment(offset, point.tangents);
    Vector<double> z = t + k * slip;
    const double bound = z_N > 0 ? 0 : most_friction(slots.friction[point.contact], -pressed), size = z.norm();
    if (size > bound) z *= size > 0 ? bound / size : 0;
    worst = larger(worst, (t - z).norm());
    scale = larger(scale, larger(t.norm(), k * slip.norm()));
  }
  return scale == 0 ? worst : worst / scale;
}

}  // namespace stickslip::scenes
