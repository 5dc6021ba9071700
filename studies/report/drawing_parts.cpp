#include "studies/report/drawing_parts.hpp"

#include <fmt/format.h>

#include <array>
#include <map>

#include "studies/report/drawing.hpp"

namespace stickslip::report {
namespace {

/// Named colours in the light scheme, those of page.css.
const std::map<std::string, std::string, std::less<>>& light() {
  static const std::map<std::string, std::string, std::less<>> colors = {
      {"ink", "#1b1d21"}, {"soft", "#5b616b"}, {"line", "#d5d8dd"}, {"paper", "#ffffff"}};
  return colors;
}

/// Widths of Helvetica's characters 32 to 126, thousandths of the size. [Adobe font metrics of Helvetica]
constexpr std::array<int, 95> helvetica = {
    278, 278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333,  278, 278, 556, 556, 556,
    556, 556, 556, 556, 556, 556, 556, 278, 278, 584, 584, 584, 556, 1015, 667, 667, 722, 722, 667,
    611, 778, 722, 278, 500, 667, 556, 833, 722, 778, 667, 778, 722, 667,  611, 722, 667, 944, 667,
    667, 611, 278, 278, 278, 469, 556, 333, 556, 556, 500, 556, 556, 278,  556, 556, 222, 222, 500,
    222, 833, 556, 556, 556, 556, 333, 500, 278, 556, 500, 722, 500, 500,  500, 334, 260, 334, 584};

}  // namespace

bool is_named(const std::string& color) { return light().count(color) > 0; }

std::string in_light(const std::string& color) {
  if (color.empty()) return "none";
  if (is_of_curve(color)) return color.substr(color.find('#'));
  const auto named = light().find(color);
  return named == light().end() ? color : named->second;
}

std::string short_number(double value) {
  std::string text = fmt::format("{:.2f}", value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

double text_width(std::string_view text, double size) {
  constexpr int other_letter = 556;
  double width = 0;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte & 0xC0) == 0x80) continue;  // a letter's first byte stands for it
    width += byte >= 32 && byte - 32u < helvetica.size() ? helvetica[byte - 32u] : other_letter;
  }
  return width * size / 1000;
}

}  // namespace stickslip::report
