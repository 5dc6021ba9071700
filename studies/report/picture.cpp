#include "studies/report/picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <vector>

#include "studies/io/wording.hpp"
#include "studies/report/html.hpp"
#include "studies/report/look_up.hpp"
#include "studies/report/picture_contact.hpp"
#include "studies/report/picture_mesh.hpp"
#include "studies/report/picture_obstacles.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

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
  for (const auto& track : scene.mesh.tracks)
    for (const auto& p : track.places) scene.whole.add(p);
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
                       : fmt::format("displacements {} times enlarged, so that bodies may seem to overlap or part",
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
      "At the last step: {}, {}; {}{}.{}",
      counted(std::ssize(elements), springs             ? "spring"
                                    : scene.mesh.aslant ? "face"
                                                        : "element"),
      counted(std::ssize(scene.contact), "contact point"), scale,
      flow + (springs ? "; a cross is a spring's anchor" : "") +
          (scene.mesh.tracks.empty() ? "" : ", the line the path of the point, the dotted one of the anchor") +
          (scene.mesh.in_space ? "; seen along z" : "") +
          (scene.mesh.aslant ? "; seen aslant, from the side of the contact" : ""),
      scene.zooms && with_close_up ? " Frame: the contact enlarged; displacements not exaggerated." : "");
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
  for (const auto& track : scene.mesh.tracks)
    for (std::size_t i = 0; i < track.places.size(); ++i)
      rows.push_back({{"what", track.of_anchor ? "path of the anchor" : "path of the point"},
                      {"number", i},
                      {"x", track.places[i].x},
                      {"y", track.places[i].y}});
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
  draw_tracks(scene.mesh, frame, drawing);
  draw_elements(scene.mesh, nodes, frame, scene.peak, with_mesh, drawing);
  draw_flowed(scene.mesh, nodes, frame, drawing);
  draw_outlines(scene.mesh, nodes, frame, drawing);
  draw_wires(obstacles, scale, frame, drawing);
}

/// Whether a close-up has room beside the whole in half the width of a page.
bool has_room_aside(const Scene& scene) { return scene.zooms && scene.whole.width() < 1.5 * scene.whole.height(); }

/// The close-up in a square frame at the upper edge, and its place in the picture of the whole.
void draw_close_up(const Scene& scene, const json& obstacles, const Frame& main, double left, double size,
                   Drawing& drawing) {
  const Box box = moved_into(scene.whole, close_up(scene.contact, scene.scale));
  drawing.path(
      Path().rectangle(main.x(box.min.x), main.y(box.max.y), main.length(box.width()), main.length(box.height())),
      {"ink"});
  drawing.unclip();
  const Frame close(scene.zoom, size, size, left);
  const auto actual = deformed(scene.mesh, 1);
  drawing.clip(Path().rectangle(left, 0, size, size));
  draw_bodies(scene, obstacles, 1, actual, close, true, drawing);
  draw_contact(scene.contact, 1, close, drawing);
  drawing.unclip();
  drawing.path(Path().rectangle(left, 0.5, size - 1, size - 1), {"ink"});
}

/// Where a picture has its parts, in pixels; the legend comes below.
struct Arrangement {
  std::string id, title;
  double canvas;           ///< width of all
  double wide, height;     ///< of the whole
  double gap, inset;       ///< beside it; of a close-up; inset 0: none
  std::size_t mesh_lines;  ///< up to so many elements have them; of more they are one grey
};

Plate draw(const Scene& scene, const json& obstacles, const Arrangement& arrangement) {
  const auto& [id, title, canvas, wide, height, gap, inset, mesh_lines] = arrangement;
  const std::string text = in_words(scene, inset > 0);
  Drawing drawing(canvas, height + 44, title, text);
  const Frame frame(scene.whole, wide, height, 0);
  const auto nodes = deformed(scene.mesh, scene.scale);
  drawing.clip(Path().rectangle(0, 0, wide, height));
  draw_bodies(scene, obstacles, scene.scale, nodes, frame, scene.mesh.elements.size() <= mesh_lines, drawing);
  drawing.part(0, 0, wide, height);
  if (inset > 0) {
    drawing.part(wide + gap, 0, inset, inset);
    draw_close_up(scene, obstacles, frame, wide + gap, inset, drawing);
  } else {
    draw_contact(scene.contact, scene.scale, frame, drawing);
    drawing.unclip();
  }
  draw_stresses(scene.peak, height + 12, drawing);
  draw_states(scene.contact, height + 12, drawing);
  return Plate{id, title, text, drawing, {}, rows_of(scene, nodes)};
}

/// The scene of picture.json; nothing where there is nothing to draw.
std::optional<Scene> scene_of(const json& picture) { return picture.is_object() ? lay_out(picture) : std::nullopt; }

/// The height at which the whole fills a width.
double height_of(const Scene& scene, double wide) { return wide * scene.whole.height() / scene.whole.width(); }

/// How many points are in each state: "step 2, t = 0.5: 3 open, 1 slip".
std::string states_at(long step, double time, const std::vector<ContactPoint>& contact) {
  std::map<std::string, long> count;
  for (const auto& point : contact) ++count[point.state];
  std::string out = (step == 0 ? std::string("start") : fmt::format("step {}", step)) + ", t = " + number(time, 4);
  for (const auto& [state, n] : count)
    out += fmt::format("{} {} {}", out.find(':') == std::string::npos ? ":" : ",", n, state);
  return out;
}

/// The places of the frames that are drawn: of many some, evenly, the last among them.
std::vector<std::size_t> drawn_frames(std::size_t frames, std::size_t elements) {
  constexpr std::size_t most = 40, most_elements = 40'000;  // of all: some 3 MB of a page
  const std::size_t room = std::clamp<std::size_t>(most_elements / std::max<std::size_t>(elements, 1), 2, most);
  const std::size_t stride = (frames + room - 1) / room;
  std::vector<std::size_t> out;
  for (std::size_t i = frames == 0 ? 0 : (frames - 1) % stride; i < frames; i += stride) out.push_back(i);
  return out;
}

}  // namespace

std::vector<StepPicture> draw_steps(const json& picture) {
  const json& frames = array_at(picture, "frames");
  json bodies = picture.is_object() ? picture : json::object();
  for (const char* key : {"frames", "paths"}) bodies.erase(key);
  std::vector<std::pair<const json*, Scene>> scenes;
  for (const std::size_t i : drawn_frames(frames.size(), array_at(picture, "elements").size())) {
    bodies.update(frames[i]);
    if (auto scene = lay_out(bodies)) scenes.emplace_back(&frames[i], *std::move(scene));
  }
  if (scenes.size() < 2) return {};
  Box whole;
  double peak = 0, scale = scenes.front().second.scale;
  for (const auto& [frame, scene] : scenes) {
    whole.add(scene.whole.min);
    whole.add(scene.whole.max);
    peak = std::max(peak, scene.peak);
    scale = std::min(scale, scene.scale);  // of the largest displacements
  }
  constexpr double canvas = 640, lowest = 160, highest = 330;
  std::vector<StepPicture> out;
  for (auto& [frame, scene] : scenes) {
    std::tie(scene.whole, scene.peak, scene.scale, scene.zooms) = std::tuple(whole, peak, scale, false);
    const double time = number_at(*frame, "time");
    const double height = std::clamp(height_of(scene, canvas), lowest, highest);
    const long step = std::lround(number_at(*frame, "step"));
    out.push_back({step, states_at(step, time, scene.contact),
                   draw(scene, array_at(*frame, "obstacles"),
                        {"step", "Step at t = " + number(time, 6), canvas, canvas, height, 0, 0, 1500})
                       .drawing});
  }
  return out;
}

bool needs_close_up(const json& picture) {
  const auto scene = scene_of(picture);
  return scene && scene->zooms && !has_room_aside(*scene);
}

std::optional<Plate> draw_overview(const json& picture) {
  const auto scene = scene_of(picture);
  if (!scene) return std::nullopt;
  constexpr double canvas = 640, lowest = 160, highest = 330, gap = 20;
  const double inset = has_room_aside(*scene) ? 300 : 0, wide = inset > 0 ? canvas - inset - gap : canvas;
  const double height = std::clamp(height_of(*scene, wide), std::max(lowest, inset), highest);
  return draw(*scene, array_at(picture, "obstacles"),
              {"overview", "The scene", canvas, wide, height, gap, inset, 1500});
}

std::optional<Plate> draw_picture(const json& picture) {
  const auto scene = scene_of(picture);
  if (!scene) return std::nullopt;
  constexpr double canvas = 1000, lowest = 120, highest = 520, gap = 24;
  const double inset = scene->zooms ? 416 : 0, wide = inset > 0 ? canvas - inset - gap : canvas;
  const double height = std::max(std::clamp(height_of(*scene, wide), lowest, highest), inset);
  return draw(*scene, array_at(picture, "obstacles"),
              {"picture", "Deformed bodies and contact states", canvas, wide, height, gap, inset, 4000});
}

}  // namespace stickslip::report
