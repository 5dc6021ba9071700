#include "studies/compare_studies.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "studies/commands.hpp"
#include "studies/input_fault.hpp"

namespace stickslip {
namespace {

using nlohmann::json;
constexpr int done = 0, bad_input = 2, not_solved = 3;
constexpr double infinite = std::numeric_limits<double>::infinity();

/// A cell by what it is.
std::pair<std::string, std::string> name_of(const json& row) { return {row.value("label", ""), variant_text(row)}; }

std::map<std::pair<std::string, std::string>, const json*> by_name(const RowsById& rows) {
  std::map<std::pair<std::string, std::string>, const json*> out;
  for (const auto& [id, row] : rows) out[name_of(row)] = &row;
  return out;
}

double log_ratio(double before, double after, double least) {
  return std::abs(std::log10(std::max(after, least) / std::max(before, least)));
}

void compare_counts(const json& before, const json& after, std::vector<Change>& changes) {
  for (const auto& [name, count] : before.items()) {
    const json other = after.value(name, json(0));
    if (other == count || !count.is_number() || !other.is_number()) continue;
    const double a = count, b = other;
    changes.push_back({"count " + name, count, other, log_ratio(a, b, 0.5), b > a});
  }
}

void compare_errors(const json& before, const json& after, const std::string& kind, const ComparisonBands& bands,
                    std::vector<Change>& changes) {
  for (const auto& [name, error] : before.items()) {
    const json other = after.value(name, json());
    const double a = error.is_number() ? std::abs(error.get<double>()) : infinite;
    const double b = other.is_number() ? std::abs(other.get<double>()) : infinite;
    const double band = bands.relative * std::min(a, b) + bands.rounding;
    if (a == b || std::abs(a - b) <= band) continue;
    changes.push_back({kind + " " + name, error, other, log_ratio(a, b, bands.rounding), b > a});
  }
}

CellComparison compare_cells(const json& before, const json& after, const ComparisonBands& bands) {
  CellComparison cell;
  std::tie(cell.label, cell.variant) = name_of(before);
  auto& changes = cell.changes;
  if (before.value("status", "") != after.value("status", ""))
    changes.push_back({"status", before.value("status", json()), after.value("status", json()), infinite,
                       converged(before) && !converged(after)});
  const auto part = [](const json& row, const char* outer, const char* inner) {
    return row.value(outer, json::object()).value(inner, json::object());
  };
  compare_counts(part(before, "cost", "counts"), part(after, "cost", "counts"), changes);
  for (const char* kind : {"enforcement", "discretization", "kkt"})
    compare_errors(part(before, "errors", kind), part(after, "errors", kind), kind, bands, changes);
  std::stable_sort(changes.begin(), changes.end(), [](const auto& a, const auto& b) { return a.size > b.size; });
  cell.seconds_before = part(before, "cost", "seconds").value("total", 0.0);
  cell.seconds_after = part(after, "cost", "seconds").value("total", 0.0);
  return cell;
}

json to_json(const CellComparison& cell) {
  json changes = json::array();
  for (const auto& change : cell.changes)
    changes.push_back(
        {{"quantity", change.quantity}, {"before", change.before}, {"after", change.after}, {"worse", change.worse}});
  return {{"label", cell.label},
          {"variant", cell.variant},
          {"worse", cell.worse()},
          {"only", cell.only_before ? json("before") : cell.only_after ? json("after") : json(nullptr)},
          {"changes", changes},
          {"seconds", {cell.seconds_before, cell.seconds_after}}};
}

std::string shown(const json& value) {
  return value.is_number_float() ? fmt::format("{:.3g}", value.get<double>())
         : value.is_string()     ? value.get<std::string>()
                                 : value.dump();
}

void print(const std::vector<CellComparison>& cells) {
  const auto line = [](const CellComparison& cell, const std::string& quantity, const std::string& before,
                       const std::string& after, bool worse) {
    fmt::print("{:<5}  {:<44} {:<44} {:>14} -> {}\n", worse ? "WORSE" : "", cell.label + "  " + cell.variant, quantity,
               before, after);
  };
  for (const auto& cell : cells) {
    if (cell.only_before) line(cell, "cell", "recorded", "missing", true);
    if (cell.only_after) line(cell, "cell", "missing", "recorded", false);
    for (const auto& change : cell.changes)
      line(cell, change.quantity, shown(change.before), shown(change.after), change.worse);
  }
}

}  // namespace

bool CellComparison::worse() const {
  return only_before || std::any_of(changes.begin(), changes.end(), [](const auto& c) { return c.worse; });
}

double CellComparison::size() const {
  if (only_before || only_after) return infinite;
  return changes.empty() ? 0 : changes.front().size;
}

std::vector<CellComparison> compare_rows(const RowsById& before, const RowsById& after, const ComparisonBands& bands) {
  std::vector<CellComparison> cells;
  const auto old_cells = by_name(before), new_cells = by_name(after);
  const auto alone = [](const std::pair<std::string, std::string>& name) {
    CellComparison cell;
    std::tie(cell.label, cell.variant) = name;
    return cell;
  };
  for (const auto& [name, row] : old_cells)
    if (const auto other = new_cells.find(name); other != new_cells.end())
      cells.push_back(compare_cells(*row, *other->second, bands));
    else
      (cells.emplace_back(alone(name))).only_before = true;
  for (const auto& [name, row] : new_cells)
    if (old_cells.count(name) == 0) (cells.emplace_back(alone(name))).only_after = true;
  std::stable_sort(cells.begin(), cells.end(), [](const auto& a, const auto& b) {
    return std::pair(a.worse(), a.size()) > std::pair(b.worse(), b.size());
  });
  return cells;
}

int compare_command(const CompareArguments& arguments) {
  for (const auto& [option, band] : {std::pair{"--relative", arguments.relative}, {"--rounding", arguments.rounding}})
    if (!(band >= 0 && band < infinite)) throw InputFault(fmt::format("{} {}: must be a number >= 0", option, band));
  RowsById rows[2];
  const std::string directories[] = {arguments.before, arguments.after};
  for (int i = 0; i < 2; ++i) {
    StoredRows stored = read_rows(directories[i]);
    if (!stored.sound()) std::cerr << "note: " << directories[i] << "/results.jsonl: " << stored.faults() << '\n';
    rows[i] = std::move(stored.rows);
    if (!rows[i].empty()) continue;
    std::cerr << directories[i] << ": there are no rows in results.jsonl\n";
    return bad_input;
  }
  const ComparisonBands bands{arguments.relative, arguments.rounding};
  const auto cells = compare_rows(rows[0], rows[1], bands);
  int changed = 0, worse = 0;
  double seconds[2] = {0, 0};
  json list = json::array();
  for (const auto& cell : cells) {
    changed += !cell.changes.empty() || cell.only_before || cell.only_after;
    worse += cell.worse();
    seconds[0] += cell.seconds_before;
    seconds[1] += cell.seconds_after;
    list.push_back(to_json(cell));
  }
  if (arguments.json) {
    std::cout << json{{"cells", list},
                      {"worse", worse},
                      {"bands", {{"relative", bands.relative}, {"rounding", bands.rounding}}}}
                     .dump(2)
              << '\n';
  } else {
    print(cells);
    fmt::print(
        "{} cells: {} changed, {} of them for the worse; errors may grow by {} of themselves and by {} (rounding), "
        "counts not at all\nseconds, not judged: {:.3g} -> {:.3g}\n",
        cells.size(), changed, worse, bands.relative, bands.rounding, seconds[0], seconds[1]);
  }
  return worse ? not_solved : done;
}

}  // namespace stickslip
