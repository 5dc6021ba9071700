#include "studies/report/play_link.hpp"

#include <fmt/format.h>

#include <cctype>
#include <nlohmann/json.hpp>
#include <system_error>

#include "studies/report/html.hpp"

namespace stickslip::report {
namespace {

/// As a part of an address: all but letters, digits and "-._~" by their bytes. [RFC 3986, 2.1]
std::string percent_encoded(const std::string& text) {
  std::string out;
  for (const unsigned char c : text)
    if (std::isalnum(c) || c == '-' || c == '.' || c == '_' || c == '~')
      out += static_cast<char>(c);
    else
      out += fmt::format("%{:02X}", c);
  return out;
}

}  // namespace

std::filesystem::path play_page() {
  std::error_code none;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", none);
  if (none) return {};
  for (const char* place : {"../wasm/stickslip.html", "../share/stickslip/stickslip.html"})
    if (const auto page = program.parent_path() / place; std::filesystem::exists(page, none))
      return std::filesystem::weakly_canonical(page, none);
  return {};
}

std::string play_link(const std::filesystem::path& directory, const nlohmann::json& picture,
                      const std::filesystem::path& page) {
  if (page.empty() || !picture.is_object() || !picture.contains("scene")) return "";
  const std::string scene = picture["scene"].dump();
  if (scene.find("\"gmsh\"") != std::string::npos) return "";
  std::error_code none;
  const auto place = std::filesystem::proximate(page, std::filesystem::weakly_canonical(directory, none), none);
  return fmt::format(
      "<p class=\"note\"><a href=\"{}#json={}\">Play with this scene</a>: three methods side by side, in the "
      "browser.</p>\n",
      escape(place.generic_string()), percent_encoded(scene));
}

}  // namespace stickslip::report
