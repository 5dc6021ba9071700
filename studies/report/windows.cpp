#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "studies/report/chart_parts.hpp"
#include "studies/report/labels.hpp"
#include "studies/report/look_up.hpp"
#include "studies/report/plot.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

struct Run {
  double knob;
  const Cell* cell;
  bool automatic;                    ///< the option is "auto", which stands for `knob`
  std::optional<double> times = {};  ///< iterations over the least: see compare_iterations
  double iterations() const { return cell->count("newton"); }
};

/// One line of the chart: a setting in a scene, with its runs along the knob.
struct Window {
  std::string name, family;
  std::vector<Run> runs;
};

/// Gives each converged run its Newton iterations over the least of those that err no more than it does. Errors within
/// `target` count as none: a soft penalty is cheap, and no substitute for a stiff one.
void compare_iterations(Window& window, std::optional<double> target) {
  const auto error = [&](const Run& run) {
    return std::max(accuracy(*run.cell, Of::responses).value_or(0), target.value_or(0));
  };
  for (auto& run : window.runs) {
    if (!run.cell->converged || run.iterations() <= 0) continue;
    double least = run.iterations();
    for (const auto& other : window.runs)
      if (other.cell->converged && other.iterations() > 0 && error(other) <= error(run))
        least = std::min(least, other.iterations());
    run.times = run.iterations() / least;
  }
}

std::vector<Window> windows_of(const Study& study, const std::vector<std::string>& knobs,
                               std::optional<double> target) {
  std::vector<Window> out;
  for (const auto& cell : study.cells)
    for (const auto& knob : knobs) {
      const Knob* found = find_knob(cell, knob);
      if (!found || found->value.value_or(0) <= 0) continue;
      const std::string name = series_of(cell, knob) + (cell.variant.empty() ? "" : ", " + cell.variant);
      auto at_name = std::find_if(out.begin(), out.end(), [&](const Window& window) { return window.name == name; });
      if (at_name == out.end()) at_name = out.insert(out.end(), {name, cell.family, {}});
      const json& options = object_at(at(cell.record, "method"), cell.family);
      at_name->runs.push_back({*found->value, &cell, text_at(options, knob) == "auto"});
    }
  std::erase_if(out, [](const Window& window) { return window.runs.size() < 2; });
  for (auto& window : out) {
    std::stable_sort(window.runs.begin(), window.runs.end(),
                     [](const Run& a, const Run& b) { return a.knob < b.knob; });
    compare_iterations(window, target);
  }
  const auto place = [&](const Window& window) {
    return std::find(study.families.begin(), study.families.end(), window.family) - study.families.begin();
  };
  std::stable_sort(out.begin(), out.end(), [&](const Window& a, const Window& b) { return place(a) < place(b); });
  return out;
}

const Run* automatic_of(const Window& window) {
  const auto found = std::find_if(window.runs.begin(), window.runs.end(), [](const Run& run) { return run.automatic; });
  return found == window.runs.end() ? nullptr : &*found;
}

/// Whether a run converged, and so did the runs with the next smaller and the next larger value.
bool is_inside(const Window& window, const Run& run) {
  const auto converged = [](const Run& other) { return other.cell->converged; };
  const Run *below = nullptr, *above = nullptr;
  for (const auto& other : window.runs) {
    if (other.knob < run.knob) below = &other;
    if (other.knob > run.knob && !above) above = &other;
  }
  return converged(run) && (!below || converged(*below)) && (!above || converged(*above));
}

constexpr double narrow = 370;  ///< a phone shows it as it is
constexpr double left = 14, row_height = 46, name_size = 11, times_size = 9;

/// As narrow as the names allow.
double width_of(const std::vector<Window>& windows) {
  constexpr double of_wide_fonts = 1.15;  // over Helvetica
  double width = narrow;
  for (const auto& window : windows)
    width = std::max(width, 2 * left + of_wide_fonts * text_width(window.name, name_size));
  return width;
}

/// "1", "1.3", "12", "2000".
std::string short_times(double times) {
  constexpr double is_one = 1.05, is_ten = 9.95;  // to the digits that are shown
  return fmt::format("{:.{}f}", times, times >= is_one && times < is_ten ? 1 : 0);
}

constexpr double around = 1.9;  ///< size of a diamond around a mark

std::string in_words(const Run& run) {
  std::string out = number(run.knob) + (run.automatic ? " (automatic)" : "") + ": " + run.cell->status;
  if (run.times) out += fmt::format(", {:.0f} iterations, {:.2f} of the least", run.iterations(), *run.times);
  return out;
}

/// The name, the bars between neighbours that both converged, a mark a run, full where it reached the target, if there
/// is one, a diamond around the automatic choice, and below what runs cost, where there is room.
void draw_window(const Window& window, const Series& looks, const Axis& x, std::optional<double> target, double top,
                 Drawing& drawing) {
  const double y = top + 23;
  drawing.text(left, top + 11, window.name, {Anchor::start, name_size});
  const std::string color = color_of(looks);
  Style bar{color, "", 7, {}};
  for (std::size_t i = 1; i < window.runs.size(); ++i)
    if (window.runs[i - 1].cell->converged && window.runs[i].cell->converged)
      drawing.line(x(window.runs[i - 1].knob), y, x(window.runs[i].knob), y, bar);
  for (const auto& run : window.runs) {
    const auto error = accuracy(*run.cell, Of::responses);
    if (!run.cell->converged)
      drawing.path(marker("failed", x(run.knob), y), {"ink", "", 2, {}}, in_words(run));
    else
      drawing.path(Path().circle(x(run.knob), y, 5),
                   {color, !target || (error && *error <= *target) ? color : "paper", 2, {}}, in_words(run));
  }
  const Run* automatic = automatic_of(window);
  if (automatic)
    drawing.path(marker("diamond", x(automatic->knob), y, around), {"ink", "", 2, {}}, in_words(*automatic));
  double free = left;  // up to where the words so far reach
  for (const auto& run : window.runs) {
    if (!run.times || (automatic && run.knob == automatic->knob && &run != automatic)) continue;
    const std::string words = short_times(*run.times);
    const double half = text_width(words, times_size) / 2 + 1;
    if (x(run.knob) - half < free) continue;
    free = x(run.knob) + half;
    drawing.text(x(run.knob), top + 41, words, {Anchor::middle, times_size, "ink", false, run.automatic});
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

double draw_legend(std::optional<double> target, bool automatic, double y, Drawing& drawing) {
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
  if (automatic) {
    drawing.path(marker("diamond", left + next + 70, y, around), {"ink", "", 2, {}});
    drawing.text(left + next + 86, y + 4, "automatic");
  }
  y += line;
  drawing.text(left, y + 4, "below: iterations over the least");
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

/// "10, inside: 13 iterations, 1.18 of the least".
std::string automatic_in_words(const Window& window) {
  const Run* run = automatic_of(window);
  if (!run) return "";
  std::string out = number(run->knob) + (is_inside(window, *run) ? ", inside" : ", not inside");
  if (run->times) out += fmt::format(": {:.0f} iterations, {:.2f} of the least", run->iterations(), *run->times);
  return out;
}

json rows_of(const std::vector<Window>& windows) {
  json rows = json::array();
  for (const auto& window : windows)
    for (const auto& run : window.runs) {
      rows.push_back({{"series", window.name}, {"option_value", run.knob}, {"status", run.cell->status}});
      if (const auto error = accuracy(*run.cell, Of::responses)) rows.back()["error"] = *error;
      rows.back()["automatic"] = run.automatic;
      if (run.times) {
        rows.back()["iterations"] = run.iterations();
        rows.back()["iterations_over_least"] = *run.times;
      }
    }
  return rows;
}

}  // namespace

std::optional<Plate> robustness_windows(const Study& study, const std::vector<std::string>& knobs) {
  const auto target = target_error(study, Of::responses);
  const auto windows = windows_of(study, knobs, target);
  if (windows.empty()) return std::nullopt;
  double low = windows.front().runs.front().knob, high = low;
  SeriesList series(study);
  for (const auto& window : windows) {
    low = std::min(low, window.runs.front().knob);
    high = std::max(high, window.runs.back().knob);
    series.add(window.name, window.family);
  }
  const bool automatic = std::any_of(windows.begin(), windows.end(), automatic_of);
  const std::string title = "Where each method works: " + knob_title(knobs);
  const std::string text =
      std::string(
          "Each line is one setting in one scene. A bar spans neighbouring values of the option that both "
          "converged; a cross is a run that did not.") +
      (target ? " A full mark is a run whose worst response is within " + number(*target) +
                    " of the exact contact conditions, an open one converged to something less accurate."
              : std::string()) +
      (automatic ? " The diamond is the automatic choice, at the value that \"auto\" stands for." : "") +
      " The number below a mark is Newton's iterations of the whole run, all augmentations counted, over the least of "
      "the line" +
      (target ? ": of the runs that err no more, or by no more than " + number(*target) + "." : ".");
  const double width = width_of(windows), right = width - left;
  const Axis x(low, high, true, left, right);
  const double top = 8, bottom = top + row_height * static_cast<double>(windows.size()) + 4;
  Plate plate{
      "windows-" + slug(knobs.front()), title, text, Drawing(width, bottom, title, text), {}, rows_of(windows), ""};
  const double end = draw_scale(x, top, bottom, right, knob_title(knobs), plate.drawing);
  plate.table.header = {"method and scene", "runs", "converges from ... to", "fails at"};
  if (automatic) plate.table.header.emplace_back("automatic choice");
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const auto& looks = series.list[series.place(windows[i].name)];
    draw_window(windows[i], looks, x, target, top + row_height * static_cast<double>(i), plate.drawing);
    const std::string failed = failures(windows[i]);
    plate.table.rows.push_back(
        {windows[i].name, std::to_string(windows[i].runs.size()), stretches(windows[i]), failed});
    if (automatic) plate.table.rows.back().push_back(automatic_in_words(windows[i]));
    plate.table.row_classes.emplace_back(failed.empty() ? "" : "failed");
  }
  const auto& classes = plate.table.row_classes;
  if (!automatic && std::all_of(classes.begin(), classes.end(), [](const auto& failed) { return failed.empty(); }))
    plate.folded = "every run converged";
  plate.drawing.set_height(draw_legend(target, automatic, end + 16, plate.drawing));
  return plate;
}

}  // namespace stickslip::report
