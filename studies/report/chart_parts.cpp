#include "studies/report/chart_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <tuple>

#include "studies/report/look_up.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

/// Okabe and Ito's palette, which stays apart for all common forms of colour vision; without its yellow, which is lost
/// on white.
std::string color_of(const Study& study, const std::string& family) {
  static const std::map<std::string, std::string> fixed = {
      {"penalty", "#D55E00"}, {"uzawa_al", "#0072B2"}, {"monolithic_al", "#009E73"}};
  static const std::vector<std::string> spare = {"#CC79A7", "#E69F00", "#56B4E9"};
  if (const auto found = fixed.find(family); found != fixed.end()) return found->second;
  std::size_t other = 0;
  for (const auto& name : study.families) {
    if (name == family) break;
    other += fixed.count(name) == 0;
  }
  return spare[other % spare.size()];
}

const char* number_label =
    "datum.value == 0 ? '0' : abs(datum.value) < 0.01 || abs(datum.value) >= 1e4 ? "
    "replace(format(datum.value, '~e'), '+', '') : format(datum.value, '~r')";

json series_channel(const char* range) {
  return {{"field", "series"},
          {"type", "nominal"},
          {"title", nullptr},
          {"scale", {{"domain", "$series"}, {"range", range}}},
          {"legend", {{"orient", "bottom"}, {"symbolFillColor", "transparent"}}}};
}

/// Dash of a line or size of a marker, without a share in the legend, whose markers they would dash and resize: legends
/// of one field are merged, so these go by `line`, which has the same values.
json quiet_channel(const char* range) {
  json out = series_channel(range);
  out["field"] = "line";
  out["type"] = "ordinal";
  out["scale"]["type"] = "ordinal";
  out["legend"] = nullptr;
  return out;
}

}  // namespace

void SeriesList::add(const std::string& name, const std::string& family) {
  if (place(name) < list.size()) return;
  static const std::vector<std::string> shapes = {"circle",        "square",         "triangle-up", "diamond",
                                                  "triangle-down", "triangle-right", "cross",       "triangle-left"};
  static const std::vector<std::vector<int>> dashes = {{1, 0}, {7, 3}, {2, 2}, {9, 3, 2, 3}, {4, 2}, {12, 4}};
  static const std::vector<int> sizes = {130, 70, 40, 90};
  const auto at = std::find(study_.families.begin(), study_.families.end(), family) - study_.families.begin();
  const auto method = static_cast<std::size_t>(at), own = std::min(study_.families.size(), shapes.size() - 1);
  const std::size_t count = count_[family]++;
  const std::size_t shape = count == 0 ? method % shapes.size() : own + further_++ % (shapes.size() - own);
  list.push_back({name, color_of(study_, family), shapes[shape], dashes[(method + 3 * count) % dashes.size()],
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
    r["shown"] = v > 0 ? v : std::pow(10, std::floor(std::log10(smallest)) - 1);
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

std::vector<std::pair<std::string, double>> quantities(const std::map<std::string, double>& errors,
                                                       const std::vector<std::string>& prefixes,
                                                       const std::string& worst_name) {
  std::vector<std::pair<std::string, double>> out;
  long of_first = 0;
  for (const auto& prefix : prefixes)
    for (const auto& [name, value] : errors)
      if (name.rfind(prefix, 0) == 0) {
        const std::string bare = name.substr(prefix.size());
        out.emplace_back(prefix == "field:" ? "field " + bare : bare, value);
        of_first += prefix == prefixes.front();
      }
  constexpr std::size_t most = 200;  // beyond, the worst stands for the rest
  if (out.size() > most) out.resize(most);
  if (of_first > 1) out.insert(out.begin(), {worst_name, *worst(errors, prefixes.front())});
  return out;
}

std::string in_words(const Cell& cell) {
  return series_of(cell, "") + (cell.converged ? "" : " [" + cell.status + "]");
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

json channel(const std::string& field, const std::string& title, bool logarithmic) {
  json scale = {{"nice", false}, {"padding", 18}, {"zero", false}};
  if (logarithmic) scale = {{"type", "log"}, {"nice", false}, {"padding", 18}};
  return {{"field", field},
          {"type", "quantitative"},
          {"title", title},
          {"scale", scale},
          {"axis", {{"labelExpr", number_label}, {"labelOverlap", true}}}};
}

json only_if(const std::string& test) { return json::array({{{"filter", test}}}); }

json tooltip(const std::vector<std::pair<std::string, std::string>>& fields) {
  json out = json::array();
  for (const auto& [field, title] : fields) out.push_back({{"field", field}, {"title", title}});
  return out;
}

json curves(const std::string& description, const json& x, const json& y, const json& tips) {
  json line = {{"transform", only_if("!datum.failed && !datum.guide")},
               {"mark", {{"type", "line"}, {"strokeWidth", 2}}},
               {"encoding",
                {{"color", series_channel("$colors")},
                 {"strokeDash", quiet_channel("$dashes")},
                 {"detail", {{"field", "line"}}},
                 {"order", {{"field", "order"}, {"type", "quantitative"}}}}}};
  json points = {{"transform", only_if("!datum.failed && !datum.guide && !datum.unmarked")},
                 {"mark", {{"type", "point"}, {"filled", false}, {"strokeWidth", 2}, {"opacity", 1}}},
                 {"encoding",
                  {{"color", series_channel("$colors")},
                   {"shape", series_channel("$shapes")},
                   {"size", quiet_channel("$sizes")},
                   {"tooltip", tips}}}};
  json failures = {
      {"transform", only_if("datum.failed")},
      {"mark",
       {{"type", "point"}, {"shape", "M-1,-1L1,1M-1,1L1,-1"}, {"size", 110}, {"strokeWidth", 2.5}, {"opacity", 1}}},
      {"encoding", {{"color", series_channel("$colors")}, {"tooltip", tips}}}};
  json tags = {
      {"transform", only_if("isValid(datum.tag) && datum.tag != ''")},
      {"mark", {{"type", "text"}, {"align", "left"}, {"dx", 9}, {"dy", -8}, {"fontSize", 11}, {"color", "$ink"}}},
      {"encoding", {{"text", {{"field", "tag"}}}}}};
  json ground = {
      {"transform", json::array({{{"filter", "datum.zero && !datum.guide"}},
                                 {{"aggregate", json::array({{{"op", "min"}, {"field", "shown"}, {"as", "shown"}}})},
                                  {"groupby", json::array()}},
                                 {{"filter", "isValid(datum.shown)"}}})},
      {"encoding", {{"y", {{"field", "shown"}, {"type", "quantitative"}}}}},
      {"layer", json::array({{{"mark", {{"type", "rule"}, {"strokeDash", {1, 3}}, {"color", "$ink"}}}},
                             {{"mark",
                               {{"type", "text"},
                                {"align", "left"},
                                {"baseline", "bottom"},
                                {"dy", -4},
                                {"dx", 4},
                                {"x", 0},
                                {"color", "$ink"},
                                {"fontSize", 11},
                                {"text", "on this line: exactly 0"}}}}})}};
  for (json* layer : {&line, &points, &failures, &tags}) {
    (*layer)["encoding"]["x"] = x;
    (*layer)["encoding"]["y"] = y;
  }
  json layers = json::array({ground, line, points, failures, tags});
  return {{"description", description},
          {"width", "container"},
          {"height", 330},
          {"autosize", {{"type", "fit-x"}, {"contains", "padding"}}},
          {"data", {{"name", "rows"}}},
          {"layer", layers}};
}

void tag_ends(json& rows, const std::string& text_field) {
  constexpr double word_width = 0.16, word_height = 0.05;  // of a word, in widths and heights of a chart
  using Place = std::array<double, 3>;  // height, and the places across in the charts against work and seconds
  const auto place = [](const json& r) {
    const auto logarithm = [&](const char* field) { return std::log10(r[field].get<double>()); };
    return Place{logarithm("shown"), logarithm("work"), logarithm("seconds")};
  };
  Place least, most;
  least.fill(std::numeric_limits<double>::infinity());
  most.fill(-std::numeric_limits<double>::infinity());
  std::map<std::string, std::pair<json*, json*>> ends;
  for (auto& r : rows) {
    if (r.value("failed", false) || r.value(text_field, "").empty()) continue;
    auto& [first, last] = ends[r.value("line", "") + '\n' + r.value("quantity", "") + '\n' + r.value("scene", "")];
    if (!first || r["order"] < (*first)["order"]) first = &r;
    if (!last || r["order"] > (*last)["order"]) last = &r;
    const Place at = place(r);
    for (std::size_t i = 0; i < at.size(); ++i)
      if (std::isfinite(at[i])) {
        least[i] = std::min(least[i], at[i]);
        most[i] = std::max(most[i], at[i]);
      }
  }
  std::map<std::string, std::vector<Place>> taken;  // by what is shown at once
  for (auto& [key, pair] : ends) {
    const auto apart = [&](const Place& a, const Place& b) {
      const auto far = [&](std::size_t i, double room) { return std::abs(a[i] - b[i]) > room * (most[i] - least[i]); };
      const auto drawn = [&](std::size_t i) { return std::isfinite(a[i]) && std::isfinite(b[i]); };
      return far(0, word_height) || ((far(1, word_width) || !drawn(1)) && (far(2, word_width) || !drawn(2)));
    };
    if (pair.first == pair.second || !apart(place(*pair.first), place(*pair.second))) continue;
    for (json* r : {pair.first, pair.second}) {
      auto& others = taken[r->value("quantity", "") + '\n' + r->value("scene", "")];
      const Place at = place(*r);
      if (!std::all_of(others.begin(), others.end(), [&](const Place& other) { return apart(at, other); })) continue;
      (*r)["tag"] = (*r)[text_field];
      others.push_back(at);
    }
  }
}

const Cell* best_cell(const Study& study, const std::string& family) {
  const Cell* best = nullptr;
  const auto rank = [](const Cell& c) {
    constexpr double none = std::numeric_limits<double>::infinity();
    return std::make_tuple(worst(c.enforcement, "response:").value_or(none), worst(c.kkt, "").value_or(none));
  };
  for (const auto& cell : study.cells)
    if (cell.family == family && cell.converged && cell.variant == study.main_variant)
      if (!best || rank(cell) <= rank(*best)) best = &cell;
  return best;
}

}  // namespace stickslip::report
