#include "studies/diagnostics.hpp"

#include <algorithm>
#include <map>
#include <tuple>

namespace stickslip {

std::string Diagnostic::text() const {
  std::string text = place.source;
  if (place.line > 0) text += ":" + std::to_string(place.line) + ":" + std::to_string(place.column);
  if (!text.empty()) text += ": ";
  if (!pointer.empty()) text += pointer + ": ";
  return text + message;
}

void Diagnostics::error(Diagnostic diagnostic) {
  const std::string text = diagnostic.text();
  if (std::any_of(errors_.begin(), errors_.end(), [&](const auto& each) { return each.text() == text; })) return;
  errors_.push_back(std::move(diagnostic));
}
void Diagnostics::note(Diagnostic diagnostic) { notes_.push_back(std::move(diagnostic)); }

bool Diagnostics::has_error_in(const std::string& pointer) const {
  return std::any_of(errors_.begin(), errors_.end(), [&](const Diagnostic& each) {
    return each.pointer == pointer || each.pointer.rfind(pointer + "/", 0) == 0;
  });
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

std::string Diagnostics::text() const {
  std::string text;
  for (const auto& each : errors()) text += each.text() + "\n";
  return text;
}

}  // namespace stickslip
