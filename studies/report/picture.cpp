#include "studies/report/picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "studies/io/wording.hpp"
#include "studies/report/html.hpp"
#include "studies/report/look_up.hpp"
#include "studies/report/picture_contact.hpp"
#include "studies/report/picture_obstacles.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

/// Light to dark, so that it reads in grey too (the ends of Viridis, turned round).
constexpr std::array<const char*, 9> colors = {"#f4f1de", "#d9e4a8", "#a8d483", "#6cbf80", "#3ba387",
                                               "#2a848c", "#31648c", "#3d4287", "#43176a"};

struct Mesh {
  std::vector<Point> points;               ///< initial
  std::vector<Point> displacement;         ///< 0 where not recorded
  std::vector<std::vector<int>> elements;  ///< node lists with valid indices
  std::vector<double> stress;              ///< one an element, or empty
  std::vector<double> plastic;             ///< equivalent plastic strain, one an element; empty where nothing flows
  std::vector<int> body;                   ///< one an element, or empty
  bool in_space = false;                   ///< three coordinates, of which two are kept: seen along z
};

/// The extent of the nodes at the start; 0 where all bodies are points.
double extent_of(const Mesh& mesh) {
  Box box;
  for (const auto& p : mesh.points) box.add(p);
  return std::max(box.width(), box.height());
}

/// Whether an element is the spring of a point to its anchor, which begin at the same place.
bool is_spring(const Mesh& mesh, const std::vector<int>& nodes) {
  if (nodes.size() != 2) return false;
  const Point a = mesh.points[nodes[0]], b = mesh.points[nodes[1]];
  return a.x == b.x && a.y == b.y;
}

/// A point of the plane, or one in space as it is seen along z; nothing of anything else.
std::optional<Point> seen(const json& value) {
  if (is_point(value)) return to_point(value);
  const bool in_space = value.is_array() && value.size() == 3 && is_point({value[0], value[1]});
  return in_space ? std::optional(to_point(value)) : std::nullopt;
}

/// The mesh of picture.json; no points where it is not one.
Mesh read_mesh(const json& picture) {
  Mesh mesh;
  const json &points = array_at(picture, "points"), &moved = array_at(picture, "displacement");
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto point = seen(points[i]);
    if (!point) return {};
    mesh.in_space |= points[i].size() == 3;
    mesh.points.push_back(*point);
    mesh.displacement.push_back(i < moved.size() ? seen(moved[i]).value_or(Point{}) : Point{});
  }
  const json &stress = array_at(picture, "von_mises"), &body = array_at(picture, "bodies");
  const json &elements = array_at(picture, "elements"), &plastic = array_at(picture, "plastic_strain");
  for (std::size_t e = 0; e < elements.size(); ++e) {
    std::vector<int> nodes;
    for (const auto& node : elements[e])
      if (node.is_number_integer() && node >= 0 && node < points.size()) nodes.push_back(node);
    if (nodes.size() < 2 || nodes.size() != elements[e].size()) continue;
    mesh.elements.push_back(nodes);
    mesh.stress.push_back(e < stress.size() && stress[e].is_number() ? stress[e].get<double>() : 0);
    if (!plastic.empty())
      mesh.plastic.push_back(e < plastic.size() && plastic[e].is_number() ? plastic[e].get<double>() : 0);
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
void draw_outlines(const Mesh& mesh, const std::vector<Point>& at, const Frame& frame, Drawing& drawing) {
  std::map<std::array<int, 3>, int> uses;  // body, lower node, higher node
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    const auto nodes = outline(mesh.elements[e]);
    if (nodes.size() < 3) continue;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const auto [a, b] = std::minmax(nodes[i], nodes[(i + 1) % nodes.size()]);
      ++uses[{mesh.body[e], a, b}];
    }
  }
  Path path;
  for (const auto& [side, n] : uses) {
    const Point a = at[side[1]], b = at[side[2]];
    Box box;
    box.add(a);
    box.add(b);
    if (n == 1 && box.overlaps(frame.window())) path.move(frame.x(a.x), frame.y(a.y)).line(frame.x(b.x), frame.y(b.y));
  }
  drawing.path(std::move(path), {"ink"});
}

/// A spring from its point to its anchor, which is a small cross.
void draw_spring(const Frame& frame, Point from, Point to, Drawing& drawing) {
  constexpr int turns = 12;
  constexpr double aside = 6, cross = 5;  // pixels
  const double x = frame.x(from.x), y = frame.y(from.y), dx = frame.x(to.x) - x, dy = frame.y(to.y) - y;
  const double length = std::hypot(dx, dy);
  Path spring, anchor;
  spring.move(x, y);
  for (int i = 1; i < turns && length > 0; ++i) {
    const double along = static_cast<double>(i) / turns, across = (i % 2 == 1 ? aside : -aside) / length;
    spring.line(x + along * dx - across * dy, y + along * dy + across * dx);
  }
  spring.line(x + dx, y + dy);
  for (const double turn : {-cross, cross})
    anchor.move(x + dx - cross, y + dy - turn).line(x + dx + cross, y + dy + turn);
  drawing.path(std::move(spring), {"ink", "", 1.2, {}});
  drawing.path(std::move(anchor), {"ink", "", 2, {}});
}

/// Elements inside the frame's window, one path a colour: 20 000 elements stay a light page.
void draw_elements(const Mesh& mesh, const std::vector<Point>& at, const Frame& frame, double peak, bool mesh_lines,
                   Drawing& drawing) {
  std::array<Path, colors.size()> paths;
  Path lines;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    const auto nodes = outline(mesh.elements[e]);
    Box box;
    for (const int i : nodes) box.add(at[i]);
    if (!box.overlaps(frame.window())) continue;
    if (is_spring(mesh, nodes)) {
      draw_spring(frame, at[nodes[0]], at[nodes[1]], drawing);
      continue;
    }
    const double share = peak > 0 ? mesh.stress[e] / peak : 0;
    const auto bin = static_cast<std::size_t>(std::clamp(share, 0.0, 1.0) * (colors.size() - 1) + 0.5);
    Path& path = nodes.size() == 2 ? lines : paths[bin];
    path.move(frame.x(at[nodes[0]].x), frame.y(at[nodes[0]].y));
    for (std::size_t i = 1; i < nodes.size(); ++i) path.line(frame.x(at[nodes[i]].x), frame.y(at[nodes[i]].y));
    if (nodes.size() > 2) path.close();
  }
  for (std::size_t i = 0; i < colors.size(); ++i)
    // Without mesh lines a stroke of the fill's own colour closes the hairlines between neighbours.
    drawing.path(std::move(paths[i]), {mesh_lines ? "#5f6670" : colors[i], colors[i], 0.3, {}});
  drawing.path(std::move(lines), {"ink", "", 2, {}});
}

/// A dot in the middle of each element that has flowed.
void draw_flowed(const Mesh& mesh, const std::vector<Point>& at, const Frame& frame, Drawing& drawing) {
  constexpr double size = 2.6;  // pixels
  Path dots;
  for (std::size_t e = 0; e < mesh.plastic.size(); ++e) {
    if (!(mesh.plastic[e] > 0)) continue;
    Point middle;
    Box box;
    for (const int i : mesh.elements[e]) {
      middle.x += at[i].x / static_cast<double>(mesh.elements[e].size());
      middle.y += at[i].y / static_cast<double>(mesh.elements[e].size());
      box.add(at[i]);
    }
    if (box.overlaps(frame.window()))
      dots.rectangle(frame.x(middle.x) - size / 2, frame.y(middle.y) - size / 2, size, size);
  }
  drawing.path(std::move(dots), {"", "ink", 0, {}});
}

constexpr double canvas = 1000, tallest = 520;  // of the picture; the legend comes below

/// A square around the contact points that touch (around all where none does), and some room; empty without points.
Box close_up(const std::vector<ContactPoint>& contact, double scale) {
  Box touching, all;
  for (const auto& c : contact) {
    all.add(c.enlarged(scale));
    if (c.state != "open") touching.add(c.enlarged(scale));
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

/// The box moved into another one, along each axis where it fits.
Box moved_into(const Box& outer, Box box) {
  for (double Point::*along : {&Point::x, &Point::y}) {
    const double size = box.max.*along - box.min.*along;
    if (size > outer.max.*along - outer.min.*along) continue;
    box.min.*along = std::clamp(box.min.*along, outer.min.*along, outer.max.*along - size);
    box.max.*along = box.min.*along + size;
  }
  return box;
}

Box padded(Box box, double share) {
  const double room = share * std::max(box.width(), box.height());
  box.add({box.min.x - room, box.min.y - room});
  box.add({box.max.x + room, box.max.y + room});
  return box;
}

void draw_stresses(double peak, double y, Drawing& drawing) {
  if (!(peak > 0)) return;
  drawing.part(0, y - 4, 350, 36);
  drawing.text(10, y + 12, "equivalent stress");
  for (std::size_t i = 0; i < colors.size(); ++i)
    drawing.path(Path().rectangle(145 + 22.0 * static_cast<double>(i), y + 2, 22, 12), {"", colors[i], 1, {}});
  drawing.text(145, y + 28, "0");
  drawing.text(343, y + 28, number(peak), {Anchor::end});
}

/// What is drawn: the mesh, what came of it, and how it is laid out.
struct Scene {
  Mesh mesh;
  std::vector<ContactPoint> contact;
  double scale, peak = 0;  ///< exaggeration; largest stress
  Box whole, zoom;         ///< windows; no zoom: empty
  bool zooms;
};

std::optional<Scene> lay_out(const json& picture) {
  Scene scene{read_mesh(picture), {}, 1, 0, {}, {}, false};
  if (scene.mesh.elements.empty()) return std::nullopt;
  scene.contact = read_contact(array_at(picture, "contact"), scene.mesh.displacement);
  const double extent = extent_of(scene.mesh);
  const bool points_alone = extent == 0;
  const bool of_bodies_alone = !scene.contact.empty() && array_at(picture, "obstacles").empty();  // else these part
  const bool true_scale = points_alone || of_bodies_alone || at(picture, "finite") == true;
  scene.scale = true_scale ? 1 : scale_of(scene.mesh, extent);
  for (const auto& p : deformed(scene.mesh, scene.scale)) scene.whole.add(p);
  if (points_alone) scene.whole.add(scene.mesh.points.front());  // where they come from
  if (!(std::max(scene.whole.width(), scene.whole.height()) > 0)) return std::nullopt;
  scene.whole = padded(scene.whole, points_alone ? 0.3 : 0.03);
  for (const double s : scene.mesh.stress) scene.peak = std::max(scene.peak, s);
  scene.zoom = moved_into(scene.whole, close_up(scene.contact, 1));
  // A close-up of most of the picture would show the same thing twice.
  scene.zooms = scene.zoom.width() > 0 && scene.zoom.width() < 0.8 * extent;
  return scene;
}

std::string in_words(const Scene& scene, bool with_close_up) {
  const std::string scale =
      scene.scale == 1 ? std::string("displacements at true scale")
                       : fmt::format("displacements {} times enlarged (bodies that touch may seem to overlap or part)",
                                     number(scene.scale));
  const auto& elements = scene.mesh.elements;
  const bool springs =
      std::all_of(elements.begin(), elements.end(), [&](const auto& nodes) { return is_spring(scene.mesh, nodes); });
  const auto& plastic = scene.mesh.plastic;
  const auto largest = std::max_element(plastic.begin(), plastic.end());
  const std::string flow =
      plastic.empty() ? ""
      : !(*largest > 0)
          ? "; nothing has flowed"
          : fmt::format("; a dot is an element that has flowed, by {:.3g} of plastic strain at most", *largest);
  return fmt::format(
      "At the last step: {}, {}; {}{}.{}", counted(std::ssize(elements), springs ? "spring" : "element"),
      counted(std::ssize(scene.contact), "contact point"), scale,
      flow + (springs ? "; a cross is a spring's anchor" : "") + (scene.mesh.in_space ? "; seen along z" : ""),
      scene.zooms && with_close_up ? " Right: the contact at true scale." : "");
}

/// Nodes and contact points where they are drawn, and elements by their nodes.
json rows_of(const Scene& scene, const std::vector<Point>& nodes) {
  json rows = json::array();
  for (std::size_t i = 0; i < nodes.size(); ++i)
    rows.push_back({{"what", "node"}, {"number", i}, {"x", nodes[i].x}, {"y", nodes[i].y}});
  for (std::size_t e = 0; e < scene.mesh.elements.size(); ++e) {
    std::string corners;
    for (const int node : scene.mesh.elements[e]) corners += (corners.empty() ? "" : " ") + std::to_string(node);
    rows.push_back({{"what", "element"}, {"number", e}, {"nodes", corners}, {"stress", scene.mesh.stress[e]}});
    if (!scene.mesh.plastic.empty()) rows.back()["plastic_strain"] = scene.mesh.plastic[e];
  }
  const double scale = scene.zooms ? 1 : scene.scale;
  for (std::size_t i = 0; i < scene.contact.size(); ++i) {
    const Point p = scene.contact[i].enlarged(scale);
    rows.push_back({{"what", "contact point"}, {"number", i}, {"x", p.x}, {"y", p.y}});
    rows.back().update({{"contact", scene.contact[i].name},
                        {"state", scene.contact[i].state},
                        {"normal", scene.contact[i].normal},
                        {"tangential", scene.contact[i].tangential}});
  }
  return rows;
}

/// Bodies and obstacles, in a frame; displacements of obstacles enlarged by `scale`.
void draw_bodies(const Scene& scene, const json& obstacles, double scale, const std::vector<Point>& nodes,
                 const Frame& frame, bool with_mesh, Drawing& drawing) {
  draw_obstacles(obstacles, scale, frame, drawing);
  draw_elements(scene.mesh, nodes, frame, scene.peak, with_mesh, drawing);
  draw_flowed(scene.mesh, nodes, frame, drawing);
  draw_outlines(scene.mesh, nodes, frame, drawing);
}

}  // namespace

bool has_close_up(const json& picture) {
  const auto scene = picture.is_object() ? lay_out(picture) : std::nullopt;
  return scene && scene->zooms;
}

std::optional<Plate> draw_overview(const json& picture) {
  if (!picture.is_object()) return std::nullopt;
  const auto scene = lay_out(picture);
  if (!scene) return std::nullopt;
  constexpr double wide = 640, lowest = 160, highest = 330;
  constexpr std::size_t lines_up_to = 1500;
  const double height = std::clamp(wide * scene->whole.height() / scene->whole.width(), lowest, highest);
  const std::string title = "The scene", text = in_words(*scene, false);
  Drawing drawing(wide, height + 44, title, text);
  const Frame frame(scene->whole, wide, height, 0);
  const auto nodes = deformed(scene->mesh, scene->scale);
  drawing.clip(Path().rectangle(0, 0, wide, height));
  draw_bodies(*scene, array_at(picture, "obstacles"), scene->scale, nodes, frame,
              scene->mesh.elements.size() <= lines_up_to, drawing);
  draw_contact(scene->contact, scene->scale, frame, drawing);
  drawing.unclip();
  drawing.part(0, 0, wide, height);
  draw_stresses(scene->peak, height + 12, drawing);
  draw_states(scene->contact, height + 12, drawing);
  return Plate{"overview", title, text, drawing, {}, rows_of(*scene, nodes)};
}

std::optional<Plate> draw_picture(const json& picture) {
  if (!picture.is_object()) return std::nullopt;
  const auto scene = lay_out(picture);
  if (!scene) return std::nullopt;
  const json& obstacles = array_at(picture, "obstacles");
  const double gap = 24, wide = scene->zooms ? 560 : canvas, inset = 416;
  const double tall = std::clamp(wide * scene->whole.height() / scene->whole.width(), 120.0, tallest);
  const double height = scene->zooms ? std::max(tall, inset) : tall;
  const std::string title = "Deformed bodies and contact states", text = in_words(*scene, true);
  Drawing drawing(canvas, height + 44, title, text);
  constexpr std::size_t lines_up_to = 4000;  // more mesh lines than that are one grey

  const Frame main(scene->whole, wide, height, 0);
  const auto exaggerated = deformed(scene->mesh, scene->scale);
  drawing.clip(Path().rectangle(0, 0, wide, height));
  draw_bodies(*scene, obstacles, scene->scale, exaggerated, main, scene->mesh.elements.size() <= lines_up_to, drawing);
  if (scene->zooms) {
    const Box box = moved_into(scene->whole, close_up(scene->contact, scene->scale));
    drawing.path(
        Path().rectangle(main.x(box.min.x), main.y(box.max.y), main.length(box.width()), main.length(box.height())),
        {"ink"});
  } else {
    draw_contact(scene->contact, scene->scale, main, drawing);
  }
  drawing.unclip();
  drawing.part(0, 0, wide, height);
  if (scene->zooms) {
    drawing.part(wide + gap, 0, inset, inset);
    const Frame close(scene->zoom, inset, inset, wide + gap);
    const auto actual = deformed(scene->mesh, 1);
    drawing.clip(Path().rectangle(wide + gap, 0, inset, inset));
    draw_bodies(*scene, obstacles, 1, actual, close, true, drawing);
    draw_contact(scene->contact, 1, close, drawing);
    drawing.unclip();
    drawing.path(Path().rectangle(wide + gap, 0.5, inset - 1, inset - 1), {"ink"});
  }
  draw_stresses(scene->peak, height + 12, drawing);
  draw_states(scene->contact, height + 12, drawing);
  return Plate{"picture", title, text, drawing, {}, rows_of(*scene, exaggerated)};
}

}  // namespace stickslip::report
