/// Ranges of numbers (core/algebra/number.hpp) as files are held to them and as their schema says them.
#pragma once

#include <nlohmann/json.hpp>

#include "core/algebra/number.hpp"
#include "studies/io/json_node.hpp"

namespace stickslip {

Rule rule_of(Range);

/// The part of the schema of a number that says its range.
nlohmann::ordered_json schema_of(Range);

}  // namespace stickslip
