#include "studies/io/diagnostics.hpp"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "studies/io/printing.hpp"

namespace stickslip {
namespace {

constexpr std::size_t most_shown = 100;  // beyond, nobody reads on

std::string lines(const std::vector<Diagnostic>& all, const std::string& before, const std::string& noun) {
  std::string text;
  for (std::size_t i = 0; i < std::min(all.size(), most_shown); ++i) text += before + all[i].text() + "\n";
  if (all.size() > most_shown) text += "... and " + std::to_string(all.size() - most_shown) + " more " + noun + "s\n";
  return text;
}

}  // namespace

std::string Diagnostic::text() const {
  std::string text = place.source;
  if (place.line > 0) text += ":" + std::to_string(place.line) + ":" + std::to_string(place.column);
  if (!text.empty()) text += ": ";
  if (!pointer.empty()) text += pointer + ": ";
  return printable(text + message);
}

void Diagnostics::error(Diagnostic diagnostic) {
  if (!texts_.insert(diagnostic.text()).second) return;
  pointers_.insert(diagnostic.pointer);
  errors_.push_back(std::move(diagnostic));
}
void Diagnostics::note(Diagnostic diagnostic) { notes_.push_back(std::move(diagnostic)); }

bool Diagnostics::has_error_in(const std::string& pointer) const {
  if (pointers_.count(pointer) > 0) return true;
  const auto inside = pointers_.lower_bound(pointer + "/");
  return inside != pointers_.end() && inside->starts_with(pointer + "/");
}

std::vector<Diagnostic> Diagnostics::errors() const {
  std::map<std::string, std::size_t> met;
  for (const auto& each : errors_) met.emplace(each.place.source, met.size());
  std::vector<Diagnostic> sorted = errors_;
  auto rank = [&](const Diagnostic& each) {
    return std::make_tuple(met.at(each.place.source), each.place.line, each.place.column);
  };
  std::stable_sort(sorted.begin(), sorted.end(), [&](const auto& a, const auto& b) { return rank(a) < rank(b); });
  return sorted;
}

std::string Diagnostics::text() const { return lines(errors(), "", "fault"); }

std::string Diagnostics::notes_text() const { return lines(notes_, "note: ", "note"); }

}  // namespace stickslip
