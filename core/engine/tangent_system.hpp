/// Systems of the tangents of bodies and contact points, as an engine sees them: how rows are solved for.
///
///   sparse      bodies and points in one sparse matrix (engine/sparse_system.hpp)
///   dense       points on the Schur complement of the bodies (engine/dense_system.hpp)
///   condensed   what is inside the bodies eliminated first, in each tangent (engine/condensed_tangent.hpp)
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/algebra/linear_solver.hpp"
#include "core/contact/cone_radius.hpp"
#include "core/engine/multipliers.hpp"
#include "core/engine/tangent_update.hpp"
#include "core/model/model.hpp"

namespace stickslip {

template <class T>
struct PointTangent;  // core/model/point_tangent.hpp

/// K [du; dl] = [r_u; r_l]: one column a right-hand side; l is the scaled multiplier lambda / rho.
template <class T>
struct BlockVector {
  Matrix<T> u, l;
};

/// How rows are solved for. `refined`: after an update of the factor, a second solve refines the solution. `unrefined`:
/// it does not, for the caller checks the solution. `transposed`: with K^T in place of K, refined.
enum class Solving { refined, unrefined, transposed };

/// What is known of all tangents of a run.
struct SystemKind {
  Multipliers multipliers = Multipliers::given;
  Symmetry symmetry = Symmetry::general;  ///< of those whose points all have a potential
  Backend backend = Backend::automatic;
  bool has_unknown_multipliers() const { return multipliers == Multipliers::unknown; }
};
/// `cone`: of all its tangents.
SystemKind system_kind(const Model& model, Multipliers multipliers, ConeRadius cone, Backend backend);

/// What an engine holds now, in bytes, and what it has done beside what Counters count.
struct EngineReport {
  long bodies = 0;                              ///< matrix of the bodies, which the tangents begin from
  long condensed = 0;                           ///< Schur complement of the bodies on the contact dofs
  long bodies_factor = 0;                       ///< factor that it came from
  long matrix = 0;                              ///< last tangent, with its pattern
  long factor = 0;                              ///< of that
  long matrix_entries = 0, factor_entries = 0;  ///< of these, stored
  double body_solves = 0;                       ///< right-hand sides solved with the bodies' factor since it was made
  bool unsymmetric = false;                     ///< the tangents are
};

/// What a factor was made from. With the same matrix and library it comes out the same to the last bit.
template <class T>
struct FactorRecipe {
  bool valid = false;
  std::vector<PointTangent<T>> tangents = {};
  Vector<double> anchor = {};
  TangentUpdate update = {};  ///< of that factor; its columns are solutions, which are kept
  long bytes() const {
    Eigen::Index numbers = 0;
    for (const auto& t : tangents) numbers += t.force_w.size() + t.force_l.size() + t.row_w.size() + t.row_l.size();
    return static_cast<long>(numbers * sizeof(T) + tangents.size() * sizeof(PointTangent<T>)) + update.bytes();
  }
};

/// What solves depend on beside what they are given: the pattern's places, the tangents of a factor that may be used
/// again or updated, and the displacement of a condensed tangent that may be used again.
template <class T>
struct EngineMemory {
  std::vector<std::vector<int>> places = {};
  FactorRecipe<T> factor = {};
  Vector<T> condensed_at = {};    ///< all dofs; empty: no such tangent
  std::vector<int> touched = {};  ///< contact dofs of its dense system
  long bytes() const {
    return factor.bytes() + static_cast<long>(condensed_at.size() * sizeof(T) + touched.size() * sizeof(int));
  }
};

/// Rows and increments are in the layout of the engine (engine/elimination.hpp), in the frames of the nodes.
template <class T>
class TangentSystem {
 public:
  TangentSystem() = default;
  TangentSystem(const TangentSystem&) = delete;
  TangentSystem& operator=(const TangentSystem&) = delete;
  virtual ~TangentSystem() = default;

  // ---- the bodies

  /// Solves from now on: lays itself out for points where nothing has slid, and takes the bodies' tangent.
  virtual void take_over() = 0;
  /// Takes the bodies' tangent where they are linearised now.
  virtual void take_bodies() = 0;
  /// Whether it can solve with the tangent that was taken; if not, another system has to take over.
  virtual bool accepts_bodies(Counters& /*counters*/) { return true; }
  /// The bodies' stiffness times increments, or its transpose; and its largest diagonal entry.
  virtual Matrix<T> times(const Matrix<T>& u, Taken taken) const = 0;
  virtual double stiffness() const = 0;
  /// Where the bodies were when their tangent was condensed, if it may serve again close to there; else nullptr.
  virtual const Vector<T>* condensed_at() const { return nullptr; }

  // ---- bodies and points

  /// As those of Engine.
  virtual bool factorise(const std::vector<PointTangent<T>>& tangents, const Vector<double>& anchor,
                         Counters& counters) = 0;
  virtual bool update(const std::vector<PointTangent<T>>& /*tangents*/, const Vector<double>& /*anchor*/,
                      Counters& /*counters*/) {
    return false;
  }
  /// The solution is zero where there is no row.
  virtual BlockVector<T> solve(const BlockVector<T>& rows, Solving how) = 0;
  virtual int solves() const { return 1; }
  virtual bool reversed() const = 0;
  /// As that of Engine.
  virtual std::optional<int> motions_unresisted(const std::vector<PointTangent<T>>& /*springs*/,
                                                Counters& /*counters*/) {
    return std::nullopt;
  }
  virtual double condition_estimate() = 0;
  virtual EngineMemory<T> memory() const = 0;
  virtual void restore(const EngineMemory<T>& memory, Counters& counters) = 0;

  // ---- what it is

  virtual bool is_free(Eigen::Index row) const = 0;
  virtual bool condenses_tangents() const { return false; }
  virtual bool has_costly_factors() const { return true; }
  virtual const std::string& message() const = 0;
  virtual std::string name() const = 0;
  virtual int unknowns() const = 0;
  virtual long nonzeros() const = 0;
  virtual void add_to_report(EngineReport& report) const = 0;
};

}  // namespace stickslip
