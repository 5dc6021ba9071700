#include "studies/input/method_options.hpp"

#include <algorithm>
#include <type_traits>
#include <utility>

#include "studies/input/described.hpp"
#include "studies/input/scene_reading.hpp"

namespace stickslip {
namespace {

using nlohmann::json;

/// Calls visit(key, option, how) for each option of a method, or of newton.
template <class Options, class Visitor>
void visit_options(Options& options, Visitor&& visit) {
  std::apply([&](const auto&... key) { (visit(key, options.*key.member, key.how), ...); },
             std::remove_const_t<Options>::keys());
}

/// Names of the options of a method, or of newton.
template <class Options>
std::vector<std::string> option_names() {
  std::vector<std::string> names;
  std::apply([&](const auto&... key) { (names.emplace_back(key.key), ...); }, Options::keys());
  return names;
}

/// Calls f(M{}) for each method of the closed set.
template <class F>
void for_each_method(F&& f) {
  for_each_alternative<Method>([&]<class M>(std::type_identity<M>) { f(M{}); });
}

/// Reads the options of one object.
struct Reader {
  const JsonNode& node;
  SceneReading& reading;

  void operator()(const auto& key, Regularisation& option, const RhoOption&) {
    const auto given = node.find(key.key);
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
  void operator()(const auto& key, double& option, const Setting& how) {
    if (const auto given = node.find(key.key)) option = reading.setting(*given, rule_of(how.range)).value_or(option);
  }
  void operator()(const auto& key, std::optional<double>& option, const AutoOrSetting& how) {
    const auto given = node.find(key.key);
    if (!given || given->value() == "auto") return;
    const Rule rule = rule_of(how.range);
    if (given->value().is_number())
      option = reading.setting(*given, rule);
    else
      given->must_be("\"auto\" or " + std::string(rule.text));
  }
  void operator()(const auto& key, int& option, const AtLeastOne&) {
    if (const auto given = node.find(key.key)) option = reading.count(*given, 1).value_or(option);
  }
  void operator()(const auto& key, NewtonOptions& newton, const Nested&) {
    const auto given = node.find(key.key);
    if (given && given->is_object({{}, option_names<NewtonOptions>()})) visit_options(newton, Reader{*given, reading});
  }
  /// As of any struct of the scene.
  void operator()(const auto& key, auto& option, const auto& how) {
    detail::read_key(node, reading, key.key, option, how);
  }
};

/// Writes the options of one object.
struct Writer {
  json& object;

  void operator()(const auto& key, const Regularisation& option, const RhoOption&) {
    switch (option.kind) {
      case Regularisation::Kind::automatic:
        object[key.key] = "auto";
        break;
      case Regularisation::Kind::relative:
        object[key.key] = option.value.value;
        break;
      case Regularisation::Kind::absolute:
        object[key.key] = {{"absolute", option.value.value}};
        break;
    }
  }
  void operator()(const auto& key, const Number& option, const IfGiven&) { object[key.key] = option.value; }
  void operator()(const auto& key, const std::optional<double>& option, const AutoOrSetting&) {
    object[key.key] = option ? json(*option) : json("auto");
  }
  template <class E, std::size_t n>
  void operator()(const auto& key, E option, const std::array<const char*, n>& words) {
    object[key.key] = words[static_cast<std::size_t>(option)];
  }
  void operator()(const auto& key, const NewtonOptions& newton, const Nested&) {
    object[key.key] = json::object();
    visit_options(newton, Writer{object[key.key]});
  }
  /// A number, or true or false.
  void operator()(const auto& key, const auto& option, const auto&) { object[key.key] = option; }
};

/// Describes the options of one object by JSON Schemas, with meaning, default and examples.
struct Describer {
  using Schema = nlohmann::ordered_json;
  Schema& properties;
  OptionLists lists;

  /// `examples`: values that show how it is written; null: its default does.
  void add(const auto& key, const Schema& schema, const std::string& title, const Schema& standard,
           const Schema& examples = nullptr) {
    Schema& own = properties[key.key];
    own["description"] = key.about;
    own["title"] = title;
    if (lists == OptionLists::refused)
      own.update(schema);
    else
      own["anyOf"] = {schema, {{"type", "array"}, {"minItems", 1}, {"items", schema}}};
    if (!standard.is_null()) own["default"] = standard;
    own["examples"] = examples.is_null() ? Schema::array({standard}) : examples;
  }
  void operator()(const auto& key, const Regularisation&, const RhoOption&) {
    const Schema number = plain(Range::positive);
    Schema absolute = Schema::object();
    const Key own{&Regularisation::value, "absolute", "rho itself (force per length cubed)", RhoOption{}};
    Describer{absolute, lists}.add(own, number, "number > 0", {}, {2400});
    const Schema object{
        {"type", "object"}, {"required", {"absolute"}}, {"additionalProperties", false}, {"properties", absolute}};
    add(key, {{"anyOf", {{{"const", "auto"}}, number, object}}}, R"("auto", number > 0 or object)", "auto",
        {"auto", 100, {{"absolute", 2400}}});
  }
  void operator()(const auto& key, const Number& option, const IfGiven& how) {
    add(key, plain(how.range), "number > 0", option.value, Schema::array({how.example}));
  }
  void operator()(const auto& key, double option, const Setting& how) {
    add(key, schema_of(how.range), rule_of(how.range).text, option);
  }
  void operator()(const auto& key, const std::optional<double>& option, const AutoOrSetting& how) {
    add(key, {{"anyOf", {{{"const", "auto"}}, schema_of(how.range)}}},
        R"("auto" or )" + std::string(rule_of(how.range).text), option ? Schema(*option) : Schema("auto"),
        {"auto", how.example});
  }
  void operator()(const auto& key, int option, const AtLeastOne&) {
    add(key, {{"type", "integer"}, {"minimum", 1}}, "whole number >= 1", option);
  }
  void operator()(const auto& key, bool option, const Flag&) {
    add(key, {{"type", "boolean"}}, "true or false", option);
  }
  template <class E, std::size_t n>
  void operator()(const auto& key, E option, const std::array<const char*, n>& words) {
    add(key, {{"enum", words}}, "one of the words", words[static_cast<std::size_t>(option)]);
  }
  void operator()(const auto& key, const NewtonOptions& newton, const Nested&) {
    Schema own = Schema::object();
    visit_options(newton, Describer{own, lists});
    properties[key.key] = {{"description", key.about},
                           {"type", "object"},
                           {"examples", {{{"max_iterations", 50}}}},
                           {"additionalProperties", false},
                           {"properties", own}};
  }

 private:
  /// Without a reference to a definition.
  static Schema plain(Range) { return {{"type", "number"}, {"exclusiveMinimum", 0}}; }
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
  return one_of(methods);
}

json to_json(const Method& method) {
  json options = json::object();
  std::visit([&](const auto& chosen) { visit_options(chosen, Writer{options}); }, method);
  return {{std::string(name_of(method)), options}};
}

}  // namespace stickslip
