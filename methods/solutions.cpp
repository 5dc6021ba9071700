#include "methods/solutions.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace stickslip {
namespace {

/// A branch of a point; `sign` of t_T in slip.
struct Branch {
  ContactState state = ContactState::open;
  double sign = 0;
};

std::vector<Branch> branches_of(const BranchProblem::Point& point) {
  if (point.tangential < 0) return {{ContactState::open, 0}, {ContactState::slip, 0}};
  return {{ContactState::open, 0}, {ContactState::stick, 0}, {ContactState::slip, -1}, {ContactState::slip, 1}};
}

/// The linear system of a combination.
struct System {
  Matrix<double> matrix;
  Vector<double> right;
};

System system_of(const BranchProblem& problem, const std::vector<Branch>& combination) {
  const Eigen::Index n = problem.free.size();
  System system{Matrix<double>::Identity(n, n), Vector<double>::Zero(n)};
  for (std::size_t p = 0; p < combination.size(); ++p) {
    const auto& point = problem.points[p];
    const auto& [state, sign] = combination[p];
    if (state == ContactState::open) continue;
    system.matrix.row(point.normal) = problem.compliance.row(point.normal);
    system.matrix(point.normal, point.normal) += point.yield_normal;
    system.right[point.normal] = problem.free[point.normal];
    if (point.tangential < 0) continue;
    if (state == ContactState::slip) {
      system.matrix(point.tangential, point.normal) = sign * point.friction;
      continue;
    }
    system.matrix.row(point.tangential) = problem.compliance.row(point.tangential);
    system.matrix(point.tangential, point.tangential) += point.yield_tangential;
    system.right[point.tangential] = problem.free[point.tangential] + point.yield_tangential * point.stored;
  }
  return system;
}

/// Calls f(combination) for each combination of branches until it returns false.
template <class F>
void for_each_combination(const BranchProblem& problem, F&& f) {
  std::vector<std::vector<Branch>> choices;
  for (const auto& point : problem.points) choices.push_back(branches_of(point));
  std::vector<std::size_t> digit(choices.size(), 0);
  std::vector<Branch> combination(choices.size());
  for (bool more = true; more;) {
    for (std::size_t p = 0; p < choices.size(); ++p) combination[p] = choices[p][digit[p]];
    if (!f(combination)) return;
    more = false;
    for (std::size_t p = 0; p < choices.size() && !more; ++p) {
      digit[p] = (digit[p] + 1) % choices[p].size();
      more = digit[p] != 0;
    }
  }
}

/// Whether tractions of a combination satisfy what its branches presume, up to rounding.
bool is_valid(const BranchProblem& problem, const std::vector<Branch>& combination, const Vector<double>& g,
              const Vector<double>& t) {
  constexpr double rounding = 1e-11;  // a dozen unknowns, condition numbers up to 1e4
  const double length = rounding * std::max(g.cwiseAbs().maxCoeff(), problem.free.cwiseAbs().maxCoeff());
  const double traction = rounding * t.cwiseAbs().maxCoeff();
  for (std::size_t p = 0; p < combination.size(); ++p) {
    const auto& point = problem.points[p];
    const auto& [state, sign] = combination[p];
    const double normal = t[point.normal];
    if (state == ContactState::open ? g[point.normal] < -length : normal > traction) return false;
    if (state == ContactState::open || point.tangential < 0) continue;
    const double tangential = t[point.tangential];
    if (state == ContactState::stick && std::abs(tangential) > -point.friction * normal + traction) return false;
    const double plastic = g[point.tangential] - point.yield_tangential * (tangential - point.stored);
    if (state == ContactState::slip && sign * plastic < -length) return false;
  }
  return true;
}

}  // namespace

bool may_have_several(const BranchProblem& problem) {
  constexpr double rounding = 1e-12;  // of Hadamard's bound: two contacts on one node repeat one another
  bool found = false;
  for_each_combination(problem, [&](const std::vector<Branch>& combination) {
    const Matrix<double> A = system_of(problem, combination).matrix;
    found = A.determinant() < -rounding * A.rowwise().norm().prod();
    return !found;
  });
  return found;
}

std::vector<BranchSolution> all_solutions(const BranchProblem& problem) {
  constexpr double same = 1e-9, singular = 1e-14;
  std::vector<BranchSolution> solutions;
  for_each_combination(problem, [&](const std::vector<Branch>& combination) {
    const System system = system_of(problem, combination);
    const Eigen::PartialPivLU<Matrix<double>> lu(system.matrix);
    if (!(lu.rcond() > singular)) return true;
    const Vector<double> t = lu.solve(system.right), g = problem.free - problem.compliance * t;
    if (!t.allFinite() || !is_valid(problem, combination, g, t)) return true;
    for (const auto& other : solutions) {
      const double lengths = std::max({g.norm(), other.kinematics.norm(), problem.free.norm()});
      const double tractions = std::max(t.norm(), other.traction.norm());
      if ((g - other.kinematics).norm() <= same * lengths && (t - other.traction).norm() <= same * tractions)
        return true;
    }
    BranchSolution solution{{}, g, t};
    for (const auto& branch : combination) solution.state.push_back(branch.state);
    solutions.push_back(std::move(solution));
    return true;
  });
  return solutions;
}

bool can_try_all_branches(const Model& model) {
  long combinations = 1;
  for (const auto& point : model.points) {
    combinations *= point.tangents > 0 ? 4 : 2;
    if (combinations > BranchProblem::most_combinations) return false;
  }
  return model.dimension == 2 && model.effects.friction;
}

bool exceeds_critical_friction(const Model& model, const Slots<double>& slots, const Matrix<double>& schur) {
  if (model.dimension != 2 || !model.framed.empty()) return false;
  return std::any_of(model.points.begin(), model.points.end(), [&](const ContactPoint& point) {
    if (point.tangents == 0) return false;
    const auto& geometry = slots.geometry[&point - model.points.data()];
    const Eigen::Matrix2d own = schur.block<2, 2>(2 * point.places[0], 2 * point.places[0]);
    const Eigen::Vector2d n = geometry.normal, e = geometry.tangents.col(0);
    return slots.friction[point.contact] * std::abs(n.dot(own * e)) >= e.dot(own * e);
  });
}

std::optional<BranchProblem> branch_problem(const ContactInput<double>& input, const Vector<double>& displacement,
                                            std::shared_ptr<Condensation<double>> condensation,
                                            const Vector<double>* stored) {
  const Model& model = input.model;
  CondensedEngine<double> engine(model, input.slots, false, ConeRadius::augmented, condensation);
  const Vector<double> u = engine.begin(input.time, displacement);
  ForceScale unused;
  const Vector<double> rows = engine.residual(u, Vector<double>::Zero(u.size()), unused);
  const auto field =
      evaluate_contact<double>(input, engine.compact(u), Vector<double>::Zero(model.multiplier_count), nullptr);
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < u.size(); ++i)
    if (engine.is_free(i)) free.push_back(i);
  BranchProblem problem;
  Eigen::Index count = 0;
  for (const auto& point : model.points) {
    problem.points.push_back({static_cast<int>(count), point.tangents > 0 ? static_cast<int>(count + 1) : -1});
    count += point.components();
  }
  Matrix<double> B = Matrix<double>::Zero(u.size(), count);  // columns: what a unit component does, in the frames
  Vector<double> area(count);
  problem.free.resize(count);
  for (int p = 0; p < static_cast<int>(model.points.size()); ++p) {
    auto& at = problem.points[p];
    const auto& point = model.points[p];
    const auto& geometry = input.slots.geometry[p];
    for (int c = 0; c < point.components(); ++c) {
      Vector<double> column = Vector<double>::Zero(u.size());
      const Vector<double> direction =
          c == 0 ? Vector<double>(geometry.normal) : Vector<double>(geometry.tangents.col(0));
      for (std::size_t n = 0; n < point.places.size(); ++n)
        column.segment<2>(2 * point.places[n]) += geometry.weights[n] * direction;
      B.col(at.normal + c) = into_frames(model, input.slots.frames, Layout::compact, std::move(column));
      area[at.normal + c] = geometry.area;
      problem.free[at.normal + c] = c == 0 ? field.gap[p] : field.slip[tangential_offset(model, p)];
    }
    at.friction = at.tangential < 0 ? 0 : input.slots.friction[point.contact];
    if (!stored) continue;
    at.yield_normal = 1 / input.rho[p].normal;
    at.yield_tangential = 1 / input.rho[p].tangential;
    at.stored = at.tangential < 0 ? 0 : (*stored)[point.multiplier + 1];
  }
  Matrix<double> stiffness(free.size(), free.size()), held(free.size(), count);
  Vector<double> load(free.size());
  for (std::size_t i = 0; i < free.size(); ++i) {
    for (std::size_t j = 0; j < free.size(); ++j) stiffness(i, j) = condensation->schur()(free[i], free[j]);
    held.row(i) = B.row(free[i]);
    load[i] = -rows[free[i]];
  }
  const Eigen::LLT<Matrix<double>> factor(stiffness);
  if (factor.info() != Eigen::Success || !(factor.rcond() > 1e-13)) return std::nullopt;
  const Matrix<double> lift = factor.solve(held) * area.asDiagonal();
  const Vector<double> moved = factor.solve(load);
  problem.compliance = held.transpose() * lift;
  problem.free += held.transpose() * moved;
  problem.unloaded = u;
  problem.lift = Matrix<double>::Zero(u.size(), count);
  for (std::size_t i = 0; i < free.size(); ++i) {
    problem.unloaded[free[i]] += moved[i];
    problem.lift.row(free[i]) = lift.row(i);
  }
  return problem;
}

std::optional<std::vector<State<double>>> other_solutions(const ContactInput<double>& input,
                                                          const Vector<double>& displacement,
                                                          const State<double>& taken,
                                                          std::shared_ptr<Condensation<double>> condensation,
                                                          const Vector<double>* stored) {
  constexpr double same = 1e-6;  // the taken one was found to a tolerance
  const auto problem = branch_problem(input, displacement, condensation, stored);
  if (!problem) return std::nullopt;
  const Model& model = input.model;
  CondensedEngine<double> engine(model, input.slots, false, ConeRadius::augmented, condensation);
  engine.begin(input.time, displacement);
  std::vector<State<double>> others;
  for (const auto& solution : all_solutions(*problem)) {
    State<double> other = taken;
    const Vector<double> u = problem->unloaded - problem->lift * solution.traction;
    other.displacement = engine.all(u);
    other.multiplier = solution.traction;
    other.contact = evaluate_contact<double>(input, engine.compact(u), solution.traction, &solution.state);
    other.contact.traction = solution.traction;  // (laid out as multipliers are)
    const double lengths =
        std::max({largest_nodal_norm(other.displacement, 2), largest_nodal_norm(taken.displacement, 2),
                  largest_nodal_norm(problem->unloaded, 2)});
    const double tractions = std::max(solution.traction.norm(), taken.contact.traction.norm());
    if (largest_nodal_norm(Vector<double>(other.displacement - taken.displacement), 2) > same * lengths ||
        (solution.traction - taken.contact.traction).norm() > same * tractions)
      others.push_back(std::move(other));
  }
  return others;
}

}  // namespace stickslip
