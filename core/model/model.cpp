#include "core/model/model.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "core/mesh/generators.hpp"
#include "core/mesh/quality.hpp"
#include "core/mesh/shapes.hpp"
#include "core/mesh/sides.hpp"
#include "core/model/pairing.hpp"
#include "core/model/response_places.hpp"
#include "core/model/slots.hpp"
#include "core/model/supports.hpp"

namespace stickslip {
namespace {

int body_index(const Scene& scene, const std::string& name) {
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    if (scene.bodies[b].name == name) return static_cast<int>(b);
  throw ModelError("there is no body \"" + name + "\"");
}

/// Throws ModelError where a body that shape parameters have moved is inside out.
void check_moved(const Model& model, const Points<double>& points, const DesignVelocity& velocity) {
  if (model.scene.numbers[velocity.slot] == 0) return;
  const BodyMesh& body = model.bodies[velocity.body];
  if (const auto bad = first_inverted_element(body.mesh, points.middleCols(body.first_node, body.mesh.node_count)))
    throw ModelError(model.scene.bodies[velocity.body].name + " has moved so far that its element " +
                         std::to_string(*bad + 1) + " is inverted or flat; must move less",
                     model.scene.pointers[velocity.slot]);
}

/// Throws ModelError where a load or a contact acts on nothing but the axis of revolution, which has no area.
void check_areas(const Model& model, const Points<double>& points) {
  const auto has_area = [&](const SideSet& side) {
    const auto& edges = side.edges;
    const auto off_axis = [&](int node) { return !model.is_on_axis(points, node); };
    return edges.empty() || std::any_of(edges.begin(), edges.end(), [&](const auto& edge) {
             return std::any_of(edge.begin(), edge.end(), off_axis);
           });
  };
  const std::string why = " lies on the axis of revolution, where it has no area";
  const auto& scene = model.scene;
  for (std::size_t l = 0; l < scene.loads.size(); ++l)
    if (scene.loads[l].kind != Load::Kind::body_force && !has_area(model.load_sides[l]))
      throw ModelError(scene.loads[l].on + why, "/loads/" + std::to_string(l) + "/on");
  for (std::size_t c = 0; c < scene.contacts.size(); ++c)
    if (const auto& contact = scene.contacts[c]; !has_area(model.contact_sides[c].slave))
      throw ModelError(contact.slave + why, "/contacts/" + contact.name + "/slave");
}

/// Resolves the sides that supports, loads and contacts name.
void resolve_sides(Model& model) {
  const auto& scene = model.scene;
  for (const auto& support : scene.supports) model.support_sides.push_back(model.side(support.on));
  for (const auto& load : scene.loads)
    if (load.kind == Load::Kind::body_force)
      model.load_sides.push_back({.body = body_index(scene, load.on)});
    else
      model.load_sides.push_back(model.side(load.on));
  for (const auto& contact : scene.contacts) {
    ContactSides sides{.slave = model.side(contact.slave)};
    for (std::size_t o = 0; o < scene.obstacles.size(); ++o)
      if (scene.obstacles[o].name == contact.master) sides.obstacle = static_cast<int>(o);
    if (sides.obstacle < 0) sides.master = model.side(contact.master);
    model.contact_sides.push_back(std::move(sides));
  }
}

/// Ends of the increments: equal steps of each leg, and the breakpoints of every table in it.
std::vector<double> step_ends(const Scene& scene) {
  std::set<double> ends;
  double start = 0;
  for (const auto& leg : scene.legs) {
    for (int i = 1; i <= leg.steps; ++i) ends.insert(start + (leg.end - start) * (static_cast<double>(i) / leg.steps));
    start = leg.end;
  }
  const double band = 1e-9 * start;
  auto hit_time = [&](double t) {
    const auto next = ends.lower_bound(t - band);
    const bool there = next != ends.end() && *next <= t + band;
    if (t > band && t < start && !there) ends.insert(t);
  };
  for (const auto& support : scene.supports) for_each_breakpoint(support, hit_time);
  for (const auto& obstacle : scene.obstacles) for_each_breakpoint(obstacle, hit_time);
  for (const auto& load : scene.loads)
    if (load.history) for_each_breakpoint(*load.history, hit_time);
  for (const auto& objective : scene.objectives)
    if (objective.at) hit_time(*objective.at);
  return {ends.begin(), ends.end()};
}

/// Gives the nodes of the contact points their places in Model::contact_nodes.
void place_contact_nodes(Model& model) {
  std::set<int> nodes;
  for (const auto& point : model.points) nodes.insert(point.nodes.begin(), point.nodes.end());
  const bool slides = model.scene.finite_strain;
  const auto turns = [&](const ContactPoint& point) {  // the normal of its side tells what it faces
    return slides && point.surface >= 0 && is_continuum(model.bodies[point.slave_body].mesh.shape);
  };
  for (const auto& curve : model.surfaces)
    if (slides) nodes.insert(curve.nodes.begin(), curve.nodes.end());
  for (const auto& point : model.points)
    if (turns(point))
      for (const auto& facet : point.area_facets) nodes.insert(facet.begin(), facet.end());
  model.contact_nodes.assign(nodes.begin(), nodes.end());
  for (auto& point : model.points)
    for (int node : point.nodes) point.places.push_back(model.place_of(node));
  for (auto& point : model.points)
    if (turns(point))
      for (const auto& facet : point.area_facets) {
        auto& places = point.facet_places.emplace_back();
        for (int node : facet) places.push_back(model.place_of(node));
      }
  for (auto& curve : model.surfaces)
    for (int node : curve.nodes)
      if (slides) curve.places.push_back(model.place_of(node));
  for (auto& framed : model.framed)
    if (nodes.count(framed.node)) framed.place = model.place_of(framed.node);
}

/// Whether the elements of a body have a mean dilatation: if that is asked for; and, if nothing is asked for, those
/// that would lock: quadrilaterals of four nodes and hexahedra of a body that flows, and hexahedra of one that hardly
/// changes its volume.
bool averages(const Scene& scene, const Body& body, ElementShape shape) {
  if (has_mean_dilatation(body.element)) return true;
  if (!body.element.empty()) return false;
  if (shape == ElementShape::hex8) return flows(body.material) || is_nearly_incompressible(body.material);
  return shape == ElementShape::quad4 && scene.space != Space::plane_stress && flows(body.material);
}

/// Gives the elements of a body their places in what bodies remember.
void place_memory(Model& model, const Material& material, BodyMesh& body) {
  body.memory = is_continuum(body.mesh.shape) ? 0 : memory_of_bar(material);
  with_shape(body.mesh.shape, [&]<class Shape>(Shape) {
    body.memory = points_of<Shape>(body.kinematics) * memory_of(material, layout_of(body.kinematics));
  });
  body.first_memory = model.memory_count;
  model.memory_count += body.memory * body.mesh.element_count();
}

/// The elements behind edges of a body, in the order of the edges.
std::vector<ElementEdge> elements_behind(const BodyMesh& body, const std::vector<std::vector<int>>& edges) {
  const int n = nodes_of(body.mesh.shape), corners = corners_of(body.mesh.shape);
  std::map<std::pair<int, int>, ElementEdge> by_ends;
  for (int e = 0; e < body.mesh.element_count(); ++e)
    for (int c = 0; c < corners; ++c) {
      const auto node = [&](int corner) { return body.first_node + body.mesh.connectivity[e * n + corner % corners]; };
      by_ends[{node(c), node(c + 1)}] = {e, c};
    }
  std::vector<ElementEdge> behind;
  for (const auto& edge : edges) behind.push_back(by_ends.at({edge[0], edge[1]}));
  return behind;
}

Follower follower(const Model& model, int load) {
  Follower follower{load};
  if (model.scene.space != Space::plane_stress) return follower;
  const SideSet& side = model.load_sides[load];
  const auto& body = model.scene.bodies[side.body];
  if (const auto fault = pressure_fault(model.scene, body); !fault.empty())
    throw ModelError(fault, "/loads/" + std::to_string(load) + "/on");
  follower.backing = elements_behind(model.bodies[side.body], side.edges);
  return follower;
}

/// Gives the feet of points with friction their places behind the slips, in the slip history.
void place_feet(Model& model) {
  for (auto& point : model.points) {
    if (point.tangents == 0) continue;
    point.foot = model.foot_count;
    point.turns_frame = model.dimension == 3 && point.obstacle >= 0 && point.surface < 0 &&
                        !is_flat(model.scene.obstacles[point.obstacle].shape);
    model.foot_count += point.feet(model.dimension);
  }
}

/// Whether nothing of a model depends on where it is, though strains are finite: points on springs against planes that
/// do not turn.
bool moves_linearly(const Model& model) {
  const auto is_spring = [](const Body& body) { return std::holds_alternative<GroundedSpring>(body.material); };
  const auto keeps_geometry = [&](const ContactPoint& point) {
    if (point.obstacle < 0) return false;
    const auto& obstacle = model.scene.obstacles[point.obstacle];
    return is_flat(obstacle.shape) && !obstacle.rotate;
  };
  return std::all_of(model.scene.bodies.begin(), model.scene.bodies.end(), is_spring) &&
         std::all_of(model.points.begin(), model.points.end(), keeps_geometry);
}

/// The effects that the scene as a whole decides; those of single contacts are there already.
void set_effects(Model& model) {
  const Scene& scene = model.scene;
  const bool is_linear = moves_linearly(model);
  const auto is_on_plane = [&](const ContactPoint& point) {
    return point.obstacle >= 0 && is_flat(scene.obstacles[point.obstacle].shape);
  };
  Effects& effects = model.effects;
  effects.sensitivity = !scene.parameters.empty();
  effects.plasticity = model.memory_count > 0;
  effects.linear_bulk = is_linear || has_constant_stiffness(scene);
  effects.current_geometry = scene.finite_strain && !is_linear && !model.points.empty();
  effects.normals_turn =
      effects.current_geometry && !std::all_of(model.points.begin(), model.points.end(), is_on_plane);
}

}  // namespace

SideSet Model::side(const std::string& text) const {
  const SideExpression expression = parse_side_expression(text);
  if (!expression.error.empty()) throw ModelError(expression.error);
  SideSet set;
  set.body = body_index(scene, expression.body);
  const auto& body = bodies[set.body];
  if (const auto error = side_error(body.mesh, expression); !error.empty()) throw ModelError(error);
  const Side side = evaluate_side(body.mesh, expression);
  set.nodes = side.nodes;
  set.facets = side.facets;
  set.edges = side.edges();
  for (int& node : set.nodes) node += body.first_node;
  for (auto* list : {&set.facets, &set.edges})
    for (auto& facet : *list)
      for (int& node : facet) node += body.first_node;
  return set;
}

bool Model::is_on_axis(const Points<double>& points, int node) const {
  return scene.space == Space::axisymmetric && std::abs(points(0, node)) <= 1e-12 * points.cwiseAbs().maxCoeff();
}

std::string space_fault(Space space, const Body& body) {
  if (space == Space::axisymmetric && filling_of(body.mesh) != Filling::continuum)
    return "an axisymmetric space has no points and no bars";
  if (space == Space::plane_stress && has_mean_dilatation(body.element))
    return "Q4_mean_dilatation is for plane_strain and axisymmetric: in plane stress the thickness gives way";
  return "";
}

std::string pressure_fault(const Scene& scene, const Body& body) {
  if (scene.space != Space::plane_stress || !scene.finite_strain || !flows(body.material)) return "";
  return "flows, and in plane stress at finite strain a pressure on what flows is not known; use traction";
}

std::string radius_fault(Space space, const Points<double>& points, const BodyMesh& body) {
  if (space != Space::axisymmetric) return "";
  const auto radii = points.row(0).segment(body.first_node, body.mesh.node_count);
  if (radii.minCoeff() >= -1e-12 * points.cwiseAbs().maxCoeff()) return "";
  return "reaches to x = " + std::to_string(radii.minCoeff()) +
         "; in an axisymmetric space x is the radius, and must not be negative";
}

int Model::contact_index(const std::string& name) const {
  for (std::size_t c = 0; c < scene.contacts.size(); ++c)
    if (scene.contacts[c].name == name) return static_cast<int>(c);
  throw ModelError("there is no contact \"" + name + "\"");
}

Model make_model(const Scene& scene) {
  Seconds spent;
  return make_model(scene, spent);
}

Model make_model(const Scene& scene, Seconds& spent) {
  Model model;
  model.scene = scene;
  model.dimension = scene.dimension();
  for (const auto& body : scene.bodies) {
    std::string fault = mesh_fault(body.mesh, body.element, model.dimension);
    if (fault.empty()) fault = space_fault(scene.space, body);
    if (!fault.empty()) throw ModelError(fault, "/bodies/" + body.name + "/mesh");
    auto mesh = make_mesh(body.mesh, body.element, model.dimension);
    const Kinematics kinematics = kinematics_of(scene.space, averages(scene, body, mesh.shape));
    model.bodies.push_back({std::move(mesh), model.node_count, kinematics});
    model.node_count += model.bodies.back().mesh.node_count;
    place_memory(model, body.material, model.bodies.back());
    if (!is_continuum(model.bodies.back().mesh.shape)) continue;
    const std::string unfit = fault_of(body.material, model.bodies.back().kinematics, strains_of(scene.finite_strain));
    if (!unfit.empty()) throw ModelError("the material " + unfit, "/bodies/" + body.name + "/material");
  }
  Points<double> points(model.dimension, model.node_count);
  const auto numbers = scene.as<double>();
  for (std::size_t b = 0; b < model.bodies.size(); ++b)
    points.middleCols(model.bodies[b].first_node, model.bodies[b].mesh.node_count) =
        make_points<double>(scene.bodies[b].mesh, model.bodies[b].mesh, numbers);
  for (int b = 0; !scene.shapes.empty() && b < static_cast<int>(model.bodies.size()); ++b) {
    const auto& body = model.bodies[b];
    try {
      auto of_body = design_velocities(scene, b, body.mesh, points.middleCols(body.first_node, body.mesh.node_count));
      std::move(of_body.begin(), of_body.end(), std::back_inserter(model.velocities));
    } catch (const std::runtime_error& error) {
      throw ModelError(scene.bodies[b].name + ": " + error.what(), "/parameters");
    }
  }
  points = initial_points(model, numbers);
  for (const auto& velocity : model.velocities) check_moved(model, points, velocity);
  for (std::size_t b = 0; b < model.bodies.size(); ++b)
    if (const auto fault = radius_fault(scene.space, points, model.bodies[b]); !fault.empty())
      throw ModelError(fault, "/bodies/" + scene.bodies[b].name + "/mesh");
  resolve_sides(model);
  number_dofs(model, points);
  if (scene.space == Space::axisymmetric) check_areas(model, points);
  {
    const Stopwatch time(spent.contact_search);
    pair_contacts(model, points);
  }
  place_contact_nodes(model);
  for (const auto& response : scene.responses) model.response_places.push_back(place_of(model, points, response));
  model.at_reactions = elements_at_reactions(model);
  for (int l = 0; scene.finite_strain && l < static_cast<int>(scene.loads.size()); ++l)
    if (scene.loads[l].kind == Load::Kind::pressure) model.followers.push_back(follower(model, l));
  model.times = step_ends(scene);
  set_effects(model);
  if (model.effects.current_geometry) place_feet(model);
  return model;
}

Model::Model() = default;
Model::Model(const Model&) = default;
Model::Model(Model&&) noexcept = default;
Model& Model::operator=(const Model&) = default;
Model& Model::operator=(Model&&) noexcept = default;
Model::~Model() = default;

}  // namespace stickslip
