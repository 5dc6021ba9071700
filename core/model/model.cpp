#include "core/model/model.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "core/contact/search.hpp"
#include "core/mesh/generators.hpp"
#include "core/mesh/sides.hpp"
#include "core/model/supports.hpp"
#include "core/solids/shapes.hpp"

namespace stickslip {
namespace {

int body_index(const Scene& scene, const std::string& name) {
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    if (scene.bodies[b].name == name) return static_cast<int>(b);
  throw ModelError("there is no body \"" + name + "\"");
}

/// Finds the facet or vertex of a polyline that a slave node faces; false where it lies past a free end.
bool find_on_polyline(const Points<double>& points, const Polyline& polyline, const Numbers<double>& numbers,
                      ContactPoint& point) {
  const int count = static_cast<int>(polyline.points.size());
  Points<double> vertices(2, count);
  for (int v = 0; v < count; ++v)
    for (int i = 0; i < 2; ++i) vertices(i, v) = numbers(polyline.points[v][i]);
  std::vector<std::vector<int>> facets;  // reversed: those of the search have the solid on their left
  for (int v = 0; v + 1 < count + polyline.closed; ++v) facets.push_back({(v + 1) % count, v});
  const auto closest = closest_point(vertices, facets, points.col(point.nodes[0]).head<2>());
  if (!closest) return false;
  const auto& facet = facets[closest->facet];
  point.master = closest->second < 0 ? ContactPoint::Master::facet : ContactPoint::Master::vertex;
  point.of_polyline = facet;
  if (closest->second >= 0) point.of_polyline.push_back(facets[closest->second][1]);
  return true;
}

/// Finds the master of a slave node; false where it faces none.
bool find_master(const Points<double>& points, const SideSet& master, ContactPoint& point) {
  const Vec<double, 2> x = points.col(point.nodes[0]).head<2>();
  const auto closest = closest_point(points, master.facets, x);
  if (!closest) return false;
  const auto& facet = master.facets[closest->facet];
  const Vec<double, 2> tau = points.col(facet[1]).head<2>() - points.col(facet[0]).head<2>();
  if (point.shares_normal && slave_normal(point.area_facets, points).dot(Vec<double, 2>(tau[1], -tau[0])) >= 0)
    return false;  // looks the same way
  if (closest->second < 0) {
    point.master = ContactPoint::Master::facet;
    point.nodes.insert(point.nodes.end(), {facet[0], facet[1]});
    return true;
  }
  point.master = ContactPoint::Master::vertex;
  const int before = facet[0], vertex = facet[1], after = master.facets[closest->second][1];
  point.nodes.push_back(vertex);
  point.neighbours = {before, after};
  const Vec<double, 2> v = points.col(vertex).head<2>();
  for (int to : point.neighbours) {
    const Vec<double, 2> along = points.col(to).head<2>() - v;
    if (std::abs((x - v).dot(along)) <= at_facet_end * along.squaredNorm()) point.nodes.push_back(to);
  }
  return true;
}

/// Finds what a slave node faces of its obstacle; false where it faces nothing. Throws ModelError where every place of
/// it is as near as any other.
bool find_on_obstacle(const Points<double>& points, const Scene& scene, ContactPoint& point) {
  const Obstacle& obstacle = scene.obstacles[point.obstacle];
  const auto numbers = scene.as<double>();
  if (const auto* polyline = std::get_if<Polyline>(&obstacle.shape))
    return find_on_polyline(points, *polyline, numbers, point);
  const auto* circle = std::get_if<Circle>(&obstacle.shape);
  const auto x = points.col(point.nodes[0]);
  if (circle && x[0] == numbers(circle->center[0]) && x[1] == numbers(circle->center[1]))
    throw ModelError("is where a slave node is, from which no place of the circle is nearer than another",
                     "/obstacles/" + obstacle.name + "/circle/center");
  return true;
}

int obstacle_index(const Scene& scene, const std::string& name) {
  for (std::size_t o = 0; o < scene.obstacles.size(); ++o)
    if (scene.obstacles[o].name == name) return static_cast<int>(o);
  return -1;
}

/// Local size of the slave side: mean length of the facets at the node.
double local_size(const Points<double>& points, const std::vector<std::pair<int, int>>& facets) {
  double size = 0;
  for (const auto& [a, b] : facets) size += (points.col(a) - points.col(b)).norm() / facets.size();
  return size;
}

/// What all points of a contact have in common.
struct Pairing {
  int index, obstacle;  ///< in Scene::contacts, Scene::obstacles (-1: deformable master)
  SideSet slave, master;
};

void add_point(Model& model, ContactPoint point) {
  model.effects.contact = true;
  model.effects.friction |= point.tangents > 0;
  model.effects.deformable_master |= point.obstacle < 0;
  point.multiplier = model.multiplier_count;
  model.multiplier_count += point.components();
  model.points.push_back(std::move(point));
}

/// A point at a slave node, still without a master.
ContactPoint slave_point(const Model& model, const Points<double>& points, const Pairing& pairing, int node) {
  const auto shape = model.bodies[pairing.slave.body].mesh.shape;
  ContactPoint point;
  point.contact = pairing.index;
  point.obstacle = pairing.obstacle;
  point.nodes = {node};
  point.slave_body = pairing.slave.body;
  for (const auto& facet : pairing.slave.facets)
    if (facet[0] == node || facet[1] == node) point.area_facets.emplace_back(facet[0], facet[1]);
  for (const auto& edge : pairing.slave.edges)
    if (std::find(edge.begin(), edge.end(), node) != edge.end()) point.area_edges.push_back(edge);
  point.area_of_bar = shape == ElementShape::bar2 && pairing.slave.nodes.size() == 1 && point.area_facets.empty();
  point.mesh_size = local_size(points, point.area_facets);
  point.tie_length = 8 * unit_roundoff * (point.mesh_size + points.col(node).cwiseAbs().maxCoeff());
  // what is on the axis of revolution cannot slide
  const bool slides = model.scene.contacts[pairing.index].friction && !model.is_on_axis(points, node);
  point.tangents = slides ? model.dimension - 1 : 0;
  return point;
}

/// Node-to-segment: each slave node against the closest point of its master.
void pair_nodes(Model& model, const Points<double>& points, const Pairing& pairing) {
  const auto shape = model.bodies[pairing.slave.body].mesh.shape;
  for (int node : pairing.slave.nodes) {
    if (is_quadratic(shape) && model.is_on_axis(points, node)) continue;  // it has no tributary area
    ContactPoint point = slave_point(model, points, pairing, node);
    point.shares_normal = pairing.obstacle < 0 && is_continuum(shape) && !point.area_facets.empty();
    const bool faces = pairing.obstacle >= 0 ? find_on_obstacle(points, model.scene, point)
                                             : find_master(points, pairing.master, point);
    if (faces) add_point(model, std::move(point));
  }
}

/// Segment-integrated: the multiplier of each slave node on the pieces of its facets.
void pair_segments(Model& model, const Points<double>& points, const Pairing& pairing) {
  const auto& nodes = pairing.slave.nodes;
  auto carries = [&](int node) { return std::find(nodes.begin(), nodes.end(), node) != nodes.end(); };
  std::map<int, std::vector<Piece>> of_node;
  for (const auto& facet : pairing.slave.facets) {
    Piece whole_facet;
    whole_facet.slave = {facet[0], facet[1]};
    const auto pieces =
        pairing.obstacle >= 0 ? std::vector<Piece>{whole_facet} : facing_pieces(points, facet, pairing.master.facets);
    for (Piece piece : pieces)
      for (int end = 0; end < 2; ++end)
        if (carries(facet[end])) {
          piece.carrier = end;
          piece.whole = !carries(facet[1 - end]);
          of_node[facet[end]].push_back(piece);
        }
  }
  for (int node : nodes) {
    if (of_node[node].empty()) continue;
    ContactPoint point = slave_point(model, points, pairing, node);
    point.master = ContactPoint::Master::pieces;
    point.pieces = of_node[node];
    auto add = [&](int n) {
      if (n >= 0 && std::find(point.nodes.begin(), point.nodes.end(), n) == point.nodes.end()) point.nodes.push_back(n);
    };
    for (const auto& piece : point.pieces) std::for_each(piece.slave.begin(), piece.slave.end(), add);
    point.slave_nodes = static_cast<int>(point.nodes.size());
    for (const auto& piece : point.pieces) std::for_each(piece.master.begin(), piece.master.end(), add);
    add_point(model, std::move(point));
  }
}

void pair_contact(Model& model, const Points<double>& points, int index) {
  const Contact& contact = model.scene.contacts[index];
  const std::string where = "/contacts/" + contact.name;
  Pairing pairing{index, obstacle_index(model.scene, contact.master), model.side(contact.slave), {}};
  if (pairing.obstacle < 0) {
    pairing.master = model.side(contact.master);
    if (model.dimension == 3) throw ModelError("a deformable master needs a 2D space", where);
    if (pairing.master.facets.empty()) throw ModelError("the master side has no facets", where);
  } else if (model.dimension == 3 && !std::holds_alternative<Plane>(model.scene.obstacles[pairing.obstacle].shape)) {
    throw ModelError("in space an obstacle must be a plane", "/obstacles/" + contact.master);
  }
  if (!contact.segment) return pair_nodes(model, points, pairing);
  const auto shape = model.bodies[pairing.slave.body].mesh.shape;
  const bool quadratic_master = pairing.obstacle < 0 && is_quadratic(model.bodies[pairing.master.body].mesh.shape);
  if (is_quadratic(shape) || quadratic_master)
    throw ModelError("segment integration needs linear elements on both sides", where);
  if (model.dimension == 3 || pairing.slave.facets.empty() || !is_continuum(shape))
    throw ModelError("segment integration needs a slave side of facets of a solid body", where);
  if (pairing.obstacle >= 0 && std::holds_alternative<Polyline>(model.scene.obstacles[pairing.obstacle].shape))
    throw ModelError("segment integration against a polyline is not available in this version", where);
  pair_segments(model, points, pairing);
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
  auto hit = [&](const Table& table) {
    for (int n = 0; n < table.repeat; ++n)
      for (std::size_t i = 0; i < table.points.size(); ++i) hit_time(table.time(n, i));
  };
  auto hit_motion = [&](const auto& of) {
    for (const auto& [axis, table] : of.move) hit(table);
    if (of.rotate) hit(of.rotate->angle);
  };
  for (const auto& support : scene.supports) {
    hit_motion(support);
    if (support.inclined) hit(support.inclined->value);
  }
  for (const auto& obstacle : scene.obstacles) hit_motion(obstacle);
  for (const auto& load : scene.loads)
    if (load.history) hit(*load.history);
  for (const auto& objective : scene.objectives)
    if (objective.at) hit_time(*objective.at);
  return {ends.begin(), ends.end()};
}

/// Shape function values at x of a plane element, if it holds x (to rounding).
template <class Shape>
std::optional<std::vector<double>> weights_in(Shape, const Points<double>& points, const std::vector<int>& nodes,
                                              const Eigen::Vector2d& x) {
  constexpr double band = 1e-9;
  constexpr bool triangle = Shape::corners == 3;
  Eigen::Vector2d xi = triangle ? Eigen::Vector2d(1.0 / 3, 1.0 / 3) : Eigen::Vector2d(0, 0);
  for (int iteration = 0; iteration < 20; ++iteration) {  // Newton for the natural coordinates
    const auto at = Shape::at(xi[0], xi[1], 1);
    Eigen::Vector2d defect = -x;
    Eigen::Matrix2d J = Eigen::Matrix2d::Zero();
    for (std::size_t a = 0; a < nodes.size(); ++a) {
      defect += at.value[a] * points.col(nodes[a]);
      J += points.col(nodes[a]) * at.gradient.col(a).transpose();
    }
    const Eigen::Vector2d step = J.partialPivLu().solve(defect);
    xi -= step;
    if (!(xi.norm() < 1e3)) return std::nullopt;
    if (step.norm() < 1e-14) break;
  }
  const bool inside = triangle ? xi.minCoeff() > -band && xi.sum() < 1 + band : xi.cwiseAbs().maxCoeff() < 1 + band;
  if (!inside) return std::nullopt;
  const auto N = Shape::at(xi[0], xi[1], 1).value;
  return std::vector<double>(N.data(), N.data() + N.size());
}

/// Shape function values at x of an element, if it holds x (to rounding).
std::optional<std::vector<double>> weights_at(ElementShape shape, const Points<double>& points,
                                              const std::vector<int>& nodes, const Eigen::VectorXd& x) {
  constexpr double band = 1e-9;
  if (shape == ElementShape::point) {
    if ((points.col(nodes[0]) - x).norm() > 0) return std::nullopt;
    return std::vector<double>{1, 0};
  }
  if (shape == ElementShape::bar2) {
    const Eigen::VectorXd a = points.col(nodes[0]), tau = points.col(nodes[1]) - a;
    const double s = (x - a).dot(tau) / tau.squaredNorm();
    if (s < -band || s > 1 + band || (x - a - s * tau).norm() > band * tau.norm()) return std::nullopt;
    return std::vector<double>{1 - s, s};
  }
  std::optional<std::vector<double>> weights;
  with_shape(shape, [&](auto kind) { weights = weights_in(kind, points, nodes, x); });
  return weights;
}

/// Finds where a response with `at` is taken. Throws ModelError where no element holds the point.
ResponsePlace locate_response(const Model& model, const Points<double>& points, const Response& response) {
  ResponsePlace place;
  if (response.at.empty()) return place;
  Eigen::VectorXd x(model.dimension);
  for (int i = 0; i < model.dimension; ++i) x[i] = response.at[i].value;
  if (response.kind == Response::Kind::displacement) {
    for (const auto& body : model.bodies) {
      const int n = nodes_of(body.mesh.shape);
      for (int e = 0; e < body.mesh.element_count(); ++e) {
        std::vector<int> nodes(n);
        Eigen::VectorXd low = Eigen::VectorXd::Constant(model.dimension, INFINITY), high = -low;
        for (int a = 0; a < n; ++a) {
          nodes[a] = body.first_node + body.mesh.connectivity[e * n + a];
          low = low.cwiseMin(points.col(nodes[a]));
          high = high.cwiseMax(points.col(nodes[a]));
        }
        const double slack = 1e-6 * (high - low).norm();
        if ((x.array() < low.array() - slack).any() || (x.array() > high.array() + slack).any()) continue;
        if (const auto weights = weights_at(body.mesh.shape, points, nodes, x)) {
          for (int a = 0; a < n; ++a) place.nodes.emplace_back(nodes[a], (*weights)[a]);
          return place;
        }
      }
    }
    throw ModelError("no element holds the point of `at`", "/responses/" + response.name);
  }
  const int contact = model.contact_index(response.on);
  double nearest = INFINITY;
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    const double distance = (points.col(model.points[p].nodes[0]) - x).norm();
    if (model.points[p].contact == contact && distance < nearest) {
      nearest = distance;
      place.contact_point = static_cast<int>(p);
    }
  }
  if (place.contact_point < 0)
    throw ModelError("no slave node of the contact faces its master", "/responses/" + response.name);
  return place;
}

}  // namespace

SideSet resolve_side(const Scene& scene, const std::vector<BodyMesh>& bodies, const std::string& text) {
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

SideSet Model::side(const std::string& expression) const { return resolve_side(scene, bodies, expression); }

bool Model::is_on_axis(const Points<double>& points, int node) const {
  return scene.space == Space::axisymmetric && std::abs(points(0, node)) <= 1e-12 * points.cwiseAbs().maxCoeff();
}

std::string space_fault(Space space, const Body& body) {
  const bool lumped = std::holds_alternative<PointMesh>(body.mesh) || std::holds_alternative<LineMesh>(body.mesh) ||
                      std::holds_alternative<ArcMesh>(body.mesh);
  if (space == Space::axisymmetric && lumped) return "an axisymmetric space has no points and no bars";
  if (space == Space::plane_stress && has_mean_dilatation(body.element))
    return "Q4_mean_dilatation is for plane_strain and axisymmetric: in plane stress the thickness gives way";
  return "";
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
  Model model;
  model.scene = scene;
  model.dimension = scene.dimension();
  for (const auto& body : scene.bodies) {
    std::string fault = mesh_fault(body.mesh, body.element, model.dimension);
    if (fault.empty()) fault = space_fault(scene.space, body);
    if (!fault.empty()) throw ModelError(fault, "/bodies/" + body.name + "/mesh");
    model.bodies.push_back({make_mesh(body.mesh, body.element, model.dimension), model.node_count,
                            kinematics_of(scene.space, has_mean_dilatation(body.element))});
    model.node_count += model.bodies.back().mesh.node_count;
  }
  Points<double> points(model.dimension, model.node_count);
  const auto numbers = scene.as<double>();
  for (std::size_t b = 0; b < model.bodies.size(); ++b)
    points.middleCols(model.bodies[b].first_node, model.bodies[b].mesh.node_count) =
        make_points<double>(scene.bodies[b].mesh, model.bodies[b].mesh, numbers);
  for (std::size_t b = 0; b < model.bodies.size(); ++b)
    if (const auto fault = radius_fault(scene.space, points, model.bodies[b]); !fault.empty())
      throw ModelError(fault, "/bodies/" + scene.bodies[b].name + "/mesh");
  for (int b = 0; !scene.shapes.empty() && b < static_cast<int>(model.bodies.size()); ++b) {
    const auto& body = model.bodies[b];
    try {
      auto of_body = design_velocities(scene, b, body.mesh, points.middleCols(body.first_node, body.mesh.node_count));
      std::move(of_body.begin(), of_body.end(), std::back_inserter(model.velocities));
    } catch (const std::runtime_error& error) {
      throw ModelError(scene.bodies[b].name + ": " + error.what(), "/parameters");
    }
  }
  number_dofs(model, points);
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) pair_contact(model, points, static_cast<int>(c));
  std::set<int> nodes;
  for (const auto& point : model.points) nodes.insert(point.nodes.begin(), point.nodes.end());
  model.contact_nodes.assign(nodes.begin(), nodes.end());
  auto place_of = [&](int node) {
    const auto found = std::lower_bound(model.contact_nodes.begin(), model.contact_nodes.end(), node);
    return static_cast<int>(found - model.contact_nodes.begin());
  };
  for (auto& point : model.points)
    for (int node : point.nodes) point.places.push_back(place_of(node));
  for (auto& framed : model.framed)
    if (nodes.count(framed.node)) framed.place = place_of(framed.node);
  for (const auto& response : scene.responses)
    model.response_places.push_back(locate_response(model, points, response));
  model.times = step_ends(scene);
  model.effects.sensitivity = !scene.parameters.empty();
  return model;
}

}  // namespace stickslip
