#include "studies/report/picture_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "studies/report/colors.hpp"
#include "studies/report/html.hpp"
#include "studies/report/look_up.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

/// A point of the plane, or one in space as it is seen along z; nothing of anything else.
std::optional<Point> seen(const json& value) {
  if (is_point(value)) return to_point(value);
  const bool in_space = value.is_array() && value.size() == 3 && is_point({value[0], value[1]});
  return in_space ? std::optional(to_point(value)) : std::nullopt;
}

/// Nodes of an element in the order of its outline. Quadratic elements list corners first, then the middles of the
/// sides in turn, faces in space perhaps a node within.
std::vector<int> outline(const std::vector<int>& nodes) {
  if (nodes.size() < 6) return nodes;
  std::vector<int> out;
  const std::size_t corners = nodes.size() / 2;
  for (std::size_t i = 0; i < corners; ++i) {
    out.push_back(nodes[i]);
    out.push_back(nodes[corners + i]);
  }
  return out;
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

/// Whether a path leaves the straight line from its first place to its furthest by a share of its length that shows.
bool turns(const std::vector<Point>& places) {
  constexpr double shows = 0.02;
  if (places.empty()) return false;
  const Point first = places.front();
  const auto way = [&](const Point& p) { return std::hypot(p.x - first.x, p.y - first.y); };
  const Point far = *std::max_element(places.begin(), places.end(), [&](auto& a, auto& b) { return way(a) < way(b); });
  const double length = way(far);
  return length > 0 && std::any_of(places.begin(), places.end(), [&](const Point& p) {
           const double across = (far.x - first.x) * (p.y - first.y) - (far.y - first.y) * (p.x - first.x);
           return std::abs(across) > shows * length * length;
         });
}

/// The tracks of points that picture.json has, where one of them turns: of those that go to and fro a line says
/// nothing.
std::vector<Track> read_tracks(const json& picture, const std::vector<Point>& points,
                               const std::vector<std::vector<int>>& elements) {
  std::vector<Track> tracks;
  for (const auto& path : array_at(picture, "paths")) {
    const json& node = at(path, "node");
    if (!node.is_number_integer() || node < 0 || node >= points.size()) continue;
    const Point start = points[node.get<std::size_t>()];
    Track track;
    track.of_anchor = std::any_of(elements.begin(), elements.end(), [&](auto& nodes) { return nodes.back() == node; });
    for (const auto& u : array_at(path, "displacement"))
      if (const auto by = seen(u)) track.places.push_back({start.x + by->x, start.y + by->y});
    tracks.push_back(std::move(track));
  }
  if (std::none_of(tracks.begin(), tracks.end(), [](const Track& track) { return turns(track.places); })) return {};
  return tracks;
}

}  // namespace

double extent_of(const Mesh& mesh) {
  Box box;
  for (const auto& p : mesh.points) box.add(p);
  return std::max(box.width(), box.height());
}

bool is_spring(const Mesh& mesh, const std::vector<int>& nodes) {
  if (nodes.size() != 2) return false;
  const Point a = mesh.points[nodes[0]], b = mesh.points[nodes[1]];
  return a.x == b.x && a.y == b.y;
}

Mesh read_mesh(const json& picture) {
  Mesh mesh;
  mesh.aslant = picture.contains("aslant");
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
  if (extent_of(mesh) == 0) mesh.tracks = read_tracks(picture, mesh.points, mesh.elements);
  return mesh;
}

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

void draw_elements(const Mesh& mesh, const std::vector<Point>& at, const Frame& frame, double peak, bool mesh_lines,
                   Drawing& drawing) {
  std::array<Path, stress_colors.size()> paths;
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
    const auto bin = static_cast<std::size_t>(std::clamp(share, 0.0, 1.0) * (stress_colors.size() - 1) + 0.5);
    Path& path = nodes.size() == 2 ? lines : paths[bin];
    path.move(frame.x(at[nodes[0]].x), frame.y(at[nodes[0]].y));
    for (std::size_t i = 1; i < nodes.size(); ++i) path.line(frame.x(at[nodes[i]].x), frame.y(at[nodes[i]].y));
    if (nodes.size() > 2) path.close();
    // Faces in space cover those behind them.
    if (mesh.aslant && nodes.size() > 2)
      drawing.path(std::exchange(path, {}), {mesh_lines ? "#5f6670" : stress_colors[bin], stress_colors[bin], 0.3, {}});
  }
  for (std::size_t i = 0; i < stress_colors.size(); ++i)
    // Without mesh lines a stroke of the fill's own colour closes the hairlines between neighbours.
    drawing.path(std::move(paths[i]), {mesh_lines ? "#5f6670" : stress_colors[i], stress_colors[i], 0.3, {}});
  drawing.path(std::move(lines), {"ink", "", 2, {}});
}

void draw_tracks(const Mesh& mesh, const Frame& frame, Drawing& drawing) {
  for (const Track& track : mesh.tracks) {
    Path path;
    for (const Point& p : track.places)
      path.empty() ? path.move(frame.x(p.x), frame.y(p.y)) : path.line(frame.x(p.x), frame.y(p.y));
    const std::vector<double> dash = track.of_anchor ? std::vector<double>{2, 4} : std::vector<double>{};
    drawing.path(std::move(path), {"soft", "", track.of_anchor ? 1.2 : 2, dash});
  }
}

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

void draw_outlines(const Mesh& mesh, const std::vector<Point>& at, const Frame& frame, Drawing& drawing) {
  if (mesh.aslant) return;                 // of faces that hide one another
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

void draw_stresses(double peak, double y, Drawing& drawing) {
  if (!(peak > 0)) return;
  drawing.part(0, y - 4, 350, 36);
  drawing.text(10, y + 12, "equivalent stress");
  for (std::size_t i = 0; i < stress_colors.size(); ++i)
    drawing.path(Path().rectangle(145 + 22.0 * static_cast<double>(i), y + 2, 22, 12), {"", stress_colors[i], 1, {}});
  drawing.text(145, y + 28, "0");
  drawing.text(343, y + 28, number(peak), {Anchor::end});
}

}  // namespace stickslip::report
