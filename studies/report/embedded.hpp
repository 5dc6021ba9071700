/// Files carried inside the program, so that a report can be written anywhere: the page's parts and the chart library.
#pragma once

#include <string_view>

namespace stickslip::report::embedded {

std::string_view page_html();
std::string_view page_css();
std::string_view numerals_js();
std::string_view page_js();
std::string_view vega_js();
std::string_view vega_lite_js();
std::string_view vega_embed_js();
std::string_view third_party_notices();

}  // namespace stickslip::report::embedded
