/// A remark on a run that is no failure: one code of a closed set, with what it is about, a number, and what to do.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace stickslip {

/// The whole set (docs/results.md).
enum class WarningCode {
  large_strain,        ///< value: largest component of strain
  tiny_strain,         ///< value: largest component of strain
  large_rotation,      ///< value: degrees
  large_sliding,       ///< value: elements of the slave
  idle_friction,       ///< value: the coefficient that has no influence
  cut_steps,           ///< value: number of steps that were cut
  locking,             ///< value: spurious pressure / stress, both root mean squares over the body
  single_node,         ///< value: share of the force that one node carries
  narrow_contact,      ///< value: width of the contact, in facets
  master_inside,       ///< value: depth of a node of the master in the slave, length
  turned_surface,      ///< value: number of slave nodes on the solid side of their obstacle
  starts_overlapping,  ///< value: depth, length, without what `offset` asks for
  never_closes,        ///< value: least gap of the run, length
  no_area,             ///< value: number of slave nodes that have no area
  floating_body,       ///< value: number of steps at whose end nothing holds the body
  shear_locking,       ///< value: share of a shear that varies within elements in the squared strain of the body
  folded_element,      ///< value: number of elements that are folded, or nearly so
  unbalanced_moment,   ///< value: share of a response that is a moment
  shared_place,        ///< value: number of bodies that hold the place of a response
  soft_penalty,        ///< value: share by which springs of the penalty yield beside the bodies
  unstable,            ///< value: number of steps whose equilibrium is unstable
  branch_ends,         ///< value: time at which the solution jumps
  path_goes_on,        ///< value: share of the load at which the last step of a path ends
  non_unique  ///< value: number of solutions that are known, 1: there may be more, 0 where they are a continuum
};
std::string_view name_of(WarningCode);

struct Warning {
  WarningCode code = WarningCode::large_strain;
  std::string where;   ///< name of a body or a contact; empty: the run
  double value = 0;    ///< of what, the code tells
  std::string remedy;  ///< what to do, as an imperative
  std::string text;    ///< a sentence that names place and value, without the remedy
};

}  // namespace stickslip
