/// Picture of a friction cone: how an iteration brought a traction into it.
#pragma once

#include <string>
#include <vector>

#include "core/contact/friction_law.hpp"
#include "studies/report/drawing.hpp"

namespace stickslip::report {

/// One iterate of a contact point. Pressure is positive in compression; tangential: the component in the plane, the
/// length in space.
struct ConeIterate {
  double trial_pressure, trial_tangential, pressure, tangential;
  bool last;  ///< of its equilibrium
  double time;
};

struct ConePath {
  std::string title;
  FrictionLaw<double> law;
  bool in_space;
  bool of_forces;  ///< a point, which has no area
  std::vector<ConeIterate> iterates;
};

/// A panel each: the cone |t_T| <= bound(p), hollow circles for trial tractions, joined to the tractions they are
/// projected to (dots), and diamonds where an equilibrium ended, with the time of the first, the last, and those whose
/// state is new. What lies far outside is cut off.
Drawing draw_cones(const std::vector<ConePath>& paths, const std::string& title);

}  // namespace stickslip::report
