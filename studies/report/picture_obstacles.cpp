#include "studies/report/picture_obstacles.hpp"

#include <cmath>
#include <utility>

#include "studies/report/look_up.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

/// What an obstacle moved by, enlarged: u = by + (R - I) (X - center). At small strain R - I is linear in the angle; at
/// finite strain pictures are at true scale, and the angle is turned by in full.
class Motion {
 public:
  Motion(const json& moved, double scale) {
    if (is_point(at(moved, "by"))) by_ = to_point(moved["by"]);
    by_ = {scale * by_.x, scale * by_.y};
    if (!is_point(at(moved, "center"))) return;
    center_ = to_point(moved["center"]);
    const double angle = number_at(moved, "degrees") * std::acos(-1.0) / 180;
    const bool finite = at(moved, "finite") == true;
    sine_ = finite ? std::sin(angle) : scale * angle;
    cosine_less_one_ = finite ? std::cos(angle) - 1 : 0;
  }
  Point place(Point p) const {
    const Point turned = direction({p.x - center_.x, p.y - center_.y});
    return {center_.x + by_.x + turned.x, center_.y + by_.y + turned.y};
  }
  Point direction(Point n) const {
    return {n.x + cosine_less_one_ * n.x - sine_ * n.y, n.y + sine_ * n.x + cosine_less_one_ * n.y};
  }

 private:
  Point by_, center_;
  double sine_ = 0, cosine_less_one_ = 0;
};

/// The stretch of a plane that covers the window, whichever of its points is named.
Path plane_shape(Point p, Point n, const Frame& frame) {
  const double length = std::hypot(n.x, n.y);
  if (length == 0) return {};
  n = {n.x / length, n.y / length};
  const double reach = 2 * (frame.window().width() + frame.window().height());
  const Point middle{(frame.window().min.x + frame.window().max.x) / 2,
                     (frame.window().min.y + frame.window().max.y) / 2};
  const double off = (middle.x - p.x) * n.x + (middle.y - p.y) * n.y;
  p = {middle.x - off * n.x, middle.y - off * n.y};
  Path path;
  for (const auto& [along, across] : {std::pair{-1, 0}, {1, 0}, {1, 1}, {-1, 1}}) {
    const double x = p.x + reach * (along * n.y - across * n.x), y = p.y - reach * (along * n.x + across * n.y);
    path.empty() ? path.move(frame.x(x), frame.y(y)) : path.line(frame.x(x), frame.y(y));
  }
  return path.close();
}

/// A solid: hatched, in grey print too.
void hatch(const Path& shape, Drawing& drawing) {
  constexpr double widest = 1000, tallest = 520;  // of a picture
  Path lines;
  for (double x = -tallest; x < widest; x += 9) lines.move(x, tallest).line(x + tallest, 0);
  drawing.clip(shape);
  drawing.path(std::move(lines), {"soft", "", 1, {}});
  drawing.unclip();
}

void add_line(const json& vertices, const Motion& motion, const Frame& frame, Path& path) {
  bool is_first = true;
  for (const auto& vertex : vertices) {
    if (!is_point(vertex)) {  // the next piece
      is_first = true;
      continue;
    }
    const Point p = motion.place(to_point(vertex));
    std::exchange(is_first, false) ? path.move(frame.x(p.x), frame.y(p.y)) : path.line(frame.x(p.x), frame.y(p.y));
  }
}

}  // namespace

void draw_wires(const json& obstacles, double scale, const Frame& frame, Drawing& drawing) {
  Path wires;
  for (const auto& obstacle : obstacles) {
    const json& wire = at(obstacle, "wire");
    if (wire.is_object()) add_line(array_at(wire, "points"), Motion(at(wire, "moved"), scale), frame, wires);
  }
  if (!wires.empty()) drawing.path(std::move(wires), {"soft", "", 0.8, {}});
}

void draw_obstacles(const json& obstacles, double scale, const Frame& frame, Drawing& drawing) {
  const Style edge{"ink", "", 1.2, {}};
  for (const auto& obstacle : obstacles) {
    if (!obstacle.is_object() || obstacle.empty()) continue;
    const std::string kind = obstacle.begin().key();
    const json& data = obstacle.begin().value();
    const Motion motion(at(data, "moved"), scale);
    Path shape;
    bool solid = true;
    if (kind == "plane" && is_point(at(data, "point")) && is_point(at(data, "normal"))) {
      shape = plane_shape(motion.place(to_point(data["point"])), motion.direction(to_point(data["normal"])), frame);
    } else if ((kind == "circle" || kind == "cylinder") && is_point(at(data, "center")) &&
               at(data, "radius").is_number()) {
      const Point c = motion.place(to_point(data["center"]));
      shape.circle(frame.x(c.x), frame.y(c.y), frame.length(data["radius"]));
      solid = at(data, "inside") != true;
    } else if (kind == "polyline") {
      solid = false;
      add_line(data.is_array() ? data : array_at(data, "points"), motion, frame, shape);
    }
    if (shape.empty()) continue;
    if (solid) hatch(shape, drawing);
    drawing.path(std::move(shape), edge);
  }
}

}  // namespace stickslip::report
