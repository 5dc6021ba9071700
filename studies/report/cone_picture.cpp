#include "studies/report/cone_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace stickslip::report {
namespace {

constexpr double side = 300, margin = 56, gap = 40, top = 64;

/// Tractions onto pixels of a panel; the same scale on both axes, so that the cone has its angle.
struct Panel {
  double left, zero, scale;
  double x(double pressure) const { return left + margin + (pressure * scale); }
  double y(double tangential) const { return zero - tangential * scale; }
};

/// Reach of a panel: a little beyond the largest traction that was kept, so that wild first trials do not shrink it.
Panel panel_of(const ConePath& path, double left) {
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

void draw_cone(const ConePath& path, const Panel& at, Drawing& drawing) {
  const double far = side / at.scale, edge = path.friction * far;
  Path cone;
  cone.move(at.x(0), at.y(0)).line(at.x(far), at.y(edge)).line(at.x(far), at.y(path.in_space ? 0 : -edge)).close();
  drawing.path(cone, {"", "line", 0, {}}, "inside the cone: stick");
  drawing.line(at.x(0), at.y(0), at.x(far), at.y(edge), {"soft", "", 1.5, {}});
  if (!path.in_space) drawing.line(at.x(0), at.y(0), at.x(far), at.y(-edge), {"soft", "", 1.5, {}});
}

void draw_iterates(const ConePath& path, const Panel& at, Drawing& drawing) {
  for (const auto& i : path.iterates) {
    const double x0 = at.x(i.trial_pressure), y0 = at.y(i.trial_tangential), x1 = at.x(i.pressure),
                 y1 = at.y(i.tangential);
    const std::string tooltip = fmt::format("t = {:g}: trial ({:.6g}, {:.6g}), traction ({:.6g}, {:.6g})", i.time,
                                            i.trial_pressure, i.trial_tangential, i.pressure, i.tangential);
    drawing.line(x0, y0, x1, y1, {"soft", "", 1, {3, 2}});
    drawing.path(Path().circle(x0, y0, 3.5), {"#1f6fb4", "paper", 1.4, {}}, tooltip);
    drawing.path(Path().circle(x1, y1, 2), {"", "ink", 1, {}}, tooltip);
  }
  std::vector<double> labelled;  // heights; a step that would write over another's time goes without
  for (const auto& i : path.iterates) {
    if (!i.last) continue;
    const double x = at.x(i.pressure), y = at.y(i.tangential);
    drawing.path(marker("diamond", x, y), {"ink", "#d1495b", 1, {}}, fmt::format("solution at t = {:g}", i.time));
    if (std::any_of(labelled.begin(), labelled.end(), [&](double h) { return std::abs(h - y) < 13; })) continue;
    drawing.text(x + 8, y + 4, fmt::format("t = {:.3g}", i.time), {Anchor::start, 11, "soft"});
    labelled.push_back(y);
  }
}

void draw_axes(const ConePath& path, const Panel& at, Drawing& drawing) {
  const double low = path.in_space ? at.zero : at.zero + side / 2;
  drawing.line(at.x(0), at.zero, at.x(0) + side, at.zero, {"ink", "", 1, {}});
  drawing.line(at.x(0), low, at.x(0), top, {"ink", "", 1, {}});
  drawing.text(at.x(0) + side, top + side + 18, fmt::format("pressure, to {:.3g}", side / at.scale), {Anchor::end, 12});
  drawing.text(at.x(0) - 10, top + side / 2,
               path.in_space ? fmt::format("size of the tangential traction, to {:.3g}", side / at.scale)
                             : fmt::format("tangential traction, to \u00b1{:.3g}", side / 2 / at.scale),
               {Anchor::middle, 12, "ink", true});
  drawing.text(at.x(0), top - 12, path.title, {Anchor::start, 13, "ink", false, true});
}

}  // namespace

Drawing draw_cones(const std::vector<ConePath>& paths, const std::string& title) {
  const double width = margin + static_cast<double>(paths.size()) * (side + margin + gap);
  Drawing drawing(width, top + side + 76, title,
                  "Friction cones: trial tractions of every iterate, joined to what they are projected to, and the "
                  "solutions of the steps.");
  drawing.text(margin, 24, title, {Anchor::start, 15, "ink", false, true});
  double left = 0;
  for (const auto& path : paths) {
    const Panel at = panel_of(path, left);
    drawing.clip(Path().rectangle(at.x(0) - 6, top - 6, side + 12, side + 12));
    draw_cone(path, at, drawing);
    draw_iterates(path, at, drawing);
    drawing.unclip();
    draw_axes(path, at, drawing);
    left += side + margin + gap;
  }
  drawing.text(margin, top + side + 44, "hollow: trial traction, joined to its projection (dot)",
               {Anchor::start, 12, "soft"});
  drawing.text(margin, top + side + 62, "diamond: solution of a step; shaded: stick", {Anchor::start, 12, "soft"});
  return drawing;
}

}  // namespace stickslip::report
