#include "studies/report/page.hpp"

#include <fmt/format.h>

#include <map>
#include <string_view>

#include "studies/report/embedded.hpp"
#include "studies/report/html.hpp"

namespace stickslip::report {

namespace {

/// The template with each {{name}} replaced once; what is put in is not searched again.
std::string fill(std::string_view page, const std::map<std::string, std::string, std::less<>>& parts) {
  std::string out;
  for (;;) {
    const std::size_t open = page.find("{{"), close = page.find("}}", open);
    if (close == std::string_view::npos) return out.append(page);
    out.append(page.substr(0, open)).append(parts.find(page.substr(open + 2, close - open - 2))->second);
    page.remove_prefix(close + 2);
  }
}

}  // namespace

std::string page(const std::string& title, const std::string& first, const std::vector<Section>& sections) {
  std::string navigation, content;
  for (const auto& section : sections) {
    if (section.content.empty()) continue;
    navigation += fmt::format("<a href=\"#{}\">{}</a>\n", section.id, section.title);
    content +=
        fmt::format("<section><h2 id=\"{}\">{}</h2>\n{}</section>\n", section.id, section.title, section.content);
  }
  return fill(embedded::page_html(), {{"title", escape(title)},
                                      {"css", std::string(embedded::page_css())},
                                      {"first", first},
                                      {"navigation", navigation},
                                      {"content", content},
                                      {"vega", embed_script(embedded::vega_js())},
                                      {"vega_lite", embed_script(embedded::vega_lite_js())},
                                      {"vega_embed", embed_script(embedded::vega_embed_js())},
                                      {"numerals", embed_script(embedded::numerals_js())},
                                      {"js", embed_script(embedded::page_js())}});
}

}  // namespace stickslip::report
