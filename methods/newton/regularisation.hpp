/// From the option `stiffness` or `scale` to rho of every contact point, force per length cubed:
///
///   relative c:  rho_i = c k_i / A_i        k_i: local nodal stiffness (core/model/slots), A_i: tributary area
///   absolute:    rho_i = value
///   automatic:   relative, with the method's automatic_multiple (options.hpp)
///
/// rho is a function of the scene, so its derivative is there by itself.
#pragma once

#include "core/model/contact_assembly.hpp"
#include "methods/options.hpp"

namespace stickslip {

template <class T>
RegularisationField<T> regularisation(const Slots<T>& slots, const Regularisation& option, double automatic_multiple,
                                      const T& tangential_ratio) {
  RegularisationField<T> rho;
  for (std::size_t p = 0; p < slots.geometry.size(); ++p) {
    const T local = slots.stiffness[p] / slots.geometry[p].area;
    T normal{};
    switch (option.kind) {
      case Regularisation::Kind::automatic:
        normal = T(automatic_multiple) * local;
        break;
      case Regularisation::Kind::relative:
        normal = slots.numbers(option.value) * local;
        break;
      case Regularisation::Kind::absolute:
        normal = slots.numbers(option.value);
        break;
    }
    rho.push_back({normal, tangential_ratio * normal});
  }
  return rho;
}

/// rho of a method's options before any adaption.
template <class T, WholeMethod M>
RegularisationField<T> initial_regularisation(const Slots<T>& slots, const M& method) {
  return regularisation(slots, method.regularisation(), M::automatic_multiple.of(slots.normals_turn),
                        slots.numbers(method.tangential_share()));
}

template <class T>
RegularisationField<T> initial_regularisation(const Slots<T>& slots, const Method& method) {
  return std::visit([&](const auto& m) { return initial_regularisation(slots, m); }, method);
}

/// rho without derivatives: of a solution that does not depend on it.
template <class T>
RegularisationField<T> constant(const RegularisationField<double>& rho) {
  RegularisationField<T> out;
  for (const auto& r : rho) out.push_back({T(r.normal), T(r.tangential)});
  return out;
}

/// rho after adaption, per point factors (empty: none).
template <class T>
RegularisationField<T> adapted(RegularisationField<T> rho, const std::vector<double>& rho_factor) {
  for (std::size_t p = 0; p < rho_factor.size(); ++p) {
    rho[p].normal *= T(rho_factor[p]);
    rho[p].tangential *= T(rho_factor[p]);
  }
  return rho;
}

}  // namespace stickslip
