/// Responses of a state, measured again (docs/scene.md, Responses).
#pragma once

#include "studies/verify/contacts.hpp"
#include "studies/verify/solids.hpp"

namespace stickslip::verify {

/// A place of contact with its traction on the slave, force per area of the start.
struct Placed {
  const Contact* contact = nullptr;
  Touch touch;
  Vec3 traction = Vec3::Zero();
  Vec2 compliance = Vec2::Zero();  ///< of the springs of a penalty, normal and tangential; zero: multipliers
  double slid = 0;                 ///< slip since the start along e = (-n_y, n_x)
  double pressure() const { return traction.dot(touch.normal); }
  Vec3 friction() const { return traction - pressure() * touch.normal; }
};

/// What responses are measured on.
struct State {
  const Scene& scene;
  const Field& u;
  const Bodies& bodies;
  std::vector<Placed> placed = {};
  Field held = {};                          ///< forces of the supports
  std::map<std::string, double> heat = {};  ///< of plastic slip since the start, of contacts and groups; NaN: not known
};

/// The value of a response; none of those that are not measured again.
std::optional<double> measure(const State& state, const Json& response);

}  // namespace stickslip::verify
