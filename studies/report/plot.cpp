#include "studies/report/plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

namespace stickslip::report {

using nlohmann::json;

namespace {

constexpr double left = 74, margin = 20, top = 12;  // of the axes; beside them on the right

/// Where the axes end: lower where a chart is narrow.
double bottom_of(double width) { return width < two_columns ? 0.65 * width : 300; }

bool is_log(const Quantity& quantity) { return quantity.spacing == Spacing::logarithmic; }

bool is_shown(const Figure& figure, const Chart& chart, const json& row) {
  if (!chart.only.empty() && row.value("panel", "") != chart.only) return false;
  for (const auto& choice : figure.choices) {
    if (!choice.when_field.empty() && row.value(choice.when_field, "") != choice.when) continue;
    const std::string value = row.value(choice.field, "");
    if (std::find(choice.chosen.begin(), choice.chosen.end(), value) == choice.chosen.end()) return false;
  }
  const auto drawable = [&](const std::string& field, bool logarithmic) {
    return row.contains(field) && row[field].is_number() && (!logarithmic || row[field].get<double>() > 0);
  };
  return drawable(chart.x.field, is_log(chart.x)) && drawable(chart.y.field, is_log(chart.y));
}

/// What is drawn of a chart: its rows, the guides beside them, and the axes they span.
struct Frame {
  double width, right, bottom;  ///< of the picture; of the axes
  std::vector<const json*> rows, guides;
  Axis x, y;
  std::optional<double> ground;  ///< where exact zeros stand, off what the axis names
};

/// A title "{field}" is what the row has there.
std::string axis_text(const Quantity& quantity, const json& row) {
  const std::string& title = quantity.title;
  return title.starts_with('{') ? row.value(title.substr(1, title.size() - 2), "") : title;
}

double number_of(const json& row, const std::string& field) { return row[field].get<double>(); }

std::optional<double> ground_of(const std::vector<const json*>& rows, const Chart& chart) {
  const auto zero = std::find_if(rows.begin(), rows.end(), [](const json* r) { return r->value("zero", false); });
  return zero == rows.end() ? std::nullopt : std::optional(number_of(**zero, chart.y.field));
}

std::optional<Frame> frame_of(const Figure& figure, const Chart& chart, double width) {
  std::vector<const json*> rows, guides;
  for (const auto& row : figure.rows)
    if (is_shown(figure, chart, row)) (row.value("guide", false) ? guides : rows).push_back(&row);
  if (rows.empty()) return std::nullopt;
  std::vector<const json*> all = rows;
  all.insert(all.end(), guides.begin(), guides.end());
  const auto bounds = [&](const std::string& field) {
    const auto [low, high] = std::minmax_element(all.begin(), all.end(), [&](const json* a, const json* b) {
      return number_of(*a, field) < number_of(*b, field);
    });
    return std::pair{number_of(**low, field), number_of(**high, field)};
  };
  const auto [x_low, x_high] = bounds(chart.x.field);
  const auto [y_low, y_high] = bounds(chart.y.field);
  const double right = width - margin, bottom = bottom_of(width);
  return Frame{width,
               right,
               bottom,
               rows,
               guides,
               Axis(x_low, x_high, is_log(chart.x), left, right, chart.x.bounded),
               Axis(y_low, y_high, is_log(chart.y), bottom, top),
               ground_of(rows, chart)};
}

/// Ticks with their labels, in as many digits as tell them apart.
std::vector<std::pair<double, std::string>> labelled(const std::vector<double>& ticks) {
  constexpr int fewest = 3, most = 12;
  std::vector<std::pair<double, std::string>> out;
  for (int digits = fewest; digits <= most; ++digits) {
    out.clear();
    std::set<std::string> labels;
    for (const double tick : ticks) labels.insert(out.emplace_back(tick, with_power(number(tick, digits))).second);
    if (labels.size() == ticks.size()) break;
  }
  return out;
}

/// A text in lines that are no wider than that, but for words that are.
std::vector<std::string> wrapped(const std::string& text, double size, double width) {
  std::vector<std::string> lines;
  std::istringstream words(text);
  for (std::string word; words >> word;)
    if (lines.empty() || text_width(lines.back() + " " + word, size) > width)
      lines.push_back(word);
    else
      lines.back() += " " + word;
  return lines;
}

constexpr double line_height = 15;  ///< of texts in several lines

/// Where the last line of the title of x stands.
double draw_axes(const Frame& frame, const Chart& chart, Drawing& drawing) {
  const Style grid{"line"};
  const double right = frame.right, bottom = frame.bottom;
  for (const auto& [tick, label] : labelled(frame.x.ticks(chart.x.least_step))) {
    drawing.line(frame.x(tick), top, frame.x(tick), bottom, grid);
    drawing.text(frame.x(tick), bottom + 16, label, {Anchor::middle});
  }
  for (const auto& [tick, label] : labelled(frame.y.ticks())) {
    if (frame.ground && tick < 5 * *frame.ground) continue;
    drawing.line(left, frame.y(tick), right, frame.y(tick), grid);
    drawing.text(left - 6, frame.y(tick) + 4, label, {Anchor::end});
  }
  drawing.path(Path().move(left, top).line(left, bottom).line(right, bottom), {"ink"});
  drawing.text(14, (top + bottom) / 2, axis_text(chart.y, *frame.rows.front()), {Anchor::middle, 12, "ink", true});
  const double middle = (left + right) / 2;
  double y = bottom + 36 - line_height;
  for (const auto& line : wrapped(axis_text(chart.x, *frame.rows.front()), 12, 2 * (frame.width - middle)))
    drawing.text(middle, y += line_height, line, {Anchor::middle});
  return y;
}

/// The line on which exact zeros stand, where there are any.
void draw_ground(const Frame& frame, Drawing& drawing) {
  if (!frame.ground) return;
  const double y = frame.y(*frame.ground);
  drawing.line(left, y, frame.right, y, {"ink", "", 1, {1, 3}});
  drawing.text(left - 6, y + 4, "exactly 0", {Anchor::end});
}

/// Lines that theory gives.
void draw_guides(const Frame& frame, const Chart& chart, Drawing& drawing) {
  std::map<std::string, Path> lines;
  for (const json* row : frame.guides) {
    const double x = frame.x(number_of(*row, chart.x.field)), y = frame.y(number_of(*row, chart.y.field));
    Path& path = lines[row->value("line", "")];
    path.empty() ? path.move(x, y) : path.line(x, y);
    if (const std::string tag = row->value("guide_tag", ""); !tag.empty())
      drawing.text(x - 6, y + 13, tag, {Anchor::end, 11});
  }
  for (const auto& [name, path] : lines) drawing.path(path, {"ink", "", 1, {3, 3}});
}

bool has_markers(const Frame& frame, const Series& series) {
  return std::any_of(frame.rows.begin(), frame.rows.end(), [&](const json* row) {
    return row->value("series", "") == series.name && !row->value("unmarked", false);
  });
}

/// The points of a line, in order.
using Line = std::vector<const json*>;

/// The lines of a series.
std::vector<Line> lines_of(const Frame& frame, const Series& series) {
  std::map<std::string, Line> by_name;
  for (const json* row : frame.rows)
    if (row->value("series", "") == series.name && !row->value("failed", false))
      by_name[row->value("line", "")].push_back(row);
  std::vector<Line> out;
  for (auto& [name, line] : by_name) {
    std::stable_sort(line.begin(), line.end(),
                     [](const json* a, const json* b) { return number_of(*a, "order") < number_of(*b, "order"); });
    out.push_back(std::move(line));
  }
  return out;
}

/// Pixels of the drawing.
struct Place {
  double x, y;
};
Place place_of(const Frame& frame, const Chart& chart, const json& row) {
  return {frame.x(number_of(row, chart.x.field)), frame.y(number_of(row, chart.y.field))};
}

/// A rectangle of a drawing.
struct Box {
  double left, right, top, bottom;

  bool overlaps(const Box& other) const {
    return left < other.right && other.left < right && top < other.bottom && other.top < bottom;
  }
  /// Whether a straight piece from one place to another passes through.
  bool is_crossed(const Place& from, const Place& to) const {
    double enters = 0, leaves = 1;  // shares of the piece between which it is inside
    const auto cut = [&](double start, double step, double low, double high) {
      if (step == 0) return start > low && start < high;
      const auto [first, second] = std::minmax({(low - start) / step, (high - start) / step});
      enters = std::max(enters, first);
      leaves = std::min(leaves, second);
      return enters < leaves;
    };
    return cut(from.x, to.x - from.x, left, right) && cut(from.y, to.y - from.y, top, bottom);
  }
};

/// The option's values at the ends of lines and at the runs that failed: each at its own end, where it covers no marker
/// and no other value and, if there is such a place, no line.
class EndValues {
 public:
  EndValues(const Figure& figure, const Frame& frame, const Chart& chart) : frame_(frame), chart_(chart) {
    constexpr double marker = 5;
    for (const json* row : frame.rows) {
      const auto [x, y] = place_of(frame, chart, *row);
      taken_.push_back({x - marker, x + marker, y - marker, y + marker});
    }
    for (const Series& series : figure.series)
      for (const Line& line : lines_of(frame, series))
        for (std::size_t i = 1; i < line.size(); ++i)
          pieces_.emplace_back(place_of(frame, chart, *line[i - 1]), place_of(frame, chart, *line[i]));
  }

  /// `color`: that of the line, so that a value beside another line's marker is not taken for its own.
  void draw(const Line& line, const std::string& color, Drawing& drawing) {
    const auto [x1, y1] = place_of(frame_, chart_, *line.front());
    const auto [x2, y2] = place_of(frame_, chart_, *line.back());
    if (std::abs(x1 - x2) > size || std::abs(y1 - y2) > size)
      for (const json* end : {line.back(), line.front()}) draw_value(*end, "", color, drawing);
  }

  void draw_failed(const json& row, const std::string& color, Drawing& drawing) {
    draw_value(row, " fails", color, drawing);
  }

 private:
  static constexpr double size = 11, aside = 7, above = 6, below = 14, apart = 4;

  void draw_value(const json& row, const std::string& after, const std::string& color, Drawing& drawing) {
    if (!row.contains(chart_.words.value)) return;
    const std::string value = row[chart_.words.value].get<std::string>() + after;
    const auto [x, y] = place_of(frame_, chart_, row);
    const double wide = text_width(value, size), middle = y + size / 2 - 1;
    std::vector<Box> boxes;
    for (const double base : {y - above, y + below, middle})
      for (const double from : {x + aside, x - aside - wide}) boxes.push_back({from, from + wide, base - size, base});
    for (const double base : {y - above - 3, y + below + 3})
      boxes.push_back({x - wide / 2, x + wide / 2, base - size, base});
    std::erase_if(boxes, [&](const Box& box) { return !has_room(box); });
    const auto clear = std::find_if(boxes.begin(), boxes.end(), [&](const Box& box) { return !is_on_a_line(box); });
    if (boxes.empty()) return;
    const Box& box = clear == boxes.end() ? boxes.front() : *clear;
    // not one number with the next, in fonts of documents that are wider too
    taken_.push_back({box.left - apart, box.right + apart + 0.15 * wide, box.top, box.bottom});
    drawing.text(box.left, box.bottom, value, {Anchor::start, size, color});
  }

  bool has_room(const Box& box) const {
    return box.left >= left && box.right <= frame_.width && box.top >= 0 && box.bottom <= frame_.bottom &&
           std::none_of(taken_.begin(), taken_.end(), [&](const Box& other) { return box.overlaps(other); });
  }
  bool is_on_a_line(const Box& box) const {
    return std::any_of(pieces_.begin(), pieces_.end(),
                       [&](const auto& piece) { return box.is_crossed(piece.first, piece.second); });
  }

  const Frame& frame_;
  const Chart& chart_;
  std::vector<Box> taken_;
  std::vector<std::pair<Place, Place>> pieces_;  ///< of all lines
};

/// Markers and lines of one series; false where it has none.
bool draw_series(const Frame& frame, const Chart& chart, const Series& series, EndValues& values, Drawing& drawing) {
  bool present = false;
  for (const json* row : frame.rows) {
    if (row->value("series", "") != series.name) continue;
    present = true;
    const auto [x, y] = place_of(frame, chart, *row);
    const bool failed = row->value("failed", false);
    if (const std::string& spread = chart.x.spread; row->contains(spread))
      drawing.line(x, y, std::min(frame.x(number_of(*row, spread)), frame.right), y, {color_of(series)});
    if (failed || !row->value("unmarked", false))
      drawing.path(marker(failed ? "failed" : series.shape, x, y), style_of(series, false));
  }
  for (const Line& line : lines_of(frame, series)) {
    Path path;
    for (const json* row : line) {
      const auto [x, y] = place_of(frame, chart, *row);
      path.empty() ? path.move(x, y) : path.line(x, y);
    }
    drawing.path(path, style_of(series, true));
    if (!chart.words.value.empty()) values.draw(line, color_of(series), drawing);
  }
  if (!chart.words.value.empty())
    for (const json* row : frame.rows)
      if (row->value("series", "") == series.name && row->value("failed", false))
        values.draw_failed(*row, color_of(series), drawing);
  return present;
}

/// The name of a series and, where the ends of its lines have values, of which option these are.
std::string name_of(const Series& series, const Frame& frame, const Chart& chart) {
  if (chart.words.value.empty()) return series.name;
  const auto row = std::find_if(frame.rows.begin(), frame.rows.end(), [&](const json* each) {
    return each->value("series", "") == series.name && each->contains("option");
  });
  return row == frame.rows.end() ? series.name : series.name + ", " + (*row)->value("option", "");
}

/// What is chosen of that of which the page offers more: "Quantity: worst response. Scene: mesh level 1."
std::string chosen_in_words(const Figure& figure) {
  std::string out;
  for (const Choice& choice : figure.choices)
    if (!choice.several && choice.options.size() > 1 && choice.chosen.size() == 1)
      out += (out.empty() ? "" : " ") + choice.label + ": " + choice.chosen.front() + ".";
  return out;
}

/// Words below a drawing in lines as wide as it. Where the last ends.
double draw_note(const std::string& text, double y, double width, Drawing& drawing) {
  constexpr double size = 11, from = 10;
  for (const auto& line : wrapped(text, size, width - from)) {
    drawing.text(from, y, line, {Anchor::start, size, "soft"});
    y += line_height;
  }
  return y;
}

/// The names of what is drawn, from y on, side by side where they have room. Where they end.
double draw_legend(const Frame& frame, const Chart& chart, const std::vector<const Series*>& present, double y,
                   Drawing& drawing) {
  constexpr double entry_height = 18, sample = 34, gap = 8, apart = 20;
  double x = 10;
  for (const Series* series : present) {
    const std::string name = name_of(*series, frame, chart);
    const double wide = sample + gap + text_width(name, 12);
    if (x > 10 && x + wide > frame.width) {
      x = 10;
      y += entry_height;
    }
    drawing.line(x, y, x + sample, y, style_of(*series, true));
    if (has_markers(frame, *series)) drawing.path(marker(series->shape, x + sample / 2, y), style_of(*series, false));
    drawing.text(x + sample + gap, y + 4, name);
    x += wide + apart;
  }
  return y + entry_height;
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
  constexpr double apart = 40;  // pixels that a label needs
  const double most = std::clamp(std::abs(to_ - from_) / apart, 3.0, 8.0);
  std::vector<double> out;
  if (log_ && high_ - low_ >= 2) {
    const double step = std::max(1.0, std::ceil((high_ - low_) / (most - 1)));
    for (double e = std::ceil(low_ / step) * step; e <= high_; e += step) out.push_back(std::pow(10, e));
  } else if (log_) {
    for (double e = std::floor(low_); e <= high_; ++e)
      for (const double m : {1, 2, 5})
        if (const double v = m * std::pow(10, e); scaled(v) >= low_ && scaled(v) <= high_) out.push_back(v);
  } else {
    const double power = std::pow(10, std::floor(std::log10((high_ - low_) / most)));
    double step = power;
    for (const double m : {2, 5, 10})
      if ((high_ - low_) / step > most) step = m * power;
    step = std::max(step, least_step);
    for (double i = std::ceil(low_ / step); i * step <= high_; ++i) out.push_back(i * step + 0.0);  // 0, never -0
  }
  return out;
}

std::string color_of(const Series& series) { return series.color == "$ink" ? "ink" : "curve " + series.color; }

Style style_of(const Series& series, bool dashed) {
  Style style{color_of(series), "", 2, {}};
  if (dashed && series.dash.back() > 0) style.dash.assign(series.dash.begin(), series.dash.end());
  return style;
}

std::optional<Drawing> draw_plot(const Figure& figure, const Chart& chart, double width) {
  const auto frame = frame_of(figure, chart, width);
  if (!frame) return std::nullopt;
  Drawing drawing(width, frame->bottom, figure.title + (chart.title.empty() ? "" : ", " + chart.title), figure.text);
  const double title = draw_axes(*frame, chart, drawing);
  draw_ground(*frame, drawing);
  draw_guides(*frame, chart, drawing);
  EndValues values(figure, *frame, chart);
  std::vector<const Series*> present;
  for (const auto& series : figure.series)
    if (draw_series(*frame, chart, series, values, drawing)) present.push_back(&series);
  const double below = draw_legend(*frame, chart, present, title + 22, drawing);
  drawing.set_height(draw_note(chosen_in_words(figure), below + 4, width, drawing));
  return drawing;
}

}  // namespace stickslip::report
