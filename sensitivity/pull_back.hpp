/// The adjoint of one equilibrium, what all schemes share.
///
/// The residual, the contact and the responses of an increment are recorded once, in reverse scalars, at its converged
/// state; the bodies' forces enter the record as variables. For an objective with derivatives c_u, c_l by displacement
/// and multiplier (from its own share and from what later increments make of this one's history),
///
///   K^T a = -c,      DJ += a . dR/dslots      history <- a . dR/dhistory
///
/// where a is the force's weight along free dofs, and -dJ/d(reaction) along prescribed ones, so that these need no case
/// of their own. An increment solves for a at the contact, in the engine's unknowns. a inside the bodies, and what it
/// weighs there, is found for many increments together (pull_back_inside.hpp). The schemes differ in what becomes of
/// the derivative by lambda.
/// Path-dependent adjoint: [MTV94]
#pragma once

#include <utility>

#include "core/algebra/reverse.hpp"
#include "core/model/contact_assembly.hpp"
#include "core/model/objective.hpp"
#include "methods/method.hpp"
#include "sensitivity/tangent.hpp"

namespace stickslip {

STICKSLIP_SLOTS(extern, Reverse);  // compiled in reverse_elements.cpp
STICKSLIP_CONTACT(extern, Reverse);

/// Derivatives of an objective by what the next increment reads of a state.
struct HistoryDerivative {
  History<double> local;
  Vector<double> traction;
};
HistoryDerivative no_derivative(const History<double>& like, Eigen::Index traction);

/// Weights a and motions u of an objective, a column an increment, all dofs in the axes.
struct WorkPairs {
  Matrix<double> weights, motions;  ///< weights empty: of the memory alone
  Matrix<double> last_memory;       ///< what bodies remember of the last increment
  Matrix<double> memory;            ///< weights of what bodies remember of this increment; empty: none
  std::vector<FlowBranches> flows;  ///< per column
};

/// Derivatives by motion (no rows where no body remembers), and by what bodies remember of the last increment.
struct WorkDerivative {
  Matrix<double> motion, last_memory;
};

/// Adds the share of the pairs to `by`, the derivatives by the entries of the tape. An element of a continuum is
/// differentiated by its own inputs, which are few (core/solids/element_work.hpp); the chain goes on from there. An
/// element of two nodes is recorded at the end of the tape, which is then rewound.
WorkDerivative pull_back_bodies(const Model& model, const Slots<Reverse>& slots, Tape& tape, const WorkPairs& pairs,
                                std::vector<double>& by);

/// The share of an equilibrium inside the bodies, which waits for other increments.
struct InteriorShare {
  Vector<double> motion;               ///< u, all dofs in the axes
  Vector<double> last_memory;          ///< what bodies remember of the last increment
  Vector<double> by_last_memory = {};  ///< derivative by `last_memory`, through what bodies remember of this increment
  double time = 0;
  Vector<double> forces;     ///< of bodies and contact, all dofs; empty where no node has a frame of its own
  Vector<double> weights;    ///< weights of the bodies' forces in what the objective reads, all dofs in the axes
  Matrix<double> u, others;  ///< solution for -c, engine dofs; what reduce() kept of c for expand()
  FlowBranches flow;
};

/// One objective on its way back.
struct BackwardSweep {
  std::vector<double> adjoint;  ///< derivative by each entry of the tape
  HistoryDerivative history;
  std::vector<InteriorShare> waiting;  ///< of the increments that wait
};

/// Everything a scheme reads to take one increment back.
struct AdjointProblem {
  const Method& method;
  const Model& model;
  const Slots<double>& slots;
  Engine<double>& engine;
  Tape& tape;
  const Slots<Reverse>& recorded;
  int slots_end = 0;  ///< on the tape
  std::vector<BackwardSweep>& objectives;
  ElementLists at_supports;      ///< elements with a dof that is prescribed: reactions are forces of these
  bool energies = false;         ///< an objective reads the bodies' forces everywhere
  std::vector<int> read_forces;  ///< dofs of which the bodies' forces are read: of nodes at supports, or all
  long waiting_bytes = 0;        ///< largest, of what waited inside the bodies
  bool follows = false;          ///< the engine has the factor of the increment that came last
  Counters counters;
  Status status = Status::singular;  ///< why a scheme gave up
  std::string message;
};

class RecordedEquilibrium {
 public:
  /// `at`: the state (its multiplier is the lambda of its equilibrium). Unknown `multipliers`: lambda is part of p.
  /// `rho`: recorded after rewinding the tape to slots_end. `objectives`: the increment is a step that they may be
  /// about.
  RecordedEquilibrium(AdjointProblem& problem, const State<double>& previous, const State<double>& at,
                      const RegularisationField<Reverse>& rho, ConeRadius cone, double time, Multipliers multipliers,
                      bool objectives);

  bool valid() const { return valid_; }

  /// Seeds what the objective reads of this increment: its own share, and the history.
  void seed_outcome(int objective);
  /// Seeds a derivative by the traction t.
  void seed_traction(int objective, const Vector<double>& by);
  /// Moves what is seeded to displacement and lambda, and balances the displacement (and an unknown lambda).
  void balance(int objective);
  /// Takes the derivative by lambda out.
  Vector<double> take_multiplier(int objective);
  /// Largest derivative by a nodal force so far.
  double force_weight(int objective) const {
    const auto largest = [](const auto& m) { return m.size() ? m.cwiseAbs().maxCoeff() : 0.0; };
    return std::max(largest(interior_[objective].weights), largest(interior_[objective].u));
  }
  /// All that an objective has gathered so far, to go back to it.
  struct Gathered;
  Gathered gathered(int objective) const;
  void restore(int objective, const Gathered& gathered);
  /// Moves all that is left to the slots; derivatives by the history that the increment started from.
  HistoryDerivative finish(int objective);

 private:
  static constexpr int refinements = 2;
  void record(const State<double>& previous, const RegularisationField<Reverse>& rho, ConeRadius cone, double time,
              bool objectives);
  Vector<double> pull_back(int objective);
  void pull_back_memory(int objective);
  void clear_free(int objective);
  void seed_contact(int objective, const BlockVector<double>& solution);
  void clear_held(Matrix<double>& rows);
  bool solves_for_multipliers() const { return multipliers_ == Multipliers::unknown; }
  std::vector<double>& adjoint(int objective) { return problem_.objectives[objective].adjoint; }
  Vector<double> gather(int objective, const Vector<Reverse>& leaves);
  static void seed(std::vector<double>& by, const Vector<Reverse>& at, const Vector<double>& derivative) {
    for (Eigen::Index i = 0; i < at.size(); ++i)
      if (at[i].entry >= 0) by[at[i].entry] += derivative[i];
  }

  AdjointProblem& problem_;
  const State<double>& at_;
  Vector<double> scale_;  ///< rho of each multiplier component
  Multipliers multipliers_;
  bool valid_ = false, redundant_ = false;
  int outcome_start_ = 0;  ///< place on the tape; behind it: functions of the variables below
  Vector<Reverse> prescribed_, displacement_, multiplier_;
  int first_read_ = 0;        ///< entry of the first of AdjointProblem::read_forces
  Vector<double> forces_;     ///< of the bodies, where they are read
  Vector<Reverse> memory_;    ///< what bodies remember of the increment
  History<Reverse> history_;  ///< that the increment starts from
  State<Reverse> state_;
  Vector<Reverse> rows_, multiplier_rows_;  ///< residual, in the frames of the nodes
  std::vector<Reverse> shares_;             ///< of this increment in each objective
  std::vector<InteriorShare> interior_;     ///< per objective
};

struct RecordedEquilibrium::Gathered {
  std::vector<double> adjoint;
  InteriorShare interior;
};

}  // namespace stickslip
