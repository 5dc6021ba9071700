#include <algorithm>

#include "studies/report/chart_parts.hpp"
#include "studies/report/look_up.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

/// Any cell of the main variant. pre: there are cells.
const Cell& main_cell(const Study& study) {
  return *std::find_if(study.cells.begin(), study.cells.end(),
                       [&](const Cell& c) { return c.variant == study.main_variant; });
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
      r["seconds"] = cell.sensitivity_seconds;
      figure.rows.push_back(r);
      series.add(name, cell.family);
    }
  }
  if (figure.rows.empty()) return std::nullopt;
  show_zeros(figure.rows, "error");
  figure.series = series.list;
  const json tips = tooltip({{"label", "method"}, {"level", "mesh level"}, {"error", "error"}, {"seconds", "seconds"}});
  const json y = channel("shown", "relative error against " + discretization_reference(study), true);
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

}  // namespace stickslip::report
