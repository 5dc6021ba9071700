/// Reads the page of a report as a browser would: tags, and the words a reader sees.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace stickslip::recorded {

struct Element {
  std::string name, attributes;
};

/// Tags of a page in order, "/name" for an end tag; what stands inside script and style is skipped.
inline std::vector<Element> tags_of(const std::string& page) {
  std::vector<Element> tags;
  for (std::size_t at = page.find('<'); at != std::string::npos; at = page.find('<', at)) {
    const std::size_t close = page.find('>', at);
    if (close == std::string::npos) break;
    std::string tag = page.substr(at + 1, close - at - 1);
    const std::size_t end = tag.find_first_of(" \n/", 1);
    const std::string name = tag.substr(0, end);
    const bool empty = !tag.empty() && tag.back() == '/';
    tags.push_back({name, end == std::string::npos ? "" : tag.substr(end)});
    if (empty) tags.push_back({"/" + name, ""});
    at = close;
    if (name == "script" || name == "style") at = page.find("</" + name, at);
  }
  return tags;
}

/// The data blocks of the charts, parsed. Throws where one is no JSON.
inline std::vector<nlohmann::json> data_of(const std::string& page) {
  std::vector<nlohmann::json> out;
  const std::string open = "<script type=\"application/json\"";
  for (std::size_t at = page.find(open); at != std::string::npos; at = page.find(open, at + 1)) {
    const std::size_t from = page.find('>', at) + 1;
    out.push_back(nlohmann::json::parse(page.substr(from, page.find("</script>", from) - from)));
  }
  return out;
}

inline std::string without_scripts(std::string page) {
  for (std::size_t at = page.find("<script"); at != std::string::npos; at = page.find("<script", at))
    page.erase(at, page.find("</script>", at) + std::string("</script>").size() - at);
  return page;
}

inline std::string all_of(const std::vector<std::string>& sentences) {
  std::string out;
  for (const auto& sentence : sentences) out += sentence + "\n";
  return out;
}

}  // namespace stickslip::recorded
