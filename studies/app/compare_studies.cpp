#include "studies/app/compare_studies.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "studies/app/commands.hpp"
#include "studies/app/exit_codes.hpp"
#include "studies/app/recorded.hpp"
#include "studies/app/say.hpp"
#include "studies/io/input_fault.hpp"
#include "studies/io/printing.hpp"
#include "studies/report/disagreement.hpp"
#include "studies/report/look_up.hpp"

namespace stickslip {
namespace {

using nlohmann::json;
using report::at, report::object_at, report::number_at, report::text_at;

constexpr double infinite = std::numeric_limits<double>::infinity();

/// What is not compared, and most of a row.
void drop_curves(json& row) {
  for (const char* part : {"steps", "film", "interface"}) row.erase(part);
}

/// A cell by what it is.
std::pair<std::string, std::string> name_of(const json& row) { return {text_at(row, "label"), variant_text(row)}; }

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
    const json& other = at(after, name);
    const double a = error.is_number() ? std::abs(error.get<double>()) : infinite;
    const double b = other.is_number() ? std::abs(other.get<double>()) : infinite;
    const double band = bands.relative * std::min(a, b) + bands.rounding;
    if (a == b || std::abs(a - b) <= band) continue;
    changes.push_back({kind + " " + name, error, other, log_ratio(a, b, bands.rounding), b > a});
  }
}

/// Parts of the errors, where both cells have budgets; but for rounding, which copies of the run measure anew. What the
/// copies make of a part is within its band.
void compare_budgets(const json& before, const json& after, const ComparisonBands& bands,
                     std::vector<Change>& changes) {
  const json& budgets = object_at(at(before, "error_budget"), "quantities");
  const json& others = object_at(at(after, "error_budget"), "quantities");
  for (const auto& [name, budget] : budgets.items()) {
    if (!others.contains(name)) continue;
    for (const char* part : {"iteration", "enforcement", "step", "mesh"}) {
      const json &a = at(at(budget, "parts"), part), &b = at(at(others[name], "parts"), part);
      ComparisonBands noisy = bands;
      noisy.rounding += number_at(a, "noise") + number_at(b, "noise");
      compare_errors({{name, at(a, "value")}}, {{name, at(b, "value")}}, std::string("budget ") + part, noisy, changes);
    }
  }
}

/// What a cell computed: responses and sensitivities of the last step, objectives and their gradients.
std::map<std::string, json> values_of(const json& row) {
  std::map<std::string, json> values;
  const auto add = [&](const std::string& name, const json& by_parameter) {
    for (const auto& [parameter, value] : by_parameter.items()) values["sensitivity " + name + "/" + parameter] = value;
  };
  for (const auto& [name, value] : object_at(row, "responses").items()) values["response " + name] = value;
  for (const auto& [name, by_parameter] : object_at(row, "sensitivities").items()) add(name, by_parameter);
  for (const auto& [name, objective] : object_at(row, "objectives").items()) {
    values["response " + name] = at(objective, "value");
    add(name, object_at(objective, "gradient"));
  }
  return values;
}

/// What a difference of a value is measured by: its largest size in any cell.
using Sizes = std::map<std::string, double>;

void take_sizes(const RowsById& rows, Sizes& sizes) {
  for (const auto& [id, row] : rows)
    for (const auto& [name, value] : values_of(row))
      if (value.is_number()) sizes[name] = std::max(sizes[name], std::abs(value.get<double>()));
}

void compare_values(const json& before, const json& after, const Sizes& sizes, double rounding,
                    std::vector<Change>& changes) {
  auto old_values = values_of(before), new_values = values_of(after);
  for (const auto& [name, value] : new_values) old_values.emplace(name, json());
  for (const auto& [name, value] : old_values) {
    const json& other = new_values[name];
    if (value == other) continue;
    double relative = infinite;
    if (value.is_number() && other.is_number())
      relative = std::abs(value.get<double>() - other.get<double>()) / sizes.at(name);
    if (relative > rounding) changes.push_back({name, value, other, std::log10(1 + relative), false});
  }
}

void compare_scenes(const json& before, const json& after, std::vector<Change>& changes) {
  const json &a = at(before, "scene_hash"), &b = at(after, "scene_hash");
  if (a.is_string() && b.is_string() && a != b) changes.push_back({"scene", a, b, infinite, false});
}

CellComparison compare_cells(const json& before, const json& after, const Sizes& sizes, const ComparisonBands& bands) {
  CellComparison cell;
  std::tie(cell.label, cell.variant) = name_of(before);
  auto& changes = cell.changes;
  compare_scenes(before, after, changes);
  if (at(before, "status") != at(after, "status"))
    changes.push_back(
        {"status", at(before, "status"), at(after, "status"), infinite, converged(before) && !converged(after)});
  const auto part = [](const json& row, const char* outer, const char* inner) -> const json& {
    return object_at(at(row, outer), inner);
  };
  compare_counts(part(before, "cost", "counts"), part(after, "cost", "counts"), changes);
  for (const char* kind : {"enforcement", "discretization", "kkt"})
    compare_errors(part(before, "errors", kind), part(after, "errors", kind), kind, bands, changes);
  compare_budgets(before, after, bands, changes);
  compare_values(before, after, sizes, bands.rounding, changes);
  std::stable_sort(changes.begin(), changes.end(), [](const auto& a, const auto& b) { return a.size > b.size; });
  cell.seconds_before = number_at(part(before, "cost", "seconds"), "total");
  cell.seconds_after = number_at(part(after, "cost", "seconds"), "total");
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

std::string in_digits(const json& value, int digits) {
  return value.is_number_float() ? fmt::format("{:.{}g}", value.get<double>(), digits)
         : value.is_string()     ? value.get<std::string>()
                                 : json_text(value);
}

/// Both values, with as many digits as tell them apart.
std::pair<std::string, std::string> in_digits(const Change& change) {
  constexpr int fewest = 3, all = 17;
  for (int digits = fewest;; ++digits)
    if (std::pair texts{in_digits(change.before, digits), in_digits(change.after, digits)};
        texts.first != texts.second || digits == all)
      return texts;
}

/// "response", "sensitivity" where the change is of one of the many values of a cell; "" otherwise.
std::string kind_of_value(const Change& change) {
  const std::string kind = change.quantity.substr(0, change.quantity.find(' '));
  return kind == "response" || kind == "sensitivity" ? kind : "";
}

/// How many changes are of each kind of value.
std::map<std::string, int> values_changed(const CellComparison& cell) {
  std::map<std::string, int> count;
  for (const auto& change : cell.changes) ++count[kind_of_value(change)];
  return count;
}

void print(const std::vector<CellComparison>& cells) {
  const auto line = [](const CellComparison& cell, const std::string& quantity, const std::string& before,
                       const std::string& after, bool worse) {
    say(std::cout, "{:<5}  {:<44} {:<44} {:>14} -> {}\n", worse ? "WORSE" : "",
        printable(cell.label + "  " + cell.variant), printable(quantity), printable(before), printable(after));
  };
  for (const auto& cell : cells) {
    if (cell.only_before) line(cell, "cell", "recorded", "missing", true);
    if (cell.only_after) line(cell, "cell", "missing", "recorded", false);
    auto left = values_changed(cell);
    for (const auto& change : cell.changes) {
      std::string more;
      if (const std::string kind = kind_of_value(change); !kind.empty()) {
        const int others = std::exchange(left[kind], 0) - 1;  // the largest of a kind speaks for all
        if (others < 0) continue;
        if (others > 0) more = fmt::format(" (and {} more)", others);
      }
      const auto [before, after] = in_digits(change);
      line(cell, change.quantity + more, before, after, change.worse);
    }
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

bool CellComparison::other_scene() const {
  return std::any_of(changes.begin(), changes.end(), [](const auto& c) { return c.quantity == "scene"; });
}

std::vector<CellComparison> compare_rows(const RowsById& before, const RowsById& after, const ComparisonBands& bands) {
  std::vector<CellComparison> cells;
  Sizes sizes;
  take_sizes(before, sizes);
  take_sizes(after, sizes);
  const auto old_cells = by_name(before), new_cells = by_name(after);
  const auto alone = [](const std::pair<std::string, std::string>& name) {
    CellComparison cell;
    std::tie(cell.label, cell.variant) = name;
    return cell;
  };
  for (const auto& [name, row] : old_cells)
    if (const auto other = new_cells.find(name); other != new_cells.end())
      cells.push_back(compare_cells(*row, *other->second, sizes, bands));
    else
      (cells.emplace_back(alone(name))).only_before = true;
  for (const auto& [name, row] : new_cells)
    if (old_cells.count(name) == 0) (cells.emplace_back(alone(name))).only_after = true;
  std::stable_sort(cells.begin(), cells.end(), [](const auto& a, const auto& b) {
    return std::pair(a.worse(), a.size()) > std::pair(b.worse(), b.size());
  });
  return cells;
}

std::string unrelated(const RowsById& before, const RowsById& after) {
  const auto old_cells = by_name(before), new_cells = by_name(after);
  bool same_cells = false, same_scene = false, values = false;
  for (const auto& [name, row] : old_cells) {
    const auto other = new_cells.find(name);
    if (other == new_cells.end()) continue;
    same_cells = true;
    const json& hash = at(*row, "scene_hash");
    same_scene = same_scene || (hash.is_string() && hash == at(*other->second, "scene_hash"));
    const auto old_values = values_of(*row), new_values = values_of(*other->second);
    values = values || !old_values.empty() || !new_values.empty();
    for (const auto& [quantity, value] : old_values) same_scene = same_scene || new_values.count(quantity) > 0;
  }
  if (!same_cells) return "they have no cell in common";
  return same_scene || !values ? "" : "their scenes are not the same, and have no response in common";
}

int compare_command(const CompareArguments& arguments) try {
  for (const auto& [option, band] : {std::pair{"--relative", arguments.relative}, {"--rounding", arguments.rounding}})
    if (!(band >= 0 && band < infinite)) throw InputFault(fmt::format("{} {}: must be a number >= 0", option, band));
  RowsById rows[2];
  const std::string directories[] = {arguments.before, arguments.after};
  for (int i = 0; i < 2; ++i) {
    check_recorded(directories[i]);
    StoredRows stored = read_rows(directories[i], drop_curves);
    tell_faults(stored, directories[i]);
    rows[i] = std::move(stored.rows);
    if (rows[i].empty()) throw InputFault(directories[i] + ": there are no rows in results.jsonl");
  }
  if (const std::string fault = unrelated(rows[0], rows[1]); !fault.empty())
    throw InputFault(directories[0] + " and " + directories[1] + " are recordings of different studies: " + fault);
  const ComparisonBands bands{arguments.relative, arguments.rounding};
  const auto cells = compare_rows(rows[0], rows[1], bands);
  int changed = 0, worse = 0, other_scenes = 0;
  double seconds[2] = {0, 0};
  json list = json::array();
  for (const auto& cell : cells) {
    changed += !cell.changes.empty() || cell.only_before || cell.only_after;
    worse += cell.worse();
    other_scenes += cell.other_scene();
    seconds[0] += cell.seconds_before;
    seconds[1] += cell.seconds_after;
    list.push_back(to_json(cell));
  }
  std::vector<const json*> all;
  for (const auto& [id, row] : rows[1]) all.push_back(&row);
  const auto disagree = disagreements(all);
  if (arguments.json) {
    std::cout << json_text({{"cells", list},
                            {"disagreements", disagree},
                            {"changed", changed},
                            {"worse", worse},
                            {"other_scenes", other_scenes},
                            {"bands", {{"relative", bands.relative}, {"rounding", bands.rounding}}}},
                           2)
              << '\n';
  } else {
    print(cells);
    if (other_scenes > 0)
      say(std::cout, "{} of {} cells ran another scene, or with other options of the method: their hashes differ\n",
          other_scenes, cells.size());
    say(std::cout,
        "{} cells: {} changed, {} of them for the worse; errors may grow by {} of themselves and by {} (rounding), "
        "counts not at all; responses and sensitivities may differ by {} of their largest size in any cell\n"
        "seconds, not judged: {:.3g} -> {:.3g}\n",
        cells.size(), changed, worse, bands.relative, bands.rounding, bands.rounding, seconds[0], seconds[1]);
    for (const auto& sentence : disagree) fmt::print("{}\n", printable(directories[1] + ": " + sentence));
  }
  return worse ? not_solved : done;
} catch (const json::exception& error) {  // rows without a checksum may hold anything
  throw not_written(arguments.before + " or " + arguments.after + ": rows without a checksum", error);
}

}  // namespace stickslip
