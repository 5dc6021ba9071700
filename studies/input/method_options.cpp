#include "studies/input/method_options.hpp"

#include <algorithm>
#include <type_traits>
#include <utility>

#include "studies/input/scene_reading.hpp"

namespace stickslip {
namespace {

using nlohmann::json;

constexpr Rule below_one{"a number > 0 and < 1", [](double x) { return x > 0 && x < 1; }};
constexpr Rule above_one{"a number > 1", [](double x) { return x > 1; }};

/// Values of an enumeration by name.
template <class E>
struct Words {
  std::vector<std::pair<std::string, E>> values;
};
/// Name of an option, its meaning, and values that show how it is written ("" where the default does), as JSON.
struct Option {
  const char *name, *about, *examples = "";
  operator const char*() const { return name; }
};

// One list of options a method; it serves reading, writing, describing and the names in messages. A number with a slot
// is a Number, one that only steers the iteration a double.

constexpr const char* rho_examples = R"(["auto", 100, {"absolute": 2400}])";
constexpr Option newton_option{"newton", "Newton's method within an increment"};

template <class Visitor>
void visit_options(NewtonOptions& newton, Visitor&& visit) {
  visit(Option{"tolerance", "residual at which it stops, relative to the scale of each residual"}, newton.tolerance,
        below_one);
  visit(Option{"max_iterations", "of each solve; beyond: status cap"}, newton.max_iterations);
  visit(Option{"line_search", "backtracking where a full step stays in its active set and the residual does not fall"},
        newton.line_search);
}

template <class Visitor>
void visit_options(Penalty& method, Visitor&& visit) {
  visit(Option{"stiffness", "penalty in multiples of the local nodal stiffness (auto: 1e3), or absolute", rho_examples},
        method.stiffness);
  visit(Option{"tangential_ratio", "tangential over normal penalty", "[0.5]"}, method.tangential_ratio);
  visit(newton_option, method.newton);
}

template <class Visitor>
void visit_options(UzawaAL& method, Visitor&& visit) {
  using Acceleration = UzawaAL::Acceleration;
  using Cone = UzawaAL::Cone;
  using Sensitivity = UzawaAL::Sensitivity;
  visit(
      Option{"scale", "rho in multiples of the local nodal stiffness (auto: 100, or 10 at finite strain), or absolute",
             rho_examples},
      method.scale);
  visit(Option{"tolerance", "relative error left in the multiplier, and violation, at which the updates stop"},
        method.tolerance, below_one);
  visit(Option{"max_augmentations", "of an increment; beyond: status cap, with the last iterate as the result"},
        method.max_augmentations);
  visit(Option{"adapt", "multiplies rho by 4 where an augmentation left more than a quarter of the violation"},
        method.adapt);
  visit(Option{"acceleration", "extrapolation of the updates; anderson takes several of the last, aitken two"},
        method.acceleration,
        Words<Acceleration>{
            {{"none", Acceleration::none}, {"aitken", Acceleration::aitken}, {"anderson", Acceleration::anderson}}});
  visit(
      Option{"cone", "frozen: radius of the last augmentation, symmetric; fails where friction is large, and says so"},
      method.cone, Words<Cone>{{{"augmented", Cone::augmented}, {"frozen", Cone::frozen}}});
  visit(Option{"sensitivity", "scheme of the derivatives"}, method.sensitivity,
        Words<Sensitivity>{{{"iterated", Sensitivity::iterated},
                            {"truncated", Sensitivity::truncated},
                            {"oversized", Sensitivity::oversized},
                            {"preconditioned", Sensitivity::preconditioned}}});
  visit(Option{"oversize", "factor on rho of the schemes oversized (auto: 1e3) and preconditioned", R"(["auto", 1e4])"},
        method.oversize, above_one);
  visit(newton_option, method.newton);
}

template <class Visitor>
void visit_options(MonolithicAL& method, Visitor&& visit) {
  using Cone = MonolithicAL::Cone;
  visit(Option{"scale", "rho in multiples of the local nodal stiffness (auto: 1), or absolute", rho_examples},
        method.scale);
  visit(Option{"cone", "radius by the trial pressure, or by the multiplier: same solution, another path"}, method.cone,
        Words<Cone>{{{"augmented", Cone::augmented}, {"multiplier", Cone::multiplier}}});
  visit(newton_option, method.newton);
}

/// Names of the options of a method, or of newton.
template <class Options>
std::vector<std::string> option_names() {
  std::vector<std::string> names;
  Options options;
  visit_options(options, [&](const char* name, auto&&...) { names.emplace_back(name); });
  return names;
}

/// Calls f(M{}) for each method of the closed set.
template <class F, std::size_t... I>
void for_each_method(F&& f, std::index_sequence<I...>) {
  (f(std::variant_alternative_t<I, Method>{}), ...);
}
template <class F>
void for_each_method(F&& f) {
  for_each_method(std::forward<F>(f), std::make_index_sequence<std::variant_size_v<Method>>{});
}

/// Reads the options of one object.
struct Reader {
  const JsonNode& node;
  SceneReading& reading;

  void operator()(const char* name, Regularisation& option) {
    const auto given = node.find(name);
    if (!given || given->value() == "auto") return;
    if (given->value().is_object()) {
      option.kind = Regularisation::Kind::absolute;
      given->is_object({{"absolute"}});
      option.value = reading.required(*given, "absolute", positive);
    } else if (given->value().is_number()) {
      option.kind = Regularisation::Kind::relative;
      option.value = reading.number(*given, positive);
    } else {
      given->must_be(R"("auto", a number > 0 or {"absolute": a number > 0})");
    }
  }
  void operator()(const char* name, Number& option) { option = reading.optional(node, name, option.value, positive); }
  void operator()(const char* name, double& option, const Rule& rule) {
    if (const auto given = node.find(name)) option = reading.setting(*given, rule).value_or(option);
  }
  void operator()(const char* name, std::optional<double>& option, const Rule& rule) {
    const auto given = node.find(name);
    if (!given || given->value() == "auto") return;
    if (given->value().is_number())
      option = reading.setting(*given, rule);
    else
      given->must_be("\"auto\" or " + std::string(rule.text));
  }
  void operator()(const char* name, int& option) {
    if (const auto given = node.find(name)) option = reading.count(*given, 1).value_or(option);
  }
  void operator()(const char* name, bool& option) {
    if (const auto given = node.find(name)) option = given->boolean().value_or(option);
  }
  template <class E>
  void operator()(const char* name, E& option, const Words<E>& words) {
    const auto given = node.find(name);
    if (!given) return;
    std::vector<std::string> allowed;
    for (const auto& [word, unused] : words.values) allowed.push_back(word);
    const auto choice = given->choice(allowed);
    for (const auto& [word, value] : words.values)
      if (word == choice) option = value;
  }
  void operator()(const char* name, NewtonOptions& newton) {
    const auto given = node.find(name);
    if (given && given->is_object({{}, option_names<NewtonOptions>()})) visit_options(newton, Reader{*given, reading});
  }
};

/// Writes the options of one object.
struct Writer {
  json& object;

  void operator()(const char* name, const Regularisation& option) {
    switch (option.kind) {
      case Regularisation::Kind::automatic:
        object[name] = "auto";
        break;
      case Regularisation::Kind::relative:
        object[name] = option.value.value;
        break;
      case Regularisation::Kind::absolute:
        object[name] = {{"absolute", option.value.value}};
        break;
    }
  }
  void operator()(const char* name, const Number& option) { object[name] = option.value; }
  void operator()(const char* name, double option, const Rule&) { object[name] = option; }
  void operator()(const char* name, const std::optional<double>& option, const Rule&) {
    object[name] = option ? json(*option) : json("auto");
  }
  void operator()(const char* name, int option) { object[name] = option; }
  void operator()(const char* name, bool option) { object[name] = option; }
  template <class E>
  void operator()(const char* name, E option, const Words<E>& words) {
    for (const auto& [word, value] : words.values)
      if (value == option) object[name] = word;
  }
  void operator()(const char* name, NewtonOptions newton) {
    object[name] = json::object();
    visit_options(newton, Writer{object[name]});
  }
};

/// Describes the options of one object by JSON Schemas, with meaning, default and examples.
struct Describer {
  using Schema = nlohmann::ordered_json;
  Schema& properties;
  OptionLists lists;

  void add(const Option& option, const Schema& schema, const char* title, const Schema& standard) {
    Schema& own = properties[option.name];
    own["description"] = option.about;
    own["title"] = title;
    if (lists == OptionLists::refused)
      own.update(schema);
    else
      own["anyOf"] = {schema, {{"type", "array"}, {"minItems", 1}, {"items", schema}}};
    if (!standard.is_null()) own["default"] = standard;
    own["examples"] = *option.examples ? Schema::parse(option.examples) : Schema::array({standard});
  }
  void operator()(const Option& option, const Regularisation&) {
    const Schema number{{"type", "number"}, {"exclusiveMinimum", 0}};
    Schema absolute = Schema::object();
    Describer{absolute, lists}.add({"absolute", "rho itself (force per length cubed)", "[2400]"}, number, "number > 0",
                                   {});
    const Schema object{
        {"type", "object"}, {"required", {"absolute"}}, {"additionalProperties", false}, {"properties", absolute}};
    add(option, {{"anyOf", {{{"const", "auto"}}, number, object}}}, R"("auto", number > 0 or object)", "auto");
  }
  void operator()(const Option& option, const Number& value) {
    add(option, {{"type", "number"}, {"exclusiveMinimum", 0}}, "number > 0", value.value);
  }
  static Schema ruled(const Rule& rule) {
    Schema schema{{"type", "number"}, {"exclusiveMinimum", rule.holds(0.5) ? 0 : 1}};
    if (!rule.holds(1.5)) schema["exclusiveMaximum"] = 1;
    return schema;
  }
  void operator()(const Option& option, double value, const Rule& rule) { add(option, ruled(rule), rule.text, value); }
  void operator()(const Option& option, const std::optional<double>& value, const Rule& rule) {
    add(option, {{"anyOf", {{{"const", "auto"}}, ruled(rule)}}}, (R"("auto" or )" + std::string(rule.text)).c_str(),
        value ? Schema(*value) : Schema("auto"));
  }
  void operator()(const Option& option, int value) {
    add(option, {{"type", "integer"}, {"minimum", 1}}, "whole number >= 1", value);
  }
  void operator()(const Option& option, bool value) { add(option, {{"type", "boolean"}}, "true or false", value); }
  template <class E>
  void operator()(const Option& option, E value, const Words<E>& words) {
    Schema allowed = Schema::array(), standard;
    for (const auto& [word, each] : words.values) {
      allowed.push_back(word);
      if (each == value) standard = word;
    }
    add(option, {{"enum", allowed}}, "one of the words", standard);
  }
  void operator()(const Option& option, NewtonOptions newton) {
    Schema own = Schema::object();
    visit_options(newton, Describer{own, lists});
    properties[option.name] = {{"description", option.about},
                               {"type", "object"},
                               {"examples", {{{"max_iterations", 50}}}},
                               {"additionalProperties", false},
                               {"properties", own}};
  }
};

bool has(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Reports the keys that are no options of the method, each with where it belongs.
void check_option_names(const JsonNode& node, const std::string& method, const std::vector<std::string>& own) {
  for (const auto& [key, option] : node.members()) {
    if (has(own, key)) continue;
    std::vector<std::string> others;
    for_each_method([&, &key = key]<class M>(const M&) {
      if (has(option_names<M>(), key)) others.emplace_back(M::name);
    });
    std::string message;
    if (!others.empty())
      message = in_quotes(key) + " is an option of " + listed(others) + ", not of " + method + ";";
    else if (has(option_names<NewtonOptions>(), key))
      message = in_quotes(key) + R"( belongs inside "newton";)";
    else
      message = "unknown option " + in_quotes(key) + " of " + method + ";" + suggestion(key, own);
    option.error_at_key(message + " allowed: " + listed(own));
  }
}

/// Reports an oversize that the scheme of derivatives takes no notice of.
void check_oversize(const JsonNode& options, const UzawaAL& method) {
  const bool used = method.sensitivity == UzawaAL::Sensitivity::oversized ||
                    method.sensitivity == UzawaAL::Sensitivity::preconditioned;
  if (method.oversize && !used)
    options.find("oversize")->error_at_key(R"(belongs to the sensitivity "oversized" or "preconditioned")");
}

}  // namespace

const std::vector<std::string>& method_names() {
  static const auto all = [] {
    std::vector<std::string> names;
    names.reserve(std::variant_size_v<Method>);
    for_each_method([&](const auto& method) { names.emplace_back(method.name); });
    return names;
  }();
  return all;
}

void check_option_names(const JsonNode& options, const std::string& method) {
  for_each_method([&]<class M>(const M&) {
    if (method == M::name) check_option_names(options, method, option_names<M>());
  });
}

void check_option_values(const JsonNode& options, const std::string& method, Diagnostics& diagnostics) {
  MeshFiles none;
  SceneReading reading(diagnostics, {}, none);
  for_each_method([&]<class M>(M chosen) {
    if (method == M::name) visit_options(chosen, Reader{options, reading});
  });
}

std::optional<Method> default_method(const std::string& name) {
  std::optional<Method> found;
  for_each_method([&](const auto& method) {
    if (method.name == name) found = method;
  });
  return found;
}

std::optional<Method> read_method(const JsonNode& node, SceneReading& reading) {
  const auto kind = node.kind(method_names());
  if (!kind) return std::nullopt;
  const auto& [name, options] = *kind;
  if (!options.is_map("the options of " + name)) return std::nullopt;
  const std::size_t faults = reading.diagnostics.error_count();
  Method method = *default_method(name);
  std::visit(
      [&, &name = name, &options = options]<class M>(M& chosen) {
        check_option_names(options, name, option_names<M>());
        visit_options(chosen, Reader{options, reading});
        if (reading.diagnostics.error_count() > faults) return;
        if constexpr (std::is_same_v<M, UzawaAL>) check_oversize(options, chosen);
        if (const auto [option, reason] = chosen.conflict(); !option.empty())
          options.find(std::string(option))->error(std::string(reason));
      },
      method);
  if (reading.diagnostics.error_count() > faults) return std::nullopt;
  return method;
}

nlohmann::ordered_json method_schema(OptionLists lists) {
  using Schema = nlohmann::ordered_json;
  Schema methods = Schema::object();
  for_each_method([&]<class M>(M method) {
    Schema options = Schema::object();
    visit_options(method, Describer{options, lists});
    methods[std::string(M::name)] = {{"description", "all options may be left out"},
                                     {"type", "object"},
                                     {"examples", {Schema::object()}},
                                     {"additionalProperties", false},
                                     {"properties", options}};
  });
  return {{"type", "object"},   {"title", "one of the following"}, {"minProperties", 1},
          {"maxProperties", 1}, {"additionalProperties", false},   {"properties", methods}};
}

json to_json(const Method& method) {
  json options = json::object();
  Method copy = method;
  std::visit([&](auto& chosen) { visit_options(chosen, Writer{options}); }, copy);
  return {{std::string(name_of(method)), options}};
}

}  // namespace stickslip
