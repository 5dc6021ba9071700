/// Which displacements are prescribed, and to what: supports by axis, rotating and inclined ones.
///
/// A node that an inclined support holds has a frame Q of its own, q_1 ... q_D (FramedNode). Its prescribed directions
/// d_1 ... d_m are orthonormalised in their order, so that d_c = sum over k <= c of (q_k.d_c) q_k, and
///
///   d_c.u = v_c    gives    q_c.u = (v_c - sum over k < c of (q_k.d_c) q_k.u) / (q_c.d_c)
///
/// In small strain a rotation is theta x (X - center): the exact one of a finite angle would strain a body that it
/// turns as a whole. At finite strain it is the exact one.
#pragma once

#include "core/contact/surfaces.hpp"
#include "core/model/model.hpp"

namespace stickslip {

/// The axis of a rotation in space, of unit length.
template <class T>
Vec<T, 3> unit_axis(const Rotation& rotation, const Numbers<T>& numbers) {
  Vec<T, 3> axis;
  for (int i = 0; i < 3; ++i) axis[i] = numbers(rotation.axis[i]);
  const T length = norm(axis);
  for (int i = 0; i < 3; ++i) axis[i] /= length;
  return axis;
}

/// A rotation's axis x arm; in the plane the axis is out of it.
template <class T>
Vector<T> across_axis(const Rotation& rotation, const Vector<T>& arm, const Numbers<T>& numbers) {
  if (arm.size() == 3) return cross<T>(unit_axis(rotation, numbers), arm);
  Vector<T> u(2);
  u << -arm[1], arm[0];
  return u;
}

/// Displacement of the place x when it is rotated by one degree: (pi / 180) axis x (x - center), length.
template <class T, class Place>
Vector<T> displacement_per_degree(const Rotation& rotation, const Place& x, const Numbers<T>& numbers) {
  const T degree(std::acos(-1.0) / 180);
  Vector<T> arm(x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) arm[i] = degree * (x[i] - numbers(rotation.center[i]));
  return across_axis(rotation, arm, numbers);
}

/// A rotation by a finite angle. What x changes by is, with a the axis, sin angle a x x + (1 - cos angle) a x (a x x).
template <class T>
struct Turn {
  T sine, cosine_less_one;  ///< the latter without cancellation at small angles
  Vec<T, 3> axis{T(0), T(0), T(1)};

  /// `degrees`: the angle, positive counter-clockwise seen against the axis.
  static Turn about(const Rotation& rotation, const T& degrees, const Numbers<T>& numbers) {
    using std::sin;
    const T angle = degrees * T(std::acos(-1.0) / 180), half = sin(angle / T(2));
    Turn turn{sin(angle), T(-2) * half * half};
    if (!rotation.axis.empty()) turn.axis = unit_axis(rotation, numbers);
    return turn;
  }
  Turn back() const { return {-sine, cosine_less_one, axis}; }
  /// What a vector changes by.
  template <class U>
  Vec<U, 2> change(const Vec<U, 2>& x) const {
    const U s(sine), c(cosine_less_one);
    return {c * x[0] - s * x[1], s * x[0] + c * x[1]};
  }
  template <class U>
  Vec<U, 3> change(const Vec<U, 3>& x) const {
    const Vec<U, 3> a{U(axis[0]), U(axis[1]), U(axis[2])}, once = cross<U>(a, x), twice = cross<U>(a, once);
    return U(sine) * once - U(cosine_less_one) * twice;
  }
};

/// Displacement of the place x when it is rotated by an angle in degrees: at finite strain exactly.
template <class T, class Place>
Vector<T> rotated(const Rotation& rotation, const Place& x, const T& degrees, Strains strains,
                  const Numbers<T>& numbers) {
  if (strains == Strains::small) return degrees * displacement_per_degree<T>(rotation, x, numbers);
  const auto turn = Turn<T>::about(rotation, degrees, numbers);
  Vector<T> arm(x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) arm[i] = x[i] - numbers(rotation.center[i]);
  if (arm.size() == 2) return turn.change(Vec<T, 2>(arm));
  return turn.change(Vec<T, 3>(arm));
}

/// Unit vector that a constraint prescribes the displacement along. pre: it has a support.
template <class T>
Vector<T> direction(const Scene& scene, const Constraint& constraint, const Numbers<T>& numbers) {
  Vector<T> d = Vector<T>::Constant(scene.dimension(), T(0));
  if (constraint.axis != Constraint::inclined) {
    d[constraint.axis - 'x'] = T(1);
    return d;
  }
  const auto& along = scene.supports[constraint.support].inclined->along;
  for (Eigen::Index i = 0; i < d.size(); ++i) d[i] = numbers(along[i]);
  const T length = norm(d);
  for (Eigen::Index i = 0; i < d.size(); ++i) d[i] /= length;
  return d;
}

/// What a constraint prescribes for a node at x, along its direction, at time t.
template <class T, class Place>
T prescribed_value(const Scene& scene, const Constraint& constraint, const Place& x, double t,
                   const Numbers<T>& numbers) {
  if (constraint.support < 0) return T(0);
  const Support& support = scene.supports[constraint.support];
  if (constraint.axis == Constraint::inclined) return evaluate(support.inclined->value, t, numbers);
  const auto move = support.move.find(constraint.axis);
  T u = move == support.move.end() ? T(0) : evaluate(move->second, t, numbers);
  if (support.rotate)
    u += rotated<T>(*support.rotate, x, evaluate(support.rotate->angle, t, numbers), strains_of(scene.finite_strain),
                    numbers)[constraint.axis - 'x'];
  return u;
}

/// Frame of a framed node, D x D, one vector a column.
template <class T>
Matrix<T> nodal_frame(const Scene& scene, const FramedNode& framed, const Numbers<T>& numbers) {
  const int D = scene.dimension();
  Matrix<T> Q = Matrix<T>::Constant(D, D, T(0));
  int known = 0;
  for (const auto& constraint : framed.prescribed) {
    if (constraint.support < 0) break;  // an anchor is held across its inclined direction as well
    Vector<T> q = direction(scene, constraint, numbers);
    for (int k = 0; k < known; ++k) q -= (dot(Q.col(k), q) * Q.col(k)).eval();
    const T length = norm(q);
    for (int i = 0; i < D; ++i) Q(i, known) = q[i] / length;
    ++known;
  }
  if (known == 1) {
    const auto across = detail::tangent_frame<T>(Vector<T>(Q.col(0)));
    for (int k = 1; k < D; ++k) Q.col(k) = across.col(k - 1);
  } else if (known == 2 && D == 3) {
    Q.col(2) = cross<T>(Q.col(0), Q.col(1));
  }
  return Q;
}

/// Decides who prescribes what: Model::constraints, framed, free_index and free_dofs. `points`: nodal coordinates.
/// Supports that share a node must agree on what it does there. Throws ModelError where they do not.
void number_dofs(Model& model, const Points<double>& points);

}  // namespace stickslip
