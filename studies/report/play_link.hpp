/// The link from a report to the page that plays with its scene (studies/web), where that page is built.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace stickslip::report {

/// The page beside this program: that of the build folder build/wasm, or the installed one. Empty where there is none.
std::filesystem::path play_page();

/// A paragraph with the link from a report in `directory` to `page`, relative to it; its address holds the scene that
/// `picture` (picture.json) has. Empty without a page or a scene, and if the scene reads meshes, which the page has
/// not.
std::string play_link(const std::filesystem::path& directory, const nlohmann::json& picture,
                      const std::filesystem::path& page = play_page());

}  // namespace stickslip::report
