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

/// Calls f(M{}) for each method of the closed set.
template <class F>
void for_each_method(F&& f) {
  for_each_alternative<Method>([&]<class M>(std::type_identity<M>) { f(M{}); });
}

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

/// What options have in their schema beside what all keys have: a title, an example and, where `lists` are swept, lists
/// of values.
void complete(nlohmann::ordered_json& options, OptionLists lists) {
  using Schema = nlohmann::ordered_json;
  for (auto& [key, own] : options.items()) {
    if (own.contains("properties")) {
      complete(own["properties"], lists);
      continue;
    }
    if (own.contains("enum")) own["title"] = "one of the words";
    if (own.value("type", "") == "boolean") own["title"] = "true or false";
    if (!own.contains("examples")) own["examples"] = Schema::array({own["default"]});
    if (lists == OptionLists::refused) continue;
    Schema all = Schema::object();
    for (const char* name : {"description", "title", "default", "examples"})
      if (own.contains(name)) {
        all[name] = own[name];
        own.erase(name);
      }
    if (own.contains("anyOf"))
      for (Schema& alternative : own["anyOf"])
        if (alternative.contains("properties")) complete(alternative["properties"], lists);
    all["anyOf"] = {own, {{"type", "array"}, {"minItems", 1}, {"items", own}}};
    own = all;
  }
}

bool has(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Reports the keys that are no options of the method, each with where it belongs.
void check_option_names(const JsonNode& node, const std::string& method, const std::vector<std::string>& own) {
  for (const auto& [key, option] : node.members()) {
    if (has(own, key)) continue;
    std::vector<std::string> others;
    for_each_method([&, &key = key]<class M>(const M&) {
      if (has(detail::allowed_keys<M>().optional, key)) others.emplace_back(M::name);
    });
    std::string message;
    if (!others.empty())
      message = in_quotes(key) + " is an option of " + listed(others) + ", not of " + method + ";";
    else if (has(detail::allowed_keys<NewtonOptions>().optional, key))
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
    if (method == M::name) check_option_names(options, method, detail::allowed_keys<M>().optional);
  });
}

void check_option_values(const JsonNode& options, const std::string& method, Diagnostics& diagnostics) {
  MeshFiles none;
  SceneReading reading(diagnostics, {}, none);
  for_each_method([&]<class M>(M chosen) {
    if (method == M::name) detail::read_keys(options, reading, chosen);
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
        check_option_names(options, name, detail::allowed_keys<M>().optional);
        detail::read_keys(options, reading, chosen);
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
  for_each_method([&]<class M>(const M&) {
    Schema options = schema_of_keys<M>().properties;
    complete(options, lists);
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
