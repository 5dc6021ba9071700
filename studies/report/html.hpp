/// The few words of HTML the report is written in. Everything that comes from a record passes through here.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "studies/io/numerals.hpp"
#include "studies/io/printing.hpp"

namespace stickslip::report {

/// escape(), with numbers such as 2e-4 kept on one line, together with units such as "0.5 s", and without the noughts
/// of 2e-04.
std::string escape_sentence(std::string_view text);

/// `value` as JSON that may stand inside <script type="application/json">: every '<' is written \u003c, so no text of a
/// record can close the element. Bytes that are not UTF-8 become U+FFFD.
std::string embed(const nlohmann::json& value);

/// `code` as it may stand inside <script>: "</script" and "<!--" are broken by a backslash, which changes no string
/// literal and no regular expression.
std::string embed_script(std::string_view code);

/// `text` as an HTML id or a file's name: small letters and digits; what else stands between them becomes one '-'.
std::string slug(std::string_view text);

using stickslip::exact_number;
using stickslip::number;

/// A text with the numbers that follow a '=' in the style of exact_number().
std::string with_exact_numbers(const std::string& text);

/// A name of the records with blanks: "converged at roundoff".
std::string in_plain_words(std::string name);

/// A count, whole.
std::string whole(double count);

/// JSON as a short text: a string bare, a number by number() or, of a whole one, all digits, null "", anything else
/// dumped.
std::string plain(const nlohmann::json& value);

/// A table. Cells are plain text and are escaped here; a cell that reads as a number, and the head of a column
/// of numbers, are set flush right; a column without any entry is left out.
struct Table {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> row_classes;  ///< empty, or one a row
};
std::string to_html(const Table& table, std::string_view caption);

/// Takes out of a table of several rows the columns, but for the first, that say the same in each. What they say, as a
/// sentence ("The same in every row: scene a, cutbacks 0."); "" where there are none.
std::string take_out_constant_columns(Table& table);

/// The table without its constant columns, which a line above it names.
std::string compact_html(Table table, std::string_view caption);

/// <details> with a summary (escaped) around `content` (HTML).
std::string folded(std::string_view summary, std::string_view content);

}  // namespace stickslip::report
