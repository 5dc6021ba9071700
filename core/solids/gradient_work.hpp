/// The derivatives of a scalar by the gradients of an element's points (core/solids/continuum.hpp), moved to its
/// coordinates X and its depth. With W = d/d(dN), and w = d/d(volume) of a point:
///
///   d dN_a = - sum_b dN_b (dN_a . dX_b)      d volume = volume sum_b dN_b . dX_b      d r = sum_b N_b dX_b0
///   dX_b  += - sum_a dN_a (W_a . dN_b) + w volume dN_b,   of revolution also by r, of N_a / r and of the volume
///
/// and first, of mean dilatation, from the exchange to what it is the mean of.
#pragma once

#include "core/solids/continuum.hpp"

namespace stickslip::detail {

/// Derivatives of a scalar by the parts of one point's gradient.
template <class Shape, Kinematics kinematics>
struct ByGradient {
  using Of = Gradient<double, Shape, kinematics>;
  decltype(Of::dN) dN = decltype(Of::dN)::Zero();
  double volume = 0;
  decltype(Of::hoop) hoop = decltype(Of::hoop)::Zero();
  decltype(Of::exchange) exchange = decltype(Of::exchange)::Zero();
};

/// Moves derivatives by the exchange of all points to their other parts. It is (mean - dilatation) / 3.
template <class Gradients, class ByGradients>
void pull_back_exchange(const Gradients& gradients, ByGradients& by) {
  using Values = std::decay_t<decltype(by[0].dN)>;
  double volume = 0;
  Values of_mean = Values::Zero();
  for (std::size_t q = 0; q < gradients.size(); ++q) {
    volume += gradients[q].volume;
    of_mean += by[q].exchange / 3;
  }
  for (std::size_t q = 0; q < gradients.size(); ++q) {
    const Values of_dilatation = of_mean * (gradients[q].volume / volume) - by[q].exchange / 3;
    by[q].dN += of_dilatation;
    if constexpr (std::decay_t<decltype(gradients[0])>::revolved) by[q].hoop += of_dilatation.row(0).transpose();
    by[q].volume -= 3 / volume * of_mean.cwiseProduct(gradients[q].exchange).sum();
  }
}

/// Adds what one point's derivatives make of the coordinates; returns those by the depth, over 1 / depth.
template <class Shape, Kinematics kinematics>
double pull_back_gradient(const Gradient<double, Shape, kinematics>& gradient, const ByGradient<Shape, kinematics>& by,
                          Nodal<double, Shape>& coordinates) {
  const double of_volume = by.volume * gradient.volume;
  const Mat<double, Shape::dimension> turned = gradient.dN.lazyProduct(by.dN.transpose());
  coordinates += of_volume * gradient.dN - turned.lazyProduct(gradient.dN);
  if constexpr (is_of_revolution(kinematics)) {
    coordinates.row(0) += (of_volume - by.hoop.dot(gradient.hoop)) * gradient.hoop.transpose();
    return 0;
  }
  return is_in_space(kinematics) ? 0 : of_volume;  // (in space there is no depth)
}

}  // namespace stickslip::detail
