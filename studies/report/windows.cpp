#include <algorithm>

#include "studies/report/chart_parts.hpp"
#include "studies/report/labels.hpp"
#include "studies/report/plot.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

struct Run {
  double knob;
  const Cell* cell;
};

/// One line of the chart: a setting in a scene, with its runs along the knob.
struct Window {
  std::string name, family;
  std::vector<Run> runs;
};

std::vector<Window> windows_of(const Study& study, const std::vector<std::string>& knobs) {
  std::vector<Window> out;
  for (const auto& cell : study.cells)
    for (const auto& knob : knobs) {
      const Knob* found = find_knob(cell, knob);
      if (!found || found->value.value_or(0) <= 0) continue;
      const std::string name = series_of(cell, knob) + (cell.variant.empty() ? "" : ", " + cell.variant);
      auto at = std::find_if(out.begin(), out.end(), [&](const Window& window) { return window.name == name; });
      if (at == out.end()) at = out.insert(out.end(), {name, cell.family, {}});
      at->runs.push_back({*found->value, &cell});
    }
  std::erase_if(out, [](const Window& window) { return window.runs.size() < 2; });
  for (auto& window : out)
    std::sort(window.runs.begin(), window.runs.end(), [](const Run& a, const Run& b) { return a.knob < b.knob; });
  const auto place = [&](const Window& window) {
    return std::find(study.families.begin(), study.families.end(), window.family) - study.families.begin();
  };
  std::stable_sort(out.begin(), out.end(), [&](const Window& a, const Window& b) { return place(a) < place(b); });
  return out;
}

constexpr double narrow = 370;  ///< a phone shows it as it is
constexpr double left = 14, row_height = 34, name_size = 11;

/// As narrow as the names allow.
double width_of(const std::vector<Window>& windows) {
  constexpr double of_wide_fonts = 1.15;  // over Helvetica
  double width = narrow;
  for (const auto& window : windows)
    width = std::max(width, 2 * left + of_wide_fonts * text_width(window.name, name_size));
  return width;
}

/// The name, the bars between neighbours that both converged, and a mark a run: full where it reached the target, if
/// there is one.
void draw_window(const Window& window, const Series& looks, const Axis& x, std::optional<double> target, double top,
                 Drawing& drawing) {
  const double y = top + 23;
  drawing.text(left, top + 11, window.name, {Anchor::start, name_size});
  Style bar{looks.color, "", 7, {}};
  for (std::size_t i = 1; i < window.runs.size(); ++i)
    if (window.runs[i - 1].cell->converged && window.runs[i].cell->converged)
      drawing.line(x(window.runs[i - 1].knob), y, x(window.runs[i].knob), y, bar);
  for (const auto& run : window.runs) {
    const auto error = accuracy(*run.cell, Of::responses);
    if (!run.cell->converged)
      drawing.path(marker("failed", x(run.knob), y), {"ink", "", 2, {}});
    else
      drawing.path(Path().circle(x(run.knob), y, 5),
                   {looks.color, !target || (error && *error <= *target) ? looks.color : "paper", 2, {}});
  }
}

/// The axis, with the remark in brackets of its title on a line of its own; returns where it ends.
double draw_scale(const Axis& x, double top, double bottom, double right, const std::string& title, Drawing& drawing) {
  for (const double tick : x.ticks()) {
    drawing.line(x(tick), top, x(tick), bottom, {"line"});
    drawing.text(x(tick), bottom + 16, number(tick), {Anchor::middle});
  }
  drawing.line(left, bottom, right, bottom, {"ink"});
  const std::size_t remark = title.find(" (");
  drawing.text((left + right) / 2, bottom + 34, title.substr(0, remark), {Anchor::middle});
  if (remark == std::string::npos) return bottom + 38;
  drawing.text((left + right) / 2, bottom + 50, title.substr(remark + 1), {Anchor::middle});
  return bottom + 54;
}

double draw_legend(std::optional<double> target, double y, Drawing& drawing) {
  constexpr double line = 20, next = 190;
  drawing.path(Path().circle(left + 6, y, 5), {"ink", "ink", 2, {}});
  drawing.text(left + 18, y + 4, target ? "converged, error at most " + number(*target) : "converged");
  if (target) {
    y += line;
    drawing.path(Path().circle(left + 6, y, 5), {"ink", "paper", 2, {}});
    drawing.text(left + 18, y + 4, "converged, less accurate");
  }
  drawing.path(marker("failed", left + next, y), {"ink", "", 2, {}});
  drawing.text(left + next + 12, y + 4, "failed");
  return y + 14;
}

/// Stretches of converged runs: "1 to 1e6, 1e8".
std::string stretches(const Window& window) {
  std::string out;
  for (std::size_t i = 0; i < window.runs.size(); ++i) {
    if (!window.runs[i].cell->converged) continue;
    std::size_t end = i;
    while (end + 1 < window.runs.size() && window.runs[end + 1].cell->converged) ++end;
    out += (out.empty() ? "" : ", ") + number(window.runs[i].knob) +
           (end > i ? " to " + number(window.runs[end].knob) : std::string());
    i = end;
  }
  return out.empty() ? "nowhere" : out;
}

std::string failures(const Window& window) {
  std::string out;
  for (const auto& run : window.runs)
    if (!run.cell->converged) out += (out.empty() ? "" : ", ") + number(run.knob) + " (" + run.cell->status + ")";
  return out;
}

json rows_of(const std::vector<Window>& windows) {
  json rows = json::array();
  for (const auto& window : windows)
    for (const auto& run : window.runs) {
      rows.push_back({{"series", window.name}, {"option_value", run.knob}, {"status", run.cell->status}});
      if (const auto error = accuracy(*run.cell, Of::responses)) rows.back()["error"] = *error;
    }
  return rows;
}

}  // namespace

std::optional<Plate> robustness_windows(const Study& study, const std::vector<std::string>& knobs) {
  const auto windows = windows_of(study, knobs);
  if (windows.empty()) return std::nullopt;
  double low = windows.front().runs.front().knob, high = low;
  SeriesList series(study);
  for (const auto& window : windows) {
    low = std::min(low, window.runs.front().knob);
    high = std::max(high, window.runs.back().knob);
    series.add(window.name, window.family);
  }
  const auto target = target_error(study, Of::responses);
  const std::string title = "Where each method works: " + knob_title(knobs);
  const std::string text =
      "Each line is one setting in one scene. A bar spans neighbouring values of the option that both converged; a "
      "cross is a run that did not." +
      (target ? " A full mark is a run whose worst response is within " + number(*target) +
                    " of the exact contact conditions, an open one converged to something less accurate."
              : std::string());
  const double width = width_of(windows), right = width - left;
  const Axis x(low, high, true, left, right);
  const double top = 8, bottom = top + row_height * static_cast<double>(windows.size()) + 4;
  Plate plate{
      "windows-" + slug(knobs.front()), title, text, Drawing(width, bottom, title, text), {}, rows_of(windows), ""};
  const double end = draw_scale(x, top, bottom, right, knob_title(knobs), plate.drawing);
  plate.table.header = {"method and scene", "runs", "converges from ... to", "fails at"};
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const auto& looks = series.list[series.place(windows[i].name)];
    draw_window(windows[i], looks, x, target, top + row_height * static_cast<double>(i), plate.drawing);
    plate.table.rows.push_back(
        {windows[i].name, std::to_string(windows[i].runs.size()), stretches(windows[i]), failures(windows[i])});
    plate.table.row_classes.emplace_back(plate.table.rows.back().back().empty() ? "" : "failed");
  }
  const auto& classes = plate.table.row_classes;
  if (std::all_of(classes.begin(), classes.end(), [](const auto& failed) { return failed.empty(); }))
    plate.folded = "every run converged";
  plate.drawing.set_height(draw_legend(target, end + 16, plate.drawing));
  return plate;
}

}  // namespace stickslip::report
