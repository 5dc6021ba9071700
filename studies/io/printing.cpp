#include "studies/io/printing.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <iostream>
#include <limits>
#include <nlohmann/json.hpp>

namespace stickslip {
namespace {

/// A character at the beginning of a text. bytes: how many it takes; 0 where it is not UTF-8.
struct Character {
  std::uint32_t code = 0;
  std::size_t bytes = 0;
};

Character first_character(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  if (byte(0) < 0x80) return {byte(0), 1};
  const std::size_t bytes = byte(0) >= 0xF0 ? 4 : byte(0) >= 0xE0 ? 3 : 2;
  if (byte(0) < 0xC2 || byte(0) > 0xF4 || text.size() < bytes) return {};
  std::uint32_t code = byte(0) & (0xFFu >> (bytes + 1));
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return {};
    code = code << 6 | (byte(i) & 0x3Fu);
  }
  const bool overlong = (bytes == 3 && code < 0x800) || (bytes == 4 && code < 0x10000);
  if (overlong || (code >= 0xD800 && code < 0xE000) || code > 0x10FFFF) return {};
  return {code, bytes};
}

/// Control characters of ASCII and Latin-1, ends of lines and paragraphs, what turns the direction of writing, and the
/// two codes that no XML file may hold.
bool acts_on_the_terminal(std::uint32_t code) {
  return code < 0x20 || (code >= 0x7F && code < 0xA0) || code == 0x200E || code == 0x200F ||
         (code >= 0x2028 && code <= 0x202E) || (code >= 0x2066 && code <= 0x2069) || code == 0xFFFE || code == 0xFFFF;
}

/// `kept`: control characters that stay.
std::string printed(std::string_view text, std::string_view kept) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const Character c = first_character(text);
    const std::size_t bytes = c.bytes > 0 ? c.bytes : 1;
    if (c.bytes == 0)
      out += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[0]));
    else if (kept.find(text[0]) != std::string_view::npos)
      out += text[0];
    else if (c.code == '\n')
      out += "\\n";
    else if (c.code == '\t')
      out += "\\t";
    else if (acts_on_the_terminal(c.code))
      out += fmt::format("\\u{:04x}", c.code);
    else
      out += text.substr(0, bytes);
    text.remove_prefix(bytes);
  }
  return out;
}

std::string replaced(std::string_view text, char from, std::string_view to) {
  std::string out;
  for (const char c : text) c == from ? out += to : out += c;
  return out;
}

}  // namespace

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t bytes = first_character(text).bytes;
    if (bytes == 0) return false;
    text.remove_prefix(bytes);
  }
  return true;
}

std::string printable(std::string_view text) { return printed(text, ""); }

std::string printable_lines(std::string_view text) { return printed(text, "\n"); }

std::string json_text(const nlohmann::json& value, int indent) {
  return value.dump(indent, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string wrapped(const std::vector<std::string>& pieces, std::string_view between, std::size_t indent,
                    std::size_t width) {
  std::string text;
  std::size_t length = 0;  // of the last line
  for (const auto& piece : pieces) {
    const bool first = &piece == pieces.data();
    if (!first && length + between.size() + piece.size() > width) {
      text += "\n" + std::string(indent, ' ');
      length = indent;
    } else if (!first) {
      text += between;
      length += between.size();
    }
    text += piece;
    length += piece.size();
  }
  return text;
}

std::string wrapped_lines(std::string_view text, std::size_t indent, std::size_t width) {
  std::string out;
  std::vector<std::string> words(1);
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto is = [&](std::size_t at, char c) { return at < text.size() && text[at] == c; };
    const bool single = i > 0 && is(i, ' ') && !is(i - 1, ' ') && !is(i + 1, ' ');
    if (text[i] == '\n') {
      out += wrapped(words, " ", indent, width) + "\n";
      words.assign(1, "");
    } else if (single) {
      words.emplace_back();
    } else {
      words.back() += text[i];
    }
  }
  return out + wrapped(words, " ", indent, width);
}

namespace {

/// Where a line that is too wide is broken: before the last column or word that has room, else behind a comma; its end
/// where there is no such place behind `indent`.
std::size_t break_of(std::string_view line, std::size_t indent, std::size_t width) {
  const auto begins_gap = [&](std::size_t i) { return line[i] == ' ' && line[i - 1] != ' '; };
  for (std::size_t i = width; i > indent; --i)
    if (begins_gap(i)) return i;
  const std::size_t comma = line.substr(0, width).rfind(',');
  return comma == std::string_view::npos || comma < indent ? line.size() : comma + 1;
}

std::size_t width_of(int stream) {
  winsize size{};
  const bool known = ::isatty(stream) == 1 && ::ioctl(stream, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return known ? size.ws_col : std::numeric_limits<std::size_t>::max() / 2;
}

}  // namespace

std::string wrapped_rows(std::string_view text, std::size_t indent, std::size_t width) {
  std::string out;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string line(text.substr(0, end));
    for (std::size_t at = 0; line.size() > width && (at = break_of(line, indent, width)) < line.size();) {
      out += line.substr(0, at) + "\n";
      const bool one_space = line[at] == ' ' && at + 1 < line.size() && line[at + 1] != ' ';  // between words
      line = std::string(indent, ' ') + line.substr(one_space ? at + 1 : at);
    }
    out += line;
    if (end < text.size()) out += '\n';
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return out;
}

std::size_t terminal_width() { return width_of(STDOUT_FILENO); }

std::size_t terminal_width(const std::ostream& out) {
  return width_of(&out == &std::cout ? STDOUT_FILENO : &out == &std::cerr ? STDERR_FILENO : -1);
}

std::string shell_word(std::string_view word) {
  constexpr std::string_view plain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_@%+=:,./-";  // what bash leaves alone
  if (!word.empty() && word.find_first_not_of(plain) == std::string_view::npos) return std::string(word);
  if (printable(word) == word) return "'" + replaced(word, '\'', "'\\''") + "'";
  std::string out = "$'";
  for (const char c : word) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte >= 0x7F)
      out += fmt::format("\\x{:02x}", byte);
    else
      out += (c == '\'' || c == '\\' ? "\\" : "") + std::string(1, c);
  }
  return out + "'";
}

std::string csv_text(std::string_view text) {
  const bool formula = !text.empty() && std::string_view("=+-@\t\r").find(text[0]) != std::string_view::npos;
  const std::string cell = (formula ? "'" : "") + printed(text, "\n\t");
  if (cell.find_first_of(",\"\r\n") == std::string::npos) return cell;
  return '"' + replaced(cell, '"', "\"\"") + '"';
}

std::string escape(std::string_view text) {
  std::string out = replaced(printable_lines(text), '&', "&amp;");
  for (const auto& [character, entity] : {std::pair{'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}, {'\'', "&#39;"}})
    out = replaced(out, character, entity);
  return out;
}

}  // namespace stickslip
