#include "studies/report/colors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace stickslip::report {
namespace {

using Rgb = std::array<double, 3>;  ///< 0 to 255

Rgb rgb(std::string_view color) {
  const auto part = [&](std::size_t at) { return std::stoi(std::string(color.substr(at, 2)), nullptr, 16); };
  return {static_cast<double>(part(1)), static_cast<double>(part(3)), static_cast<double>(part(5))};
}

/// Relative luminance, 0 black to 1 white. [WCAG 2.1, "relative luminance"]
double luminance(const Rgb& color) {
  const auto linear = [](double value) {
    const double s = value / 255;
    return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
  };
  return 0.2126 * linear(color[0]) + 0.7152 * linear(color[1]) + 0.0722 * linear(color[2]);
}

}  // namespace

double contrast(std::string_view a, std::string_view b) {
  const auto [low, high] = std::minmax({luminance(rgb(a)), luminance(rgb(b))});
  return (high + 0.05) / (low + 0.05);
}

std::string with_contrast(const std::string& color, std::string_view paper, double wanted) {
  const bool is_light = luminance(rgb(paper)) > 0.5, more = contrast(color, paper) < wanted;
  const double toward = is_light == more ? 0 : 255;  // black or white
  std::string best = color;
  constexpr int steps = 64;  // finer than the eye
  for (int i = 0; i <= steps; ++i) {
    Rgb mixed = rgb(color);
    for (double& part : mixed) part += (toward - part) * i / steps;
    const std::string text =
        fmt::format("#{:02X}{:02X}{:02X}", std::lround(mixed[0]), std::lround(mixed[1]), std::lround(mixed[2]));
    if (more ? contrast(best, paper) >= wanted : contrast(text, paper) < wanted) break;
    best = text;
  }
  return best;
}

std::string on_dark(const std::string& color) {
  constexpr double brighter = 1.15;  // lines on dark paper look thinner
  return with_contrast(color, dark_paper, std::max(brighter * contrast(color, light_paper), least_contrast));
}

}  // namespace stickslip::report
