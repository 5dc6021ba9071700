/// The ledger as JSON and as a table.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "studies/io/amounts.hpp"
#include "studies/io/numerals.hpp"
#include "studies/run/ledger.hpp"

namespace stickslip {
namespace {

using nlohmann::json;

json amounts_json(const std::vector<Amount>& amounts) {
  json out = json::object();
  for (const auto& amount : amounts) out[amount.name] = amount.spread > 0 ? json(std::llround(amount.value)) : json();
  return out;
}

/// Three digits and a unit.
std::string bytes_text(double bytes) {
  for (const auto& [unit, size] : {std::pair{"TB", 1e12}, {"GB", 1e9}, {"MB", 1e6}, {"kB", 1e3}})
    if (bytes >= size) return fmt::format("{:.{}f} {}", bytes / size, bytes < 10 * size ? 1 : 0, unit);
  return fmt::format("{:.0f} B", bytes);
}

/// The sum of what is known; before it "~" where that is not exact, ">" where something is missing.
std::string sum_text(const std::vector<Amount>& amounts) {
  double sum = 0;
  bool exact = true, all = true;
  for (const auto& amount : amounts) {
    sum += amount.value;
    exact &= amount.spread == 1 || amount.value == 0;
    all &= amount.spread > 0;
  }
  if (sum == 0) return all ? "" : "?";
  return (!all ? ">" : exact ? "" : "~") + bytes_text(sum);
}

std::string unknowns_text(const std::vector<Amount>& amounts) {
  if (amounts.empty() || amounts.front().value == 0) return "";
  return fmt::format("{}{:.0f}", amounts.front().name == "eliminated" ? "-" : "+", amounts.front().value);
}

std::string counts_text(const std::vector<Amount>& amounts) {
  std::string text;
  for (const auto& amount : amounts)
    if (amount.spread > 0 && amount.value > 0) text += (text.empty() ? "" : ", ") + amount_in_words(amount);
  return text;
}

std::string joined(const std::vector<std::string>& parts) { return fmt::format("{}", fmt::join(parts, ", ")); }

}  // namespace

std::string amount_in_words(const Amount& amount) {
  return amount.spread == 1 ? amount_in_words(amount.name, amount.value)
                            : "~" + number(amount.value) + " " + ledger_words(amount.name);
}

json repeatable_ledger_json(const Ledger& ledger) {
  json out = json::array();
  for (const auto& row : ledger)
    out.push_back({{"effect", row.effect},
                   {"on", row.on},
                   {"unknowns", amounts_json(row.unknowns)},
                   {"memory", amounts_json(row.memory)},
                   {"counts", amounts_json(row.counts)}});
  return out;
}

json ledger_json(const Ledger& ledger) {
  json out = repeatable_ledger_json(ledger);
  for (std::size_t i = 0; i < ledger.size(); ++i)
    out[i]["seconds"] = std::isfinite(ledger[i].seconds) ? json(ledger[i].seconds) : json();
  return out;
}

std::string ledger_table(const Ledger& ledger) {
  std::string text = fmt::format("  {:<20} {:>9} {:>9}  counts\n", "effect", "unknowns", "memory");
  std::vector<std::string> off;
  for (const auto& row : ledger) {
    if (!row.on) {
      off.push_back(ledger_words(row.effect));
      continue;
    }
    const std::string counts = counts_text(row.counts);
    text += fmt::format("  {:<20} {:>9} {:>9}{}{}\n", ledger_words(row.effect), unknowns_text(row.unknowns),
                        sum_text(row.memory), counts.empty() ? "" : "  ", counts);
  }
  if (!off.empty()) text += "  off, and nothing of it there: " + joined(off) + "\n";
  return text;
}

std::string ledger_line(const json& ledger) {
  std::vector<std::string> parts;
  for (const auto& row : ledger) {
    if (!row["on"].get<bool>()) continue;
    std::vector<std::string> amounts;
    double bytes = 0;
    for (const auto& [name, amount] : row["memory"].items()) bytes += amount.get<double>();
    for (const auto& [name, amount] : row["unknowns"].items())
      if (amount != 0)
        amounts.push_back(amount_in_words(name == "normal" || name == "tangential" ? "multipliers" : name, amount));
    if (bytes > 0) amounts.push_back(bytes_text(bytes));
    parts.push_back(ledger_words(row["effect"]) + (amounts.empty() ? "" : ": ") + joined(amounts));
  }
  return fmt::format("{}", fmt::join(parts, "; "));
}

}  // namespace stickslip
