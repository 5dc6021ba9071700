/// A JSON text that remembers where each of its values stands.
#pragma once

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "studies/io/diagnostics.hpp"
#include "studies/io/json_pointer.hpp"
#include "studies/io/wording.hpp"

namespace stickslip {

class JsonDocument {
 public:
  /// The document of a text, with `//` and `/* */` comments; none where it is not JSON or where an object has a key
  /// twice. Numbers beyond the range of a double are faults, as are NaN and Infinity.
  static std::optional<JsonDocument> parse(std::string_view text, const std::string& file, Diagnostics&);

  /// A document that no file holds. Faults in it name `source` and have no lines.
  static JsonDocument of(nlohmann::json value, const std::string& source);

  /// The document of a file; a file that cannot be read is a fault.
  static std::optional<JsonDocument> read(const std::string& file, Diagnostics&);

  const std::string& file() const { return file_; }
  const nlohmann::json& root() const { return root_; }

  /// Where the value of a pointer begins; that of the nearest value around it where there is none.
  Place place(const std::string& pointer) const;
  /// Where the key of a pointer begins; place() for elements of arrays.
  Place key_place(const std::string& pointer) const;

  /// Puts a value at a pointer, made where its parent is an object; place() then gives `origin` for all of it.
  /// pre: the parent exists.
  void set(const std::string& pointer, nlohmann::json value, Place origin);
  /// Takes a value out of an object. pre: the pointer exists.
  void remove(const std::string& pointer);

  /// Carries out an override "POINTER=VALUE". VALUE is JSON; where the document holds a string it may also be bare
  /// text. The pointer, or the object around it, must exist, and it may not name an object; else nothing changes.
  void override_value(const std::string& assignment, Diagnostics&);

 private:
  /// Of the value that set() put at the pointer or around it.
  std::optional<Place> origin(const std::string& pointer) const;

  using Position = std::pair<int, int>;  // line, column
  std::string file_;
  nlohmann::json root_;
  struct Positions {
    std::map<std::string, Position> values, keys;
  };
  std::shared_ptr<const Positions> positions_ = std::make_shared<const Positions>();  // in the file; copies share them
  std::map<std::string, Place> origins_;  // of values put in by set(): these hide the positions below

  friend class PositionReader;
};

/// 64-bit FNV-1a hash of a text, 16 hexadecimal digits. [Fowler, Noll, Vo; RFC draft-eastlake-fnv]
std::string fingerprint(std::string_view text);

}  // namespace stickslip
