/// What a scene simulates and what it leaves out, in words; nothing is solved.
#pragma once

#include <string>

#include "studies/input/scene_reader.hpp"
#include "studies/run/case.hpp"

namespace stickslip {

/// Several lines: bodies, contacts, driving, unknowns, active effects, effects left out, cost to expect.
std::string explain(const Input& input, const Problem& problem);

}  // namespace stickslip
