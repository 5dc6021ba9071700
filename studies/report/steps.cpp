#include "studies/report/steps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "studies/report/chart_parts.hpp"
#include "studies/report/look_up.hpp"
#include "studies/report/picture.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

/// Tractions of a frame along each contact: its points follow one another as in `interface`, which has their places.
json rows_of(const json& frame, const json& interface, const std::string& time) {
  json rows = json::array();
  std::map<std::string, std::size_t> place;
  for (const auto& point : array_at(frame, "contact")) {
    const std::string contact = text_at(point, "name");
    const json& arc = array_at(at(interface, contact), "arc");
    const std::size_t i = place[contact]++;
    if (i >= arc.size() || !arc[i].is_number()) continue;
    for (const auto& [panel, value] : {std::pair{"pressure", -number_at(point, "normal")},
                                       std::pair{"tangential traction", number_at(point, "tangential")}})
      rows.push_back({{"panel", panel},
                      {"time", time},
                      {"series", contact},
                      {"line", contact},
                      {"failed", false},
                      {"s", arc[i]},
                      {"order", arc[i]},
                      {"unmarked", i % std::max<std::size_t>(arc.size() / 12, 1) != 0},  // a dozen markers a curve
                      {"value", value},
                      {"state", text_at(point, "state")}});
  }
  return rows;
}

/// Tractions at each of the times; the axes are those of the time that is chosen.
std::optional<Figure> tractions_of_steps(const Study& run, const std::vector<StepPicture>& steps) {
  Figure figure;
  figure.id = "step-tractions";
  figure.title = "Tractions at that step";
  figure.text = "Pressure is positive in compression.";
  SeriesList series(run);
  for (const auto& frame : array_at(run.picture, "frames"))
    for (const auto& step : steps)
      if (static_cast<double>(step.step) == number_at(frame, "step"))
        for (auto& row : rows_of(frame, object_at(run.picture, "interface"), step.words)) figure.rows.push_back(row);
  for (const auto& name : distinct(figure.rows, "series")) series.add(name, run.families.front());
  figure.series = series.list;
  for (const auto& [panel, title] :
       {std::pair{"pressure", "pressure p"}, {"tangential traction", "tangential traction q"}})
    if (std::any_of(figure.rows.begin(), figure.rows.end(),
                    [&, panel = panel](const json& r) { return r["panel"] == panel && r["value"] != 0; }))
      figure.charts.push_back(
          {.title = title,
           .x = {"s", "position along the interface"},
           .y = {"value", title},
           .tooltip = {{"series", "contact"}, {"s", "position"}, {"value", "value"}, {"state", "state"}},
           .only = panel,
           .height = 200});
  if (figure.charts.empty()) return std::nullopt;
  offer(figure, "Step", "time", steps.back().words);
  return figure;
}

}  // namespace

std::string steps_of_run(const Study& run, Figures& figures) {
  const auto steps = draw_steps(run.picture);
  if (steps.empty()) return "";
  std::string pictures;
  for (const auto& step : steps)
    pictures += fmt::format("<div class=\"step drawn\" data-words=\"{}\"{}>{}</div>\n", escape(step.words),
                            &step == &steps.back() ? "" : " hidden", step.drawing.inline_svg());
  return fmt::format(
             "<figure class=\"steps\" id=\"steps\" aria-labelledby=\"steps-title\">\n<figcaption>"
             "<h3 id=\"steps-title\">Step by step</h3><p>The steps whose fields were kept.</p></figcaption>\n"
             "<label class=\"slider\"><input type=\"range\" autocomplete=\"off\" min=\"0\" max=\"{0}\" value=\"{0}\"> "
             "<output>{1}</output></label>\n{2}</figure>\n",
             steps.size() - 1, escape(steps.back().words), pictures) +
         figures.show(tractions_of_steps(run, steps));
}

}  // namespace stickslip::report
