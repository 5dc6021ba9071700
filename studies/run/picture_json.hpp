/// The picture.json that the report draws.
#pragma once

#include <nlohmann/json.hpp>

#include "studies/run/case.hpp"

namespace stickslip {

/// The last step as the report's picture: points, elements, displacement, von Mises stress, contact points, obstacles
/// as at the start with what they moved by since, and the kinds of the responses by name. `every`: as of
/// kept_moments(); of several, `frames` has what differs in each.
nlohmann::json picture_json(const CaseResult& result, int every = 0);

}  // namespace stickslip
