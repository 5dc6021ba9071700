#include "studies/report/charts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <tuple>

#include "studies/report/look_up.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

// --- series --------------------------------------------------------------------------------------------------------

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

/// Adds a series once. Colour and size go by family; marker and dash by the place within the family, starting with
/// another one for each family.
class SeriesList {
 public:
  explicit SeriesList(const Study& study) : study_(study) {}

  void add(const std::string& name, const std::string& family) {
    if (place(name) < list.size()) return;
    static const std::vector<std::string> shapes = {"circle",        "square",         "triangle-up", "diamond",
                                                    "triangle-down", "triangle-right", "cross",       "triangle-left"};
    static const std::vector<std::vector<int>> dashes = {{1, 0}, {7, 3}, {2, 2}, {9, 3, 2, 3}, {4, 2}, {12, 4}};
    static const std::vector<int> sizes = {130, 70, 40, 90};
    const auto at = std::find(study_.families.begin(), study_.families.end(), family) - study_.families.begin();
    const std::size_t place = static_cast<std::size_t>(at) + 3 * count_[family]++;
    list.push_back({name, color_of(study_, family), shapes[place % shapes.size()], dashes[place % dashes.size()],
                    sizes[static_cast<std::size_t>(at) % sizes.size()]});
  }

  /// Where `name` stands in the list; its length where it does not.
  std::size_t place(const std::string& name) const {
    return static_cast<std::size_t>(
        std::find_if(list.begin(), list.end(), [&](const Series& s) { return s.name == name; }) - list.begin());
  }

  std::vector<Series> list;

 private:
  const Study& study_;
  std::map<std::string, std::size_t> count_;
};

// --- rows ----------------------------------------------------------------------------------------------------------

json row_of(const Cell& cell) {
  return {{"label", cell.label}, {"family", cell.family}, {"status", cell.status}, {"failed", !cell.converged}};
}

/// Six digits are more than a chart shows; a third of the bytes.
double rounded(double value) { return std::stod(fmt::format("{:.6g}", value)); }

/// Adds `shown` to each row: `field` where it is positive. Where it is exactly 0, which no logarithmic axis can hold,
/// a decade below the smallest other value of the same choice, with `zero` set, so that the point is kept and named.
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

std::vector<std::string> distinct(const json& rows, const std::string& field, const std::string& panel = "") {
  std::vector<std::string> out;
  for (const auto& r : rows) {
    if (!panel.empty() && r.value("panel", "") != panel) continue;
    if (const std::string v = r.value(field, ""); std::find(out.begin(), out.end(), v) == out.end()) out.push_back(v);
  }
  return out;
}

/// A choice of one among the values of `field`, where there are several; `first` is chosen if it is among them.
void offer(Figure& figure, const std::string& label, const std::string& field, const std::string& first = "",
           const std::string& panel = "") {
  Choice choice{label, field, distinct(figure.rows, field, panel), {}, false, panel.empty() ? "" : "panel", panel};
  if (choice.options.size() < 2) return;
  const bool known = std::find(choice.options.begin(), choice.options.end(), first) != choice.options.end();
  choice.chosen = {known ? first : choice.options.front()};
  figure.choices.push_back(choice);
}

const std::map<std::string, double>& errors_of(const Cell& cell, Against against) {
  if (against == Against::same_mesh) return cell.enforcement;
  return against == Against::closed_form ? cell.discretization : cell.kkt;
}

/// The quantities of one cell: the worst of `prefix` first where there are several, then each that starts with one of
/// the prefixes.
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
  if (of_first > 1) out.insert(out.begin(), {worst_name, *worst(errors, prefixes.front())});
  return out;
}

// --- Vega-Lite -----------------------------------------------------------------------------------------------------

const char* number_label =
    "datum.value == 0 ? '0' : abs(datum.value) < 0.01 || abs(datum.value) >= 1e4 ? "
    "replace(format(datum.value, '~e'), '+', '') : format(datum.value, '~r')";

json channel(const std::string& field, const std::string& title, bool logarithmic) {
  json scale = {{"nice", false}, {"padding", 18}, {"zero", false}};
  if (logarithmic) scale = {{"type", "log"}, {"nice", false}, {"padding", 18}};
  return {{"field", field},
          {"type", "quantitative"},
          {"title", title},
          {"scale", scale},
          {"axis", {{"labelExpr", number_label}, {"labelOverlap", true}}}};
}

json series_channel(const char* range) {
  return {{"field", "series"},
          {"type", "nominal"},
          {"title", nullptr},
          {"scale", {{"domain", "$series"}, {"range", range}}},
          {"legend", {{"orient", "top"}, {"columns", 2}, {"labelLimit", 300}, {"symbolFillColor", "transparent"}}}};
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

json only_if(const std::string& test) { return json::array({{{"filter", test}}}); }

json tooltip(const std::vector<std::pair<std::string, std::string>>& fields) {
  json out = json::array();
  for (const auto& [field, title] : fields) out.push_back({{"field", field}, {"title", title}});
  return out;
}

/// Lines, markers, crosses for what failed, and the ground for exact zeros. Rows: series, line, order, shown, zero,
/// failed, and `tag`, a word beside the marker.
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

/// Marks the ends of each line with the knob's value there, so that a reader sees which way it runs. Not those of a
/// line that stays in one place: the knob does nothing, and the two words would cover each other.
void tag_ends(json& rows, const std::string& text_field) {
  const auto apart = [](const json& a, const json& b, const char* field, double factor) {
    const double u = a[field], v = b[field];
    return std::max(u, v) > factor * std::min(u, v);
  };
  std::map<std::string, std::pair<json*, json*>> ends;
  for (auto& r : rows) {
    if (r.value("failed", false) || r.value(text_field, "").empty()) continue;
    auto& [first, last] = ends[r.value("line", "") + '\n' + r.value("quantity", "") + '\n' + r.value("scene", "")];
    if (!first || r["order"] < (*first)["order"]) first = &r;
    if (!last || r["order"] > (*last)["order"]) last = &r;
  }
  for (auto& [key, pair] : ends)
    if (pair.first != pair.second &&
        (apart(*pair.first, *pair.second, "work", 1.5) || apart(*pair.first, *pair.second, "shown", 3)))
      for (json* r : {pair.first, pair.second}) (*r)["tag"] = (*r)[text_field];
}

}  // namespace

// --- figures -------------------------------------------------------------------------------------------------------

std::vector<std::vector<std::string>> knob_groups(const Study& study) {
  std::vector<std::vector<std::string>> groups;
  std::vector<std::string> regularisation;
  for (const auto& name : knob_names(study)) {
    if (name == "stiffness" || name == "scale")
      regularisation.push_back(name);
    else
      groups.push_back({name});
  }
  if (!regularisation.empty()) groups.insert(groups.begin(), regularisation);
  return groups;
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

std::optional<Figure> work_precision(const Study& study, Against against, Of of) {
  const bool derivative = of == Of::sensitivities;
  std::vector<std::string> prefixes =
      derivative ? std::vector<std::string>{"sensitivity:"} : std::vector<std::string>{"response:", "field:"};
  if (against == Against::coulomb) prefixes = {""};
  const std::string worst_name = against == Against::coulomb ? "worst of all"
                                 : derivative                ? "worst sensitivity"
                                                             : "worst response";
  Figure figure;
  SeriesList series(study);
  figure.table.header = {"method",         "scene",       "quantity", "error", "work",
                         "factorisations", "back-solves", "seconds",  "status"};
  for (const auto& cell : study.cells) {
    const std::string knob = running_knob(study, cell.family);
    const std::string name = series_of(cell, knob) + (knob.empty() ? "" : ", along " + knob);
    const double factorizations =
        cell.count("factorizations") - (derivative ? 0 : cell.count("sensitivity_factorizations"));
    const double backsolves = cell.count("backsolves") + (derivative ? cell.count("sensitivity_backsolves") : 0);
    const double work = derivative ? cell.sensitivity_work : cell.work;
    const double seconds = derivative ? cell.sensitivity_seconds : cell.seconds;
    for (const auto& [quantity, error] : quantities(errors_of(cell, against), prefixes, worst_name)) {
      json r = row_of(cell);
      r["series"] = r["line"] = name;
      r["scene"] = cell.variant;
      r["quantity"] = quantity;
      r["error"] = error;
      r["work"] = rounded(work);
      r["backsolves"] = backsolves;
      r["seconds"] = rounded(seconds);
      const Knob* value = find_knob(cell, knob);
      r["order"] = value && value->value ? *value->value : 0;
      if (value) r["knob"] = value->text;
      figure.rows.push_back(r);
      series.add(name, cell.family);
      figure.table.rows.push_back({cell.label, cell.variant, quantity, number(error), number(work, 4),
                                   number(factorizations, 9), number(backsolves, 9), number(seconds), cell.status});
    }
  }
  if (figure.rows.empty()) return std::nullopt;
  show_zeros(figure.rows, "error");
  tag_ends(figure.rows, "knob");
  figure.series = series.list;

  const std::string what = derivative ? "sensitivities" : "responses";
  const std::string joined =
      "A curve joins the runs of one method along the option that is swept; its ends carry the option's value.";
  std::string y_title = derivative ? "relative error of the sensitivity" : "relative error of the response";
  if (against == Against::same_mesh) {
    figure.id = "enforcement-" + what;
    figure.title = derivative ? "Sensitivities: what enforcing contact exactly costs"
                              : "Responses: what enforcing contact exactly costs";
    figure.text =
        "Enforcement error: the distance from the reference solution on the same mesh, so what is seen is "
        "the method alone. Lower left is better. " +
        joined +
        " A method that is the reference itself "
        "stands on the line of exact zeros. ";
  } else if (against == Against::closed_form) {
    figure.id = "discretization-" + what;
    figure.title =
        derivative ? "Sensitivities: error against the closed form" : "Responses: error against the closed form";
    figure.text =
        "Discretisation error: the distance from the closed-form solution, mesh and method together. Where "
        "curves lie on one level, the mesh decides and a stricter method buys nothing. " +
        joined + " ";
  } else {
    figure.id = "kkt";
    figure.title = "How well equilibrium and Coulomb's law are met";
    figure.text =
        "Computed from the final state alone by code that does not know which method ran; every measure is "
        "dimensionless. " +
        joined + " ";
    y_title = "measure";
  }
  figure.text += derivative ? "Costs are those of the solution and its derivatives together." : "";
  const json y = channel("shown", y_title, true);
  const json tips = tooltip({{"label", "method"},
                             {"error", "error"},
                             {"work", "work"},
                             {"seconds", "seconds"},
                             {"backsolves", "back-solves"},
                             {"status", "status"}});
  const auto panel = [&](const std::string& field, const std::string& title, bool folded) {
    const auto positive = [&](const json& r) { return r[field].get<double>() > 0; };
    if (std::none_of(figure.rows.begin(), figure.rows.end(), positive)) return;
    json spec = curves(figure.title + ", against " + title, channel(field, title, true), y, tips);
    spec["transform"] = only_if("datum." + field + " > 0");
    figure.panels.push_back({"against " + title, spec, field, "shown", true, true, "", folded});
  };
  panel("work", "work (factorisations)", false);
  panel("seconds", "seconds", false);
  panel("backsolves", "back-solves", true);
  if (figure.panels.empty()) return std::nullopt;
  offer(figure, "Quantity", "quantity", worst_name);
  offer(figure, "Scene", "scene", study.main_variant);
  return figure;
}

namespace {

/// A row per cell and value for each that has one of `knobs`; for families that have none, their best cell as a level
/// line over the whole range. `add` is called with the row to complete and its cell.
template <class Add>
void rows_along(const Study& study, const std::vector<std::string>& knobs, SeriesList& series, Add add) {
  double low = std::numeric_limits<double>::infinity(), high = 0;
  std::set<std::string> with_knob;
  for (const auto& cell : study.cells)
    for (const auto& name : knobs)
      if (const Knob* knob = find_knob(cell, name); knob && knob->value && *knob->value > 0) {
        low = std::min(low, *knob->value);
        high = std::max(high, *knob->value);
        with_knob.insert(cell.family);
      }
  for (const auto& cell : study.cells) {
    const Knob* knob = nullptr;
    std::string name;
    for (const auto& candidate : knobs)
      if (const Knob* found = find_knob(cell, candidate); found && found->value && *found->value > 0) {
        knob = found;
        name = candidate;
      }
    json r = row_of(cell);
    r["scene"] = cell.variant;
    if (knob) {
      r["series"] = series_of(cell, name);
      r["line"] = r["series"];
      r["knob"] = r["order"] = *knob->value;
      r["knob_name"] = name;
      series.add(r["series"], cell.family);
      add(r, cell);
    } else if (with_knob.count(cell.family) == 0 && &cell == best_cell(study, cell.family)) {
      r["series"] = r["line"] = family_name(cell.family) + " (has no such option)";
      r["unmarked"] = true;
      series.add(r["series"], cell.family);
      for (const double x : {low, high}) {
        r["knob"] = r["order"] = x;
        add(r, cell);
      }
    }
  }
}

/// `text` as an HTML id: what is no letter or digit becomes '-'.
std::string slug(std::string text) {
  for (char& c : text)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '-';
  return text;
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

/// A grey line of slope -1 through the middle of the penalty's falling branch: the rate theory gives.
void add_guides(json& rows) {
  std::map<std::tuple<std::string, std::string, std::string, std::string>, std::vector<std::pair<double, double>>> runs;
  for (const auto& r : rows)
    if (r["family"] == "penalty" && r.value("knob_name", "") == "stiffness" && !r["failed"].get<bool>() &&
        r["error"].get<double>() > 0)
      runs[{r["panel"], r["quantity"], r["scene"], r["series"]}].emplace_back(r["knob"], r["error"]);
  for (auto& [key, points] : runs) {
    std::sort(points.begin(), points.end());
    const auto least = std::min_element(points.begin(), points.end(),
                                        [](const auto& a, const auto& b) { return a.second < b.second; });
    if (least - points.begin() < 2) continue;
    const auto& middle = points[static_cast<std::size_t>(least - points.begin()) / 2];
    for (const auto& end : {points.front(), *least}) {
      json r = {{"panel", std::get<0>(key)}, {"quantity", std::get<1>(key)}, {"scene", std::get<2>(key)}};
      r["family"] = "penalty";
      r["guide"] = true;
      r["failed"] = false;
      r["line"] = "guide " + std::get<3>(key);
      r["knob"] = r["order"] = end.first;
      // Set off by a factor of 3, so that a curve that follows it is not hidden.
      r["error"] = middle.second * middle.first / end.first / 3;
      r["guide_tag"] = end.first == least->first ? "slope -1" : "";
      rows.push_back(r);
    }
  }
}

json with_guides(json spec, const json& x, const json& y) {
  json guide = {
      {"transform", only_if("datum.guide")},
      {"encoding", {{"x", x}, {"y", y}, {"detail", {{"field", "line"}}}}},
      {"layer",
       json::array(
           {{{"mark", {{"type", "line"}, {"strokeDash", {3, 3}}, {"strokeWidth", 1}, {"color", "$ink"}}}},
            {{"transform", only_if("datum.guide_tag != ''")},
             {"mark",
              {{"type", "text"}, {"align", "right"}, {"dx", -6}, {"dy", 6}, {"color", "$ink"}, {"fontSize", 11}}},
             {"encoding", {{"text", {{"field", "guide_tag"}}}}}}})}};
  spec["layer"].insert(spec["layer"].begin(), guide);
  return spec;
}

}  // namespace

std::optional<Figure> error_against_knob(const Study& study, const std::vector<std::string>& knobs) {
  Figure figure;
  SeriesList series(study);
  figure.id = slug("error-" + knobs.front());
  figure.title = "Error against " + knob_title(knobs);
  figure.table.header = {"method", "scene", "option", "value", "quantity", "error", "status"};
  rows_along(study, knobs, series, [&](json r, const Cell& cell) {
    for (const auto& [panel, prefix, worst_name] : {std::tuple{"responses", "response:", "worst response"},
                                                    std::tuple{"sensitivities", "sensitivity:", "worst sensitivity"}})
      for (const auto& [quantity, error] : quantities(cell.enforcement, {prefix}, worst_name)) {
        r["panel"] = panel;
        r["quantity"] = quantity;
        r["error"] = error;
        figure.rows.push_back(r);
        figure.table.rows.push_back({cell.label, cell.variant, r.value("knob_name", "none"),
                                     r.contains("knob_name") ? number(r["knob"], 6) : "", quantity, number(error),
                                     cell.status});
      }
  });
  if (figure.rows.empty()) return std::nullopt;
  add_guides(figure.rows);
  show_zeros(figure.rows, "error");
  figure.series = series.list;
  const bool penalty = std::find(knobs.begin(), knobs.end(), "stiffness") != knobs.end();
  figure.text = "Enforcement error (same mesh) as the option is turned. ";
  figure.text += penalty ? "Penalty lets bodies penetrate and creep by an amount proportional to 1/stiffness, so its "
                           "error falls with slope -1, until rounding, which grows with the stiffness, lifts it again. "
                           "An augmented Lagrangian's answer does not depend on its scale: its line is flat. "
                         : "";
  figure.text += "Crosses are runs that did not converge.";
  const json tips = tooltip({{"label", "method"}, {"knob", "option"}, {"error", "error"}, {"status", "status"}});
  for (const std::string panel : {"responses", "sensitivities"}) {
    if (distinct(figure.rows, "quantity", panel).empty()) continue;
    const bool derivative = panel == "sensitivities";
    const json x = channel("knob", knob_title(knobs), true);
    const json y =
        channel("shown", derivative ? "relative error of the sensitivity" : "relative error of the response", true);
    json spec = with_guides(curves(figure.title + ", " + panel, x, y, tips), x, y);
    spec["transform"] = only_if("datum.panel == '" + panel + "'");
    figure.panels.push_back({panel, spec, "knob", "shown", true, true, panel, false});
    offer(figure, derivative ? "Sensitivity" : "Response", "quantity", "", panel);
  }
  offer(figure, "Scene", "scene", study.main_variant);
  return figure;
}

/// Panels of iterations_against_knob, each with the count it shows.
const std::pair<std::string, std::string> counted_along_knobs[] = {
    {"Newton iterations", "newton"},
    {"augmentations", "augmentations"},
    {"back-solves for derivatives", "sensitivity_backsolves"}};

std::optional<Figure> iterations_against_knob(const Study& study, const std::vector<std::string>& knobs) {
  Figure figure;
  SeriesList series(study);
  figure.id = slug("iterations-" + knobs.front());
  figure.title = "Iterations against " + knob_title(knobs);
  figure.text = "Totals of the whole run. Crosses are runs that did not converge, at what they had spent by then.";
  figure.table.header = {
      "method",   "scene", "option", "value", "Newton iterations", "augmentations", "back-solves for derivatives",
      "cutbacks", "status"};
  rows_along(study, knobs, series, [&](json r, const Cell& cell) {
    for (const auto& [panel, count] : counted_along_knobs)
      if (cell.count(count) > 0) {
        r["panel"] = panel;
        r["shown"] = cell.count(count);
        figure.rows.push_back(r);
      }
    figure.table.rows.push_back(
        {cell.label, cell.variant, r.value("knob_name", "none"), r.contains("knob_name") ? number(r["knob"], 6) : "",
         number(cell.count("newton"), 9), number(cell.count("augmentations"), 9),
         number(cell.count("sensitivity_backsolves"), 9), number(cell.count("cutbacks"), 9), cell.status});
  });
  if (figure.rows.empty()) return std::nullopt;
  figure.series = series.list;
  const json tips = tooltip({{"label", "method"}, {"knob", "option"}, {"shown", "iterations"}, {"status", "status"}});
  for (const auto& [panel, unused] : counted_along_knobs) {
    if (distinct(figure.rows, "label", panel).empty()) continue;
    json spec = curves(figure.title + ", " + panel, channel("knob", knob_title(knobs), true),
                       channel("shown", panel, true), tips);
    spec["transform"] = only_if("datum.panel == '" + panel + "'");
    figure.panels.push_back({panel, spec, "knob", "shown", true, true, panel, false});
  }
  offer(figure, "Scene", "scene", study.main_variant);
  return figure;
}

namespace {

std::string in_words(const Cell& cell) {
  return series_of(cell, "") + (cell.converged ? "" : " [" + cell.status + "]");
}

/// Names of those of `labels` in the main variant first: the cells shown at first get the most unlike markers.
void add_first(SeriesList& series, const Study& study, const std::vector<std::string>& labels) {
  for (const auto& cell : study.cells)
    if (cell.variant == study.main_variant && std::find(labels.begin(), labels.end(), cell.label) != labels.end())
      series.add(in_words(cell), cell.family);
}

/// Labels of the best cell of each family, and of the converged cell furthest from the reference of all.
std::vector<std::string> telling_cells(const Study& study, bool furthest) {
  std::vector<std::string> out;
  for (const auto& family : study.families)
    if (const Cell* best = best_cell(study, family)) out.push_back(best->label);
  const Cell* far = nullptr;
  for (const auto& cell : study.cells)
    if (cell.converged && cell.variant == study.main_variant && worst(cell.enforcement, "response:"))
      if (!far || *worst(cell.enforcement, "response:") > *worst(far->enforcement, "response:")) far = &cell;
  if (furthest && far && std::find(out.begin(), out.end(), far->label) == out.end()) out.push_back(far->label);
  return out;
}

/// Any cell of the main variant. pre: there are cells.
const Cell& main_cell(const Study& study) {
  return *std::find_if(study.cells.begin(), study.cells.end(),
                       [&](const Cell& c) { return c.variant == study.main_variant; });
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

/// Labels of up to three settings of each family in the main variant: the loosest, the middle one and the strictest.
std::vector<std::string> spread_of_cells(const Study& study) {
  std::vector<std::string> out;
  for (const auto& family : study.families) {
    std::vector<std::pair<double, std::string>> by_error;
    for (const auto& cell : study.cells)
      if (cell.family == family && cell.converged && cell.variant == study.main_variant)
        by_error.emplace_back(worst(cell.enforcement, "response:").value_or(0), cell.label);
    if (by_error.empty()) continue;
    std::sort(by_error.begin(), by_error.end());
    for (const std::size_t i : {by_error.size() - 1, by_error.size() / 2, std::size_t(0)})
      if (std::find(out.begin(), out.end(), by_error[i].second) == out.end()) out.push_back(by_error[i].second);
  }
  return out;
}

}  // namespace

std::optional<Figure> mesh_convergence(const Study& study) {
  if (!study.refined) return std::nullopt;
  Figure figure;
  SeriesList series(study);
  figure.id = "mesh";
  figure.title = "The same error as the mesh is refined";
  figure.text =
      "A curve joins the mesh levels of one setting; each level halves the elements. Counts are of unlike "
      "matrices here, so cost is in seconds. Where a loose setting's curve levels off, its own error has "
      "overtaken the mesh's. Shown at first are the loosest, a middle and the strictest setting of each "
      "method.";
  figure.table.header = {"method", "scene", "mesh level", "quantity", "error", "seconds", "status"};
  const auto shown = spread_of_cells(study);
  add_first(series, study, shown);
  for (const auto& cell : study.cells) {
    const std::string name = in_words(cell);
    for (const auto& [quantity, error] :
         quantities(cell.discretization, {"response:", "sensitivity:"}, "worst response")) {
      json r = row_of(cell);
      r["series"] = r["line"] = name;
      r["of_cell"] = "yes";
      r["scene"] = cell.scene;
      r["quantity"] = quantity;
      r["error"] = error;
      r["level"] = r["order"] = cell.refine;
      r["seconds"] = rounded(cell.sensitivity_seconds);
      figure.rows.push_back(r);
      series.add(name, cell.family);
      figure.table.rows.push_back({cell.label, cell.scene, std::to_string(cell.refine), quantity, number(error),
                                   number(cell.sensitivity_seconds), cell.status});
    }
  }
  if (figure.rows.empty()) return std::nullopt;
  show_zeros(figure.rows, "error");
  figure.series = series.list;
  const json tips = tooltip({{"label", "method"}, {"level", "mesh level"}, {"error", "error"}, {"seconds", "seconds"}});
  const json y = channel("shown", "relative error against the closed form", true);
  json x = channel("level", "mesh level", false);
  x["axis"]["tickMinStep"] = 1;
  figure.panels.push_back(
      {"against the mesh level", curves(figure.title, x, y, tips), "level", "shown", false, true, "", false});
  if (std::any_of(figure.rows.begin(), figure.rows.end(), [](const json& r) { return r["seconds"] > 0; })) {
    json spec = curves(figure.title + ", against seconds", channel("seconds", "seconds", true), y, tips);
    spec["transform"] = only_if("datum.seconds > 0");
    figure.panels.push_back({"against seconds", spec, "seconds", "shown", true, true, "", false});
  }
  offer(figure, "Quantity", "quantity", "worst response");
  offer(figure, "Scene", "scene", main_cell(study).scene);
  offer_cells(figure, shown);
  return figure;
}

std::optional<Figure> convergence_histories(const Study& study) {
  Figure figure;
  SeriesList series(study);
  figure.id = "histories";
  figure.title = "Convergence: residual per iteration in the hardest step";
  figure.text =
      "For each run, the load step that took most iterations (of a run that failed, the last). The residual "
      "is the largest of equilibrium, normal and tangential contact, each relative to its own scale; an "
      "augmented run starts anew with each augmentation, which is the sawtooth.";
  figure.table.header = {"method",         "step",          "time",          "iterations", "augmentations",
                         "first residual", "last residual", "state changes", "status"};
  const auto shown = telling_cells(study, false);
  add_first(series, study, shown);
  for (const auto& cell : study.cells) {
    if (cell.variant != study.main_variant) continue;
    const json& steps = array_at(cell.record, "steps");
    std::size_t hardest = steps.size(), most = 0;
    for (std::size_t i = 0; i < steps.size(); ++i) {
      const std::size_t length = array_at(steps[i], "history").size();
      if (length > 0 && (length >= most || !cell.converged)) {
        most = length;
        hardest = i;
      }
    }
    if (hardest == steps.size()) continue;
    const json& step = steps[hardest];
    const json& history = step["history"];
    const std::string name = in_words(cell);
    series.add(name, cell.family);
    double changes = 0;
    for (std::size_t i = 0; i < history.size(); ++i) {
      const json& record = history[i];
      const json& residual = at(record, "residual");
      if (!residual.is_number()) continue;
      json r = row_of(cell);
      r["failed"] = false;  // the residuals of a failed run are a curve like any other; its name tells the status
      r["series"] = r["line"] = name;
      r["of_cell"] = "yes";
      r["error"] = rounded(residual);
      r["iteration"] = r["order"] = i + 1;
      r["changed"] = number_at(record, "changed");
      r["augmentation"] = number_at(record, "augmentation");
      changes += number_at(record, "changed");
      figure.rows.push_back(r);
    }
    const auto residual_at = [&](const json& record) {
      return at(record, "residual").is_number() ? number(record["residual"]) : std::string();
    };
    figure.table.rows.push_back({cell.label, std::to_string(hardest + 1), plain(at(step, "time")),
                                 std::to_string(history.size()), plain(at(step, "augmentations")),
                                 residual_at(history.front()), residual_at(history.back()), number(changes, 9),
                                 cell.status});
  }
  if (figure.rows.empty()) return std::nullopt;
  show_zeros(figure.rows, "error");
  figure.series = series.list;
  const json tips = tooltip({{"series", "run"},
                             {"iteration", "iteration"},
                             {"error", "residual"},
                             {"changed", "points that changed state"},
                             {"augmentation", "augmentation"}});
  json x = channel("iteration", "iteration within the step", false);
  x["axis"]["tickMinStep"] = 1;
  figure.panels.push_back({"", curves(figure.title, x, channel("shown", "relative residual", true), tips), "iteration",
                           "shown", false, true, "", false});
  offer_cells(figure, shown);
  return figure;
}

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
  r["s"] = r["order"] = rounded(s);
  r["error"] = rounded(value);
  rows.push_back(r);
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
  figure.table.header = {"method", "contact",    "arc length",   "x",   "y",
                         "state",  "pressure p", "tangential q", "gap", "slip"};
  const auto shown = telling_cells(study, true);
  add_first(series, study, shown);
  const json& analytic = at(study.description, "analytic");
  const json& curves_of = object_at(analytic, "curves");
  const std::string closed_name = text_at(analytic, "name");

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
      const auto arc = numbers_at(face, "arc"), x = numbers_at(face, "x"), y = numbers_at(face, "y");
      const auto normal = numbers_at(face, "normal"), tangential = numbers_at(face, "tangential");
      const auto gap = numbers_at(face, "gap"), slip = numbers_at(face, "slip");
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
        const auto value = [&](const std::vector<double>& v) { return i < v.size() ? number(v[i], 6) : ""; };
        if (chosen)
          figure.table.rows.push_back({cell.label, contact, value(arc), value(x), value(y), state,
                                       number(-normal[i], 6), value(tangential), value(gap), value(slip)});
      }
    }
  }
  if (figure.rows.empty()) return std::nullopt;

  const std::string closed = "closed form" + (closed_name.empty() ? "" : " (" + closed_name + ")");
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
  show_zeros(differences, "error");
  for (auto& r : others) {
    r["shown"] = r["error"];
    r["zero"] = false;
  }
  figure.rows = others;
  for (auto& r : differences) figure.rows.push_back(r);

  figure.text = fmt::format(
      "Pressure is positive in compression. The last panel is the distance, point by point, from "
      "the most accurate run ({}), relative to its largest traction: there the methods come "
      "apart where the curves above lie on each other. Shown at first are the most accurate run "
      "of each method and the one furthest off.",
      in_words(*reference));
  const json tips = tooltip({{"series", "run"}, {"s", "position"}, {"error", "value"}, {"state", "state"}});
  for (const auto& [panel, title, logarithmic] :
       {std::tuple{std::string("pressure"), "pressure p", false},
        std::tuple{std::string("tangential traction"), "tangential traction q", false},
        std::tuple{std::string("difference"), "difference / largest traction", true}}) {
    if (distinct(figure.rows, "label", panel).empty()) continue;
    json spec = curves(figure.title + ": " + title, channel("s", "position along the interface", false),
                       channel("shown", title, logarithmic), tips);
    spec["transform"] = only_if("datum.panel == '" + panel + "'");
    figure.panels.push_back({title, spec, "s", "shown", false, logarithmic, panel, false});
  }
  offer(figure, "Contact", "contact");
  offer_cells(figure, shown);
  return figure;
}

}  // namespace stickslip::report
