#include "core/model/warning.hpp"

namespace stickslip {

std::string_view name_of(WarningCode code) {
  switch (code) {
    case WarningCode::large_strain:
      return "large_strain";
    case WarningCode::tiny_strain:
      return "tiny_strain";
    case WarningCode::large_rotation:
      return "large_rotation";
    case WarningCode::large_sliding:
      return "large_sliding";
    case WarningCode::idle_friction:
      return "idle_friction";
    case WarningCode::cut_steps:
      return "cut_steps";
    case WarningCode::locking:
      return "locking";
    case WarningCode::single_node:
      return "single_node";
    case WarningCode::narrow_contact:
      return "narrow_contact";
    case WarningCode::master_inside:
      return "master_inside";
    case WarningCode::turned_surface:
      return "turned_surface";
    case WarningCode::starts_overlapping:
      return "starts_overlapping";
    case WarningCode::never_closes:
      return "never_closes";
    case WarningCode::no_area:
      return "no_area";
    case WarningCode::floating_body:
      return "floating_body";
    case WarningCode::shear_locking:
      return "shear_locking";
    case WarningCode::folded_element:
      return "folded_element";
    case WarningCode::unbalanced_moment:
      return "unbalanced_moment";
    case WarningCode::shared_place:
      return "shared_place";
    case WarningCode::soft_penalty:
      return "soft_penalty";
    case WarningCode::unstable:
      return "unstable";
    case WarningCode::branch_ends:
      return "branch_ends";
    case WarningCode::path_goes_on:
      return "path_goes_on";
    case WarningCode::non_unique:
      return "non_unique";
  }
  return "";
}

}  // namespace stickslip
