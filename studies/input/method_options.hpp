/// Options of the methods in JSON: {"penalty": {"stiffness": 100}}.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "methods/options.hpp"

namespace stickslip {

class Diagnostics;
class JsonNode;
struct SceneReading;

/// Names of the closed set, in its order.
const std::vector<std::string>& method_names();

/// The method with its default options, without slots; none where there is none of this name.
std::optional<Method> default_method(const std::string& name);

/// The method an object with one key names; its numbers get slots. None where it is at fault.
std::optional<Method> read_method(const JsonNode&, SceneReading&);

/// Reports the keys among the options that are none of the method's, each with where it belongs.
void check_option_names(const JsonNode& options, const std::string& method);

/// Reports the values of options that are at fault, each by itself: nothing of how they go together.
void check_option_values(const JsonNode& options, const std::string& method, Diagnostics&);

/// Whether an option may be a list of values, as in the "methods" of a study.
enum class OptionLists { refused, swept };

/// JSON Schema of {"NAME": {options}}, options in the order of their list.
nlohmann::ordered_json method_schema(OptionLists);

/// {"NAME": {every option, as used}}.
nlohmann::json to_json(const Method&);

}  // namespace stickslip
