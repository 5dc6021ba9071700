/// A scene as another machine rounds it: the same bodies with coordinates moved by roundings, and numbered otherwise.
#pragma once

#include <algorithm>
#include <numeric>

#include "core/model/slots.hpp"
#include "tests/support/derivatives.hpp"

namespace stickslip::perturbed {

/// What is done to a scene. Its numbers stay; its parameters are left out, for some are dimensions of generated meshes.
struct Perturbation {
  double share = 0;       ///< largest motion of a coordinate, relative to it
  bool reversed = false;  ///< nodes, elements, bodies and contacts in the opposite order
  unsigned seed = 1;
};

/// Coordinates times 1 + up to `share`.
inline void move_points(Eigen::Ref<Points<double>> points, const Perturbation& by) {
  const Vector<double> random = derivatives::arbitrary(static_cast<int>(points.size()), by.seed);
  points = points.array() * (1 + by.share * random.array().reshaped(points.rows(), points.cols()));
}

/// The corners of a linear element, begun at another one: turned about an axis of it. Of a quadratic one all its nodes.
inline std::vector<int> turned_nodes(ElementShape shape) {
  if (shape == ElementShape::tet4) return {1, 2, 0, 3};
  if (shape == ElementShape::hex8) return {1, 2, 3, 0, 5, 6, 7, 4};
  std::vector<int> nodes(nodes_of(shape));
  std::iota(nodes.begin(), nodes.end(), 0);
  if (!is_quadratic(shape)) std::rotate(nodes.begin(), nodes.begin() + 1, nodes.end());
  return nodes;
}

/// A mesh with its nodes and elements numbered backwards, and each linear element begun at another corner.
inline void reverse_numbers(Mesh& mesh, Points<double>& points) {
  const int last = mesh.node_count - 1, corners = nodes_of(mesh.shape), elements = mesh.element_count();
  const auto turned = turned_nodes(mesh.shape);
  const auto before = mesh.connectivity;
  for (int e = 0; e < elements; ++e)
    for (int a = 0; a < corners; ++a)
      mesh.connectivity[(elements - 1 - e) * corners + a] = last - before[e * corners + turned[a]];
  for (auto& [name, side] : mesh.sides) {
    for (int& node : side.nodes) node = last - node;
    for (auto* facets : {&side.facets, &side.quadratic})
      for (auto& facet : *facets)
        for (int& node : facet) node = last - node;
  }
  points = points.rowwise().reverse().eval();
}

/// The scene with its continua as imported meshes, perturbed. What is left to do to chains and points, which cannot be
/// imported: slots_of.
inline Scene scene_of(Scene scene, const Perturbation& by) {
  scene.parameters.clear();
  scene.objectives.clear();
  const Model model = make_model(scene);
  const auto points = initial_points(model, scene.as<double>());
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const auto& body = model.bodies[b];
    if (!is_continuum(body.mesh.shape)) continue;
    ImportedMesh imported{"", scene.bodies[b].name, body.mesh,
                          points.middleCols(body.first_node, body.mesh.node_count)};
    imported.mesh.middles.clear();
    move_points(imported.points, by);
    if (by.reversed) reverse_numbers(imported.mesh, imported.points);
    scene.bodies[b].mesh = imported;
  }
  if (by.reversed) {
    std::reverse(scene.bodies.begin(), scene.bodies.end());
    std::reverse(scene.contacts.begin(), scene.contacts.end());
  }
  return scene;
}

/// Slots of the model of a perturbed scene, with the nodes of chains and points moved too.
inline Slots<double> slots_of(const Model& model, const Perturbation& by) {
  const auto numbers = model.scene.as<double>();
  Points<double> points = initial_points(model, numbers);
  for (const auto& body : model.bodies)
    if (!is_continuum(body.mesh.shape)) move_points(points.middleCols(body.first_node, body.mesh.node_count), by);
  return make_slots<double>(model, numbers, std::move(points));
}

}  // namespace stickslip::perturbed
