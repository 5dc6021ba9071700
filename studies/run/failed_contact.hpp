/// What the contact points of a run that failed do, and what to check.
#pragma once

#include <string>

#include "studies/run/case.hpp"

namespace stickslip {

/// Contact points of a failed step, in its last iterate.
struct FailedContact {
  int open = 0, stick = 0, slip = 0;  ///< numbers of points; frictionless ones that touch count as slip
  bool rough = true;                  ///< a point has friction
  bool unheld = false;                ///< contact alone holds a body, in some direction at least
  bool unbalanced = false;            ///< and no forces of it balance the load
  bool turned = false;                ///< an obstacle is turned inside out, which is said elsewhere
  double nearest = 0;                 ///< least gap at the start, length; infinite where no point faces a master
};

/// "9 contact points: 0 stick, 9 slip, 0 open; ...": the numbers, and what to check for this pattern, if it has a cause
/// that one can check. Empty without points.
std::string failed_contact_in_words(const FailedContact& contact);

/// What a scene has that advice may be about.
struct Advisable {
  bool contact = false;          ///< contact points, which have a stiffness or scale
  bool other_side = false;       ///< a deformable master, which may be the slave
  bool may_be_smooth = false;    ///< a master of facets that are not smoothed, seen from nodes
  bool may_be_segments = false;  ///< a master of facets, seen from nodes of a solid body
};
Advisable advisable(const Model& model);

/// What to try if iterations did not converge: "try more steps, or segments". Nothing that the scene lacks, or is so
/// already.
std::string advice_in_words(const Advisable& scene);

/// Adds to the message of a run that failed what its contact points do, what to try, and the obstacles that are turned
/// inside out.
void explain_failed_contact(const Problem& problem, Trajectory<double>& trajectory);

}  // namespace stickslip
