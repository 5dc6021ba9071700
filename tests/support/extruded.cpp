#include "tests/support/extruded.hpp"

#include <stdexcept>

namespace stickslip::scenes {
namespace {

MeshDescription drawn_out(const MeshDescription& mesh, const Number& thickness) {
  return std::visit(
      [&]<class M>(const M& plane) -> MeshDescription {
        if constexpr (std::is_constructible_v<PlaneMesh, M>) return ExtrudedMesh{plane, 0.0, thickness, 1};
        throw std::invalid_argument("extruded: a mesh that is not of the plane");
      },
      mesh);
}

RigidSurface drawn_out(const RigidSurface& surface) {
  if (const auto* plane = std::get_if<Plane>(&surface))
    return Plane{{plane->point[0], plane->point[1], 0.0}, {plane->normal[0], plane->normal[1], 0.0}};
  if (const auto* circle = std::get_if<Circle>(&surface))
    return Cylinder{{circle->center[0], circle->center[1], 0.0}, {0.0, 0.0, 1.0}, circle->radius, circle->inside};
  // a polyline, drawn out beyond the bodies
  const auto& polyline = std::get<Polyline>(surface);
  const auto count = static_cast<int>(polyline.points.size());
  RigidFacets facets;
  facets.vertices.resize(3, 2 * count);
  for (int v = 0; v < count; ++v)
    for (const int end : {0, 1})
      facets.vertices.col(2 * v + end) << polyline.points[v][0].value, polyline.points[v][1].value, end == 0 ? -1 : 2;
  for (int v = 0; v + 1 < count + polyline.closed; ++v) {
    const int next = (v + 1) % count;
    facets.facets.push_back({2 * v, 2 * v + 1, 2 * next + 1, 2 * next});
  }
  return facets;
}

void draw_out(std::optional<Rotation>& rotation) {
  if (!rotation) return;
  rotation->center.emplace_back(0.0);
  rotation->axis = {0.0, 0.0, 1.0};
}

}  // namespace

Scene extruded(Scene scene) {
  scene.space = Space::solid;
  for (auto& body : scene.bodies) {
    body.mesh = drawn_out(body.mesh, body.thickness);
    body.thickness = 1.0;
    if (body.element == "Q4") body.element = "H8";
    if (body.element == "Q8") body.element = "H20";
    if (body.element == "Q4_mean_dilatation") body.element = "H8_mean_dilatation";
    for (const char* end : {".front", ".back"}) scene.supports.push_back({body.name + end, {{'z', Table{{{0, 0.0}}}}}});
  }
  for (auto& obstacle : scene.obstacles) {
    obstacle.shape = drawn_out(obstacle.shape);
    draw_out(obstacle.rotate);
  }
  for (auto& support : scene.supports) {
    draw_out(support.rotate);
    if (support.inclined) support.inclined->along.emplace_back(0.0);
  }
  for (auto& load : scene.loads)
    if (load.kind != Load::Kind::pressure) load.vector.emplace_back(0.0);
  std::erase_if(scene.responses, [](const Response& response) {
    return response.component == Response::Component::moment || response.kind == Response::Kind::contact_half_width;
  });
  for (auto& response : scene.responses)
    if (!response.at.empty()) response.at.emplace_back(0.0);
  for (auto& shape : scene.shapes) shape.direction.push_back(0);
  return scene;
}

}  // namespace stickslip::scenes
