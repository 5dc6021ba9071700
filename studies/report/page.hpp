/// The page around its sections.
#pragma once

#include <string>
#include <vector>

namespace stickslip::report {

/// A part of the page with a heading of its own; HTML.
struct Section {
  std::string id, title, content;
};

/// The whole page: `first` before the list of sections, of which those without content are left out. `title` is plain
/// text.
std::string page(const std::string& title, const std::string& first, const std::vector<Section>& sections);

}  // namespace stickslip::report
