#include "studies/report/plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <vector>

namespace stickslip::report {

using nlohmann::json;

namespace {

constexpr double width = 640, left = 74, right = 620, top = 12, bottom = 300;  // of the picture, of the axes

bool is_shown(const Figure& figure, const Panel& panel, const json& row) {
  if (!panel.only.empty() && row.value("panel", "") != panel.only) return false;
  for (const auto& choice : figure.choices) {
    if (!choice.when_field.empty() && row.value(choice.when_field, "") != choice.when) continue;
    const std::string value = row.value(choice.field, "");
    if (std::find(choice.chosen.begin(), choice.chosen.end(), value) == choice.chosen.end()) return false;
  }
  const auto drawable = [&](const std::string& field, bool logarithmic) {
    return row.contains(field) && row[field].is_number() && (!logarithmic || row[field].get<double>() > 0);
  };
  return drawable(panel.x, panel.x_log) && drawable(panel.y, panel.y_log);
}

/// What is drawn of a panel: its rows, the guides beside them, and the axes they span.
struct Frame {
  std::vector<const json*> rows, guides;
  Axis x, y;
  std::optional<double> ground;  ///< where exact zeros stand, off what the axis names
};

/// The channel of an axis, with its title; null where no layer has one.
json channel_of(const json& spec, const std::string& name) {
  for (const auto& layer : spec["layer"])
    if (layer.contains("encoding") && layer["encoding"].contains(name) && layer["encoding"][name].contains("title"))
      return layer["encoding"][name];
  return nullptr;
}

/// A title "{field}" is what the row has there.
std::string axis_text(const json& spec, const std::string& name, const json& row) {
  const json channel = channel_of(spec, name);
  const std::string title = channel.is_null() ? std::string() : channel["title"].get<std::string>();
  return title.starts_with('{') ? row.value(title.substr(1, title.size() - 2), "") : title;
}

/// Whether nothing can lie below the least value of the axis.
bool is_bounded(const json& spec, const std::string& name) {
  const json channel = channel_of(spec, name);
  return !channel.is_null() && channel["scale"].contains("domainMin");
}

double number_of(const json& row, const std::string& field) { return row[field].get<double>(); }

std::optional<double> ground_of(const std::vector<const json*>& rows, const Panel& panel) {
  const auto zero = std::find_if(rows.begin(), rows.end(), [](const json* r) { return r->value("zero", false); });
  return zero == rows.end() ? std::nullopt : std::optional(number_of(**zero, panel.y));
}

std::optional<Frame> frame_of(const Figure& figure, const Panel& panel) {
  std::vector<const json*> rows, guides;
  for (const auto& row : figure.rows)
    if (is_shown(figure, panel, row)) (row.value("guide", false) ? guides : rows).push_back(&row);
  if (rows.empty()) return std::nullopt;
  std::vector<const json*> all = rows;
  all.insert(all.end(), guides.begin(), guides.end());
  const auto bounds = [&](const std::string& field) {
    const auto [low, high] = std::minmax_element(all.begin(), all.end(), [&](const json* a, const json* b) {
      return number_of(*a, field) < number_of(*b, field);
    });
    return std::pair{number_of(**low, field), number_of(**high, field)};
  };
  const auto [x_low, x_high] = bounds(panel.x);
  const auto [y_low, y_high] = bounds(panel.y);
  return Frame{rows, guides, Axis(x_low, x_high, panel.x_log, left, right, is_bounded(panel.spec, "x")),
               Axis(y_low, y_high, panel.y_log, bottom, top), ground_of(rows, panel)};
}

/// Ticks with their labels, in as many digits as tell them apart.
std::vector<std::pair<double, std::string>> labelled(const std::vector<double>& ticks) {
  constexpr int fewest = 3, most = 12;
  std::vector<std::pair<double, std::string>> out;
  for (int digits = fewest; digits <= most; ++digits) {
    out.clear();
    std::set<std::string> labels;
    for (const double tick : ticks) labels.insert(out.emplace_back(tick, number(tick, digits)).second);
    if (labels.size() == ticks.size()) break;
  }
  return out;
}

/// The least step between ticks that the axis allows: 1 where it counts; 0 where it says nothing.
double least_step(const json& spec, const std::string& name) {
  const json channel = channel_of(spec, name);
  return channel.is_null() ? 0 : channel["axis"].value("tickMinStep", 0.0);
}

void draw_axes(const Frame& frame, const json& spec, Drawing& drawing) {
  const Style grid{"line"};
  for (const auto& [tick, label] : labelled(frame.x.ticks(least_step(spec, "x")))) {
    drawing.line(frame.x(tick), top, frame.x(tick), bottom, grid);
    drawing.text(frame.x(tick), bottom + 16, label, {Anchor::middle});
  }
  for (const auto& [tick, label] : labelled(frame.y.ticks())) {
    if (frame.ground && tick < 5 * *frame.ground) continue;
    drawing.line(left, frame.y(tick), right, frame.y(tick), grid);
    drawing.text(left - 6, frame.y(tick) + 4, label, {Anchor::end});
  }
  drawing.path(Path().move(left, top).line(left, bottom).line(right, bottom), {"ink"});
  drawing.text((left + right) / 2, bottom + 36, axis_text(spec, "x", *frame.rows.front()), {Anchor::middle});
  drawing.text(14, (top + bottom) / 2, axis_text(spec, "y", *frame.rows.front()), {Anchor::middle, 12, "ink", true});
}

/// The line on which exact zeros stand, where there are any.
void draw_ground(const Frame& frame, const Panel& panel, Drawing& drawing) {
  if (!frame.ground) return;
  const double y = frame.y(*frame.ground);
  drawing.line(left, y, right, y, {"ink", "", 1, {1, 3}});
  drawing.text(left - 6, y + 4, "0", {Anchor::end});
  const auto some_exact_in = [&](double from, double to) {
    return std::any_of(frame.rows.begin(), frame.rows.end(), [&](const json* row) {
      const double x = frame.x(number_of(*row, panel.x));
      return row->value("zero", false) && x > from && x < to;
    });
  };
  constexpr double words = 80;
  const bool at_right = some_exact_in(left - words, left + words) && !some_exact_in(right - words, right + words);
  drawing.text(at_right ? right - 4 : left + 4, y - 4, "exactly 0", {at_right ? Anchor::end : Anchor::start, 11});
}

/// Lines that theory gives.
void draw_guides(const Frame& frame, const Panel& panel, Drawing& drawing) {
  std::map<std::string, Path> lines;
  for (const json* row : frame.guides) {
    const double x = frame.x(number_of(*row, panel.x)), y = frame.y(number_of(*row, panel.y));
    Path& path = lines[row->value("line", "")];
    path.empty() ? path.move(x, y) : path.line(x, y);
    if (const std::string tag = row->value("guide_tag", ""); !tag.empty())
      drawing.text(x - 6, y + 13, tag, {Anchor::end, 11});
  }
  for (const auto& [name, path] : lines) drawing.path(path, {"ink", "", 1, {3, 3}});
}

/// The names of curves, and the option's values at their ends.
void draw_tags(const Frame& frame, const Panel& panel, Drawing& drawing) {
  constexpr double size = 11, aside = 9, above = 8, below = 15;
  for (const json* row : frame.rows) {
    const std::string tag = row->value(panel.tag, ""), side = row->value(panel.tag + "_at", "");
    if (tag.empty()) continue;
    const double x = frame.x(number_of(*row, panel.x)), y = frame.y(number_of(*row, panel.y));
    const bool fits = side.starts_with("right") && x + aside + text_width(tag, size) < width;
    drawing.text(fits ? x + aside : x - aside, side.ends_with("below") ? y + below : y - above, tag,
                 {fits ? Anchor::start : Anchor::end, size});
  }
}

bool has_markers(const Frame& frame, const Series& series) {
  return std::any_of(frame.rows.begin(), frame.rows.end(), [&](const json* row) {
    return row->value("series", "") == series.name && !row->value("unmarked", false);
  });
}

/// Markers and lines of one series; false where it has none.
bool draw_series(const Frame& frame, const Panel& panel, const Series& series, Drawing& drawing) {
  std::map<std::string, std::vector<const json*>> lines;
  bool present = false;
  const auto place = [&](const json& row) {
    return std::pair{frame.x(number_of(row, panel.x)), frame.y(number_of(row, panel.y))};
  };
  for (const json* row : frame.rows) {
    if (row->value("series", "") != series.name) continue;
    present = true;
    const auto [x, y] = place(*row);
    const bool failed = row->value("failed", false);
    if (!failed) lines[row->value("line", "")].push_back(row);
    if (failed || !row->value("unmarked", false))
      drawing.path(marker(failed ? "failed" : series.shape, x, y), style_of(series, false));
  }
  for (auto& [name, points] : lines) {
    std::stable_sort(points.begin(), points.end(),
                     [&](const json* a, const json* b) { return number_of(*a, "order") < number_of(*b, "order"); });
    Path path;
    for (const json* row : points) {
      const auto [x, y] = place(*row);
      path.empty() ? path.move(x, y) : path.line(x, y);
    }
    drawing.path(path, style_of(series, true));
  }
  return present;
}

}  // namespace

Axis::Axis(double low, double high, bool logarithmic, double from, double to, bool bounded)
    : log_(logarithmic), from_(from), to_(to) {
  low_ = scaled(low);
  high_ = scaled(high);
  if (log_ && high_ - low_ < 1) {  // a decade at least: rounding is no trend, and some tick has its place
    const double middle = (low_ + high_) / 2;
    low_ = bounded ? low_ : middle - 0.5;
    high_ = low_ + 1;
  }
  constexpr double rounding = 1e-5;  // of a number: what an axis must not magnify, nor the six digits of a page show
  if (!log_ && high_ - low_ < rounding * std::max(std::abs(low_), std::abs(high_))) low_ = high_ = (low_ + high_) / 2;
  const double room = high_ > low_ ? 0.05 * (high_ - low_) : high_ == 0 ? 1 : std::abs(high_) / 2;
  if (!bounded) low_ -= room;
  high_ += room;
}

double Axis::operator()(double value) const { return from_ + (to_ - from_) * (scaled(value) - low_) / (high_ - low_); }

double Axis::scaled(double value) const { return log_ ? std::log10(value) : value; }

std::vector<double> Axis::ticks(double least_step) const {
  std::vector<double> out;
  if (log_ && high_ - low_ >= 2) {
    const double step = std::max(1.0, std::ceil((high_ - low_) / 7));
    for (double e = std::ceil(low_ / step) * step; e <= high_; e += step) out.push_back(std::pow(10, e));
  } else if (log_) {
    for (double e = std::floor(low_); e <= high_; ++e)
      for (const double m : {1, 2, 5})
        if (const double v = m * std::pow(10, e); scaled(v) >= low_ && scaled(v) <= high_) out.push_back(v);
  } else {
    double step = std::pow(10, std::floor(std::log10((high_ - low_) / 5)));
    for (const double m : {5, 2})
      if ((high_ - low_) / (m * step) >= 4) {
        step *= m;
        break;
      }
    step = std::max(step, least_step);
    for (double i = std::ceil(low_ / step); i * step <= high_; ++i) out.push_back(i * step + 0.0);  // 0, never -0
  }
  return out;
}

Style style_of(const Series& series, bool dashed) {
  Style style{series.color == "$ink" ? "ink" : series.color, "", 2, {}};
  if (dashed && series.dash.back() > 0) style.dash.assign(series.dash.begin(), series.dash.end());
  return style;
}

std::optional<Drawing> draw_plot(const Figure& figure, const Panel& panel) {
  const auto frame = frame_of(figure, panel);
  if (!frame) return std::nullopt;
  Drawing drawing(width, bottom, figure.title + (panel.title.empty() ? "" : ", " + panel.title), figure.text);
  draw_axes(*frame, panel.spec, drawing);
  draw_ground(*frame, panel, drawing);
  draw_guides(*frame, panel, drawing);
  double legend = bottom + 58;
  for (const auto& series : figure.series) {
    if (!draw_series(*frame, panel, series, drawing)) continue;
    drawing.line(left, legend, left + 34, legend, style_of(series, true));
    if (has_markers(*frame, series)) drawing.path(marker(series.shape, left + 17, legend), style_of(series, false));
    drawing.text(left + 42, legend + 4, series.name);
    legend += 18;
  }
  draw_tags(*frame, panel, drawing);
  drawing.set_height(legend);
  return drawing;
}

}  // namespace stickslip::report
