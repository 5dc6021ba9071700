/// The words of a mesh file, one after another, each with its place in the text.
#pragma once

#include <charconv>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <type_traits>

#include "core/mesh/decimal.hpp"

namespace stickslip {

/// What is wrong with the form of a file. Thrown by MshTokens, caught by parse_msh.
struct MshFault {
  std::size_t offset;  ///< in the text
  std::string message;
};

/// A word of the text and where it begins.
struct MshToken {
  std::size_t offset;
  std::string_view text;
};

/// Words of the text in order. `what` names what should stand there, for the message of a fault.
class MshTokens {
 public:
  explicit MshTokens(std::string_view text) : text_(text) {}

  bool at_end() { return offset() == text_.size(); }

  /// Where the next word begins.
  std::size_t offset() {
    while (here_ < text_.size() && is_space(text_[here_])) ++here_;
    return here_;
  }

  MshToken next(const std::string& what) {
    if (at_end()) throw MshFault{text_.size(), "the file ends where " + what + " should stand: it is truncated"};
    const std::size_t start = here_;
    while (here_ < text_.size() && !is_space(text_[here_])) ++here_;
    return {start, text_.substr(start, here_ - start)};
  }

  long long integer(const std::string& what) { return number<long long>(what, "a whole number"); }

  double real(const std::string& what) {
    const std::size_t start = offset();
    const double x = number<double>(what, "a number");
    if (!std::isfinite(x)) throw MshFault{start, what + " is not finite"};
    return x;
  }

  long long count(const std::string& what) {
    const std::size_t start = offset();
    const long long n = integer(what);
    if (n < 0) throw MshFault{start, what + " is negative"};
    return n;
  }

  std::string quoted(const std::string& what) {
    if (at_end() || text_[here_] != '"') throw MshFault{here_, what + " should stand here, in double quotes"};
    const std::size_t end = text_.find('"', here_ + 1);
    if (end == std::string_view::npos) throw MshFault{here_, "the quote of " + what + " is not closed"};
    std::string name(text_.substr(here_ + 1, end - here_ - 1));
    here_ = end + 1;
    return name;
  }

  /// The word must be `keyword`, the end of a section whose header announced what has been read.
  void close(const std::string& keyword, const std::string& announced) {
    const MshToken token = next(keyword);
    if (token.text != keyword)
      throw MshFault{token.offset,
                     keyword + " should stand here, after " + announced + " announced; found " + shown(token)};
  }

  void skip_section(const std::string& keyword) {
    while (next(keyword).text != keyword) {
    }
  }

  static std::string shown(const MshToken& token) { return "\"" + std::string(token.text.substr(0, 40)) + "\""; }

 private:
  static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

  template <class Value>
  Value number(const std::string& what, const char* kind) {
    const MshToken token = next(what);
    if constexpr (std::is_same_v<Value, double>) {
      if (const auto value = decimal(token.text)) return *value;
    } else {
      Value value{};
      const auto [end, error] = std::from_chars(token.text.data(), token.text.data() + token.text.size(), value);
      if (error == std::errc() && end == token.text.data() + token.text.size()) return value;
    }
    const char* hint = token.text.front() == '$' ? ": the section has fewer entries than announced" : "";
    throw MshFault{token.offset, what + " should stand here, " + kind + "; found " + shown(token) + hint};
  }

  std::string_view text_;
  std::size_t here_ = 0;
};

}  // namespace stickslip
