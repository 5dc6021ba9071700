#include "studies/report/cone_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "studies/report/html.hpp"

namespace stickslip::report {
namespace {

constexpr double side = 300, margin = 72, gap = 24, top = 64;

/// Tractions onto pixels of a panel; the same scale on both axes, so that the cone has its angle.
struct ConePanel {
  double left, zero, scale;
  double reach() const { return side / scale; }
  double x(double pressure) const { return left + margin + (pressure * scale); }
  double y(double tangential) const { return zero - tangential * scale; }
};

/// Reach of a panel: a little beyond the largest traction that was kept, so that wild first trials do not shrink it.
ConePanel panel_of(const ConePath& path, double left) {
  double pressure = 0, tangential = 0;
  for (const auto& i : path.iterates) {
    if (!i.last) continue;
    pressure = std::max(pressure, i.pressure);
    tangential = std::max(tangential, std::abs(i.tangential));
  }
  double reach = 1.25 * std::max(pressure, (path.in_space ? 1 : 2) * tangential);
  if (!(reach > 0)) reach = 1;
  const double zero = top + (path.in_space ? side : side / 2);
  return {left, zero, side / reach};
}

/// Corners of the bound over the pressure: where it begins, where it bends, where the panel ends.
std::vector<std::pair<double, double>> edge_of(const FrictionLaw<double>& law, double far) {
  std::vector<std::pair<double, double>> edge{{0, law.bound(0)}};
  const auto corner = law.corner();
  if (corner && law.piece(far) != law.piece(0)) edge.emplace_back(*corner, law.bound(far));
  edge.emplace_back(far, law.bound(far));
  return edge;
}

void draw_cone(const ConePath& path, const ConePanel& at, Drawing& drawing) {
  const auto edge = edge_of(path.law, side / at.scale);
  Path cone;
  cone.move(at.x(0), at.y(0));
  for (const auto& [p, t] : edge) cone.line(at.x(p), at.y(t));
  if (path.in_space) cone.line(at.x(edge.back().first), at.y(0));
  for (auto corner = edge.rbegin(); !path.in_space && corner != edge.rend(); ++corner)
    cone.line(at.x(corner->first), at.y(-corner->second));
  drawing.path(cone.close(), {"", "line", 0, {}}, "inside the cone: stick");
  for (double sign : {1.0, -1.0})
    for (std::size_t k = 1; k < edge.size() && (sign > 0 || !path.in_space); ++k)
      drawing.line(at.x(edge[k - 1].first), at.y(sign * edge[k - 1].second), at.x(edge[k].first),
                   at.y(sign * edge[k].second), {"soft", "", 1.5, {}});
}

/// 0 open, 1 sticks, 2 and -2 slips this way and that. A slipping traction lies on the cone but for rounding.
int state_of(const ConeIterate& i, const FrictionLaw<double>& law) {
  if (!(i.pressure > 0)) return 0;
  if (std::abs(i.tangential) < law.bound(i.pressure) * (1 - 1e-9)) return 1;
  return i.tangential < 0 ? -2 : 2;
}

/// The solutions worth a word: the first, the last, and where the state is no longer that of the step before.
std::vector<const ConeIterate*> telling_solutions(const ConePath& path) {
  std::vector<const ConeIterate*> out, all;
  for (const auto& i : path.iterates)
    if (i.last) all.push_back(&i);
  for (std::size_t n = 0; n < all.size(); ++n)
    if (n == 0 || n + 1 == all.size() || state_of(*all[n], path.law) != state_of(*all[n - 1], path.law))
      out.push_back(all[n]);
  return out;
}

struct Label {
  double left, top, width;  ///< of its text, some 12 pixels high
  bool covers(double x, double y) const { return x > left - 6 && x < left + width + 6 && y > top - 6 && y < top + 18; }
  bool overlaps(const Label& o) const {
    return left < o.left + o.width + 4 && o.left < left + width + 4 && std::abs(top - o.top) < 14;
  }
};

/// Writes the times of the telling solutions beside their marks, each at the nearest place where it covers no mark and
/// no other time, with a line to its mark; solutions in one place share a label, and one without room goes without.
void draw_times(const ConePath& path, const ConePanel& at, Drawing& drawing) {
  std::vector<std::pair<double, double>> marks;
  for (const auto& i : path.iterates)
    for (const auto& [p, t] : {std::pair{i.pressure, i.tangential}, {i.trial_pressure, i.trial_tangential}})
      marks.emplace_back(at.x(p), at.y(t));
  std::map<std::pair<long, long>, std::string> texts;  // by pixels
  for (const auto* i : telling_solutions(path)) {
    auto& text = texts[{std::lround(at.x(i->pressure)), std::lround(at.y(i->tangential))}];
    text += fmt::format("{}{:.3g}", text.empty() ? "t = " : ", ", i->time);
  }
  std::vector<Label> placed;
  for (const auto& [place, text] : texts) {
    const auto x = static_cast<double>(place.first), y = static_cast<double>(place.second);
    const auto is_free = [&](const Label& label) {
      return label.left > at.x(0) + 2 && label.left + label.width < at.x(0) + side && label.top > top &&
             label.top + 12 < top + side &&
             std::none_of(marks.begin(), marks.end(), [&](const auto& m) { return label.covers(m.first, m.second); }) &&
             std::none_of(placed.begin(), placed.end(), [&](const Label& o) { return label.overlaps(o); });
    };
    const double width = 1.2 * text_width(text, 11);  // where Helvetica is missing, others are wider
    for (int n = 0; n < 48; ++n) {                    // eight directions, ever further out
      const double angle = n % 8 * std::numbers::pi / 4, distance = 18 + 14.0 * (n / 8);
      const double across = distance * std::cos(angle), down = distance * std::sin(angle);
      const Label label{x + across - (across < -1 ? width : across > 1 ? 0 : width / 2), y + down - 6, width};
      if (!is_free(label)) continue;
      drawing.line(x, y, x + across, y + down, {"soft", "", 0.7, {}});
      drawing.text(label.left, label.top + 10, text, {Anchor::start, 11, "ink"});
      placed.push_back(label);
      break;
    }
  }
}

void draw_iterates(const ConePath& path, const ConePanel& at, Drawing& drawing) {
  for (const auto& i : path.iterates) {
    const double x0 = at.x(i.trial_pressure), y0 = at.y(i.trial_tangential), x1 = at.x(i.pressure),
                 y1 = at.y(i.tangential);
    const std::string tooltip = fmt::format("t = {:g}: trial ({:.6g}, {:.6g}), traction ({:.6g}, {:.6g})", i.time,
                                            i.trial_pressure, i.trial_tangential, i.pressure, i.tangential);
    drawing.line(x0, y0, x1, y1, {"soft", "", 1, {3, 2}});
    drawing.path(Path().circle(x0, y0, 3.5), {"#1f6fb4", "paper", 1.4, {}}, tooltip);
    drawing.path(Path().circle(x1, y1, 2), {"", "ink", 1, {}}, tooltip);
  }
  for (const auto& i : path.iterates)
    if (i.last)
      drawing.path(marker("diamond", at.x(i.pressure), at.y(i.tangential)), {"ink", "#d1495b", 1, {}},
                   fmt::format("solution at t = {:g}", i.time));
}

/// A round number that goes some four to ten times into `reach`.
double tick_step(double reach) {
  const double decade = std::pow(10, std::floor(std::log10(reach / 4)));
  return reach / 4 >= 5 * decade ? 5 * decade : reach / 4 >= 2 * decade ? 2 * decade : decade;
}

void draw_axes(const ConePath& path, const ConePanel& at, Drawing& drawing) {
  const double low = path.in_space ? at.zero : at.zero + side / 2;
  drawing.line(at.x(0), at.zero, at.x(0) + side, at.zero, {"ink", "", 1, {}});
  drawing.line(at.x(0), low, at.x(0), top, {"ink", "", 1, {}});
  const double step = tick_step(at.reach()), least = path.in_space ? 0 : -at.reach() / 2;
  for (double n = 0; n * step <= at.reach(); ++n) {
    drawing.line(at.x(n * step), low, at.x(n * step), low + 5, {"ink"});
    drawing.text(at.x(n * step), low + 17, number(n * step), {Anchor::middle, 11});
  }
  for (double n = std::ceil(least / step); n * step <= least + at.reach(); ++n) {
    drawing.line(at.x(0) - 5, at.y(n * step), at.x(0), at.y(n * step), {"ink"});
    drawing.text(at.x(0) - 8, at.y(n * step) + 4, number(n * step + 0.0), {Anchor::end, 11});  // 0, never -0
  }
  drawing.text(at.x(side / 2 / at.scale), top + side + 36, path.of_forces ? "normal force" : "pressure",
               {Anchor::middle, 12});
  const std::string friction = path.of_forces ? "friction" : "tangential traction";
  drawing.text(at.left + 12, top + side / 2, (path.in_space ? "size of the " : "") + friction,
               {Anchor::middle, 12, "ink", true});
  drawing.text(at.x(0), top - 12, path.title, {Anchor::start, 13, "ink", false, true});
}

}  // namespace

Drawing draw_cones(const std::vector<ConePath>& paths, const std::string& title) {
  const double width = margin + static_cast<double>(paths.size()) * (side + margin + gap);
  Drawing drawing(width, top + side + 94, title,
                  "Friction cones: trial tractions of every iterate, joined to what they are projected to, and the "
                  "solutions of the steps.");
  drawing.text(margin, 24, title, {Anchor::start, 15, "ink", false, true});
  double left = 0;
  for (const auto& path : paths) {
    const ConePanel at = panel_of(path, left);
    drawing.clip(Path().rectangle(at.x(0) - 6, top - 6, side + 12, side + 12));
    draw_cone(path, at, drawing);
    draw_iterates(path, at, drawing);
    draw_times(path, at, drawing);
    drawing.unclip();
    draw_axes(path, at, drawing);
    left += side + margin + gap;
  }
  drawing.text(margin, top + side + 62, "hollow: trial traction, joined to its projection (dot)",
               {Anchor::start, 12, "soft"});
  drawing.text(margin, top + side + 80, "diamond: solution of a step; shaded: stick", {Anchor::start, 12, "soft"});
  return drawing;
}

}  // namespace stickslip::report
