/// Text from outside (names, paths, recorded messages) as it is printed, written to JSON or put on a command line.
#pragma once

#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stickslip {

/// True where the bytes are UTF-8 throughout (RFC 3629: no surrogates, nothing overlong).
bool is_utf8(std::string_view text);

/// The text in one line that moves no cursor and changes no colour: control characters, and those that turn the
/// direction of writing, as \n, \t or \u001b; bytes that are not UTF-8 as \xff.
std::string printable(std::string_view text);
/// The same, with the ends of lines left as they are.
std::string printable_lines(std::string_view text);

/// JSON in one line, or indented. Never throws: bytes that are not UTF-8 become U+FFFD.
std::string json_text(const nlohmann::json& value, int indent = -1);

/// Pieces in lines of at most `width` characters (bytes), a piece longer than that on a line of its own. `between`: put
/// between two of one line. Lines after the first begin with `indent` spaces.
std::string wrapped(const std::vector<std::string>& pieces, std::string_view between, std::size_t indent,
                    std::size_t width);

/// The same of each line of a text, broken at single spaces: where columns are apart by more, they stay together.
std::string wrapped_lines(std::string_view text, std::size_t indent, std::size_t width);

/// The same of each line that is wider, a row of a table too: its columns go on below, under one another as before.
/// What has no space is broken behind a comma.
std::string wrapped_rows(std::string_view text, std::size_t indent, std::size_t width);

/// Characters in a line of the terminal that standard output is; no bound where it is none, so files stay as they are.
std::size_t terminal_width();
/// The same of a stream: standard output or standard error; no bound of any other.
std::size_t terminal_width(const std::ostream& out);

/// A word as bash reads it again: as it is, in single quotes, or, where it holds what would not print, as $'...'.
std::string shell_word(std::string_view word);

/// The text of a cell of a CSV file, in double quotes where it needs them. What a spreadsheet would take for a formula
/// (it begins with = + - @ or a tab) gets an apostrophe before it, by which spreadsheets know text; control characters
/// but ends of lines and tabs are escaped.
std::string csv_text(std::string_view text);

/// printable_lines() with & < > " ' replaced by entities: safe in XML and HTML, as content and as an attribute.
std::string escape(std::string_view text);

}  // namespace stickslip
