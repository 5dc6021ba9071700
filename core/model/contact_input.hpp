/// What a contact evaluation reads.
#pragma once

#include "core/model/slots.hpp"
#include "core/model/state.hpp"

namespace stickslip {

/// Regularisation of all points, force per length cubed.
template <class T>
using RegularisationField = std::vector<PointRegularisation<T>>;

/// What a contact evaluation reads beside displacement and multiplier.
template <class T>
struct ContactInput {
  const Model& model;
  const Slots<T>& slots;
  const RegularisationField<T>& rho;
  const History<T>& previous;  ///< of the last converged increment
  ConeRadius cone = ConeRadius::augmented;
  double time = 0;
  const std::vector<Facing>* facing = nullptr;  ///< per point, on its surface; nullptr: search for it
};

}  // namespace stickslip
