/// Mean dilatation at finite strain: an element changes its volume as one.
///
///   F_bar = a F,   a = (theta / J)^(1/3),   theta = int J dV / V,   J = det F, of three dimensions
///   R_ia = int P_bar : dF_bar/du_ia dV,    dF_bar = a dF + a/3 (d theta / theta - F^-T : dF) F
///
/// P_bar is the stress of F_bar: of a material with an energy int W(F_bar) dV is the element's, and its tangent
/// symmetric. It is the limit of small strain of continuum.hpp, and written in H = F - I, so that a small strain does
/// not vanish beside one: F_bar - I = H + (a - 1) F. A quadrilateral of four nodes in plane strain, where F_bar_33 = a,
/// and of revolution; a hexahedron of eight. An inverted element has strains that are not numbers. Source: [H80],
/// [MOS90]
#pragma once

#include "core/solids/continuum.hpp"
#include "core/solids/logarithmic.hpp"

namespace stickslip {

/// An element at displacements in the scalar T; G: of its geometry.
template <class T, class G, class Shape, Kinematics kinematics>
class MeanDilatation {
 public:
  static constexpr int nodes = Shape::nodes;
  static constexpr std::size_t points = static_cast<std::size_t>(points_of<Shape>(kinematics));
  using Strain = Tensor<T, layout_of(kinematics)>;

  MeanDilatation(const Nodal<G, Shape>& coordinates, const G& depth, const Nodal<T, Shape>& u) {
    using std::log1p, stickslip::log1p;
    const auto& quadrature = detail::quadrature_of<Shape, kinematics>();
    std::array<T, points> growth;  // J - 1
    G volume{};
    T mean{};
    bool inverted = false;
    for (std::size_t q = 0; q < points; ++q) {
      gradients_[q] = {quadrature[q], coordinates, depth};
      const Strain& H = H_[q] = gradients_[q].of(u);
      growth[q] = stickslip::growth(H);
      inverted |= is_inverted(H);
      volume += gradients_[q].volume;
      mean += growth[q] * gradients_[q].volume;
    }
    mean = mean / volume;
    theta_ = T(1) + mean;
    volume_ = volume;
    for (std::size_t q = 0; q < points; ++q) {
      if (inverted) {
        strain_[q] = Strain::constant(T(std::numeric_limits<double>::quiet_NaN()));
        continue;
      }
      const T more = exp_minus_one<T>(T((log1p(mean) - log1p(growth[q])) / T(3)));  // a - 1
      scale_[q] = T(1) + more;
      J_[q] = T(1) + growth[q];
      strain_[q] = H_[q].map([&](const T& h) { return T(scale_[q] * h); });
      for (int i = 0; i < 3; ++i) strain_[q](i, i) += more;
    }
  }

  /// F_bar - I of a point, and the volume that it stands for.
  const Strain& strain(std::size_t q) const { return strain_[q]; }
  const G& volume(std::size_t q) const { return gradients_[q].volume; }

  /// Nodal forces of stresses P_bar, one a point.
  Nodal<T, Shape> forces(const std::array<Strain, points>& P) const {
    Nodal<T, Shape> R = Nodal<T, Shape>::Constant(T(0)), mean = R;  // mean: d theta V
    T pressure{};                                                   // of a/3 P_bar : F, over the volume
    for (std::size_t q = 0; q < points; ++q) {
      const auto& gradient = gradients_[q];
      const Strain& H = H_[q];
      T work = contracted(P[q], H);
      for (int i = 0; i < 3; ++i) work += P[q](i, i);
      const T share = scale_[q] * work * gradient.volume / T(3);
      pressure += share;
      const Strain inverse = inverse_transposed(H, J_[q]);
      for (int a = 0; a < nodes; ++a)
        for (int i = 0; i < Shape::dimension; ++i) {
          T along{}, change{};
          gradient.for_each(i, a, [&](int p, int r, const G& b) {
            along += P[q](p, r) * b;
            change += inverse(p, r) * b;
          });
          R(i, a) += scale_[q] * gradient.volume * along - share * change;
          mean(i, a) += J_[q] * gradient.volume * change;
        }
    }
    const T over = pressure / (theta_ * volume_);
    for (int k = 0; k < Shape::dimension * nodes; ++k) R.data()[k] += over * mean.data()[k];
    return R;
  }

 private:
  /// F^-T; J: det F of three dimensions.
  static Strain inverse_transposed(const Strain& H, const T& J) {
    Strain inverse;
    if constexpr (Strain::in_space) {
      inverse.matrix() = cofactors<T>(H.plus_one()) / J;
    } else {
      const T out = T(1) + H(2, 2), area = J / out;
      inverse(0, 0) = (T(1) + H(1, 1)) / area;
      inverse(1, 1) = (T(1) + H(0, 0)) / area;
      inverse(0, 1) = -H(1, 0) / area;
      inverse(1, 0) = -H(0, 1) / area;
      inverse(2, 2) = T(1) / out;
    }
    return inverse;
  }

  std::array<Gradient<G, Shape, kinematics>, points> gradients_;
  std::array<Strain, points> H_, strain_;
  std::array<T, points> scale_, J_;
  T theta_;
  G volume_;
};

/// Calls f(H, volume) at each point of an element with the strain that its law is given: of mean dilatation at finite
/// strain F_bar - I, else the displacement gradient.
template <class T, class Shape, Kinematics kinematics, class F>
void for_each_strain_in(bool finite_strain, const Nodal<T, Shape>& coordinates, const T& depth,
                        const Nodal<T, Shape>& u, F&& f) {
  if constexpr (has_mean_dilatation(kinematics))
    if (finite_strain) {
      const MeanDilatation<T, T, Shape, kinematics> element(coordinates, depth, u);
      for (std::size_t q = 0; q < element.points; ++q) f(element.strain(q), element.volume(q));
      return;
    }
  for_each_gradient<T, Shape, kinematics>(coordinates, depth,
                                          [&](const auto& gradient) { f(gradient.of(u), gradient.volume); });
}

}  // namespace stickslip
