#include "studies/io/json_node.hpp"

#include <algorithm>
#include <cmath>

namespace stickslip {
namespace {

bool has(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::vector<std::string> joined(std::vector<std::string> a, const std::vector<std::string>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

std::string unknown_key(const std::string& name, const std::vector<std::string>& allowed) {
  return "unknown key " + in_quotes(name) + ";" + suggestion(name, allowed) + " allowed: " + listed(allowed);
}

}  // namespace

std::string unavailable(const std::string& name, const std::vector<std::string>& allowed) {
  return in_quotes(name) + " is not available in this version; allowed: " + listed(allowed);
}

void JsonNode::error(const std::string& message) const { diagnostics_->error({place(), pointer_, message}); }

void JsonNode::error_at_key(const std::string& message) const {
  diagnostics_->error({document_->key_place(pointer_), pointer_, message});
}

void JsonNode::must_be(const std::string& what) const {
  // of a whole file of another kind, which may be none of the user's, no content is shown
  const bool foreign = pointer_.empty() && (value_->is_string() || value_->is_array());
  error("is " + (foreign ? (value_->is_string() ? "a text" : "an array") : shown(*value_)) + "; must be " + what);
}

std::optional<JsonNode> JsonNode::find(const std::string& key) const {
  const auto found = value_->find(key);
  if (found == value_->end()) return std::nullopt;
  JsonNode node = *this;
  node.value_ = &*found;
  node.pointer_ = child_pointer(pointer_, key);
  return node;
}

std::vector<std::pair<std::string, JsonNode>> JsonNode::members() const {
  std::vector<std::pair<std::string, JsonNode>> nodes;
  for (const auto& [name, unused] : value_->items()) nodes.emplace_back(name, *find(name));
  return nodes;
}

std::vector<JsonNode> JsonNode::elements() const {
  std::vector<JsonNode> nodes(value_->size(), *this);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    nodes[i].value_ = &(*value_)[i];
    nodes[i].pointer_ = child_pointer(pointer_, std::to_string(i));
  }
  return nodes;
}

bool JsonNode::is_object(const Keys& keys) const {
  const auto allowed = joined(keys.required, keys.optional);
  if (!value_->is_object()) {
    must_be("an object with the keys " + listed(allowed));
    return false;
  }
  for (const auto& [name, node] : members()) {
    if (has(keys.later, name))
      node.error_at_key(unavailable(name, allowed));
    else if (!has(allowed, name))
      node.error_at_key(unknown_key(name, allowed));
  }
  for (const std::string& name : keys.required)
    if (!value_->contains(name)) {
      std::string message = "the key " + in_quotes(name) + " is missing; required: " + listed(keys.required);
      if (!keys.optional.empty()) message += "; optional: " + listed(keys.optional);
      error(message);
    }
  return true;
}

bool JsonNode::is_map(const std::string& of_what) const {
  if (!value_->is_object()) must_be("an object, " + of_what);
  return value_->is_object();
}

std::optional<std::pair<std::string, JsonNode>> JsonNode::kind(const std::vector<std::string>& kinds,
                                                               const std::vector<std::string>& later,
                                                               const std::vector<std::string>& others) const {
  if (!value_->is_object()) {
    must_be("an object with one of the keys " + listed(kinds));
    return std::nullopt;
  }
  std::optional<std::pair<std::string, JsonNode>> found;
  bool wrong = false;
  for (const auto& [name, node] : members()) {
    if (has(others, name)) continue;
    if (has(later, name) && !has(kinds, name)) {
      node.error_at_key(unavailable(name, kinds));
    } else if (!has(kinds, name)) {
      node.error_at_key(unknown_key(name, joined(kinds, others)));
    } else if (found) {
      node.error_at_key(in_quotes(name) + " stands beside " + in_quotes(found->first) + "; only one is allowed of " +
                        listed(kinds));
    } else {
      found.emplace(name, node);
      continue;
    }
    wrong = true;
  }
  if (!found && !wrong) error("one of the keys is missing: " + listed(kinds));
  return wrong ? std::nullopt : found;
}

std::optional<double> JsonNode::number(const Rule& rule) const {
  if (value_->is_number())
    // a whole number with more digits than a double has is rounded, never infinite
    if (const double number = value_->get<double>(); rule.holds(number)) return number;
  must_be(value_->is_number() ? std::string(rule.text) + rule.instead : rule.text);
  return std::nullopt;
}

std::optional<int> JsonNode::count(int least, int most) const {
  if (value_->is_number()) {
    const double number = value_->get<double>();
    if (number >= least && number <= most && number == std::floor(number)) return static_cast<int>(number);
  }
  must_be("a whole number from " + std::to_string(least) + " to " + std::to_string(most));
  return std::nullopt;
}

std::optional<bool> JsonNode::boolean() const {
  if (value_->is_boolean()) return value_->get<bool>();
  must_be("true or false");
  return std::nullopt;
}

std::optional<std::string> JsonNode::text() const {
  if (value_->is_string()) return value_->get<std::string>();
  must_be("a text");
  return std::nullopt;
}

std::optional<std::string> JsonNode::choice(const std::vector<std::string>& allowed,
                                            const std::vector<std::string>& later) const {
  if (value_->is_string()) {
    const auto name = value_->get<std::string>();
    if (has(allowed, name)) return name;
    if (has(later, name))
      error(unavailable(name, allowed));
    else
      error("is " + in_quotes(name) + ";" + suggestion(name, allowed) + " allowed: " + listed(allowed));
    return std::nullopt;
  }
  must_be("one of " + listed(allowed));
  return std::nullopt;
}

std::optional<std::vector<JsonNode>> JsonNode::array(std::size_t size, const std::string& what) const {
  if (value_->is_array() && value_->size() == size) return elements();
  must_be(what);
  return std::nullopt;
}

}  // namespace stickslip
