#include "studies/input/ranges.hpp"

#include <stdexcept>

namespace stickslip {
namespace {

struct RangeWords {
  Rule rule;
  const char* schema;
};

RangeWords words_of(Range range) {
  switch (range) {
    case Range::any:
      return {any_number, R"({"type": "number"})"};
    case Range::positive:
      return {positive, R"({"$ref": "#/$defs/positive"})"};
    case Range::not_negative:
      return {not_negative, R"({"$ref": "#/$defs/not_negative"})"};
    case Range::poisson_ratio:
      return {poisson_ratio, R"({"title": "number > -1 and < 0.5", "type": "number",
        "exclusiveMinimum": -1, "exclusiveMaximum": 0.5})"};
    case Range::below_one:
      return {below_one, R"({"type": "number", "exclusiveMinimum": 0, "exclusiveMaximum": 1})"};
    case Range::above_one:
      return {above_one, R"({"type": "number", "exclusiveMinimum": 1})"};
  }
  throw std::logic_error("no range");
}

}  // namespace

Rule rule_of(Range range) { return words_of(range).rule; }

nlohmann::ordered_json schema_of(Range range) { return nlohmann::ordered_json::parse(words_of(range).schema); }

}  // namespace stickslip
