/// Responses of a state, measured again (docs/scene.md, Responses).
#pragma once

#include "studies/verify/bodies.hpp"
#include "studies/verify/contacts.hpp"

namespace stickslip::verify {

/// A place of contact with its traction.
struct Placed {
  const Contact* contact;
  Touch touch;
  Vec3 traction;    ///< on the slave, force per area of the start
  double slid = 0;  ///< slip since the start along e = (-n_y, n_x)
  double pressure() const { return traction.dot(touch.normal); }
};

/// What responses are measured on.
struct State {
  const Scene& scene;
  const Field& u;
  const Bodies& bodies;
  std::vector<Placed> places;
  Field held;                          ///< forces of the supports
  std::map<std::string, double> heat;  ///< work of plastic slip since the start, of each contact and group
};

/// The value of a response; none of those that are not measured again.
std::optional<double> measure(const State& state, const Json& response);

}  // namespace stickslip::verify
