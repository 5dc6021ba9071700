/// Names of the kinds of responses.
#pragma once

#include <string_view>

#include "core/model/scene.hpp"

namespace stickslip {

/// The key of a kind of response in a scene file: "reaction", "contact_force", ...
std::string_view name_of(Response::Kind kind);

}  // namespace stickslip
