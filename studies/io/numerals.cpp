#include "studies/io/numerals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "studies/io/printing.hpp"

namespace stickslip {

std::string number(double value, int digits) {
  if (!std::isfinite(value)) return {};
  if (value == 0) return "0";
  std::string text = fmt::format("{:.{}e}", value, digits - 1);
  const std::size_t e = text.find('e');
  const int power = std::atoi(text.c_str() + e + 1);
  if (power >= digits && power < 4) return fmt::format("{:.0f}", value);  // (99.6 has the power of 100)
  if (power >= -3 && power < 4) return fmt::format("{:.{}g}", value, digits);
  text.erase(e);
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return text + "e" + std::to_string(power);
}

std::string exact_number(double value) {
  constexpr int most = 17;  // significant digits that tell any two numbers apart
  int digits = 1;
  while (digits < most && std::strtod(number(value, digits).c_str(), nullptr) != value) ++digits;
  return number(value, digits);
}

std::string with_power(const std::string& numeral) {
  const std::size_t e = numeral.find('e');
  if (e == std::string::npos) return numeral;
  const std::string factor = numeral.substr(0, e);
  std::string out = factor == "1" ? "10" : factor == "-1" ? "-10" : factor + "·10";
  for (const char c : numeral.substr(e + 1)) out += raised[lowered.find(c)];
  return out;
}

std::string json_with_exact_numbers(const nlohmann::json& value) {
  if (value.is_number_float()) return exact_number(value.get<double>());
  if (!value.is_structured()) return json_text(value);
  std::string out;
  for (const auto& [key, entry] : value.items())
    out += (out.empty() ? "" : ",") + (value.is_object() ? json_text(key) + ":" : "") + json_with_exact_numbers(entry);
  return value.is_object() ? "{" + out + "}" : "[" + out + "]";
}

}  // namespace stickslip
