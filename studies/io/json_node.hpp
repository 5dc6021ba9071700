/// Typed reading of a JSON document: each access that finds something else reports it, with what was given and what is
/// allowed, and returns nothing.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "studies/io/json_document.hpp"

namespace stickslip {

/// What a number must be; `text` completes "must be ...".
struct Rule {
  const char* text;
  bool (*holds)(double);
  const char* instead = "";  ///< follows `text` where a number breaks the rule: what to use
};
inline constexpr Rule any_number{"a number", [](double) { return true; }};
inline constexpr Rule positive{"a number > 0", [](double x) { return x > 0; }};
inline constexpr Rule not_negative{"a number >= 0", [](double x) { return x >= 0; }};
inline constexpr Rule below_one{"a number > 0 and < 1", [](double x) { return x > 0 && x < 1; }};
inline constexpr Rule above_one{"a number > 1", [](double x) { return x > 1; }};
inline constexpr Rule poisson_ratio{
    "a number > -1 and < 0.5", [](double nu) { return nu > -1 && nu < 0.5; },
    R"(; for a body that keeps its volume take 0.499 and "element": "Q4_mean_dilatation", )"
    R"("Q8" or "T6")"};

/// Keys of an object.
struct Keys {
  std::vector<std::string> required;
  std::vector<std::string> optional = {};
  std::vector<std::string> later = {};  ///< part of the format, but not available in this version
};

/// One value of a document. It holds references: document and diagnostics must outlive it.
class JsonNode {
 public:
  JsonNode(const JsonDocument& document, Diagnostics& diagnostics)
      : document_(&document), diagnostics_(&diagnostics), value_(&document.root()) {}

  const nlohmann::json& value() const { return *value_; }
  const std::string& pointer() const { return pointer_; }
  Place place() const { return document_->place(pointer_); }

  /// Reports a fault of this value, at the value or at its key.
  void error(const std::string& message) const;
  void error_at_key(const std::string& message) const;
  /// Reports "is VALUE; must be WHAT".
  void must_be(const std::string& what) const;

  /// The member or element; none where there is none.
  std::optional<JsonNode> find(const std::string& key) const;
  /// Members by name, or elements in order. pre: an object; an array.
  std::vector<std::pair<std::string, JsonNode>> members() const;
  std::vector<JsonNode> elements() const;

  /// True where the value is an object; keys that are missing, unknown or for later are reported.
  bool is_object(const Keys& keys) const;
  /// True where the value is an object, whose keys are names of the user's.
  bool is_map(const std::string& of_what) const;
  /// The one key of an object that is in `kinds`, besides any of `others`; reported where it is not just one.
  std::optional<std::pair<std::string, JsonNode>> kind(const std::vector<std::string>& kinds,
                                                       const std::vector<std::string>& later = {},
                                                       const std::vector<std::string>& others = {}) const;

  std::optional<double> number(const Rule& rule) const;
  /// A whole number from `least` to `most`; ten million is the most that counts of anything may be.
  std::optional<int> count(int least, int most = 10'000'000) const;
  std::optional<bool> boolean() const;
  std::optional<std::string> text() const;
  std::optional<std::string> choice(const std::vector<std::string>& allowed,
                                    const std::vector<std::string>& later = {}) const;
  /// Sets an enumerator by its word; the words are in the order of the enumeration. Any other text is reported.
  template <class E, std::size_t n>
  void word(E& to, const std::array<const char*, n>& words) const {
    const auto given = choice({words.begin(), words.end()});
    for (std::size_t i = 0; i < n; ++i)
      if (given == words[i]) to = static_cast<E>(i);
  }
  /// The elements of an array of this size (`what` completes "must be ...").
  std::optional<std::vector<JsonNode>> array(std::size_t size, const std::string& what) const;

 private:
  const JsonDocument* document_;
  Diagnostics* diagnostics_;
  const nlohmann::json* value_;
  std::string pointer_;
};

/// `"NAME" is not available in this version; allowed: a, b`.
std::string unavailable(const std::string& name, const std::vector<std::string>& allowed);

}  // namespace stickslip
