#include "studies/report/picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include "studies/report/html.hpp"
#include "studies/report/look_up.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

struct Point {
  double x = 0, y = 0;
};

struct Box {
  Point min{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  Point max{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  void add(Point p) {
    min = {std::min(min.x, p.x), std::min(min.y, p.y)};
    max = {std::max(max.x, p.x), std::max(max.y, p.y)};
  }
  double width() const { return max.x - min.x; }
  double height() const { return max.y - min.y; }
  bool overlaps(const Box& o) const {
    return min.x <= o.max.x && o.min.x <= max.x && min.y <= o.max.y && o.min.y <= max.y;
  }
};

/// Light to dark, so that it reads in grey too (the ends of Viridis, turned round).
constexpr std::array<const char*, 9> colors = {"#f4f1de", "#d9e4a8", "#a8d483", "#6cbf80", "#3ba387",
                                               "#2a848c", "#31648c", "#3d4287", "#43176a"};

struct Mesh {
  std::vector<Point> points;               ///< initial
  std::vector<Point> displacement;         ///< 0 where not recorded
  std::vector<std::vector<int>> elements;  ///< node lists with valid indices
  std::vector<double> stress;              ///< one an element, or empty
  std::vector<int> body;                   ///< one an element, or empty
};

bool is_point(const json& value) {
  return value.is_array() && value.size() == 2 && value[0].is_number() && value[1].is_number();
}
Point to_point(const json& value) { return {value[0].get<double>(), value[1].get<double>()}; }

/// The plane mesh of picture.json; no points where it is not one.
Mesh read_mesh(const json& picture) {
  Mesh mesh;
  const json &points = array_at(picture, "points"), &moved = array_at(picture, "displacement");
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!is_point(points[i])) return {};
    mesh.points.push_back(to_point(points[i]));
    mesh.displacement.push_back(i < moved.size() && is_point(moved[i]) ? to_point(moved[i]) : Point{});
  }
  const json &stress = array_at(picture, "von_mises"), &body = array_at(picture, "bodies");
  const json& elements = array_at(picture, "elements");
  for (std::size_t e = 0; e < elements.size(); ++e) {
    std::vector<int> nodes;
    for (const auto& node : elements[e])
      if (node.is_number_integer() && node >= 0 && node < points.size()) nodes.push_back(node);
    if (nodes.size() < 2 || nodes.size() != elements[e].size()) continue;
    mesh.elements.push_back(nodes);
    mesh.stress.push_back(e < stress.size() && stress[e].is_number() ? stress[e].get<double>() : 0);
    mesh.body.push_back(e < body.size() && body[e].is_number_integer() ? body[e].get<int>() : 0);
  }
  return mesh;
}

/// Exaggeration: 1 where displacements show by themselves, else the round number that brings the largest to some 3 %
/// of the picture.
double scale_of(const Mesh& mesh, double extent) {
  double largest = 0;
  for (const auto& u : mesh.displacement) largest = std::max(largest, std::hypot(u.x, u.y));
  if (largest <= 0 || largest >= 0.01 * extent) return 1;
  const double wanted = 0.03 * extent / largest, decade = std::pow(10, std::floor(std::log10(wanted)));
  for (const double step : {5, 2})
    if (wanted >= step * decade) return step * decade;
  return decade;
}

/// Maps a window of the plane onto a picture of the given size in pixels, y up.
class Frame {
 public:
  Frame(Box window, double width, double height, double left) : window_(window) {
    scale_ = std::min(width / window.width(), height / window.height());
    shift_ = {left + (width - scale_ * window.width()) / 2, (height - scale_ * window.height()) / 2};
  }
  double x(double x) const { return shift_.x + scale_ * (x - window_.min.x); }
  double y(double y) const { return shift_.y + scale_ * (window_.max.y - y); }
  double length(double l) const { return scale_ * l; }
  const Box& window() const { return window_; }

 private:
  Box window_;
  double scale_;
  Point shift_;
};

std::vector<Point> deformed(const Mesh& mesh, double scale) {
  std::vector<Point> out(mesh.points.size());
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = {mesh.points[i].x + scale * mesh.displacement[i].x, mesh.points[i].y + scale * mesh.displacement[i].y};
  return out;
}

/// Nodes of an element in the order of its outline. Quadratic elements list corners first, then the middles of the
/// sides in turn.
std::vector<int> outline(const std::vector<int>& nodes) {
  if (nodes.size() != 6 && nodes.size() != 8) return nodes;
  std::vector<int> out;
  for (std::size_t i = 0; i < nodes.size() / 2; ++i) {
    out.push_back(nodes[i]);
    out.push_back(nodes[nodes.size() / 2 + i]);
  }
  return out;
}

/// Sides that belong to one element of a body alone: the outlines of the bodies.
std::string draw_outlines(const Mesh& mesh, const std::vector<Point>& at, const Frame& frame) {
  std::map<std::array<int, 3>, int> uses;  // body, lower node, higher node
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    const auto nodes = outline(mesh.elements[e]);
    if (nodes.size() < 3) continue;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const auto [a, b] = std::minmax(nodes[i], nodes[(i + 1) % nodes.size()]);
      ++uses[{mesh.body[e], a, b}];
    }
  }
  std::string path;
  for (const auto& [side, n] : uses) {
    const Point a = at[side[1]], b = at[side[2]];
    Box box;
    box.add(a);
    box.add(b);
    if (n == 1 && box.overlaps(frame.window()))
      path += fmt::format("M{:.1f} {:.1f}L{:.1f} {:.1f}", frame.x(a.x), frame.y(a.y), frame.x(b.x), frame.y(b.y));
  }
  return path.empty() ? path : fmt::format("<path d=\"{}\" class=\"ink\" fill=\"none\"/>\n", path);
}

/// Elements inside the frame's window, one path a colour: 20 000 elements stay a light page.
std::string draw_elements(const Mesh& mesh, const std::vector<Point>& at, const Frame& frame, double peak,
                          bool mesh_lines) {
  std::array<std::string, colors.size()> paths;
  std::string lines;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    const auto nodes = outline(mesh.elements[e]);
    Box box;
    for (const int i : nodes) box.add(at[i]);
    if (!box.overlaps(frame.window())) continue;
    std::string path;
    for (std::size_t i = 0; i < nodes.size(); ++i)
      path += fmt::format("{}{:.1f} {:.1f}", i == 0 ? "M" : "L", frame.x(at[nodes[i]].x), frame.y(at[nodes[i]].y));
    if (nodes.size() == 2) {
      lines += path;
      continue;
    }
    const double share = peak > 0 ? mesh.stress[e] / peak : 0;
    const auto bin = static_cast<std::size_t>(std::clamp(share, 0.0, 1.0) * (colors.size() - 1) + 0.5);
    paths[bin] += path + "Z";
  }
  std::string out;
  for (std::size_t i = 0; i < colors.size(); ++i)
    if (!paths[i].empty())
      // Without mesh lines a stroke of the fill's own colour closes the hairlines between neighbours.
      out += fmt::format("<path d=\"{0}\" fill=\"{1}\" stroke=\"{2}\" stroke-width=\"{3}\"/>\n", paths[i], colors[i],
                         mesh_lines ? "#00000055" : colors[i], mesh_lines ? "0.5" : "0.3");
  if (!lines.empty()) out += fmt::format("<path d=\"{}\" class=\"ink\" fill=\"none\" stroke-width=\"2\"/>\n", lines);
  return out;
}

std::string draw_obstacles(const json& obstacles, const Frame& frame) {
  std::string out;
  const double reach = 2 * (frame.window().width() + frame.window().height());
  for (const auto& obstacle : obstacles) {
    if (!obstacle.is_object() || obstacle.empty()) continue;
    const std::string kind = obstacle.begin().key();
    const json& data = obstacle.begin().value();
    if (kind == "plane" && is_point(at(data, "point")) && is_point(at(data, "normal"))) {
      Point p = to_point(data["point"]), n = to_point(data["normal"]);
      const double length = std::hypot(n.x, n.y);
      if (length == 0) continue;
      n = {n.x / length, n.y / length};
      // The foot of the window's middle, so that the drawn stretch covers the window wherever the point lies.
      const Point middle{(frame.window().min.x + frame.window().max.x) / 2,
                         (frame.window().min.y + frame.window().max.y) / 2};
      const double off = (middle.x - p.x) * n.x + (middle.y - p.y) * n.y;
      p = {middle.x - off * n.x, middle.y - off * n.y};
      const std::array<Point, 4> corners = {Point{p.x - reach * n.y, p.y + reach * n.x},
                                            Point{p.x + reach * n.y, p.y - reach * n.x},
                                            Point{p.x + reach * (n.y - n.x), p.y - reach * (n.x + n.y)},
                                            Point{p.x - reach * (n.y + n.x), p.y + reach * (n.x - n.y)}};
      std::string shape;
      for (const auto& c : corners)
        shape += fmt::format("{}{:.1f} {:.1f}", shape.empty() ? "M" : "L", frame.x(c.x), frame.y(c.y));
      out += fmt::format("<path d=\"{}Z\" class=\"obstacle\"/>\n", shape);
    } else if ((kind == "circle" || kind == "cylinder") && is_point(at(data, "center")) &&
               at(data, "radius").is_number()) {
      const Point c = to_point(data["center"]);
      const bool cup = at(data, "inside") == true;
      out += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\" class=\"obstacle\"{}/>\n", frame.x(c.x),
                         frame.y(c.y), frame.length(data["radius"]), cup ? " style=\"fill:none\"" : "");
    } else if (kind == "polyline") {
      const json& points = data.is_array() ? data : array_at(data, "points");
      std::string shape;
      for (const auto& p : points)
        if (is_point(p))
          shape += fmt::format("{}{:.1f} {:.1f}", shape.empty() ? "M" : "L", frame.x(p[0]), frame.y(p[1]));
      out += fmt::format("<path d=\"{}\" class=\"obstacle\" style=\"fill:none\"/>\n", shape);
    }
  }
  return out;
}

std::string marker(const std::string& state, double x, double y) {
  if (state == "stick")
    return fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"7\" height=\"7\" class=\"stick\"/>", x - 3.5, y - 3.5);
  if (state == "slip") return fmt::format("<path d=\"M{:.1f} {:.1f}l4.5 8h-9Z\" class=\"slip\"/>", x, y - 5);
  return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" class=\"open\"/>", x, y);
}

/// Contact points of `contact` inside the window, with the state and tractions as a tooltip. `contact` gives deformed
/// positions.
std::string draw_contact(const json& contact, const Frame& frame) {
  std::string out;
  const Box& w = frame.window();
  for (const auto& c : contact) {
    if (!at(c, "x").is_number() || !at(c, "y").is_number()) continue;
    const double x = c["x"], y = c["y"];
    const std::string state = plain(at(c, "state"));
    if (x < w.min.x || x > w.max.x || y < w.min.y || y > w.max.y) continue;
    out += fmt::format("<g>{}<title>{}: {}, normal traction {}, tangential {}</title></g>\n",
                       marker(state, frame.x(x), frame.y(y)), escape(plain(at(c, "name"))), escape(state),
                       escape(plain(at(c, "normal"))), escape(plain(at(c, "tangential"))));
  }
  return out;
}

/// A square around the contact points that touch (around all where none does), and some room; empty without points.
Box close_up(const json& contact) {
  Box touching, all;
  for (const auto& c : contact) {
    if (!at(c, "x").is_number() || !at(c, "y").is_number()) continue;
    const Point p{c["x"], c["y"]};
    all.add(p);
    if (plain(at(c, "state")) != "open") touching.add(p);
  }
  const Box& core = touching.width() >= 0 && std::max(touching.width(), touching.height()) > 0 ? touching : all;
  const double size = std::max(core.width(), core.height());
  if (!(size > 0)) return {};
  const Point middle{(core.min.x + core.max.x) / 2, (core.min.y + core.max.y) / 2};
  Box out;
  out.add({middle.x - 0.7 * size, middle.y - 0.7 * size});
  out.add({middle.x + 0.7 * size, middle.y + 0.7 * size});
  return out;
}

Box padded(Box box, double share) {
  const double room = share * std::max(box.width(), box.height());
  box.add({box.min.x - room, box.min.y - room});
  box.add({box.max.x + room, box.max.y + room});
  return box;
}

std::string legend(double peak, double y) {
  std::string out = fmt::format("<g class=\"text\" transform=\"translate(10 {:.0f})\">", y);
  if (peak > 0) {
    out += "<text y=\"12\">equivalent stress</text>";
    for (std::size_t i = 0; i < colors.size(); ++i)
      out += fmt::format("<rect x=\"{}\" y=\"2\" width=\"22\" height=\"12\" fill=\"{}\"/>", 135 + 22 * i, colors[i]);
    out += fmt::format("<text x=\"135\" y=\"28\">0</text><text x=\"333\" y=\"28\" text-anchor=\"end\">{}</text>",
                       number(peak));
  }
  double x = 390;
  for (const auto& [state, words] : {std::pair{"stick", "sticks"}, {"slip", "slips"}, {"open", "open"}}) {
    out += marker(state, x, 8) + fmt::format("<text x=\"{:.0f}\" y=\"12\">{}</text>", x + 10, words);
    x += 80;
  }
  return out + "</g>\n";
}

}  // namespace

std::string draw_picture(const json& picture) {
  if (!picture.is_object()) return {};
  const Mesh mesh = read_mesh(picture);
  if (mesh.elements.empty()) return {};
  Box reference;
  for (const auto& p : mesh.points) reference.add(p);
  const double extent = std::max(reference.width(), reference.height());
  if (!(extent > 0)) return {};

  const double scale = scale_of(mesh, extent);
  const auto exaggerated = deformed(mesh, scale), actual = deformed(mesh, 1);
  Box whole;
  for (const auto& p : exaggerated) whole.add(p);
  whole = padded(whole, 0.03);
  double peak = 0;
  for (const double s : mesh.stress) peak = std::max(peak, s);
  const json& contact = array_at(picture, "contact");
  const json& obstacles = array_at(picture, "obstacles");
  const Box zoom = close_up(contact);
  // A close-up of most of the picture would show the same thing twice.
  const bool zooms = zoom.width() > 0 && zoom.width() < 0.8 * extent;

  const double gap = 24, wide = zooms ? 560 : 1000, inset = 416;
  const double tall = std::clamp(wide * whole.height() / whole.width(), 120.0, 520.0);
  const double height = zooms ? std::max(tall, inset) : tall;
  const Frame main(whole, wide, height, 0);
  constexpr std::size_t lines_up_to = 4000;  // more mesh lines than that are one grey

  const std::string scale_text =
      scale == 1
          ? std::string("displacements at true scale")
          : fmt::format("displacements {} times enlarged (bodies that touch may seem to overlap)", number(scale));
  const std::string description =
      fmt::format("Reference solution at the last step: {} elements, {} contact points; {}.{}", mesh.elements.size(),
                  contact.size(), scale_text, zooms ? " Right: the contact at true scale." : "");
  std::string out = fmt::format(
      "<svg class=\"picture\" viewBox=\"0 0 1000 {:.0f}\" role=\"img\" aria-labelledby=\"picture-title "
      "picture-desc\">\n"
      "<title id=\"picture-title\">Deformed bodies and contact states</title>"
      "<desc id=\"picture-desc\">{}</desc>\n",
      height + 44, escape(description));
  out += fmt::format(
      "<defs><clipPath id=\"main-clip\"><rect width=\"{:.0f}\" height=\"{:.0f}\"/></clipPath>"
      "<clipPath id=\"zoom-clip\"><rect x=\"{:.0f}\" width=\"{:.0f}\" height=\"{:.0f}\"/></clipPath>"
      "<pattern id=\"hatch\" width=\"7\" height=\"7\" patternUnits=\"userSpaceOnUse\" "
      "patternTransform=\"rotate(45)\"><path d=\"M0 0V7\" class=\"ink\" stroke-width=\"1\"/></pattern>"
      "</defs>\n",
      wide, height, wide + gap, inset, inset);
  out += "<g clip-path=\"url(#main-clip)\">\n" + draw_obstacles(obstacles, main) +
         draw_elements(mesh, exaggerated, main, peak, mesh.elements.size() <= lines_up_to) +
         draw_outlines(mesh, exaggerated, main);
  // Contact points are recorded at their true place, which an enlarged picture does not show.
  if (!zooms && scale == 1) out += draw_contact(contact, main);
  if (zooms)
    out += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" class=\"frame\"/>\n",
                       main.x(zoom.min.x), main.y(zoom.max.y), main.length(zoom.width()), main.length(zoom.height()));
  out += "</g>\n";
  if (zooms) {
    const Frame close(zoom, inset, inset, wide + gap);
    out += "<g clip-path=\"url(#zoom-clip)\">\n" + draw_obstacles(obstacles, close) +
           draw_elements(mesh, actual, close, peak, true) + draw_outlines(mesh, actual, close) +
           draw_contact(contact, close) + "</g>\n";
    out += fmt::format("<rect x=\"{:.0f}\" y=\"0.5\" width=\"{:.0f}\" height=\"{:.0f}\" class=\"frame\"/>\n",
                       wide + gap, inset - 1, inset - 1);
  }
  out += legend(peak, height + 12) + "</svg>\n";
  return out + "<p class=\"note\">" + escape(description) + "</p>\n";
}

}  // namespace stickslip::report
