/// The bodies as an engine sees them: what of them is eliminated before its systems see them, and so which
/// displacements there are.
///
///   nothing        all dofs; forces and tangent come from the elements (engine/full_bodies.hpp)
///   some bodies    those of constant stiffness, once, by their Schur complement on the contact dofs; all dofs, of
///                  which those inside condensed bodies mean nothing (engine/mixed_bodies.hpp)
///   all bodies     likewise; the contact dofs alone (engine/condensed_bodies.hpp)
///
/// These displacements are the layout of the engine's rows and increments, in the frames of the nodes
/// (model/frames.hpp). Entries of prescribed dofs are zero in increments and ignored in rows.
#pragma once

#include <string>
#include <vector>

#include "core/engine/tangent_system.hpp"
#include "core/model/slots.hpp"

namespace stickslip {

/// Scales that a residual is measured against.
struct ForceScale {
  double force = 0;     ///< largest nodal force of any kind
  double rounding = 0;  ///< what rounding alone may leave in a row
};

/// Largest Euclidean norm of the nodal vectors (D consecutive entries) of the primal parts; NaN where one is. V: a
/// vector, or a part of one.
template <class V>
double largest_nodal_norm(const V& v, int D) {
  double most = 0, extreme = 0;  // largest sum of squares; largest norm whose squares overflow or vanish
  for (Eigen::Index n = 0; n + D <= v.size(); n += D) {
    double squares = 0;
    bool is_zero = true;
    for (int i = 0; i < D; ++i) {
      squares += value(v[n + i]) * value(v[n + i]);
      is_zero &= value(v[n + i]) == 0;
    }
    if (squares > 1e-280 && squares < 1e280) {
      most = std::max(most, squares);
    } else if (!is_zero) {
      double norm = 0;
      for (int i = 0; i < D; ++i) norm = std::hypot(norm, value(v[n + i]));
      extreme = larger(extreme, norm);
    }
  }
  return larger(extreme, std::sqrt(most));
}

template <class T>
class Elimination {
 public:
  Elimination(const Model& model, const Slots<T>& slots) : model_(model), slots_(slots) {}
  Elimination(const Elimination&) = delete;
  Elimination& operator=(const Elimination&) = delete;
  virtual ~Elimination() = default;

  // ---- loads

  /// Takes the loads of a time, and what is prescribed then. `u`: all dofs, in the frames; returned in the engine's
  /// layout. `before`: what bodies remember of the last increment.
  virtual Vector<T> begin(double time, Vector<T> u, const Vector<T>& before) = 0;
  /// Takes the loads of another time.
  virtual void move_loads(double time) = 0;
  /// As those of Engine.
  virtual Vector<T> load_rate(const Vector<T>& u) = 0;
  virtual Vector<T> increment(const Vector<T>& u, double time) = 0;

  // ---- layouts

  /// As those of Engine.
  virtual Vector<T> compact(const Vector<T>& u) const = 0;
  virtual Vector<T> all(const Vector<T>& u) const = 0;
  virtual Matrix<T> spread(const Matrix<T>& u) const = 0;
  virtual Vector<T> spread(const Vector<T>& u) const = 0;
  virtual Matrix<T> scatter(const Matrix<T>& compact) const = 0;
  virtual Reduction<T> reduce(const Matrix<T>& rows) const = 0;
  virtual Matrix<T> expand(const Matrix<T>& u, Matrix<T> others, const std::vector<int>* wanted) const = 0;
  /// Adds forces of the contact dofs, in the frames.
  virtual void add_contact(const Vector<T>& forces, Vector<T>& rows) const = 0;

  // ---- forces and tangents

  /// f_int - f_ext. `system`: has the tangent of bodies whose linearisation is fixed. Raises scale.force.
  virtual Vector<T> residual(const Vector<T>& u, const TangentSystem<T>& system, ForceScale& scale) const = 0;
  /// The motion that the tangent of bodies that change is taken at from now on.
  virtual void linearise(const BodyMotion<T>& /*at*/) {}
  /// As Engine::fix_linearisation, about the motion at which they are linearised, or another.
  virtual void fix(const BodyMotion<T>& /*at*/, const Vector<T>& /*u*/) {}
  virtual void release() {}
  /// As that of Engine.
  virtual Vector<T> tangent_times(const BodyMotion<T>& at, const Vector<T>& motion) const = 0;

  /// What it adds to the engine's name.
  virtual std::string name() const { return {}; }
  virtual void add_to_report(EngineReport& /*report*/) const {}

 protected:
  const Model& model_;
  const Slots<T>& slots_;
};

}  // namespace stickslip
