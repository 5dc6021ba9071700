/// Direct differentiation, what all schemes share.
///
/// A State<Direction> carries the derivative of a state along `directions` parameters. At the converged state of an
/// increment, with p = u (and lambda where it is an unknown) and everything else as seeds,
///
///   K Dp = -r,     r = directional derivative of R along parameters, history and prescribed motion, p held fixed
///
/// comes from one sweep of the solver's own residual in dual numbers; a second sweep with Dp gives the local unknowns,
/// which are the next increment's history. The schemes differ, as the methods do, in who supplies D lambda.
/// [MTV94], [SLK10]
#pragma once

#include <optional>

#include "sensitivity/differentiate.hpp"
#include "sensitivity/tangent.hpp"

namespace stickslip {

/// Parameters differentiated in one sweep.
inline constexpr int directions = 4;
using Direction = Dual<directions>;

/// Numbers of the scene with up to `directions` parameters seeded, each in a direction of its own.
inline Numbers<Direction> seeded(const Scene& scene, const std::vector<int>& parameters) {
  auto numbers = scene.as<Direction>();
  for (std::size_t d = 0; d < parameters.size(); ++d)
    for (const auto& [slot, weight] : scene.parameters[parameters[d]].slots) numbers.at_slot[slot].d[d] += weight;
  return numbers;
}

/// Slots and running state of up to `directions` parameters.
struct ParameterBlock {
  Slots<Direction> slots;
  State<Direction> previous, current;
};

/// Everything a scheme reads to differentiate one increment.
template <class E>
struct Differentiation {
  const Model& model;
  const Slots<double>& slots;
  E& engine;
  std::vector<ParameterBlock>& blocks;
  int parameters = 0;
  Counters counters;
  Status status = Status::singular;  ///< where a scheme fails: that it could not factorise, or cap
  std::string message;
  std::optional<SchemeRecord> record;  ///< of the last increment
};

/// A vector as dual numbers without derivative.
inline Vector<Direction> lift(const Vector<double>& v) {
  return v.unaryExpr([](double x) { return Direction(x); });
}

/// Columns of derivatives out of the blocks, and back. `pick` selects the dual vector of a block.
template <class Pick>
Matrix<double> gather(std::vector<ParameterBlock>& blocks, int parameters, Pick&& pick) {
  Matrix<double> out;
  for (int j = 0; j < parameters; ++j) {
    const Vector<Direction>& v = pick(blocks[j / directions], j / directions);
    if (j == 0) out.resize(v.size(), parameters);
    for (Eigen::Index i = 0; i < v.size(); ++i) out(i, j) = v[i].d[j % directions];
  }
  return out;
}
inline void add_derivatives(Vector<Direction>& v, const Matrix<double>& columns, int block) {
  for (int d = 0; d < directions && block * directions + d < columns.cols(); ++d)
    for (Eigen::Index i = 0; i < v.size(); ++i) v[i].d[d] += columns(i, block * directions + d);
}

/// rho of a method with its derivatives, per block; `factor`: adaption, empty for none.
template <class M, class E>
std::vector<RegularisationField<Direction>> regularisation_blocks(const M& method, const Differentiation<E>& problem,
                                                                  const std::vector<double>& factor = {}) {
  std::vector<RegularisationField<Direction>> rho;
  for (const auto& block : problem.blocks) rho.push_back(adapted(initial_regularisation(block.slots, method), factor));
  return rho;
}

/// One equilibrium with its derivative problem: factorised tangent and the bodies' part of the pseudo-load, which do
/// not change while D lambda is iterated.
template <class E>
class LinearisedEquilibrium {
 public:
  /// `at`: the state (its multiplier is the lambda of its equilibrium); `rho`, per block and in double.
  /// `unknown`: lambda is part of p.
  LinearisedEquilibrium(Differentiation<E>& problem, const State<double>& at, const RegularisationField<double>& rho,
                        std::vector<RegularisationField<Direction>> rho_blocks, ConeRadius cone, double time,
                        bool unknown, const Vector<double>& previous_placement);

  bool valid() const { return valid_; }

  /// Solves for the derivative given D lambda (per block; read as a seed, also where lambda is unknown: then zero) and
  /// returns the fields t_hat with all derivatives in. Adds D lambda to `lambda` where it is unknown.
  std::vector<ContactField<Direction>> solve(std::vector<Vector<Direction>>& lambda);

  /// Completes the state of every block from the last solve.
  void settle(const std::vector<ContactField<Direction>>& fields, const std::vector<Vector<Direction>>& lambda);

  /// Largest derivatives, by parameter, of the contact displacements, then and now, and of the forces of bodies and
  /// loads on the unknowns, whatever part of these cancels.
  Vector<double> reach() const {
    const Matrix<double> then = gather(
        problem_.blocks,
        problem_.parameters, [&](auto& block, int) -> auto& { return block.previous.contact.placement; });
    return largest(compact_).cwiseMax(largest(then));
  }
  Vector<double> load() const { return largest(reduced_); }

 private:
  static constexpr int refinements = 2;
  static Vector<double> largest(const Matrix<double>& columns) {
    if (columns.rows() == 0) return Vector<double>::Zero(columns.cols());
    return columns.cwiseAbs().colwise().maxCoeff();
  }
  struct Rows {
    Matrix<double> u, l;
    std::vector<ContactField<Direction>> fields;
    bool accurate = true;
  };
  Rows evaluate(const std::vector<Vector<Direction>>& compact, const std::vector<Vector<Direction>>& lambda);
  ContactInput<Direction> input(int block) const {
    return {problem_.model,
            problem_.blocks[block].slots,
            rho_blocks_[block],
            problem_.blocks[block].previous.contact.placement,
            cone_,
            time_};
  }

  Differentiation<E>& problem_;
  const State<double>& at_;
  std::vector<RegularisationField<Direction>> rho_blocks_;
  const RegularisationField<double>& rho_;
  ConeRadius cone_;
  double time_;
  bool unknown_, valid_ = false;
  bool redundant_ = false;            ///< constraints repeat one another: the tangent yields, and is used twice
  std::vector<Vector<Direction>> u_;  ///< per block: value, and the derivative of prescribed motion
  Matrix<double> bulk_, reduced_;     ///< pseudo-load of the bodies, all dofs and engine rows
  Matrix<double> increment_, compact_;
};

template <class E>
LinearisedEquilibrium<E>::LinearisedEquilibrium(Differentiation<E>& problem, const State<double>& at,
                                                const RegularisationField<double>& rho,
                                                std::vector<RegularisationField<Direction>> rho_blocks, ConeRadius cone,
                                                double time, bool unknown, const Vector<double>& previous_placement)
    : problem_(problem),
      at_(at),
      rho_blocks_(std::move(rho_blocks)),
      rho_(rho),
      cone_(cone),
      time_(time),
      unknown_(unknown) {
  const Model& model = problem.model;
  const ContactInput<double> primal{model, problem.slots, rho, previous_placement, cone, time};
  valid_ = factorise_converged(problem, primal, at, unknown, redundant_);
  if (!valid_) return;
  std::vector<Vector<Direction>> rows;
  for (auto& block : problem.blocks) {
    Vector<Direction> u = lift(at.displacement), prescribed = u;
    prescribe(model, block.slots, time, prescribed);
    for (Eigen::Index i = 0; i < u.size(); ++i) u[i].d = prescribed[i].d;
    const Vector<Direction> balance = bulk_forces(model, block.slots, u) - external_forces(model, block.slots, time);
    rows.push_back(into_frames(model, block.slots.frames, Layout::all, balance));
    u_.push_back(std::move(u));
  }
  bulk_ = gather(
      problem.blocks, problem.parameters, [&](auto&, int b) -> auto& { return rows[b]; });
  reduced_ = problem.engine.reduce(bulk_);
}

template <class E>
std::vector<ContactField<Direction>> LinearisedEquilibrium<E>::solve(std::vector<Vector<Direction>>& lambda) {
  const Model& model = problem_.model;
  const int blocks = static_cast<int>(problem_.blocks.size()), parameters = problem_.parameters;
  std::vector<Vector<Direction>> compact;
  for (int b = 0; b < blocks; ++b) compact.push_back(to_compact(model, u_[b]));
  increment_ = Matrix<double>();
  Rows rows = evaluate(compact, lambda);
  for (int pass = 0;; ++pass) {
    const auto step = problem_.engine.solve({-rows.u, -rows.l});
    problem_.counters.sensitivity_backsolves += parameters;
    increment_ = pass == 0 ? step.u : Matrix<double>(increment_ + step.u);
    Matrix<double> moved(compact[0].size(), parameters), multiplier = step.l;
    for (int j = 0; j < parameters; ++j) moved.col(j) = problem_.engine.compact(step.u.col(j));
    compact_ = pass == 0 ? moved : Matrix<double>(compact_ + moved);
    if (unknown_)
      for (std::size_t p = 0; p < model.points.size(); ++p)
        for (int c = 0; c < model.points[p].components(); ++c)
          multiplier.row(model.points[p].multiplier + c) *= c == 0 ? rho_[p].normal : rho_[p].tangential;
    for (int b = 0; b < blocks; ++b) {
      add_derivatives(compact[b], moved, b);
      if (unknown_) add_derivatives(lambda[b], multiplier, b);
    }
    rows = evaluate(compact, lambda);
    if (!unknown_ || pass == refinements || (rows.accurate && !redundant_)) return std::move(rows.fields);
  }
}

/// Rows of the derivative problem at the derivatives reached so far. `accurate`: what is left of the displacement rows
/// is rounding, measured by the derivatives of the forces that should balance in them. It is not where a large rho
/// magnifies the rounding of Dg; lambda then takes the defect up in another pass.
template <class E>
typename LinearisedEquilibrium<E>::Rows LinearisedEquilibrium<E>::evaluate(
    const std::vector<Vector<Direction>>& compact, const std::vector<Vector<Direction>>& lambda) {
  const int blocks = static_cast<int>(problem_.blocks.size());
  Rows rows;
  std::vector<Vector<Direction>> forces, multiplier_rows;
  for (int b = 0; b < blocks; ++b) {
    const auto& slots = problem_.blocks[b].slots;
    rows.fields.push_back(evaluate_contact<Direction>(input(b), compact[b], lambda[b], &at_.contact.state));
    take_rays(input(b), lambda[b], at_.contact.ray, rows.fields[b]);
    forces.push_back(into_frames(problem_.model, slots.frames, Layout::compact,
                                 contact_forces(problem_.model, slots, rows.fields[b].traction)));
    if (unknown_)
      multiplier_rows.push_back(multiplier_residual(problem_.model, slots, rows.fields[b].traction, lambda[b]));
  }
  auto columns = [&](std::vector<Vector<Direction>>& of) {
    return gather(
        problem_.blocks, problem_.parameters, [&](auto&, int b) -> auto& { return of[b]; });
  };
  const Matrix<double> contact = columns(forces);
  rows.u = reduced_ + problem_.engine.scatter(contact);
  if (unknown_) rows.l = columns(multiplier_rows);
  if (!unknown_ || increment_.size() == 0) return rows;
  const Matrix<double> internal = problem_.engine.apply_stiffness(increment_);
  rows.u += internal;
  for (Eigen::Index i = 0; i < rows.u.rows(); ++i)
    if (!problem_.engine.is_free(i)) rows.u.row(i).setZero();
  for (Eigen::Index j = 0; j < rows.u.cols() && rows.u.rows() > 0; ++j) {
    const double size = contact.rows() ? contact.col(j).cwiseAbs().maxCoeff() : 0;
    rows.accurate &=
        rows.u.col(j).cwiseAbs().maxCoeff() <= 1e-12 * std::max(size, internal.col(j).cwiseAbs().maxCoeff());
  }
  return rows;
}

template <class E>
void LinearisedEquilibrium<E>::settle(const std::vector<ContactField<Direction>>& fields,
                                      const std::vector<Vector<Direction>>& lambda) {
  const Matrix<double> all = problem_.engine.expand(increment_, -bulk_, -reduced_);
  for (std::size_t b = 0; b < problem_.blocks.size(); ++b) {
    auto& block = problem_.blocks[b];
    block.current.displacement = u_[b];
    add_derivatives(block.current.displacement, all, static_cast<int>(b));
    block.current.multiplier = lambda[b];
    block.current.contact = fields[b];
    block.current.dissipation =
        dissipated(input(static_cast<int>(b)), fields[b], lambda[b], block.previous.dissipation);
  }
}

}  // namespace stickslip
