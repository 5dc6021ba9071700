/// Colours "#RRGGBB" that stand out from the paper of a page, white or dark.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <utility>

namespace stickslip::report {

// Okabe and Ito's palette, which stays apart for all common forms of colour vision; without its yellow, which is lost
// on white. What cannot include this has copies that a test holds equal: studies/web/page.css and picture.js,
// python/stickslip/plots.py.
constexpr const char *vermilion = "#D55E00", *blue = "#0072B2", *green = "#009E73", *orange = "#E69F00",
                     *purple = "#CC79A7", *sky_blue = "#56B4E9";

constexpr std::pair<const char*, const char*> method_colors[] = {
    {"penalty", vermilion}, {"uzawa_al", blue}, {"monolithic_al", green}};
/// Of states of contact; closed: without friction.
constexpr const char *stick_color = blue, *slip_color = orange, *closed_color = "#5b616b", *open_color = "#ffffff";
/// Of stresses, light to dark, so that they read in grey too (the ends of Viridis, turned round).
inline constexpr std::array stress_colors = {"#f4f1de", "#d9e4a8", "#a8d483", "#6cbf80", "#3ba387",
                                             "#2a848c", "#31648c", "#3d4287", "#43176a"};

constexpr std::string_view light_paper = "#ffffff", dark_paper = "#16181c";  ///< --paper of page.css

constexpr double least_contrast = 3.2;  ///< of a curve: 3 is what WCAG 2.1 asks of graphics (1.4.11), and a margin

/// Contrast of two colours, 1 to 21. [WCAG 2.1, "contrast ratio"]
double contrast(std::string_view a, std::string_view b);

/// The colour mixed with black or with white until it has that contrast to the paper, or as near to it as there is.
std::string with_contrast(const std::string& color, std::string_view paper, double wanted);

/// The shade on dark paper of a colour of a curve on white paper: what stands out most there does so here.
std::string on_dark(const std::string& color);

}  // namespace stickslip::report
