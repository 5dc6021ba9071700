#include "studies/report/html.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <regex>

namespace stickslip::report {

namespace {

std::string replace_all(std::string text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

bool reads_as_number(const std::string& text) {
  if (text.empty()) return false;
  char* end = nullptr;
  std::strtod(text.c_str(), &end);
  return *end == '\0';
}

/// Whether a column has entries, and numbers alone.
bool holds_numbers(const Table& table, std::size_t column) {
  bool any = false;
  for (const auto& row : table.rows) {
    if (row[column].empty()) continue;
    if (!reads_as_number(row[column])) return false;
    any = true;
  }
  return any;
}

}  // namespace

std::string escape_sentence(std::string_view text) {
  static const std::regex small(R"((\d[\d.]*e-)0*(\d+))");
  static const std::regex unit(R"((\d) (ms|s|%)(?!\w))");
  return std::regex_replace(std::regex_replace(escape(text), unit, "$1&nbsp;$2"), small,
                            "<span class=\"number\">$1$2</span>");
}

std::string embed(const nlohmann::json& value) {
  return replace_all(value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace), "<", "\\u003c");
}

std::string embed_script(std::string_view code) {
  return replace_all(replace_all(std::string(code), "</script", "<\\/script"), "<!--", "<\\!--");
}

std::string slug(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte))
      out += static_cast<char>(std::tolower(byte));
    else if (!out.empty() && out.back() != '-')
      out += '-';
  }
  if (!out.empty() && out.back() == '-') out.pop_back();
  return out;
}

std::string with_exact_numbers(const std::string& text) {
  std::string out;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t sign = text.find('=', from);
    if (sign == std::string::npos) return out + text.substr(from);
    const std::size_t end = std::min(text.find_first_of(" =,", sign + 1), text.size());
    const std::string value = text.substr(sign + 1, end - sign - 1);
    out += text.substr(from, sign + 1 - from);
    const double number = std::strtod(value.c_str(), nullptr);
    out += reads_as_number(value) && std::isfinite(number) ? exact_number(number) : value;
    from = end;
  }
  return out;
}

std::string in_plain_words(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

std::string whole(double count) { return fmt::format("{:.0f}", count); }

std::string plain(const nlohmann::json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_integer()) return value.dump();
  if (value.is_number()) return number(value.get<double>(), 6);
  if (value.is_null()) return {};
  return value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string to_html(const Table& table, std::string_view caption) {
  constexpr std::size_t short_text = 22;  // "converged at roundoff" stays on one line
  std::string out = fmt::format(
      "<div class=\"wide\" role=\"region\" tabindex=\"0\" aria-label=\"{0}\"><table>"
      "<caption>{0}</caption><thead><tr>",
      escape(caption));
  std::vector<bool> used(table.header.size(), table.rows.empty());
  for (const auto& row : table.rows)
    for (std::size_t i = 0; i < row.size(); ++i) used[i] = used[i] || !row[i].empty();
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i])
      out += (holds_numbers(table, i) ? "<th scope=\"col\" class=\"n\">" : "<th scope=\"col\">") +
             escape(table.header[i]) + "</th>";
  out += "</tr></thead><tbody>\n";
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const bool marked = i < table.row_classes.size() && !table.row_classes[i].empty();
    out += marked ? fmt::format("<tr class=\"{}\">", escape(table.row_classes[i])) : "<tr>";
    for (std::size_t j = 0; j < used.size(); ++j) {
      const std::string& cell = table.rows[i][j];
      if (used[j])
        out += reads_as_number(cell) ? "<td class=\"n\">" + escape(cell) + "</td>"
                                     : (j > 0 && cell.size() <= short_text ? "<td class=\"s\">" : "<td>") +
                                           escape_sentence(cell) + "</td>";
    }
    out += "</tr>\n";
  }
  return out + "</tbody></table></div>\n";
}

std::string take_out_constant_columns(Table& table) {
  if (table.rows.size() < 2) return {};
  std::string out;
  for (std::size_t column = table.header.size(); column-- > 1;) {
    const std::string value = table.rows.front()[column];
    if (std::any_of(table.rows.begin(), table.rows.end(), [&](const auto& row) { return row[column] != value; }))
      continue;
    if (!value.empty()) out = table.header[column] + " " + value + (out.empty() ? "" : ", " + out);
    const auto at = static_cast<std::ptrdiff_t>(column);
    table.header.erase(table.header.begin() + at);
    for (auto& row : table.rows) row.erase(row.begin() + at);
  }
  return out.empty() ? out : "The same in every row: " + out + ".";
}

std::string compact_html(Table table, std::string_view caption) {
  const std::string constant = take_out_constant_columns(table);
  return (constant.empty() ? "" : "<p class=\"note\">" + escape_sentence(constant) + "</p>\n") +
         to_html(table, caption);
}

std::string folded(std::string_view summary, std::string_view content) {
  return fmt::format("<details><summary>{}</summary>\n{}</details>\n", escape(summary), content);
}

}  // namespace stickslip::report
