#include "studies/report/chart_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <tuple>

#include "studies/report/colors.hpp"
#include "studies/report/html.hpp"
#include "studies/report/labels.hpp"
#include "studies/report/look_up.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

/// Whose curves there are: methods, then other programs.
std::vector<std::string> owners_of(const Study& study) {
  std::vector<std::string> owners = study.families;
  for (const auto& peer : study.peers) owners.push_back(peer.family);
  return owners;
}

std::string color_of(const Study& study, const std::string& family) {
  static const std::map<std::string, std::string> fixed(std::begin(method_colors), std::end(method_colors));
  static const std::vector<std::string> spare = {purple, orange, sky_blue};
  if (const auto found = fixed.find(family); found != fixed.end()) return found->second;
  std::size_t other = 0;
  for (const auto& name : owners_of(study)) {
    if (name == family) break;
    other += fixed.count(name) == 0;
  }
  return spare[other % spare.size()];
}

/// A method's colour, and another shade of it for each further series: by the contrast to the paper.
std::string shade(const std::string& color, std::size_t count) {
  constexpr std::array<double, 4> contrasts = {8.5, least_contrast, 14, 4};
  const double wanted =
      count == 0 ? std::max(contrast(color, light_paper), least_contrast) : contrasts[(count - 1) % contrasts.size()];
  return with_contrast(color, light_paper, wanted);
}

}  // namespace

void SeriesList::add(const std::string& name, const std::string& family) {
  if (place(name) < list.size()) return;
  static const std::vector<std::string> shapes = {"circle",        "square",         "triangle-up", "diamond",
                                                  "triangle-down", "triangle-right", "cross",       "triangle-left"};
  static const std::vector<std::vector<int>> dashes = {{1, 0}, {7, 3}, {2, 2}, {9, 3, 2, 3}, {4, 2}, {12, 4}};
  static const std::vector<int> sizes = {130, 70, 40, 90};
  const auto owners = owners_of(study_);
  const auto at = std::find(owners.begin(), owners.end(), family) - owners.begin();
  const auto method = static_cast<std::size_t>(at), own = std::min(owners.size(), shapes.size() - 1);
  const std::size_t count = count_[family]++;
  const std::size_t shape = count == 0 ? method % shapes.size() : own + further_++ % (shapes.size() - own);
  list.push_back({name, shade(color_of(study_, family), count), shapes[shape],
                  dashes[(method + 3 * count + count / 2) % dashes.size()],
                  sizes[static_cast<std::size_t>(at) % sizes.size()]});
}

std::size_t SeriesList::place(const std::string& name) const {
  return static_cast<std::size_t>(
      std::find_if(list.begin(), list.end(), [&](const Series& s) { return s.name == name; }) - list.begin());
}

json row_of(const Cell& cell) {
  return {{"label", cell.label}, {"family", cell.family}, {"status", cell.status}, {"failed", !cell.converged}};
}

void show_zeros(json& rows, const std::string& field) {
  const auto group = [](const json& r) {
    return r.value("panel", "") + '\n' + r.value("quantity", "") + '\n' + r.value("scene", "");
  };
  std::map<std::string, double> least;
  for (const auto& r : rows)
    if (const double v = r[field]; v > 0) {
      const auto [at, added] = least.emplace(group(r), v);
      if (!added) at->second = std::min(at->second, v);
    }
  for (auto& r : rows) {
    const double v = r[field];
    const auto found = least.find(group(r));
    // Where everything is 0 the rounding unit stands for the smallest value.
    const double smallest = found == least.end() ? std::numeric_limits<double>::epsilon() : found->second;
    r["zero"] = v == 0;
    r["shown"] = v > 0 ? v : std::pow(10, std::floor(std::log10(smallest)) - 1.5);
  }
}

std::vector<std::string> distinct(const json& rows, const std::string& field, const std::string& panel) {
  std::vector<std::string> out;
  for (const auto& r : rows) {
    if (!panel.empty() && r.value("panel", "") != panel) continue;
    if (const std::string v = r.value(field, ""); std::find(out.begin(), out.end(), v) == out.end()) out.push_back(v);
  }
  return out;
}

void offer(Figure& figure, const std::string& label, const std::string& field, const std::string& first,
           const std::string& panel) {
  Choice choice{label, field, distinct(figure.rows, field, panel), {}, false, panel.empty() ? "" : "panel", panel};
  if (choice.options.size() < 2) return;
  const bool known = std::find(choice.options.begin(), choice.options.end(), first) != choice.options.end();
  choice.chosen = {known ? first : choice.options.front()};
  figure.choices.push_back(choice);
}

std::string first_choice(const std::optional<Figure>& figure, const std::string& field) {
  if (figure)
    for (const auto& choice : figure->choices)
      if (choice.field == field && !choice.chosen.empty()) return choice.chosen.front();
  return "";
}

std::vector<std::pair<std::string, double>> quantities(const std::map<std::string, double>& errors,
                                                       const std::vector<std::string>& prefixes,
                                                       const std::string& worst_name) {
  std::vector<std::pair<std::string, double>> out;
  long of_first = 0;
  for (const auto& prefix : prefixes)
    for (const auto& [name, value] : errors)
      if (name.rfind(prefix, 0) == 0) {
        const std::string bare = name.substr(prefix.size());
        out.emplace_back(prefix == "field:" ? "field: " + in_plain_words(bare) : bare, value);
        of_first += prefix == prefixes.front();
      }
  constexpr std::size_t most = 200;  // beyond, the worst stands for the rest
  if (out.size() > most) out.resize(most);
  if (of_first > 1) out.insert(out.begin(), {worst_name, *worst(errors, prefixes.front())});
  return out;
}

std::string in_words(const Cell& cell) {
  return series_of(cell, "") + (cell.converged ? "" : " [" + in_plain_words(cell.status) + "]");
}

void add_first(SeriesList& series, const Study& study, const std::vector<std::string>& labels) {
  for (const auto& cell : study.cells)
    if (cell.variant == study.main_variant && std::find(labels.begin(), labels.end(), cell.label) != labels.end())
      series.add(in_words(cell), cell.family);
}

std::string knob_title(const std::vector<std::string>& knobs) {
  const bool regularisation = knobs.front() == "stiffness" || knobs.front() == "scale";
  std::string names;
  for (const auto& name : knobs)
    names += (names.empty() ? "" : " or ") + (name == "stiffness" ? "penalty stiffness"
                                              : name == "scale"   ? "AL scale"
                                                                  : name);
  return names + (regularisation ? " (multiple of the local nodal stiffness)" : "");
}

std::vector<std::string> telling_cells(const Study& study, Furthest furthest) {
  std::vector<std::string> out;
  for (const auto& family : study.families)
    if (const Cell* best = best_cell(study, family)) out.push_back(best->label);
  const Cell* far = nullptr;
  for (const auto& cell : study.cells)
    if (cell.converged && cell.variant == study.main_variant && worst(cell.enforcement, "response:"))
      if (!far || *worst(cell.enforcement, "response:") > *worst(far->enforcement, "response:")) far = &cell;
  if (furthest == Furthest::added && far && std::find(out.begin(), out.end(), far->label) == out.end())
    out.push_back(far->label);
  return out;
}

void offer_cells(Figure& figure, const std::vector<std::string>& chosen) {
  Choice choice{"Runs shown", "label", {}, {}, true, "of_cell", "yes"};
  for (const auto& r : figure.rows)
    if (const std::string label = r.value("label", ""); r.contains("of_cell"))
      if (std::find(choice.options.begin(), choice.options.end(), label) == choice.options.end())
        choice.options.push_back(label);
  for (const auto& label : chosen)
    if (std::find(choice.options.begin(), choice.options.end(), label) != choice.options.end())
      choice.chosen.push_back(label);
  std::set<std::string> families;
  if (choice.chosen.empty())
    for (const auto& r : figure.rows)
      if (r.contains("of_cell") && families.insert(r["family"]).second) choice.chosen.push_back(r["label"]);
  if (choice.options.size() > 1) figure.choices.push_back(choice);
}

const Cell* best_cell(const Study& study, const std::string& family) {
  const Cell* best = nullptr;
  const auto error = [](const Cell& c) {
    return worst(c.enforcement, "response:").value_or(std::numeric_limits<double>::infinity());
  };
  const auto rank = [](const Cell& c) {
    return std::make_tuple(at(c.record, "default") != true, c.work, worst(c.kkt, "").value_or(0));
  };
  for (const auto& cell : study.cells) {
    if (cell.family != family || !cell.converged || cell.variant != study.main_variant) continue;
    if (!best || error(cell) < error(*best)) best = &cell;
  }
  if (!best) return nullptr;
  const double as_good = std::max(error(*best), rounding_error);
  for (const auto& cell : study.cells)
    if (cell.family == family && cell.converged && cell.variant == study.main_variant && error(cell) <= as_good)
      if (error(*best) > as_good || rank(cell) < rank(*best)) best = &cell;
  return best;
}

}  // namespace stickslip::report
