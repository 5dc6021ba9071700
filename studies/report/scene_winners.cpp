#include "studies/report/scene_winners.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "studies/report/cheapest.hpp"
#include "studies/report/headline.hpp"
#include "studies/report/html.hpp"
#include "studies/report/labels.hpp"
#include "studies/report/look_up.hpp"

namespace stickslip::report {
namespace {

/// "Penalty (stiffness=10) or Monolithic AL, work 6.1"; of more than two that tie the first, and how many others; where
/// none gets there, which comes nearest.
std::string winner(const std::vector<Row>& rows, const Measure& measure, const Level& level) {
  const Column column = column_of(rows, measure, level.error);
  if (!column.least) {
    std::optional<double> nearest;
    std::string of;
    for (const Row& row : rows)
      if (const auto error = nearest_of(row, measure); error && *error < nearest.value_or(INFINITY)) {
        nearest = error;
        of = row.name;
      }
    return nearest ? "none; best " + percent(*nearest) + " (" + of + ")" : "no run";
  }
  std::vector<std::string> names;
  for (const Pick& pick : column.runs)
    if (pick.run && is_least(column, measure, *pick.run)) names.push_back(pick.name());
  std::string out = names.front();
  if (names.size() == 2) out += " or " + names.back();
  if (names.size() > 2) out += fmt::format(" or {} others", names.size() - 1);
  return out + ", work " + number(measure.work(*column.least), 2);
}

/// Head of the column of an accuracy: one that is asked for, or that of each scene's own error.
std::string head_of(const Measure& measure, const Level& level) {
  return measure.noun() + " within " + (level.whose.empty() ? level.title() : "its own error");
}

/// Of responses, then of derivatives.
std::vector<std::string> heads_of(const std::vector<Study>& scenes) {
  std::vector<std::string> heads;
  for (const Of of : {Of::responses, Of::sensitivities})
    for (const Study& scene : scenes)
      if (const auto measure = measure_of(scene, of))
        for (const Level& level : measure->levels) {
          const std::string head = head_of(*measure, level);
          if (std::find(heads.begin(), heads.end(), head) == heads.end()) heads.push_back(head);
        }
  return heads;
}

/// What stands below each head.
std::vector<std::string> winners_of(const Study& scene, const std::vector<std::string>& heads) {
  const bool converged = std::any_of(scene.cells.begin(), scene.cells.end(), [](auto& cell) { return cell.converged; });
  std::vector<std::string> winners(heads.size(), converged ? "not measured" : "no run converged");
  const auto rows = rows_of(scene).first;
  for (const Of of : {Of::responses, Of::sensitivities})
    if (const auto measure = measure_of(scene, of))
      for (const Level& level : measure->levels) {
        const auto column = std::find(heads.begin(), heads.end(), head_of(*measure, level)) - heads.begin();
        winners[static_cast<std::size_t>(column)] =
            (level.whose.empty() ? "" : level.title() + ": ") + winner(rows, *measure, level);
      }
  return winners;
}

}  // namespace

std::string cheapest_by_scene(const Study& study) {
  const auto& titles = object_at(study.description, "scene_titles");
  std::vector<Study> scenes;
  for (const auto& file : array_at(study.description, "scenes"))
    if (Study scene = of_scene(study, plain(file)); !scene.cells.empty()) scenes.push_back(std::move(scene));
  const auto heads = heads_of(scenes);
  if (scenes.size() < 2 || heads.empty()) return "";
  std::string head, body;
  for (const auto& each : heads) head += "<th scope=\"col\">" + escape(each) + "</th>";
  for (const Study& scene : scenes) {
    const std::string title = text_at(titles, scene.cells.front().file);
    body += "<tr><th scope=\"row\">" + escape(scene.main_variant + (title.empty() ? "" : ": " + title)) + "</th>";
    const auto winners = winners_of(scene, heads);
    for (std::size_t i = 0; i < heads.size(); ++i)
      body += fmt::format("<td data-within=\"{}\">{}</td>", escape(heads[i]), escape(winners[i]));
    body += "</tr>\n";
  }
  return fmt::format(
      "<div class=\"wide\" role=\"region\" tabindex=\"0\" aria-label=\"Cheapest by scene\"><table class=\"verdict\">"
      "<caption>Which method is cheapest, scene by scene. Work within 5 % is a tie.</caption>\n<thead><tr>"
      "<th>scene</th>{}</tr></thead><tbody>\n{}</tbody></table></div>\n",
      head, body);
}

}  // namespace stickslip::report
