/// Colours "#RRGGBB" that stand out from the paper of a page, white or dark.
#pragma once

#include <string>
#include <string_view>
#include <utility>

namespace stickslip::report {

// Okabe and Ito's palette, which stays apart for all common forms of colour vision; without its yellow, which is lost
// on white. What cannot include this has copies that a test holds equal: studies/web/page.css,
// python/stickslip/plots.py.

constexpr std::pair<const char*, const char*> method_colors[] = {
    {"penalty", "#D55E00"}, {"uzawa_al", "#0072B2"}, {"monolithic_al", "#009E73"}};
/// Of states of contact; closed: without friction.
constexpr const char *stick_color = "#0072B2", *slip_color = "#E69F00", *closed_color = "#5b616b",
                     *open_color = "#ffffff";

constexpr std::string_view light_paper = "#ffffff", dark_paper = "#16181c";  ///< --paper of page.css

constexpr double least_contrast = 3.2;  ///< of a curve: 3 is what WCAG 2.1 asks of graphics (1.4.11), and a margin

/// Contrast of two colours, 1 to 21. [WCAG 2.1, "contrast ratio"]
double contrast(std::string_view a, std::string_view b);

/// The colour mixed with black or with white until it has that contrast to the paper, or as near to it as there is.
std::string with_contrast(const std::string& color, std::string_view paper, double wanted);

/// The shade on dark paper of a colour of a curve on white paper: what stands out most there does so here.
std::string on_dark(const std::string& color);

}  // namespace stickslip::report
