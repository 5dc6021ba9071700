/// The element template of the continuum: forces, tangent, energy and flow of any shape and kinematics, for any
/// material routine.
///
///   R_ia = int sigma_pq B_pq,ia dV        K = int B_pq,ia (dsigma_pq/dH_rs) B_rs,kb dV        H_pq = B_pq,ia u_ia
///
/// sigma is the stress that does work on H: at finite strain the first Piola-Kirchhoff stress. The material tangent is
/// the Dual of the stress routine; this file writes its assembly into an element once, by hand, but with mean
/// dilatation at finite strain, where the tangent is the Dual of the whole element. Tested against the complex step.
#pragma once

#include "core/solids/hardening.hpp"
#include "core/solids/mean_dilatation.hpp"

namespace stickslip {

/// What the points of an element remember: a law's numbers a point, one after another; nullptr where it has none.
template <class T>
class ElementMemory {
 public:
  /// `branches`: of the flows from there (flow_branch), at the first number of each point; nullptr: by their values.
  ElementMemory(const T* numbers = nullptr, const int* branches = nullptr)  // NOLINT: what is remembered is one
      : next_(numbers), branches_(branches) {}
  /// Of the next point.
  template <int count>
  Vec<T, count> take() {
    const Vec<T, count> memory = Eigen::Map<const Vec<T, count>>(next_);
    next_ += count;
    if (branches_) branches_ += count;
    return memory;
  }
  const int* branches() const { return branches_; }
  /// Of the next point.
  int branch() const { return branches_ ? *branches_ : flow_branch::by_values; }

 private:
  const T* next_;
  const int* branches_;
};

/// Dofs of an element.
template <class Shape>
inline constexpr int dofs_of = Shape::dimension* Shape::nodes;

/// A square matrix of an element, on the heap if it is larger than Eigen leaves on the stack: of hexahedra with middles
/// and their derivatives.
template <class T, int n>
inline constexpr int size_in_element = sizeof(T) * n* n <= EIGEN_STACK_ALLOCATION_LIMIT ? n : Eigen::Dynamic;
template <class T, int n>
using ElementMatrix = Eigen::Matrix<T, size_in_element<T, n>, size_in_element<T, n>>;

/// Numbers that a law remembers at a point of an element of these kinematics; 0: it does not remember.
template <class Law, Kinematics kinematics>
constexpr int memory_at() {
  if constexpr (requires { Law::memory_in(layout_of(kinematics)); }) return Law::memory_in(layout_of(kinematics));
  return 0;
}

namespace detail {

/// Whether elements of a law can have a mean dilatation at finite strain.
template <class Law, Kinematics kinematics>
constexpr bool averages() {
  if constexpr (has_mean_dilatation(kinematics) && requires { Law::is_made_for(kinematics, Strains::finite); })
    return Law::is_made_for(kinematics, Strains::finite);
  return false;
}

/// Forces of an element with mean dilatation at finite strain. `flows`: from `memory`, to `after` where that is given.
template <bool flows, class T, class Shape, Kinematics kinematics, class G, class Law>
Nodal<T, Shape> averaged_forces(const Law& law, const Nodal<G, Shape>& coordinates, const Nodal<T, Shape>& u,
                                const G& depth, ElementMemory<T> memory, T* after = nullptr) {
  using Element = MeanDilatation<T, G, Shape, kinematics>;
  const Element element(coordinates, depth, u);
  std::array<typename Element::Strain, Element::points> P;
  for (std::size_t q = 0; q < Element::points; ++q) {
    if constexpr (requires { Law::memory; }) {
      [[maybe_unused]] const int branch = memory.branch();
      Vec<T, memory_at<Law, kinematics>()> remembered = memory.template take<memory_at<Law, kinematics>()>();
      if constexpr (flows) {
        const auto before = remembered;
        P[q] = law.stress_with_flow(element.strain(q), before, branch, after ? &remembered : nullptr);
      } else {
        P[q] = law.stress(element.strain(q), remembered);
      }
      if (after) after = std::copy(remembered.begin(), remembered.end(), after);
    } else {
      P[q] = law.stress(element.strain(q));
    }
  }
  return element.forces(P);
}

}  // namespace detail

/// Internal nodal forces, dimension x nodes. G, the scalar of the geometry, is T, or double if it has no derivative.
/// `memory`: that the forces are at, of a law that remembers.
template <class T, class Shape, Kinematics kinematics = plain_kinematics<Shape>, class G = T, class Law>
Nodal<T, Shape> element_forces(const Law& law, const std::type_identity_t<Nodal<G, Shape>>& coordinates,
                               const Nodal<T, Shape>& u, const std::type_identity_t<G>& depth = G(1),
                               ElementMemory<T> memory = {}) {
  if constexpr (detail::averages<Law, kinematics>())
    if (law.is_finite)
      return detail::averaged_forces<false, T, Shape, kinematics, G>(law, coordinates, u, depth, memory);
  Nodal<T, Shape> forces = Nodal<T, Shape>::Constant(T(0));
  for_each_gradient<G, Shape, kinematics>(coordinates, depth, [&](const auto& gradient) {
    Tensor<T, layout_of(kinematics)> sigma;
    if constexpr (requires { Law::memory; })
      sigma = law.stress(gradient.of(u), memory.template take<memory_at<Law, kinematics>()>());
    else
      sigma = law.stress(gradient.of(u));
    for (int k = 0; k < sigma.size; ++k) sigma[k] = sigma[k] * gradient.volume;
    for (int a = 0; a < Shape::nodes; ++a)
      for (int i = 0; i < Shape::dimension; ++i)
        gradient.for_each(i, a, [&](int p, int q, const G& b) { forces(i, a) += sigma(p, q) * b; });
  });
  return forces;
}

namespace detail {

/// A law whose tangent is the same at all displacements.
template <class Law>
concept IsLinear = !requires {
  Law::memory;
}
&&!Law::is_finite;

/// H with a derivative by each of its components, in their order.
template <class Probe, class T, TensorLayout layout>
Tensor<Probe, layout> seeded(const Tensor<T, layout>& H) {
  Tensor<Probe, layout> probe;
  for (int k = 0; k < H.size; ++k) probe[k] = Probe::seed(H[k], k);
  return probe;
}

/// sigma with its derivatives by H, component by component; of a law that remembers, with the flow from `before`.
template <class T, TensorLayout layout, class Law, class Probe = Dual<Tensor<T, layout>::size, T>>
Tensor<Probe, layout> seeded_stress(const Law& law, const Tensor<T, layout>& H, ElementMemory<T>& before) {
  const Tensor<Probe, layout> probe = seeded<Probe>(H);
  if constexpr (requires { Law::memory; }) {
    constexpr int remembered = Law::memory_in(layout);
    const int branch = before.branch();
    const auto memory = before.template take<remembered>();
    const Vec<Probe, remembered> constant = memory.unaryExpr([](const T& x) { return Probe(x); });
    return law.template stress_with_flow<Probe, layout>(probe, constant, branch);
  } else {
    return law.stress(probe);
  }
}

/// dsigma/dH times a volume.
template <class T, TensorLayout layout, class Law, int size = Tensor<T, layout>::size>
Mat<T, size> material_tangent(const Law& law, const Tensor<T, layout>& H, const T& volume, ElementMemory<T>& before) {
  const auto sigma = seeded_stress(law, H, before);
  Mat<T, size> tangent;
  for (int k = 0; k < size; ++k) tangent.row(k) = sigma[k].d * volume;
  return tangent;
}

/// Nodal forces of an element with mean dilatation at finite strain, with the derivatives that u has. The law is
/// evaluated with those by its strain alone.
template <class T, class Probe, class Shape, Kinematics kinematics, class Law>
Nodal<Probe, Shape> averaged_forces_by_chain(const Law& law, const Nodal<T, Shape>& coordinates,
                                             const Nodal<Probe, Shape>& u, const T& depth, ElementMemory<T>& before) {
  using Element = MeanDilatation<Probe, T, Shape, kinematics>;
  const Element element(coordinates, depth, u);
  std::array<typename Element::Strain, Element::points> P;
  for (std::size_t q = 0; q < Element::points; ++q) {
    const auto& strain = element.strain(q);
    const auto sigma = seeded_stress(law, strain.map([](const Probe& x) { return x.v; }), before);
    for (int k = 0; k < strain.size; ++k) {
      P[q][k] = Probe(sigma[k].v);
      for (int m = 0; m < strain.size; ++m) P[q][k].d += sigma[k].d[m] * strain[m].d;
    }
  }
  return element.forces(P);
}

/// Tangent of an element with mean dilatation at finite strain.
template <class T, class Shape, Kinematics kinematics, class Law>
Mat<T, dofs_of<Shape>> averaged_tangent(const Law& law, const Nodal<T, Shape>& coordinates, const Nodal<T, Shape>& u,
                                        const T& depth, ElementMemory<T> before) {
  constexpr int dofs = dofs_of<Shape>;
  using Probe = Dual<dofs, T>;
  Nodal<Probe, Shape> seeded;
  for (int k = 0; k < dofs; ++k) seeded.data()[k] = Probe::seed(u.data()[k], k);
  Nodal<Probe, Shape> forces;
  if constexpr (is_in_space(kinematics)) {
    forces = averaged_forces_by_chain<T, Probe, Shape, kinematics>(law, coordinates, seeded, depth, before);
  } else if constexpr (requires { Law::memory; }) {
    constexpr int count = points_of<Shape>(kinematics) * memory_at<Law, kinematics>();
    const int* const branches = before.branches();
    const Vec<T, count> numbers = before.template take<count>();
    const Vec<Probe, count> constant = numbers.unaryExpr([](const T& x) { return Probe(x); });
    forces = averaged_forces<true, Probe, Shape, kinematics, T>(law, coordinates, seeded, depth,
                                                                ElementMemory<Probe>(constant.data(), branches));
  } else {
    forces = averaged_forces<true, Probe, Shape, kinematics, T>(law, coordinates, seeded, depth, {});
  }
  Mat<T, dofs> K;
  for (int k = 0; k < dofs; ++k) K.row(k) = forces.data()[k].d;
  return K;
}

}  // namespace detail

/// Tangent, dofs x dofs, node-major. `before`: the memory that a law which remembers flows from.
template <class T, class Shape, Kinematics kinematics = plain_kinematics<Shape>, class Law>
ElementMatrix<T, dofs_of<Shape>> element_tangent(const Law& law, const Nodal<T, Shape>& coordinates,
                                                 const Nodal<T, Shape>& u, const T& depth = T(1),
                                                 ElementMemory<T> before = {}) {
  constexpr int n = Shape::nodes, D = Shape::dimension;
  if constexpr (detail::averages<Law, kinematics>())
    if (law.is_finite) return detail::averaged_tangent<T, Shape, kinematics>(law, coordinates, u, depth, before);
  using Stress = Tensor<T, layout_of(kinematics)>;
  // Derivatives of a symmetric tangent are dear, so they are made of its lower blocks alone.
  constexpr bool mirrors = tells_constants<T>;
  using Tangent = ElementMatrix<T, D * n>;
  Tangent K = Tangent::Constant(D * n, D * n, T(0));
  Mat<T, Stress::size> at_unit_volume;
  if constexpr (detail::IsLinear<Law>)
    at_unit_volume = detail::material_tangent(law, Stress::constant(T(0)), T(1), before);
  for_each_gradient<T, Shape, kinematics>(coordinates, depth, [&](const auto& gradient) {
    Mat<T, Stress::size> C;
    if constexpr (detail::IsLinear<Law>)
      C = at_unit_volume * gradient.volume;
    else
      C = detail::material_tangent(law, gradient.of(u), gradient.volume, before);
    for (int b = 0; b < n; ++b)
      for (int k = 0; k < D; ++k) {
        auto column = Stress::constant(T(0));  // dsigma/du_kb
        gradient.for_each(k, b, [&](int p, int q, const T& x) {
          for (int c = 0; c < column.size; ++c) column[c] += C(c, column.place(p, q)) * x;
        });
        for (int a = mirrors ? b : 0; a < n; ++a)
          for (int i = 0; i < D; ++i)
            gradient.for_each(i, a, [&](int p, int q, const T& x) { K(a * D + i, b * D + k) += column(p, q) * x; });
      }
  });
  if constexpr (mirrors)
    for (int b = 1; b < n; ++b)
      for (int a = 0; a < b; ++a)
        K.template block<D, D>(D * a, D * b) = K.template block<D, D>(D * b, D * a).transpose();
  return K;
}

/// Strain energy int W dV, of a law that remembers at a memory.
template <class T, class Shape, Kinematics kinematics = plain_kinematics<Shape>, class Law>
T element_energy(const Law& law, const Nodal<T, Shape>& coordinates, const Nodal<T, Shape>& u, const T& depth = T(1),
                 ElementMemory<T> memory = {}) {
  T energy{};
  for_each_strain_in<T, Shape, kinematics>(law.is_finite, coordinates, depth, u, [&](const auto& H, const T& volume) {
    if constexpr (requires { Law::memory; })
      energy += law.energy(H, memory.template take<memory_at<Law, kinematics>()>()) * volume;
    else
      energy += law.energy(H) * volume;
  });
  return energy;
}

/// The memory that displacements leave, point by point, of the one before. `after` has room for it.
template <class T, class Shape, Kinematics kinematics = plain_kinematics<Shape>, class Law>
void element_flow(const Law& law, const Nodal<T, Shape>& coordinates, const Nodal<T, Shape>& u, ElementMemory<T> before,
                  T* after) {
  for_each_strain_in<T, Shape, kinematics>(law.is_finite, coordinates, T(1), u, [&](const auto& H, const T&) {
    const int branch = before.branch();
    const Vec<T, memory_at<Law, kinematics>()> flown =
        law.flow(H, before.template take<memory_at<Law, kinematics>()>(), branch);
    std::copy(flown.begin(), flown.end(), after);
    after += memory_at<Law, kinematics>();
  });
}

}  // namespace stickslip
