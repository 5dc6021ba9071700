/// A JSON text that remembers where each of its values stands, and the faults found in it.
///
/// Every fault is one line, `FILE:LINE:COL: POINTER: what is wrong`, and all of them are collected: a reader goes on
/// after a fault. Columns count characters, from 1.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stickslip {

/// Where a value was given: a place in a file, or an override (which has no lines).
struct Place {
  std::string source;  ///< file as the user named it, or "--set /a/b=1"
  int line = 0;        ///< from 1; 0: the source has no lines
  int column = 0;
  std::string pointer = {};  ///< of the value in this source, where it is not the one of the document that holds it
};

struct Diagnostic {
  Place place;
  std::string pointer;  ///< JSON pointer of the value; empty: the whole file
  std::string message;

  /// "FILE:LINE:COL: POINTER: MESSAGE", each part where it is known.
  std::string text() const;
};

/// Faults, which make the input invalid, and notes, which do not.
class Diagnostics {
 public:
  /// A fault that is there already, in the same words, is not added again.
  void error(Diagnostic);
  void note(Diagnostic);
  bool has_errors() const { return !errors_.empty(); }
  std::size_t error_count() const { return errors_.size(); }
  /// True where a fault names this pointer or a value inside it.
  bool has_error_in(const std::string& pointer) const;
  /// Sources in the order they were met, each from its first line to its last.
  std::vector<Diagnostic> errors() const;
  const std::vector<Diagnostic>& notes() const { return notes_; }
  /// errors() as text, one line each.
  std::string text() const;

 private:
  std::vector<Diagnostic> errors_, notes_;
};

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
  /// text. The pointer must exist and may not name an object; otherwise that is a fault and nothing changes.
  void override_value(const std::string& assignment, Diagnostics&);

 private:
  using Position = std::pair<int, int>;  // line, column
  std::string file_;
  nlohmann::json root_;
  std::map<std::string, Position> values_, keys_;
  std::map<std::string, Place> origins_;  // of values put in by set()

  friend class PositionReader;
};

/// The pointer of a member or element: `/` in a key becomes `~1`, `~` becomes `~0` (RFC 6901).
std::string child_pointer(const std::string& parent, std::string_view key);
/// The value of a pointer; null where there is none or the text is no pointer.
const nlohmann::json* value_at(const nlohmann::json& root, const std::string& pointer);
/// What a pointer misses: "" where it names a value, else what is wrong with it and the nearest that exists.
std::string pointer_fault(const nlohmann::json& root, const std::string& pointer);

/// Text of a value for a message, at most about 40 characters.
std::string shown(const nlohmann::json& value);
/// "NAME" in quotes.
std::string in_quotes(std::string_view name);
/// Names as a list: "a, b, c".
std::string listed(const std::vector<std::string>& names);
/// ` did you mean "NAME"?` with the nearest of the names, where at most two letters differ (a swap counts
/// as one); otherwise "".
std::string suggestion(std::string_view name, const std::vector<std::string>& names);

/// 64-bit FNV-1a hash of a text, 16 hexadecimal digits. [Fowler, Noll, Vo; RFC draft-eastlake-fnv]
std::string fingerprint(std::string_view text);

}  // namespace stickslip
