#include "methods/rescue/solutions.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "methods/rescue/motion_pace.hpp"

namespace stickslip {
namespace {

constexpr long most_combinations = 4096;  // six points with friction

/// A branch of a point. `sign`: s, that of t_T in slip.
struct SignedState {
  ContactState state = ContactState::open;
  double sign = 0;
};

std::vector<SignedState> signed_states_of(const ContactProblem::Point& point) {
  if (point.tangential < 0) return {{ContactState::open, 0}, {ContactState::slip, 0}};
  std::vector<SignedState> branches{{ContactState::open, 0}, {ContactState::stick, 0}};
  for (ContactState state : {ContactState::slip, ContactState::limited})
    if (point.friction.has(state))
      for (double sign : {-1.0, 1.0}) branches.push_back({state, sign});
  return branches;
}

/// (I - P) g + P tau = g_f, and v = moved + lift (g - tau).
struct Relation {
  Matrix<double> of_g, of_tau;
  Vector<double> free, moved;
  Matrix<double> lift;
};

std::optional<Relation> relation(const ContactProblem& problem, double alpha, const Vector<double>& from) {
  constexpr double singular = 1e-13;
  const Matrix<double> BW = problem.directions * problem.weight.asDiagonal();
  Matrix<double> K = problem.stiffness + BW * problem.directions.transpose();
  Vector<double> f = problem.load - BW * problem.start;
  if (alpha > 0) {
    K.diagonal() += alpha * problem.damping;
    f += alpha * problem.damping.cwiseProduct(from);
  }
  const Vector<double> scale = K.diagonal().cwiseMax(0).cwiseSqrt().cwiseInverse();
  if (!scale.allFinite()) return std::nullopt;
  const Eigen::LLT<Matrix<double>> factor(scale.asDiagonal() * K * scale.asDiagonal());
  if (factor.info() != Eigen::Success || !(factor.rcond() > singular)) return std::nullopt;
  const auto solve = [&](const Matrix<double>& b) -> Matrix<double> {
    return scale.asDiagonal() * factor.solve(scale.asDiagonal() * b);
  };
  Relation r;
  r.lift = solve(BW);
  r.moved = solve(f);
  r.of_tau = problem.directions.transpose() * r.lift;
  r.of_g = Matrix<double>::Identity(r.of_tau.rows(), r.of_tau.cols()) - r.of_tau;
  r.free = problem.start + problem.directions.transpose() * r.moved;
  return r;
}

/// Of the components of all points, without memory of its own on the heap: combinations are many. Each component
/// doubles their number at least.
constexpr int most_components = 12;
static_assert(1L << most_components == most_combinations);
using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most_components, most_components>;
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most_components, 1>;

/// The linear system of a combination. Its unknowns are g where tau is given, and tau elsewhere.
struct System {
  SmallMatrix matrix;
  SmallVector right;
};

System system_of(const ContactProblem& problem, const Relation& r, const std::vector<SignedState>& combination) {
  System system{r.of_g, r.free};
  for (std::size_t p = 0; p < combination.size(); ++p) {
    const auto& point = problem.points[p];
    const auto& [state, sign] = combination[p];
    if (state == ContactState::open) continue;
    const int n = point.normal, t = point.tangential;
    system.matrix.col(n) = r.of_tau.col(n) + point.compliance_normal * r.of_g.col(n);
    if (t < 0) continue;
    if (state == ContactState::slip) {
      system.matrix.col(n) -= sign * point.friction.slope_at_apex() * r.of_tau.col(t);
    } else if (state == ContactState::limited) {
      system.right -= sign * point.friction.bound(0, state) * r.of_tau.col(t);
    } else {
      system.matrix.col(t) = r.of_tau.col(t) + point.compliance_tangential * r.of_g.col(t);
      system.right += point.compliance_tangential * point.stored * r.of_g.col(t);
    }
  }
  return system;
}

/// g and tau of a combination.
struct Outcome {
  SmallVector g, tau;
};

Outcome outcome_of(const ContactProblem& problem, const std::vector<SignedState>& combination, const SmallVector& x) {
  Outcome out{x, SmallVector::Zero(x.size())};
  for (std::size_t p = 0; p < combination.size(); ++p) {
    const auto& point = problem.points[p];
    const auto& [state, sign] = combination[p];
    if (state == ContactState::open) continue;
    const int n = point.normal, t = point.tangential;
    out.tau[n] = x[n];
    out.g[n] = point.compliance_normal * x[n];
    if (t < 0) continue;
    if (is_slipping(state)) {
      out.tau[t] = sign * point.friction.bound(-x[n], state);
    } else {
      out.tau[t] = x[t];
      out.g[t] = point.compliance_tangential * (x[t] - point.stored);
    }
  }
  return out;
}

/// Calls f(combination) for each combination of branches until it returns false.
template <class F>
void for_each_combination(const ContactProblem& problem, F&& f) {
  std::vector<std::vector<SignedState>> choices;
  for (const auto& point : problem.points) choices.push_back(signed_states_of(point));
  std::vector<std::size_t> digit(choices.size(), 0);
  std::vector<SignedState> combination(choices.size());
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

/// The rounding of the motion without tractions, in gaps and forces that are zero.
double noise_of(const Relation& r) { return 1e3 * unit_roundoff * r.moved.lpNorm<Eigen::Infinity>(); }

/// Whether an outcome satisfies the conditions of its branches up to rounding. Rounding is a share of the largest
/// lengths and tractions, and noise_of().
bool is_valid(const ContactProblem& problem, const std::vector<SignedState>& combination, const Outcome& at,
              const Relation& r, double rounding) {
  const double noise = noise_of(r),
               length = rounding * std::max(at.g.cwiseAbs().maxCoeff(), r.free.cwiseAbs().maxCoeff()) + noise;
  const double traction = rounding * at.tau.cwiseAbs().maxCoeff() + noise;
  for (std::size_t p = 0; p < combination.size(); ++p) {
    const auto& point = problem.points[p];
    const auto& [state, sign] = combination[p];
    const double normal = at.tau[point.normal];
    if (state == ContactState::open ? at.g[point.normal] < -length : normal > traction) return false;
    if (state == ContactState::open || point.tangential < 0) continue;
    const double tangential = at.tau[point.tangential];
    // (A slipping point is on the bound of its piece. If there are two pieces, it must be the least bound.)
    const bool asked = state == ContactState::stick || point.friction.piece_count() > 1;
    if (asked && std::abs(tangential) > point.friction.bound(-normal) + traction) return false;
    const double plastic = at.g[point.tangential] - point.compliance_tangential * (tangential - point.stored);
    if (is_slipping(state) && sign * plastic < -length) return false;
  }
  return true;
}

/// A determinant over Hadamard's bound for it.
double share_of_determinant(const SmallMatrix& A) { return A.determinant() / A.colwise().norm().prod(); }

/// A smaller share is rounding. Example: two contacts at one node repeat one another, which leaves some 1e-16.
constexpr double rounding_of_determinants = 1e-12;

}  // namespace

bool can_try_all_branches(const Model& model) {
  long combinations = 1;
  for (const auto& point : model.points) {
    const auto& law = model.scene.contacts[point.contact].friction;
    combinations *= point.tangents > 0 ? 2 + 2 * law->piece_count() : 2;
    const bool is_linear = point.tangents == 0 || law->is_piecewise_linear();
    if (combinations > most_combinations || !is_linear) return false;
  }
  return model.dimension == 2 && model.effects.linear_bulk && model.effects.friction && !model.points.empty();
}

Uniqueness uniqueness_of(const ContactProblem& problem) {
  const auto r = relation(problem, 0, {});
  bool reversed = false, vanishes = false;
  if (r)
    for_each_combination(problem, [&](const std::vector<SignedState>& combination) {
      const double share = share_of_determinant(system_of(problem, *r, combination).matrix);
      vanishes |= std::abs(share) <= rounding_of_determinants;
      reversed = share < -rounding_of_determinants;
      return !reversed;
    });
  if (reversed) return Uniqueness::several;
  return vanishes && !has_repeated_constraints(problem) ? Uniqueness::critical : Uniqueness::unique;
}

double reach_of(const ContactProblem& problem) {
  const auto r = relation(problem, 0, {});
  return r ? r->moved.lpNorm<Eigen::Infinity>() : 0;
}

std::optional<std::vector<BranchSolution>> all_solutions(const ContactProblem& problem, double alpha,
                                                         const Vector<double>& from, double rounding) {
  constexpr double same = 1e-9, singular = 1e-13;
  const auto r = relation(problem, alpha, from);
  if (!r) return std::nullopt;
  std::vector<BranchSolution> solutions;
  std::vector<Vector<double>> tractions;  // as lengths
  const double noise = noise_of(*r);
  for_each_combination(problem, [&](const std::vector<SignedState>& combination) {
    const System system = system_of(problem, *r, combination);
    const Eigen::PartialPivLU<SmallMatrix> lu(system.matrix);
    const Outcome at = outcome_of(problem, combination, lu.solve(system.right));
    if (!at.g.allFinite() || !is_valid(problem, combination, at, *r, rounding) || !(lu.rcond() > singular)) return true;
    for (std::size_t k = 0; k < solutions.size(); ++k) {
      const double length = std::max({at.g.norm(), solutions[k].kinematics.norm(), r->free.norm()});
      const double traction = std::max(at.tau.norm(), tractions[k].norm());
      if ((at.g - solutions[k].kinematics).norm() <= same * length + noise &&
          (at.tau - tractions[k]).norm() <= same * traction + noise)
        return true;
    }
    BranchSolution solution;
    for (const auto& branch : combination) solution.state.push_back(branch.state);
    solution.increment = r->moved + r->lift * (at.g - at.tau);
    solution.kinematics = at.g;
    solution.traction = at.tau.cwiseProduct(problem.weight).cwiseQuotient(problem.area);
    solution.reversed = share_of_determinant(system.matrix) < -rounding_of_determinants;
    tractions.push_back(at.tau);
    solutions.push_back(std::move(solution));
    return true;
  });
  return solutions;
}

bool has_repeated_constraints(const ContactProblem& problem) {
  constexpr double singular = 1e-12;
  const auto r = relation(problem, 0, {});
  return !r || !(Eigen::PartialPivLU<Matrix<double>>(r->of_tau).rcond() > singular);
}

bool is_feasible(const ContactProblem& problem) {
  // (frictionless: solutions minimise a strictly convex energy, if any motion is feasible)
  ContactProblem smooth = problem;
  for (auto& point : smooth.points) point = {point.normal};
  const auto solutions = all_solutions(smooth, 1, Vector<double>::Zero(problem.load.size()));
  return !solutions || !solutions->empty();
}

std::optional<std::size_t> resting_solution(const ContactProblem& problem, const std::vector<BranchSolution>& all) {
  constexpr double rounding = 1e-9;  // of the largest solution
  if (all.empty()) return std::nullopt;
  if (all.size() == 1) return 0;
  double largest = 0;
  for (const auto& solution : all) largest = std::max(largest, solution.increment.norm());
  Vector<double> v = Vector<double>::Zero(problem.load.size());
  MotionPace pace(rounding * largest);
  while (pace.goes_on()) {
    const auto moved = all_solutions(problem, pace.alpha(), v);
    const BranchSolution* next = nullptr;
    double length = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; moved && k < moved->size(); ++k)
      if (const double distance = ((*moved)[k].increment - v).norm(); distance < length) {
        length = distance;
        next = &(*moved)[k];
      }
    if (!next || !pace.allows(length)) {
      pace.fail();
      continue;
    }
    pace.move(length);
    v = next->increment;
    for (std::size_t k = 0; k < all.size(); ++k)
      if (!all[k].reversed && all[k].state == next->state && pace.is_near((all[k].increment - v).norm())) return k;
    pace.hasten();
  }
  return std::nullopt;
}

bool exceeds_critical_friction(const Model& model, const Slots<double>& slots, const Matrix<double>& schur) {
  if (model.dimension != 2 || !model.framed.empty()) return false;
  return std::any_of(model.points.begin(), model.points.end(), [&](const ContactPoint& point) {
    if (point.tangents == 0) return false;
    const auto& geometry = slots.geometry[&point - model.points.data()];
    const Eigen::Matrix2d own = schur.block<2, 2>(2 * point.places[0], 2 * point.places[0]);
    const Eigen::Vector2d n = geometry.normal, e = geometry.tangents.col(0);
    return slots.friction[point.contact].slope_at_apex() * std::abs(n.dot(own * e)) >= e.dot(own * e);
  });
}

}  // namespace stickslip
