#include "studies/io/amounts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace stickslip {
namespace {

/// The name of one of them.
std::string of_one(std::string names) {
  for (const auto& [many, one] : {std::pair<std::string, std::string>{"analyses", "analysis"}, {"ies", "y"}, {"s", ""}})
    if (names.ends_with(many)) return names.replace(names.size() - many.size(), many.size(), one);
  return names;
}

}  // namespace

std::string ledger_words(const std::string& name) {
  std::string out = name;
  std::replace(out.begin(), out.end(), '_', ' ');
  for (const auto& [recorded, shown] : {std::pair<std::string, std::string>{"factorizations", "factorisations"},
                                        {"backsolves", "back-solves"},
                                        {"slots", "model data"},
                                        {"one sided", "one-sided"}})
    if (const auto at = out.find(recorded); at != std::string::npos) out.replace(at, recorded.size(), shown);
  return out;
}

std::string amount_in_words(const std::string& name, double amount) {
  const std::string words = ledger_words(name);
  return fmt::format("{:.0f} {}", amount, amount == 1 ? of_one(words) : words);
}

}  // namespace stickslip
