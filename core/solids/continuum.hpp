/// The element template of the continuum: residual and tangent of any shape, in the plane or of revolution, with or
/// without mean dilatation, for any material routine.
///
///   R_ia = int sigma_pq B_pq,ia dV        K = int B_pq,ia (dsigma_pq/dH_rs) B_rs,kb dV        H_pq = B_pq,ia u_ia
///
/// H is the displacement gradient, sigma the stress that does work on it: at finite strain the first Piola-Kirchhoff
/// stress. In the plane it has four components, B_pq,ia = delta_ip dN_a/dX_q, and dV is area
/// times thickness. Of revolution (X_0 = r, X_1 axial) the hoop strain H_22 = u_r / r joins them, and dV is area times
/// the circumference 2 pi r. With mean dilatation the trace of H is replaced by its mean over the element,
///
///   H -> H + (theta - tr H)/3 I,   theta = int tr H dV / V,
///
/// so that a nearly incompressible element has one volume to keep and not one at every point: the small-strain limit of
/// F -> (theta/J)^(1/3) F. It has a potential, hence a symmetric tangent. In plane strain it too has H_22, the spread
/// of the dilatation out of the plane. [H80]
///
/// The material tangent is the Dual of the stress routine; this file writes its assembly into an element once, by hand.
/// Tested against the Dual of the whole element.
#pragma once

#include "core/solids/kinematics.hpp"
#include "core/solids/shapes.hpp"

namespace stickslip {

/// Calls f.template operator()<K>() with the kinematics as a compile-time constant. Mean dilatation is made for the
/// four-node quadrilateral alone.
template <class Shape, class F>
void with_kinematics(Kinematics kinematics, F&& f) {
  if (kinematics == Kinematics::plane) return f.template operator()<Kinematics::plane>();
  if (kinematics == Kinematics::revolution) return f.template operator()<Kinematics::revolution>();
  if constexpr (Shape::nodes == 4) {
    if (kinematics == Kinematics::plane_mean_dilatation)
      return f.template operator()<Kinematics::plane_mean_dilatation>();
    f.template operator()<Kinematics::revolution_mean_dilatation>();
  }
}

/// dN/dX (one column a node) and the volume of one quadrature point. `coordinates`: 2 x nodes. `depth`: thickness of a
/// plane body, unread in one of revolution.
template <class T, class Shape, Kinematics kinematics = Kinematics::plane>
struct Gradient {
  static constexpr int nodes = Shape::nodes, rows = stress_dimension(kinematics), components = rows == 2 ? 4 : 5;
  static constexpr bool revolved = is_of_revolution(kinematics), averaged = has_mean_dilatation(kinematics);
  Mat<T, 2, nodes> dN;
  T volume;
  Vec<T, revolved ? nodes : 0> hoop;         ///< N_a / r
  Mat<T, 2, averaged ? nodes : 0> exchange;  ///< d(theta - tr H)/du_ia, a third of it

  Gradient() = default;
  Gradient(const ShapePoint<nodes>& point, const Mat<T, 2, nodes>& coordinates, const T& depth = T(1)) {
    if constexpr (averaged) exchange.setConstant(T(0));  // element_gradients sets it
    Mat<T, 2> J = Mat<T, 2>::Zero();                     // J(i, j) = dX_i/dxi_j
    for (int a = 0; a < nodes; ++a)
      for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j) J(i, j) += coordinates(i, a) * T(point.gradient(j, a));
    const T det = J(0, 0) * J(1, 1) - J(0, 1) * J(1, 0);
    volume = det * T(point.weight);
    for (int a = 0; a < nodes; ++a) {
      const T gx(point.gradient(0, a)), gy(point.gradient(1, a));
      dN(0, a) = (gx * J(1, 1) - gy * J(1, 0)) / det;
      dN(1, a) = (gy * J(0, 0) - gx * J(0, 1)) / det;
    }
    if constexpr (revolved) {
      T r{};
      for (int a = 0; a < nodes; ++a) r += coordinates(0, a) * T(point.value[a]);
      for (int a = 0; a < nodes; ++a) hoop[a] = T(point.value[a]) / r;
      volume *= T(2 * std::acos(-1.0)) * r;
    } else {
      volume *= depth;
    }
  }

  /// d tr H / du_ia before averaging.
  T dilatation(int i, int a) const {
    if constexpr (revolved)
      if (i == 0) return dN(0, a) + hoop[a];
    return dN(i, a);
  }

  /// Calls f(p, q, B_pq,ia) for the components of H that u_ia moves.
  template <class F>
  void for_each(int i, int a, F&& f) const {
    f(i, 0, dN(0, a));
    f(i, 1, dN(1, a));
    if constexpr (revolved)
      if (i == 0) f(2, 2, hoop[a]);
    if constexpr (averaged)
      for (int p = 0; p < 3; ++p) f(p, p, exchange(i, a));
  }

  /// Displacement gradient of nodal displacements (2 x nodes), in their scalar: T, or a Dual built on it.
  template <class U>
  Mat<U, rows> of(const Mat<U, 2, nodes>& u) const {
    Mat<U, rows> H = Mat<U, rows>::Constant(U(0));
    for (int a = 0; a < nodes; ++a)
      for (int i = 0; i < 2; ++i) for_each(i, a, [&](int p, int q, const T& b) { H(p, q) += b * u(i, a); });
    return H;
  }
};

namespace detail {

template <class Shape, Kinematics kinematics>
const auto& quadrature_of() {
  static const auto points = [] {
    if constexpr (is_of_revolution(kinematics))
      return Shape::quadrature_of_revolution();
    else
      return Shape::quadrature();
  }();
  return points;
}

/// Sets the exchange of all gradients of an element.
template <class Gradients>
void average_dilatation(Gradients& gradients) {
  using T = std::decay_t<decltype(gradients[0].volume)>;
  T volume{};
  for (const auto& gradient : gradients) volume += gradient.volume;
  for (int a = 0; a < gradients[0].nodes; ++a)
    for (int i = 0; i < 2; ++i) {
      T mean{};
      for (const auto& gradient : gradients) mean += gradient.dilatation(i, a) * gradient.volume;
      for (auto& gradient : gradients) gradient.exchange(i, a) = (mean / volume - gradient.dilatation(i, a)) / T(3);
    }
}

}  // namespace detail

/// Calls f(gradient) at each quadrature point of an element.
template <class T, class Shape, Kinematics kinematics, class F>
void for_each_gradient(const Mat<T, 2, Shape::nodes>& coordinates, const T& depth, F&& f) {
  const auto& quadrature = detail::quadrature_of<Shape, kinematics>();
  if constexpr (has_mean_dilatation(kinematics)) {
    std::array<Gradient<T, Shape, kinematics>, std::tuple_size_v<std::decay_t<decltype(quadrature)>>> gradients;
    for (std::size_t p = 0; p < gradients.size(); ++p) gradients[p] = {quadrature[p], coordinates, depth};
    detail::average_dilatation(gradients);
    for (const auto& gradient : gradients) f(gradient);
  } else {
    for (const auto& point : quadrature) f(Gradient<T, Shape, kinematics>(point, coordinates, depth));
  }
}

/// What the points of an element remember: a law's numbers a point, one after another; nullptr where it has none.
template <class T>
class ElementMemory {
 public:
  ElementMemory(const T* numbers = nullptr) : next_(numbers) {}  // NOLINT: what is remembered is one
  /// Of the next point.
  template <int count>
  Vec<T, count> take() {
    const Vec<T, count> memory = Eigen::Map<const Vec<T, count>>(next_);
    next_ += count;
    return memory;
  }

 private:
  const T* next_;
};

/// Internal nodal forces, 2 x nodes. G, the scalar of the geometry, is T, or double where no derivative rides on it.
/// `memory`: that the forces are at, of a law that remembers.
template <class T, class Shape, Kinematics kinematics = Kinematics::plane, class G = T, class Law>
Mat<T, 2, Shape::nodes> element_forces(const Law& law, const std::type_identity_t<Mat<G, 2, Shape::nodes>>& coordinates,
                                       const Mat<T, 2, Shape::nodes>& u, const std::type_identity_t<G>& depth = G(1),
                                       ElementMemory<T> memory = {}) {
  Mat<T, 2, Shape::nodes> forces = Mat<T, 2, Shape::nodes>::Constant(T(0));
  for_each_gradient<G, Shape, kinematics>(coordinates, depth, [&](const auto& gradient) {
    constexpr int rows = stress_dimension(kinematics);
    Mat<T, rows> sigma;
    if constexpr (requires { Law::memory; })
      sigma = law.template stress<T, rows>(gradient.of(u), memory.template take<Law::memory>());
    else
      sigma = law.template stress<T, rows>(gradient.of(u));
    for (int k = 0; k < rows * rows; ++k) sigma.data()[k] = sigma.data()[k] * gradient.volume;
    for (int a = 0; a < Shape::nodes; ++a)
      for (int i = 0; i < 2; ++i)
        gradient.for_each(i, a, [&](int p, int q, const G& b) { forces(i, a) += sigma(p, q) * b; });
  });
  return forces;
}

namespace detail {

/// Place of H_pq, or sigma_pq, among those that are not always zero: 00 01 10 11 22.
constexpr int component(int p, int q) { return p == 2 ? 4 : 2 * p + q; }

/// dsigma/dH times a volume, component by component; of a law that remembers, with the flow from `before`.
template <class T, int components, int rows, class Law>
Mat<T, components> material_tangent(const Law& law, const Mat<T, rows>& H, const T& volume, ElementMemory<T>& before) {
  using Probe = Dual<components, T>;
  Mat<Probe, rows> seeded = Mat<Probe, rows>::Constant(Probe(T(0)));
  for (int p = 0; p < rows; ++p)
    for (int q = 0; q < rows; ++q)
      if ((p == 2) == (q == 2)) seeded(p, q) = Probe::seed(H(p, q), component(p, q));
  Mat<Probe, rows> sigma;
  if constexpr (requires { Law::memory; }) {
    const auto memory = before.template take<Law::memory>();
    const Vec<Probe, Law::memory> constant = memory.unaryExpr([](const T& x) { return Probe(x); });
    sigma = law.template stress<Probe, rows>(seeded, law.template flow<Probe, rows>(seeded, constant));
  } else {
    sigma = law.template stress<Probe, rows>(seeded);
  }
  Mat<T, components> tangent;
  for (int p = 0; p < rows; ++p)
    for (int q = 0; q < rows; ++q)
      if ((p == 2) == (q == 2)) tangent.row(component(p, q)) = sigma(p, q).d * volume;
  return tangent;
}

}  // namespace detail

/// Tangent, (2 nodes) x (2 nodes), node-major. `before`: the memory that a law which remembers flows from.
template <class T, class Shape, Kinematics kinematics = Kinematics::plane, class Law>
Mat<T, 2 * Shape::nodes> element_tangent(const Law& law, const Mat<T, 2, Shape::nodes>& coordinates,
                                         const Mat<T, 2, Shape::nodes>& u, const T& depth = T(1),
                                         ElementMemory<T> before = {}) {
  constexpr int n = Shape::nodes;
  Mat<T, 2 * n> K = Mat<T, 2 * n>::Constant(T(0));
  for_each_gradient<T, Shape, kinematics>(coordinates, depth, [&](const auto& gradient) {
    constexpr int rows = stress_dimension(kinematics), components = rows == 2 ? 4 : 5;
    const auto C = detail::material_tangent<T, components, rows>(law, gradient.of(u), gradient.volume, before);
    for (int b = 0; b < n; ++b)
      for (int k = 0; k < 2; ++k) {
        Vec<T, components> column = Vec<T, components>::Constant(T(0));  // dsigma/du_kb
        gradient.for_each(k, b, [&](int p, int q, const T& x) {
          for (int c = 0; c < components; ++c) column[c] += C(c, detail::component(p, q)) * x;
        });
        for (int a = 0; a < n; ++a)
          for (int i = 0; i < 2; ++i)
            gradient.for_each(i, a, [&](int p, int q, const T& x) {
              K(a * 2 + i, b * 2 + k) += column[detail::component(p, q)] * x;
            });
      }
  });
  return K;
}

/// Strain energy int W dV, of a law that remembers at a memory.
template <class T, class Shape, Kinematics kinematics = Kinematics::plane, class Law>
T element_energy(const Law& law, const Mat<T, 2, Shape::nodes>& coordinates, const Mat<T, 2, Shape::nodes>& u,
                 const T& depth = T(1), ElementMemory<T> memory = {}) {
  constexpr int rows = stress_dimension(kinematics);
  T energy{};
  for_each_gradient<T, Shape, kinematics>(coordinates, depth, [&](const auto& gradient) {
    if constexpr (requires { Law::memory; })
      energy += law.template energy<T, rows>(gradient.of(u), memory.template take<Law::memory>()) * gradient.volume;
    else
      energy += law.template energy<T, rows>(gradient.of(u)) * gradient.volume;
  });
  return energy;
}

/// The memory that displacements leave, point by point, of the one before. `after` has room for it.
template <class T, class Shape, Kinematics kinematics = Kinematics::plane, class Law>
void element_flow(const Law& law, const Mat<T, 2, Shape::nodes>& coordinates, const Mat<T, 2, Shape::nodes>& u,
                  ElementMemory<T> before, T* after) {
  constexpr int rows = stress_dimension(kinematics);
  for_each_gradient<T, Shape, kinematics>(coordinates, T(1), [&](const auto& gradient) {
    const Vec<T, Law::memory> flown = law.template flow<T, rows>(gradient.of(u), before.template take<Law::memory>());
    std::copy(flown.begin(), flown.end(), after);
    after += Law::memory;
  });
}

/// Quadrature points of an element.
template <class Shape>
constexpr int points_of(Kinematics kinematics) {
  return static_cast<int>(is_of_revolution(kinematics) ? std::tuple_size_v<decltype(Shape::quadrature_of_revolution())>
                                                       : std::tuple_size_v<decltype(Shape::quadrature())>);
}

}  // namespace stickslip
