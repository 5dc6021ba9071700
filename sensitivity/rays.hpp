/// Derivatives of points at the apex of their cone, z = 0. The projection has no tangent there, but a directional
/// derivative:
///
///   Dt = 0  if Dz_N > 0,  else  Dt_N = Dz_N,  Dt_T = Dz_T  or  bound Dz_T / |Dz_T|,  bound = -mu Dz_N
///
/// It is positively homogeneous. So for a slipping point Dt is the tangent of the projection at any positive multiple
/// of Dz, applied to Dz. The tangent is therefore taken at the trial ContactField::ray, a multiple of Dz, while the
/// traction stays zero. If mu = 0 the cone is a line: the pressure keeps its value, and the ray is the direction of
/// Dz_T. Source: core/README.md.
#pragma once

#include "core/model/contact_assembly.hpp"

namespace stickslip {

/// Whether point p slips from the apex of its cone. `ray`: ContactField::ray.
inline bool has_ray(const Model& model, const Vector<double>& ray, std::size_t p) {
  const auto& point = model.points[p];
  return ray.size() > 0 && ray.segment(point.multiplier, point.components()).cwiseAbs().maxCoeff() > 0;
}

namespace detail {

/// Traction with its value at the apex and the derivatives of the projection at the trial `ray` (a traction of any
/// size).
template <class T, int Tangents>
Traction<T, Tangents> traction_on_ray(const Traction<T, Tangents>& z, const Vector<double>& ray,
                                      const FrictionLaw<T>& friction) {
  const bool line = friction.bears_nothing();
  const T slope = friction.slope_at_apex();
  auto moved = [](const T& x, double to) { return x + T(to - value(x)); };
  Traction<T, Tangents> trial;
  trial.normal = line ? z.normal : moved(z.normal, ray[0]);
  for (int a = 0; a < Tangents; ++a) trial.tangential[a] = moved(z.tangential[a], ray[1 + a]);
  const T bound =
      line ? friction.bound(T(-z.normal), friction.piece(-value(z.normal))) : T(T(-value(slope)) * trial.normal);
  auto t = project_onto_cone(trial, bound, ContactState::slip);
  t.normal = z.normal;
  for (int a = 0; a < Tangents; ++a) t.tangential[a] = moved(t.tangential[a], 0);
  return t;
}

}  // namespace detail

/// Replaces the tractions of the points with a ray by traction_on_ray(). `multiplier`: lambda of the field.
template <class T>
void take_rays(const ContactInput<T>& input, const Vector<T>& multiplier, const Vector<double>& ray,
               ContactField<T>& field) {
  const Model& model = input.model;
  for (std::size_t p = 0; ray.size() > 0 && p < model.points.size(); ++p) {
    if (!has_ray(model, ray, p)) continue;
    const auto& point = model.points[p];
    const int index = static_cast<int>(p), k = point.multiplier, offset = tangential_offset(model, index);
    detail::with_point(model, point, [&]<int D, int Tangents>() {
      auto z = detail::gather_traction<T, Tangents>(multiplier, k);
      z.normal += input.rho[p].normal * field.gap[index];
      for (int a = 0; a < Tangents; ++a) z.tangential[a] += input.rho[p].tangential * field.slip[offset + a];
      const auto t =
          detail::traction_on_ray<T, Tangents>(z, ray.segment(k, 1 + Tangents), input.slots.friction[point.contact]);
      field.traction[k] = t.normal;
      for (int a = 0; a < Tangents; ++a) field.traction[k + 1 + a] = t.tangential[a];
    });
  }
}

/// The multiplier at which a tangent is taken. For each point with a ray it puts the trial on the ray, so far from the
/// apex that the rounding of rho g is negligible.
inline Vector<double> multiplier_on_rays(const ContactInput<double>& input, const State<double>& at) {
  Vector<double> multiplier = at.multiplier;
  const auto& ray = at.contact.ray;
  for (std::size_t p = 0; ray.size() > 0 && p < input.model.points.size(); ++p) {
    if (!has_ray(input.model, ray, p)) continue;
    const auto& point = input.model.points[p];
    const int k = point.multiplier, offset = tangential_offset(input.model, static_cast<int>(p));
    Vector<double> g(point.components());
    g[0] = input.rho[p].normal * at.contact.gap[p];
    for (int a = 0; a < point.tangents; ++a) g[1 + a] = input.rho[p].tangential * at.contact.slip[offset + a];
    const double size =
        std::max(g.cwiseAbs().maxCoeff(), multiplier.segment(k, point.components()).cwiseAbs().maxCoeff());
    const bool line = input.slots.friction[point.contact].bears_nothing();
    for (int c = line ? 1 : 0; c < point.components(); ++c)
      multiplier[k + c] = (size > 0 ? size : 1) * ray[k + c] - g[c];
  }
  return multiplier;
}

}  // namespace stickslip
