#include "studies/report/figure_html.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <set>

#include "studies/report/colors.hpp"
#include "studies/report/drawing_parts.hpp"
#include "studies/report/figure_files.hpp"
#include "studies/report/html.hpp"
#include "studies/report/look_up.hpp"
#include "studies/report/plot.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

std::string control(const Choice& choice) {
  const std::string data = fmt::format("data-field=\"{}\" data-when-field=\"{}\" data-when=\"{}\"",
                                       escape(choice.field), escape(choice.when_field), escape(choice.when));
  const auto is_chosen = [&](const std::string& option) {
    return std::find(choice.chosen.begin(), choice.chosen.end(), option) != choice.chosen.end();
  };
  std::string out;
  if (!choice.several) {
    for (const auto& option : choice.options)
      out += fmt::format("<option value=\"{0}\"{1}>{0}</option>", escape(option), is_chosen(option) ? " selected" : "");
    return fmt::format("<label>{}: <select autocomplete=\"off\" {}>{}</select></label>\n", escape(choice.label), data,
                       out);
  }
  for (const auto& option : choice.options)
    out += fmt::format("<label><input type=\"checkbox\" autocomplete=\"off\" value=\"{0}\"{1}> {0}</label>",
                       escape(option), is_chosen(option) ? " checked" : "");
  return fmt::format("<details class=\"several\"><summary>{}</summary><div {}>{}</div></details>\n",
                     escape(choice.label), data, out);
}

/// "Quantity: worst response; Scene: mu = 0.1": for paper, and where no script shows the choices.
std::string what_is_chosen(const Figure& figure) {
  std::string out;
  for (const auto& choice : figure.choices)
    if (!choice.several) out += (out.empty() ? "" : "; ") + choice.label + ": " + choice.chosen.front();
  return out.empty() ? out : "<p class=\"chosen\">" + escape(out) + "</p>\n";
}

/// The chart for readers without scripts; "" where it has nothing to draw.
std::string plain_picture(const Figure& figure, const Chart& chart) {
  const auto drawing = draw_plot(figure, chart);
  return drawing ? drawing->inline_svg() : std::string();
}

/// Six digits are more than a chart shows, in a third of the bytes. The files beside the page hold all of them.
json rounded(const json& value) {
  return value.is_number_float() ? json(std::strtod(fmt::format("{:.6g}", value.get<double>()).c_str(), nullptr))
                                 : value;
}

bool says_something(const json& value) { return !value.is_null() && value != false; }

/// Rows in a sixth of the bytes: as arrays under one list of `fields`, those that most rows have first, without what
/// ends them that is false or missing; of a field that holds texts alone, each is a place in its list of `texts`.
json compact(const json& rows) {
  std::map<std::string, long> uses;
  std::set<std::string> mixed;
  for (const auto& row : rows)
    for (const auto& [field, value] : row.items()) {
      uses[field] += says_something(value);
      if (!value.is_string()) mixed.insert(field);
    }
  std::vector<std::string> fields;
  for (const auto& [field, unused] : uses) fields.push_back(field);
  std::ranges::stable_sort(fields, std::greater(), [&](const std::string& field) { return uses[field]; });
  json out = {{"fields", fields}, {"texts", json::object()}, {"rows", json::array()}};
  std::map<std::string, std::map<std::string, std::size_t>> places;
  for (const auto& row : rows) {
    json values = json::array();
    for (const auto& field : fields) {
      const json& value = at(row, field);
      if (value.is_null() || mixed.count(field)) {
        values.push_back(says_something(value) ? rounded(value) : json());
        continue;
      }
      auto& known = places[field];
      const auto [place, added] = known.emplace(value.get<std::string>(), known.size());
      if (added) out["texts"][field].push_back(value);
      values.push_back(place->second);
    }
    while (!values.empty() && values.back().is_null()) values.erase(values.size() - 1);
    out["rows"].push_back(std::move(values));
  }
  return out;
}

/// The title, but of a folded figure, whose fold has it, and what is said below it.
std::string caption(const std::string& id, const std::string& title, const std::string& text, const std::string& fold) {
  const std::string head = fold.empty() ? fmt::format("<h3 id=\"{}-title\">{}</h3>", id, escape(title)) : "";
  return "<figcaption>" + head + "<p>" + escape_sentence(text) + "</p></figcaption>\n";
}

std::string behind_a_fold(const std::string& id, const std::string& title, const std::string& fold,
                          const std::string& figure) {
  if (fold.empty()) return figure;
  return fmt::format(
      "<details class=\"fold\"><summary><span id=\"{}-title\">{}</span> <small>({})</small></summary>\n{}</details>\n",
      id, escape(title), escape(fold), figure);
}

json axis_json(const Quantity& quantity) {
  return {
      {"field", quantity.field},     {"title", quantity.title},     {"log", quantity.spacing == Spacing::logarithmic},
      {"step", quantity.least_step}, {"bounded", quantity.bounded}, {"spread", quantity.spread}};
}

/// What page.js draws a chart from.
json chart_json(const Figure& figure, const Chart& chart) {
  const std::string description = figure.title + (chart.title.empty() ? "" : ", " + chart.title);
  json out = {{"description", description},     {"caption", tex_text(description)},
              {"x", axis_json(chart.x)},        {"y", axis_json(chart.y)},
              {"tips", chart.tooltip},          {"only", chart.only},
              {"file", file_of(figure, chart)}, {"folded", chart.folded},
              {"height", chart.height}};
  if (!chart.words.name.empty()) out["words"] = {{"name", chart.words.name}, {"value", chart.words.value}};
  return out;
}

/// Series as page.js draws them: a marker by its path, as large as it is in a legend where its `size` is 4.
json series_json(const std::vector<Series>& list) {
  constexpr double of_unit = 16;
  json out = json::array();
  for (const auto& s : list)
    out.push_back({{"name", s.name},
                   {"color", s.color},
                   {"dark", s.color == "$ink" ? s.color : on_dark(s.color)},
                   {"shape", svg_path(marker(s.shape, 0, 0))},
                   {"dash", s.dash},
                   {"size", s.size / of_unit}});
  return out;
}

std::string to_html(const Figure& figure) {
  std::string open, folded_panels;
  json charts = json::array();
  for (const bool folded : {false, true})
    for (const auto& chart : figure.charts)
      if (chart.folded == folded) {
        charts.push_back(chart_json(figure, chart));
        (folded ? folded_panels : open) += fmt::format(
            "<div class=\"panel\"><h4>{}</h4><div class=\"vega\"></div><div class=\"static\">{}</div></div>\n",
            escape(chart.title), plain_picture(figure, chart));
      }
  const json table = compact(figure.rows);
  std::string controls;
  for (const auto& choice : figure.choices) controls += control(choice);
  std::string out = fmt::format("<figure data-chart id=\"{0}\" aria-labelledby=\"{0}-title\">\n", figure.id) +
                    caption(figure.id, figure.title, figure.text, figure.folded);
  if (!controls.empty()) out += "<div class=\"choices\">" + controls + "</div>\n" + what_is_chosen(figure);
  out += "<div class=\"legend\"></div>\n<div class=\"panels\">" + open + "</div>\n";
  if (!folded_panels.empty())
    out += "<details class=\"panels-folded\"><summary>More views</summary><div class=\"panels\">" + folded_panels +
           "</div></details>\n";
  out += "<details class=\"data\"><summary>Data of this chart</summary></details>\n";
  out += fmt::format("<script type=\"application/json\" id=\"{}-data\">{}</script>\n</figure>\n", figure.id,
                     embed({{"fields", table["fields"]},
                            {"texts", table["texts"]},
                            {"columns", columns_of(figure.rows)},
                            {"rows", table["rows"]},
                            {"series", series_json(figure.series)},
                            {"failed", svg_path(marker("failed", 0, 0))},
                            {"charts", charts},
                            {"caption", tex_text(figure.title)}}));
  return behind_a_fold(figure.id, figure.title, figure.folded, out);
}

std::string to_html(const Plate& plate) {
  const std::string figure = fmt::format(
      "<figure class=\"plate\" id=\"{0}\" aria-labelledby=\"{0}-title\">\n{1}<div class=\"drawn\" role=\"region\" "
      "tabindex=\"0\" aria-label=\"{2}\">{3}</div>\n{4}</figure>\n",
      plate.id, caption(plate.id, plate.title, plate.text, plate.folded), escape(plate.title),
      plate.drawing.inline_svg(),
      plate.table.rows.empty() ? "" : folded("Data of this chart", report::to_html(plate.table, plate.title)));
  return behind_a_fold(plate.id, plate.title, plate.folded, figure);
}

}  // namespace

std::string Figures::show(std::optional<Figure> figure) {
  if (!figure) return {};
  figures.push_back(*std::move(figure));
  return to_html(figures.back());
}

std::string Figures::show(std::optional<Plate> plate) {
  if (!plate) return {};
  plates.push_back(*std::move(plate));
  return to_html(plates.back());
}

std::string Figures::beside(std::optional<Figure> figure, std::optional<Plate> plate) {
  const auto open = [](const Figure& f) {
    return std::count_if(f.charts.begin(), f.charts.end(), [](const Chart& chart) { return !chart.folded; });
  };
  const bool together = figure && plate && figure->folded.empty() && plate->folded.empty() && open(*figure) == 1;
  const std::string left = show(std::move(figure)), right = show(std::move(plate));
  return together ? "<div class=\"beside\">" + left + right + "</div>\n" : left + right;
}

}  // namespace stickslip::report
