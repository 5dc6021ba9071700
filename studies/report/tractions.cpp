#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "studies/report/chart_parts.hpp"
#include "studies/report/look_up.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

std::vector<double> numbers_at(const json& value, const std::string& key) {
  std::vector<double> out;
  for (const auto& v : array_at(value, key)) out.push_back(v.is_number() ? v.get<double>() : std::nan(""));
  return out;
}

/// The largest magnitude, not counting what is not finite.
double largest(const std::vector<double>& values) {
  double out = 0;
  for (const double v : values)
    if (std::isfinite(v)) out = std::max(out, std::abs(v));
  return out;
}

void add_traction(json& rows, const json& base, const char* panel, double s, double value) {
  if (!std::isfinite(s) || !std::isfinite(value)) return;
  json r = base;
  r["panel"] = panel;
  r["s"] = r["order"] = s;
  r["value"] = value;
  rows.push_back(r);
}

/// Of each contact keeps the rows where some run touches, and a third of that stretch on either side; true where others
/// were left out.
bool keep_near_the_contact(json& rows) {
  struct Stretch {
    double low = INFINITY, high = -INFINITY;
    bool near(double s) const {
      const double room = (high - low) / 3;
      return !(high > low) || (s >= low - room && s <= high + room);
    }
  };
  std::map<std::string, Stretch> touching;
  for (const auto& r : rows)
    if (r["panel"] == "pressure" && r["value"] != 0) {
      Stretch& stretch = touching[r["contact"]];
      stretch.low = std::min(stretch.low, r["s"].get<double>());
      stretch.high = std::max(stretch.high, r["s"].get<double>());
    }
  json kept = json::array();
  for (const auto& r : rows)
    if (touching[r["contact"]].near(r["s"])) kept.push_back(r);
  const bool any = kept.size() < rows.size();
  rows = std::move(kept);
  return any;
}

/// The most accurate cell of the variant: what the others are compared with, point by point.
const Cell* most_accurate(const Study& study) {
  const Cell* reference = nullptr;
  for (const auto& family : study.families)
    if (const Cell* best = best_cell(study, family))
      if (!reference ||
          worst(best->enforcement, "response:").value_or(1) <= worst(reference->enforcement, "response:").value_or(1))
        reference = best;
  return reference;
}

/// Whether the page would be too heavy with the curves of all cells: then it has those that are shown at first.
bool has_too_many_points(const Study& study) {
  constexpr std::size_t most_points = 20000;
  std::size_t points = 0;
  for (const auto& cell : study.cells)
    if (cell.variant == study.main_variant)
      for (const auto& [name, face] : object_at(cell.record, "interface").items())
        points += numbers_at(face, "normal").size();
  return points > most_points;
}

/// Tractions at the points of one contact.
struct Tractions {
  std::vector<double> normal, tangential;
  explicit Tractions(const json& face)
      : normal(numbers_at(face, "normal")), tangential(numbers_at(face, "tangential")) {}
};

constexpr double rounding = 1e-16;  ///< of the largest traction

/// How far point i is from the reference, relative to its largest tractions; none where that says nothing.
std::optional<double> difference(const Tractions& of, const Tractions& reference, std::size_t i) {
  const double scale_p = largest(reference.normal), scale_q = largest(reference.tangential);
  if (reference.normal.size() != of.normal.size() || !(scale_p > 0)) return std::nullopt;
  if (of.normal[i] == 0 && reference.normal[i] == 0) return std::nullopt;
  double difference = std::abs(of.normal[i] - reference.normal[i]) / scale_p;
  if (of.tangential.size() == of.normal.size() && reference.tangential.size() == of.normal.size() && scale_q > 0)
    difference = std::max(difference, std::abs(of.tangential[i] - reference.tangential[i]) / scale_q);
  return difference < rounding ? 0 : difference;
}

/// The rows of one contact of a cell. `along_x`: its closed form goes along x. `turn`: which points are marked.
void add_face(json& rows, json base, const json& face, const json& reference, bool along_x, std::size_t turn) {
  const Tractions of(face), twin(reference);
  const auto s = numbers_at(face, along_x ? "x" : "arc");
  const json& states = array_at(face, "state");
  // Curves that coincide stay readable when each marks other points.
  const std::size_t stride = std::max<std::size_t>(of.normal.size() / 12, 1);
  for (std::size_t i = 0; i < of.normal.size(); ++i) {
    base["unmarked"] = (i + turn) % stride != 0;
    const std::string state = i < states.size() ? plain(states[i]) : "";
    base["state"] = state;
    add_traction(rows, base, "pressure", s[i], -of.normal[i]);
    if (i < of.tangential.size()) add_traction(rows, base, "tangential traction", s[i], of.tangential[i]);
    if (reference.is_null()) continue;
    if (const auto far = difference(of, twin, i)) add_traction(rows, base, "difference", s[i], *far);
  }
}

/// Whether a contact's closed form goes along x, and not along the arc.
bool goes_along_x(const json& curves_of, const std::string& contact) {
  return at(at(curves_of, contact), "x").is_array();
}

/// The rows of all runs.
json rows_of_runs(const Study& study, const Cell& reference, const std::vector<std::string>& shown,
                  SeriesList& series) {
  const json& curves_of = object_at(at(study.description, "analytic"), "curves");
  const bool shown_alone = has_too_many_points(study);
  json rows = json::array();
  std::vector<const Cell*> cells;
  for (const auto* all : {&study.cells, &study.peers})
    for (const auto& cell : *all) cells.push_back(&cell);
  for (const Cell* one : cells) {
    const Cell& cell = *one;
    if (cell.variant != study.main_variant) continue;
    if (shown_alone && std::find(shown.begin(), shown.end(), cell.label) == shown.end()) continue;
    const std::string name = in_words(cell);
    for (const auto& [contact, face] : object_at(cell.record, "interface").items()) {
      const bool along_x = goes_along_x(curves_of, contact);
      const std::size_t points = numbers_at(face, "normal").size();
      if (points < 2 || numbers_at(face, along_x ? "x" : "arc").size() != points) continue;
      json base = row_of(cell);
      base["failed"] = false;  // a curve like any other; its name tells the status
      base["series"] = base["line"] = name;
      base["of_cell"] = "yes";
      base["contact"] = contact;
      series.add(name, cell.family);
      const json& twin = &cell == &reference ? json() : at(at(reference.record, "interface"), contact);
      add_face(rows, base, face, twin, along_x, 3 * series.place(name));
    }
  }
  return rows;
}

const std::string closed_form = "closed form";

/// The rows of the closed forms that a study names.
json rows_of_closed_forms(const Study& study) {
  json rows = json::array();
  for (const auto& [contact, curve] : object_at(at(study.description, "analytic"), "curves").items()) {
    const auto s = numbers_at(curve, at(curve, "x").is_array() ? "x" : "s");
    const Tractions of(curve);
    const json base = {{"label", closed_form}, {"series", closed_form}, {"line", closed_form}, {"family", ""},
                       {"failed", false},      {"unmarked", true},      {"contact", contact}};
    for (std::size_t i = 0; i < s.size(); ++i) {
      if (i < of.normal.size()) add_traction(rows, base, "pressure", s[i], -of.normal[i]);
      if (i < of.tangential.size()) add_traction(rows, base, "tangential traction", s[i], of.tangential[i]);
    }
  }
  return rows;
}

/// Gives rows the value that is drawn, and puts the differences last; true where there are any.
bool sort_for_panels(json& rows) {
  json differences = json::array(), others = json::array();
  for (auto& r : rows) (r["panel"] == "difference" ? differences : others).push_back(r);
  show_zeros(differences, "value");
  for (auto& r : others) r["shown"] = r["value"];
  rows = std::move(others);
  for (auto& r : differences) rows.push_back(r);
  return !differences.empty();
}

/// Whether all rows of a panel have one value, up to rounding.
bool is_level(const json& rows, const std::string& panel) {
  constexpr double alike = 1e-9;
  double low = INFINITY, high = -INFINITY;
  for (const auto& r : rows)
    if (r["panel"] == panel) {
      low = std::min(low, r["value"].get<double>());
      high = std::max(high, r["value"].get<double>());
    }
  return high - low <= alike * std::max(std::abs(low), std::abs(high));
}

/// One chart a kind of traction that is not zero everywhere, and one of the differences. What is the same at all points
/// of all runs is folded, where there is something else.
void add_charts(Figure& figure) {
  for (const auto& [panel, title, spacing] :
       {std::tuple{std::string("pressure"), "pressure p", Spacing::linear},
        std::tuple{std::string("tangential traction"), "tangential traction q", Spacing::linear},
        std::tuple{std::string("difference"), "difference / largest traction", Spacing::logarithmic}}) {
    if (std::none_of(figure.rows.begin(), figure.rows.end(),
                     [&panel = panel](const json& r) { return r["panel"] == panel && r["value"] != 0; }))
      continue;
    figure.charts.push_back({.title = title,
                             .x = {"s", "position along the interface"},
                             .y = {"shown", title, spacing},
                             .tooltip = {{"series", "run"}, {"s", "position"}, {"value", "value"}, {"state", "state"}},
                             .only = panel,
                             .folded = is_level(figure.rows, panel)});
  }
  if (std::all_of(figure.charts.begin(), figure.charts.end(), [](const Chart& chart) { return chart.folded; }))
    for (Chart& chart : figure.charts) chart.folded = false;
}

}  // namespace

std::optional<Figure> tractions(const Study& study) {
  const Cell* reference = most_accurate(study);
  if (!reference) return std::nullopt;
  Figure figure;
  SeriesList series(study);
  figure.id = "tractions";
  figure.title = "Tractions along the interface, last step";
  auto shown = telling_cells(study, Furthest::added);
  add_first(series, study, shown);
  for (const auto& peer : study.peers) shown.push_back(peer.label);
  figure.rows = rows_of_runs(study, *reference, shown, series);
  if (figure.rows.empty()) return std::nullopt;
  const bool far_left_out = keep_near_the_contact(figure.rows);
  const json closed = rows_of_closed_forms(study);
  figure.rows.insert(figure.rows.begin(), closed.begin(), closed.end());  // first, so that runs are drawn over them
  figure.series = series.list;
  if (!closed.empty()) figure.series.insert(figure.series.begin(), {closed_form, "$ink", "circle", {1, 0}, 10});
  const bool differ = sort_for_panels(figure.rows);
  figure.text = "Pressure is positive in compression.";
  if (far_left_out) figure.text += " Open points far from what touches are left out.";
  if (differ)
    figure.text += fmt::format(
        " The last panel is the distance, point by point, from {}, a run of the most accurate, relative to its largest "
        "traction (below 1e-16, which is rounding, counted as 0): there the methods come apart where the curves above "
        "lie on each other. Shown at first are the most "
        "accurate run of each method and the one furthest off.",
        in_words(*reference));
  add_charts(figure);
  if (figure.charts.empty()) return std::nullopt;  // nothing touches, and nothing should
  offer(figure, "Contact", "contact");
  offer_cells(figure, shown);
  return figure;
}

}  // namespace stickslip::report
