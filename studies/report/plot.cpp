#include "studies/report/plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

namespace stickslip::report {

using nlohmann::json;

namespace {

constexpr double left = 74, right = 620, top = 12, bottom = 300;  // of the axes, in a picture 640 wide

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

/// One axis: values onto pixels, linear or logarithmic.
class Axis {
 public:
  Axis(double low, double high, bool logarithmic, double from, double to) : log_(logarithmic), from_(from), to_(to) {
    low_ = scaled(low);
    high_ = scaled(high);
    const double room = high_ > low_ ? 0.05 * (high_ - low_) : log_ ? 0.5 : std::max(std::abs(high_), 1.0) / 2;
    low_ -= room;
    high_ += room;
  }
  double operator()(double value) const { return from_ + (to_ - from_) * (scaled(value) - low_) / (high_ - low_); }

  /// Some four to eight round values inside the axis.
  std::vector<double> ticks() const {
    std::vector<double> out;
    if (log_ && high_ - low_ >= 2) {
      const double step = std::max(1.0, std::ceil((high_ - low_) / 7));
      for (double e = std::ceil(low_ / step) * step; e <= high_; e += step) out.push_back(std::pow(10, e));
    } else if (log_) {
      const bool narrow = high_ - low_ < 0.8;  // less than a decade: two or three of 1 2 5 would be all
      for (double e = std::floor(low_); e <= high_; ++e)
        for (const double m : narrow ? std::vector<double>{1, 1.5, 2, 3, 4, 5, 7} : std::vector<double>{1, 2, 5})
          if (const double v = m * std::pow(10, e); scaled(v) >= low_ && scaled(v) <= high_) out.push_back(v);
    } else {
      double step = std::pow(10, std::floor(std::log10((high_ - low_) / 5)));
      for (const double m : {5, 2})
        if ((high_ - low_) / (m * step) >= 4) {
          step *= m;
          break;
        }
      for (double i = std::ceil(low_ / step); i * step <= high_; ++i) out.push_back(i * step);
    }
    return out;
  }

 private:
  double scaled(double value) const { return log_ ? std::log10(value) : value; }
  bool log_;
  double from_, to_, low_, high_;
};

std::string marker(const std::string& shape, double x, double y) {
  if (shape == "square") return fmt::format("M{:.1f} {:.1f}h8v8h-8Z", x - 4, y - 4);
  if (shape == "triangle-up") return fmt::format("M{:.1f} {:.1f}l5 9h-10Z", x, y - 5);
  if (shape == "triangle-down") return fmt::format("M{:.1f} {:.1f}l5 -9h-10Z", x, y + 5);
  if (shape == "triangle-left") return fmt::format("M{:.1f} {:.1f}l9 5v-10Z", x - 5, y);
  if (shape == "triangle-right") return fmt::format("M{:.1f} {:.1f}l-9 5v-10Z", x + 5, y);
  if (shape == "diamond") return fmt::format("M{:.1f} {:.1f}l5 5l-5 5l-5 -5Z", x, y - 5);
  if (shape == "cross") return fmt::format("M{:.1f} {:.1f}h8M{:.1f} {:.1f}v8", x - 4, y, x, y - 4);
  return fmt::format("M{:.1f} {:.1f}a4 4 0 1 0 8 0a4 4 0 1 0 -8 0Z", x - 4, y);
}

std::string style_of(const Series& series, bool dashed) {
  const std::string color = series.color == "$ink" ? "currentColor" : series.color;
  std::string out = fmt::format("fill=\"none\" stroke=\"{}\" stroke-width=\"2\"", color);
  if (dashed && series.dash.back() > 0) {
    out += " stroke-dasharray=\"";
    for (const int d : series.dash) out += std::to_string(d) + " ";
    out += "\"";
  }
  return out;
}

std::string axis_text(const json& spec, const std::string& name) {
  for (const auto& layer : spec["layer"])
    if (layer.contains("encoding") && layer["encoding"].contains(name) && layer["encoding"][name].contains("title"))
      return layer["encoding"][name]["title"];
  return {};
}

}  // namespace

std::string draw_plot(const Figure& figure, const Panel& panel) {
  std::vector<const json*> rows;
  for (const auto& row : figure.rows)
    if (!row.value("guide", false) && is_shown(figure, panel, row)) rows.push_back(&row);
  if (rows.empty()) return {};
  const auto value = [](const json& row, const std::string& field) { return row[field].get<double>(); };
  const auto bounds = [&](const std::string& field) {
    const auto [low, high] = std::minmax_element(
        rows.begin(), rows.end(), [&](const json* a, const json* b) { return value(*a, field) < value(*b, field); });
    return std::pair{value(**low, field), value(**high, field)};
  };
  const auto [x_low, x_high] = bounds(panel.x);
  const auto [y_low, y_high] = bounds(panel.y);
  const Axis x(x_low, x_high, panel.x_log, left, right), y(y_low, y_high, panel.y_log, bottom, top);

  std::string body;
  for (const double tick : x.ticks())
    body += fmt::format(
        "<path d=\"M{0:.1f} {1}V{2}\" class=\"grid\"/><text x=\"{0:.1f}\" y=\"{3}\" "
        "text-anchor=\"middle\">{4}</text>\n",
        x(tick), top, bottom, bottom + 16, number(tick));
  for (const double tick : y.ticks())
    body += fmt::format(
        "<path d=\"M{1} {0:.1f}H{2}\" class=\"grid\"/><text x=\"{3}\" y=\"{4:.1f}\" "
        "text-anchor=\"end\">{5}</text>\n",
        y(tick), left, right, left - 6, y(tick) + 4, number(tick));

  double legend_y = bottom + 58;
  for (const auto& series : figure.series) {
    std::map<std::string, std::vector<const json*>> lines;
    bool present = false;
    for (const json* row : rows) {
      if (row->value("series", "") != series.name) continue;
      present = true;
      const double px = x(value(*row, panel.x)), py = y(value(*row, panel.y));
      if (row->value("failed", false)) {
        body += fmt::format("<path d=\"M{:.1f} {:.1f}l8 8m-8 0l8 -8\" {}/>\n", px - 4, py - 4, style_of(series, false));
        continue;
      }
      lines[row->value("line", "")].push_back(row);
      if (!row->value("unmarked", false))
        body += fmt::format("<path d=\"{}\" {}/>\n", marker(series.shape, px, py), style_of(series, false));
    }
    if (!present) continue;
    for (auto& [name, points] : lines) {
      std::stable_sort(points.begin(), points.end(),
                       [&](const json* a, const json* b) { return value(*a, "order") < value(*b, "order"); });
      std::string path;
      for (const json* row : points)
        path +=
            fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", x(value(*row, panel.x)), y(value(*row, panel.y)));
      body += fmt::format("<path d=\"{}\" {}/>\n", path, style_of(series, true));
    }
    body += fmt::format("<path d=\"M{0} {1}h34\" {2}/><path d=\"{3}\" {4}/><text x=\"{5}\" y=\"{6}\">{7}</text>\n",
                        left, legend_y, style_of(series, true), marker(series.shape, left + 17, legend_y),
                        style_of(series, false), left + 42, legend_y + 4, escape(series.name));
    legend_y += 18;
  }
  if (std::any_of(rows.begin(), rows.end(), [](const json* r) { return r->value("zero", false); })) {
    body += fmt::format("<text x=\"{}\" y=\"{}\">lowest points: exactly 0</text>\n", left, legend_y + 4);
    legend_y += 18;
  }
  body += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>", (left + right) / 2, bottom + 36,
                      escape(axis_text(panel.spec, "x")));
  body += fmt::format("<text transform=\"translate(14 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
                      (top + bottom) / 2, escape(axis_text(panel.spec, "y")));
  const std::string name = figure.title + (panel.title.empty() ? "" : ", " + panel.title);
  return fmt::format(
      "<svg class=\"plot text\" viewBox=\"0 0 640 {:.0f}\" role=\"img\"><title>{}</title><desc>{}</desc>"
      "\n<path d=\"M{} {}V{}H{}\" class=\"ink\" fill=\"none\"/>\n{}</svg>\n",
      legend_y, escape(name), escape(figure.text), left, top, bottom, right, body);
}

}  // namespace stickslip::report
