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

}  // namespace

std::optional<Figure> tractions(const Study& study) {
  // The most accurate cell of the variant is what the others are compared with, point by point.
  const Cell* reference = nullptr;
  for (const auto& family : study.families)
    if (const Cell* best = best_cell(study, family))
      if (!reference ||
          worst(best->enforcement, "response:").value_or(1) <= worst(reference->enforcement, "response:").value_or(1))
        reference = best;
  if (!reference) return std::nullopt;

  Figure figure;
  SeriesList series(study);
  figure.id = "tractions";
  figure.title = "Tractions along the interface, last step";
  const auto shown = telling_cells(study, Furthest::added);
  add_first(series, study, shown);
  const json& analytic = at(study.description, "analytic");
  const json& curves_of = object_at(analytic, "curves");

  // Past this many points only the cells shown at first are kept: the page has to stay light.
  constexpr std::size_t most_points = 20000;
  std::size_t points = 0;
  for (const auto& cell : study.cells)
    if (cell.variant == study.main_variant)
      for (const auto& [name, face] : object_at(cell.record, "interface").items())
        points += numbers_at(face, "normal").size();

  for (const auto& cell : study.cells) {
    if (cell.variant != study.main_variant) continue;
    const bool chosen = std::find(shown.begin(), shown.end(), cell.label) != shown.end();
    if (points > most_points && !chosen) continue;
    const std::string name = in_words(cell);
    for (const auto& [contact, face] : object_at(cell.record, "interface").items()) {
      const auto arc = numbers_at(face, "arc"), x = numbers_at(face, "x");
      const auto normal = numbers_at(face, "normal"), tangential = numbers_at(face, "tangential");
      const json& twin = at(at(reference->record, "interface"), contact);
      const auto normal_of_reference = numbers_at(twin, "normal");
      const auto tangential_of_reference = numbers_at(twin, "tangential");
      const auto& s = at(at(curves_of, contact), "x").is_array() ? x : arc;
      if (normal.size() < 2 || s.size() != normal.size()) continue;
      const json& states = array_at(face, "state");
      json base = row_of(cell);
      base["failed"] = false;  // a curve like any other; its name tells the status
      base["series"] = base["line"] = name;
      base["of_cell"] = "yes";
      base["contact"] = contact;
      series.add(name, cell.family);
      const double scale_p = largest(normal_of_reference), scale_q = largest(tangential_of_reference);
      // Curves that coincide stay readable when each marks other points.
      const std::size_t stride = std::max<std::size_t>(normal.size() / 12, 1), turn = 3 * series.place(name);
      for (std::size_t i = 0; i < normal.size(); ++i) {
        base["unmarked"] = (i + turn) % stride != 0;
        const std::string state = i < states.size() ? plain(states[i]) : "";
        base["state"] = state;
        add_traction(figure.rows, base, "pressure", s[i], -normal[i]);
        if (i < tangential.size()) add_traction(figure.rows, base, "tangential traction", s[i], tangential[i]);
        if (normal_of_reference.size() == normal.size() && scale_p > 0 && &cell != reference &&
            (normal[i] != 0 || normal_of_reference[i] != 0)) {
          double difference = std::abs(normal[i] - normal_of_reference[i]) / scale_p;
          if (tangential.size() == normal.size() && tangential_of_reference.size() == normal.size() && scale_q > 0)
            difference = std::max(difference, std::abs(tangential[i] - tangential_of_reference[i]) / scale_q);
          add_traction(figure.rows, base, "difference", s[i], difference);
        }
      }
    }
  }
  if (figure.rows.empty()) return std::nullopt;
  const bool far_left_out = keep_near_the_contact(figure.rows);

  const std::string closed = "closed form";
  json closed_rows = json::array();  // first, so that the runs are drawn over them
  for (const auto& [contact, curve] : curves_of.items()) {
    const auto s = numbers_at(curve, at(curve, "x").is_array() ? "x" : "s");
    const auto normal = numbers_at(curve, "normal"), tangential = numbers_at(curve, "tangential");
    json base = {{"label", closed}, {"series", closed}, {"line", closed},    {"family", ""},
                 {"failed", false}, {"unmarked", true}, {"contact", contact}};
    for (std::size_t i = 0; i < s.size(); ++i) {
      if (i < normal.size()) add_traction(closed_rows, base, "pressure", s[i], -normal[i]);
      if (i < tangential.size()) add_traction(closed_rows, base, "tangential traction", s[i], tangential[i]);
    }
  }
  figure.rows.insert(figure.rows.begin(), closed_rows.begin(), closed_rows.end());
  figure.series = series.list;
  if (!closed_rows.empty()) figure.series.insert(figure.series.begin(), {closed, "$ink", "circle", {1, 0}, 10});

  json differences = json::array(), others = json::array();
  for (auto& r : figure.rows) (r["panel"] == "difference" ? differences : others).push_back(r);
  show_zeros(differences, "value");
  for (auto& r : others) {
    r["shown"] = r["value"];
  }
  figure.rows = others;
  for (auto& r : differences) figure.rows.push_back(r);

  figure.text = "Pressure is positive in compression.";
  if (far_left_out) figure.text += " Open points far from what touches are left out.";
  if (!differences.empty())
    figure.text += fmt::format(
        " The last panel is the distance, point by point, from {}, a run of the most accurate, relative to its largest "
        "traction: there the methods come apart where the curves above lie on each other. Shown at first are the most "
        "accurate run of each method and the one furthest off.",
        in_words(*reference));
  const json tips = tooltip({{"series", "run"}, {"s", "position"}, {"value", "value"}, {"state", "state"}});
  for (const auto& [panel, title, logarithmic] :
       {std::tuple{std::string("pressure"), "pressure p", false},
        std::tuple{std::string("tangential traction"), "tangential traction q", false},
        std::tuple{std::string("difference"), "difference / largest traction", true}}) {
    if (std::none_of(figure.rows.begin(), figure.rows.end(),
                     [&](const json& r) { return r["panel"] == panel && r["value"] != 0; }))
      continue;
    json spec = curves(figure.title + ": " + title, channel("s", "position along the interface", false),
                       channel("shown", title, logarithmic), tips);
    spec["transform"] = only_if("datum.panel == '" + panel + "'");
    figure.panels.push_back({title, spec, "s", "shown", false, logarithmic, panel, false});
  }
  if (figure.panels.empty()) return std::nullopt;  // nothing touches, and nothing should
  offer(figure, "Contact", "contact");
  offer_cells(figure, shown);
  return figure;
}

}  // namespace stickslip::report
