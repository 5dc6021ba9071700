/// The faults found in an input.
///
/// Every fault is one line, `FILE:LINE:COL: POINTER: what is wrong`, and all of them are collected: a reader goes on
/// after a fault. Columns count characters, from 1.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <unordered_set>
#include <vector>

#include "studies/io/caller.hpp"

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

  /// "FILE:LINE:COL: POINTER: MESSAGE", each part where it is known, in one printable line.
  std::string text() const;
};

/// Faults, which make the input invalid, and notes, which do not.
class Diagnostics {
 public:
  Diagnostics() = default;
  /// `caller`: who reads them.
  explicit Diagnostics(const Caller& caller) : caller_(&caller) {}
  const Caller& caller() const { return *caller_; }
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
  /// errors() as text, one line each; of more than 100 the first 100, and how many more there are.
  std::string text() const;
  /// The same of the notes, each after "note: ".
  std::string notes_text() const;

 private:
  const Caller* caller_ = &command_line;
  std::vector<Diagnostic> errors_, notes_;
  std::unordered_set<std::string> texts_;  ///< of errors_
  std::set<std::string> pointers_;         ///< of errors_
};

}  // namespace stickslip
