#include "core/model/pairing.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "core/contact/curve_search.hpp"
#include "core/contact/facet_search.hpp"
#include "core/contact/segments.hpp"
#include "core/mesh/sides.hpp"
#include "core/model/segment_search.hpp"

namespace stickslip {
namespace {

/// Vertices of a polyline, 2 x vertices, length.
Eigen::Matrix2Xd vertices_of(const Polyline& polyline, const Numbers<double>& numbers) {
  Eigen::Matrix2Xd vertices(2, static_cast<Eigen::Index>(polyline.points.size()));
  for (Eigen::Index v = 0; v < vertices.cols(); ++v)
    for (int i = 0; i < 2; ++i) vertices(i, v) = numbers(polyline.points[v][i]);
  return vertices;
}

/// Facets of a polyline as vertex pairs, the solid on their left. A polyline has it on its right, so they are reversed.
std::vector<std::vector<int>> facets_of(const Polyline& polyline) {
  const int count = static_cast<int>(polyline.points.size());
  std::vector<std::vector<int>> facets;
  for (int v = 0; v + 1 < count + polyline.closed; ++v) facets.push_back({(v + 1) % count, v});
  return facets;
}

/// What a contact is searched in: the facets of a master side or of a polyline; empty against another obstacle.
struct Facets {
  Points<double> points;  ///< of the model's nodes and, behind these, the vertices of the polyline
  std::vector<std::vector<int>> facets;
  FacetSearch search;
  Facets(Points<double> at, std::vector<std::vector<int>> of)
      : points(std::move(at)), facets(std::move(of)), search(points, facets) {}
  Facets(const Facets&) = delete;
};

/// Sets the facet or vertex of a polyline that a slave node faces. False if the node lies past a free end.
bool find_on_polyline(const Points<double>& points, const Facets& polyline, int node_count, ContactPoint& point) {
  const auto closest = polyline.search.closest(points.col(point.nodes[0]).head<2>());
  if (!closest) return false;
  const auto& facet = polyline.facets[closest->facet];
  point.master = closest->second < 0 ? ContactPoint::Master::facet : ContactPoint::Master::vertex;
  point.of_polyline = facet;
  if (closest->second >= 0) point.of_polyline.push_back(polyline.facets[closest->second][1]);
  for (int& vertex : point.of_polyline) vertex -= node_count;
  return true;
}

/// Leaves a slave node at a corner of its side the facets that face a master facet of normal `across`, any length:
/// those within 60 degrees. If none is, it keeps all.
void keep_facets_that_face(const Points<double>& points, const Vec<double, 2>& across, ContactPoint& point) {
  constexpr double within = 0.5;
  auto facets = point.area_facets;
  std::erase_if(facets, [&](const auto& facet) {
    const Vec<double, 2> outward = slave_normal({facet}, points);
    return outward.dot(across) > -within * outward.norm() * across.norm();
  });
  if (!facets.empty()) point.area_facets = std::move(facets);
}

/// Sets the facet or vertex of a deformable master that a slave node faces. False if it faces none.
bool find_master(const Points<double>& points, const Facets& master, ContactPoint& point) {
  const Vec<double, 2> x = points.col(point.nodes[0]).head<2>();
  const auto closest = master.search.closest(x);
  if (!closest) return false;
  const auto opposes = [&](int f) {
    const Vec<double, 2> tau = points.col(master.facets[f][1]).head<2>() - points.col(master.facets[f][0]).head<2>();
    return !point.shares_normal || slave_normal(point.area_facets, points).dot(Vec<double, 2>(tau[1], -tau[0])) < 0;
  };
  const bool first = opposes(closest->facet), second = closest->second >= 0 && opposes(closest->second);
  if (!first && !second) return false;
  if (closest->second < 0 || first != second) {  // at a corner only one of its facets may oppose the slave side
    const auto& facet = master.facets[first ? closest->facet : closest->second];
    const Vec<double, 2> tau = points.col(facet[1]).head<2>() - points.col(facet[0]).head<2>();
    if (point.shares_normal) keep_facets_that_face(points, {tau[1], -tau[0]}, point);
    point.master = ContactPoint::Master::facet;
    point.nodes.insert(point.nodes.end(), {facet[0], facet[1]});
    return true;
  }
  point.master = ContactPoint::Master::vertex;
  const int before = master.facets[closest->facet][0], vertex = master.facets[closest->facet][1],
            after = master.facets[closest->second][1];
  point.nodes.push_back(vertex);
  point.neighbours = {before, after};
  const Vec<double, 2> v = points.col(vertex).head<2>();
  for (int to : point.neighbours) {
    const Vec<double, 2> along = points.col(to).head<2>() - v;
    if (std::abs((x - v).dot(along)) <= at_facet_end * along.squaredNorm()) point.nodes.push_back(to);
  }
  return true;
}

/// Sets what a slave node faces of its obstacle. False if it faces nothing. Throws ModelError if all places of the
/// obstacle are equally near.
bool find_on_obstacle(const Points<double>& points, const Model& model, const Facets& facets, ContactPoint& point) {
  const Obstacle& obstacle = model.scene.obstacles[point.obstacle];
  const auto numbers = model.scene.as<double>();
  if (std::holds_alternative<Polyline>(obstacle.shape))
    return find_on_polyline(points, facets, model.node_count, point);
  if (const char* key = ambiguity(points.col(point.nodes[0]), obstacle.shape, numbers))
    throw ModelError("is where a slave node is, from which no place of the surface is nearer than another",
                     "/obstacles/" + obstacle.name + "/" + key);
  return true;
}

int obstacle_index(const Scene& scene, const std::string& name) {
  for (std::size_t o = 0; o < scene.obstacles.size(); ++o)
    if (scene.obstacles[o].name == name) return static_cast<int>(o);
  return -1;
}

/// Mean length of the facets at a slave node; 0 without facets.
double local_size(const Points<double>& points, const std::vector<std::pair<int, int>>& facets) {
  double size = 0;
  for (const auto& [a, b] : facets) size += (points.col(a) - points.col(b)).norm() / facets.size();
  return size;
}

/// One contact while its points are made.
struct Pairing {
  int index;     ///< in Scene::contacts
  int obstacle;  ///< in Scene::obstacles; -1: deformable master
  SideSet slave, master;
};

/// Appends a point, numbers its multiplier and sets its effects.
void add_point(Model& model, ContactPoint point) {
  model.effects.contact = true;
  model.effects.friction |= point.tangents > 0;
  model.effects.coupled_friction |= point.tangents > 0 && model.scene.contacts[point.contact].friction->couples();
  model.effects.deformable_master |= point.obstacle < 0;
  point.multiplier = model.multiplier_count;
  model.multiplier_count += point.components();
  model.points.push_back(std::move(point));
}

/// Contact point of a slave node. The caller sets its master.
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
  // a node on the axis of revolution cannot slide
  const bool slides = model.scene.contacts[pairing.index].friction && !model.is_on_axis(points, node);
  point.tangents = slides ? model.dimension - 1 : 0;
  return point;
}

Facets facets_of_master(const Model& model, const Points<double>& points, const Pairing& pairing) {
  if (pairing.obstacle < 0) return {points, pairing.master.facets};
  const auto* polyline = std::get_if<Polyline>(&model.scene.obstacles[pairing.obstacle].shape);
  if (!polyline) return {points, {}};
  const Eigen::Matrix2Xd vertices = vertices_of(*polyline, model.scene.as<double>());
  Points<double> all(2, points.cols() + vertices.cols());
  all << points, vertices;
  auto facets = facets_of(*polyline);
  for (auto& facet : facets)
    for (int& vertex : facet) vertex += model.node_count;
  return {std::move(all), std::move(facets)};
}

/// Whether a node of the surface of a body has no tributary area. On the axis of revolution the share of a corner of a
/// quadratic element is the integral of (1 - s) (1 - 2 s) s, which is zero.
bool has_no_area(const Model& model, const Points<double>& points, const SideSet& side, int node) {
  return is_quadratic(model.bodies[side.body].mesh.shape) && model.is_on_axis(points, node);
}

/// Node-to-segment contact: each slave node against the closest point of its master.
void pair_nodes(Model& model, const Points<double>& points, const Pairing& pairing) {
  const auto shape = model.bodies[pairing.slave.body].mesh.shape;
  const Facets facets = facets_of_master(model, points, pairing);
  for (int node : pairing.slave.nodes) {
    if (has_no_area(model, points, pairing.slave, node)) continue;
    ContactPoint point = slave_point(model, points, pairing, node);
    point.shares_normal = pairing.obstacle < 0 && is_continuum(shape) && !point.area_facets.empty();
    const bool faces =
        pairing.obstacle >= 0 ? find_on_obstacle(points, model, facets, point) : find_master(points, facets, point);
    if (faces) add_point(model, std::move(point));
  }
}

/// The facets of a side in contact with itself, or of a segment-integrated one, in order along the side. The order does
/// not depend on numbering. Longer chains of facets come first. A closed chain starts at the vertex farthest from its
/// mean vertex; among equally far ones at the one with least x, then least y.
std::vector<std::vector<int>> ordered_facets(const std::vector<std::vector<int>>& facets,
                                             const Points<double>& points) {
  std::map<int, int> starting;
  std::set<int> ends;
  for (std::size_t f = 0; f < facets.size(); ++f) {
    starting[facets[f][0]] = static_cast<int>(f);
    ends.insert(facets[f][1]);
  }
  struct Chain {
    double length = 0;
    std::vector<int> facets;
  };
  std::vector<Chain> chains;
  std::vector<char> taken(facets.size(), 0);
  const auto follow = [&](int f) {
    Chain chain;
    for (auto next = starting.find(facets[f][0]); next != starting.end() && !taken[next->second];
         next = starting.find(facets[chain.facets.back()][1])) {
      taken[next->second] = 1;
      chain.facets.push_back(next->second);
      chain.length += (points.col(facets[next->second][1]) - points.col(facets[next->second][0])).norm();
    }
    chains.push_back(std::move(chain));
  };
  for (std::size_t f = 0; f < facets.size(); ++f)
    if (ends.count(facets[f][0]) == 0) follow(static_cast<int>(f));
  for (std::size_t f = 0; f < facets.size(); ++f) {
    if (taken[f]) continue;
    follow(static_cast<int>(f));
    auto& loop = chains.back().facets;
    const auto place = [&](int facet) -> Vec<double, 2> { return points.col(facets[facet][0]).head<2>(); };
    Vec<double, 2> middle = Vec<double, 2>::Zero();
    for (int facet : loop) middle += place(facet) / static_cast<double>(loop.size());
    const double same = 1e-9 * chains.back().length;
    const auto comes_first = [&](int a, int b) {
      const double apart = (place(a) - middle).norm() - (place(b) - middle).norm();
      if (std::abs(apart) > same) return apart > 0;
      if (std::abs(place(a)[0] - place(b)[0]) > same) return place(a)[0] < place(b)[0];
      return place(a)[1] < place(b)[1];
    };
    std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end(), comes_first), loop.end());
  }
  std::stable_sort(chains.begin(), chains.end(),
                   [](const Chain& a, const Chain& b) { return a.length > b.length * (1 + 1e-9); });
  std::vector<std::vector<int>> ordered;
  for (const auto& chain : chains)
    for (int f : chain.facets) ordered.push_back(facets[f]);
  return ordered;
}

/// Master curve of a contact, and the initial positions of its vertices, 2 x vertices.
std::pair<MasterCurve, Eigen::Matrix2Xd> make_curve(const Model& model, const Points<double>& points,
                                                    const Pairing& pairing) {
  const Contact& contact = model.scene.contacts[pairing.index];
  MasterCurve curve;
  curve.contact = pairing.index;
  curve.obstacle = pairing.obstacle;
  std::vector<std::vector<int>> facets = pairing.master.facets;  // of vertices
  Eigen::Matrix2Xd places;
  if (pairing.obstacle >= 0) {
    const auto& polyline = std::get<Polyline>(model.scene.obstacles[pairing.obstacle].shape);
    places = vertices_of(polyline, model.scene.as<double>());
    facets = facets_of(polyline);
    if (contact.segment) std::reverse(facets.begin(), facets.end());  // each begins where the one before ends
  } else {
    if (contact.is_of_itself() || contact.segment) facets = ordered_facets(facets, points);
    std::map<int, int> number;
    for (auto& facet : facets)
      for (int& node : facet) {
        const auto [found, is_new] = number.emplace(node, static_cast<int>(number.size()));
        if (is_new) curve.nodes.push_back(node);
        node = found->second;
      }
    places.resize(2, static_cast<Eigen::Index>(curve.nodes.size()));
    for (std::size_t v = 0; v < curve.nodes.size(); ++v)
      places.col(static_cast<Eigen::Index>(v)) = points.col(curve.nodes[v]).head<2>();
  }
  curve.vertex_count = static_cast<int>(places.cols());
  curve.patches = make_patches(facets, contact.smoothing, contact.corner, places);
  return {std::move(curve), std::move(places)};
}

/// Contact along a curve: each slave node against the place of the curve that it faces. At finite strain a node that
/// faces nothing yet is a point too.
void pair_along_curve(Model& model, const Points<double>& points, const Pairing& pairing) {
  const auto shape = model.bodies[pairing.slave.body].mesh.shape;
  auto [curve, places] = make_curve(model, points, pairing);
  const CurveSearch search(curve.patches, places);
  const bool of_itself = model.scene.contacts[pairing.index].is_of_itself();
  for (int node : pairing.slave.nodes) {
    if (has_no_area(model, points, pairing.slave, node)) continue;
    ContactPoint point = slave_point(model, points, pairing, node);
    const bool has_side = is_continuum(shape) && !point.area_facets.empty();
    const Vec<double, 2> outward = has_side ? slave_normal(point.area_facets, points) : Vec<double, 2>::Zero().eval();
    point.master = ContactPoint::Master::curve;
    point.curve = static_cast<int>(model.curves.size());
    const Vec<double, 2> x = points.col(node).head<2>();
    if (of_itself) {
      const auto found = std::find(curve.nodes.begin(), curve.nodes.end(), node);
      point.own =
          own_vertex(curve.patches, places, static_cast<int>(found - curve.nodes.begin()), outward, point.mesh_size);
      if (!point.own.may_face_some(curve.patches)) continue;
      point.facing = search.facing_itself(x, outward, point.own, Patch::none);
      if (point.facing.patch == Patch::none)
        point.facing.nearest = search.nearest_of_itself(x, outward, point.own, Patch::none);
    } else {
      point.facing = search.facing(x, outward);
    }
    const bool faces = point.facing.patch != Patch::none;
    if (!faces && !model.scene.finite_strain) continue;
    point.shares_normal = !model.scene.finite_strain && pairing.obstacle < 0 && has_side;
    if (faces && pairing.obstacle < 0)
      for (int vertex : curve.patches[point.facing.patch].vertices)
        if (vertex != Patch::none) point.nodes.push_back(curve.nodes[vertex]);
    add_point(model, std::move(point));
  }
  model.effects.smoothing |= model.scene.contacts[pairing.index].smoothing != Smoothing::none;
  model.curves.push_back(std::move(curve));
}

/// The function facet -> side of a quadratic element that it is half of (Segment::slave_edge).
auto quadratic_edges(const SideSet& side) {
  std::map<int, std::array<int, 3>> of_middle;
  for (const auto& edge : side.edges)
    if (edge.size() == 3) of_middle[edge[2]] = {edge[0], edge[1], edge[2]};
  return [of_middle](int a, int b) {
    for (int node : {a, b})
      if (const auto found = of_middle.find(node); found != of_middle.end()) return found->second;
    return Segment{}.slave_edge;
  };
}

/// Sets what the vertices of a curve in contact with itself may face.
void set_own_vertices(const Eigen::Matrix2Xd& places, MasterCurve& curve) {
  for (std::size_t p = 0; p < curve.patches.size(); ++p) {
    const Patch& patch = curve.patches[p];
    for (int vertex : {patch.vertices[1], patch.vertices[2]}) {
      if (curve.own.count(curve.nodes[vertex]) > 0) continue;
      Vec<double, 2> outward = Vec<double, 2>::Zero();
      double size = 0;
      int count = 0;
      for (const Patch& at : curve.patches)
        if (at.vertices[1] == vertex || at.vertices[2] == vertex) {
          const Vec<double, 2> along = places.col(at.vertices[2]) - places.col(at.vertices[1]);
          outward += Vec<double, 2>(along[1], -along[0]);
          size += along.norm();
          ++count;
        }
      curve.own.emplace(curve.nodes[vertex], own_vertex(curve.patches, places, vertex, outward, size / count));
    }
  }
}

/// Master curve of segment-integrated contact at finite strain.
MasterCurve integrated_curve(const Model& model, const Points<double>& points, const Pairing& pairing) {
  auto [curve, places] = make_curve(model, points, pairing);
  if (model.scene.contacts[pairing.index].is_of_itself()) set_own_vertices(places, curve);
  const auto node_of = [&](int vertex) {
    return pairing.obstacle >= 0 ? model.node_count + vertex : curve.nodes[vertex];
  };
  const auto edge_of = quadratic_edges(pairing.master);
  for (const auto& patch : curve.patches) {
    const int begin = node_of(patch.vertices[1]), end = node_of(patch.vertices[2]);
    curve.facets.push_back({begin, end});
    curve.edges.push_back(edge_of(begin, end));
    if (patch.previous == Patch::none) curve.ends.push_back(begin);
    if (patch.next == Patch::none) curve.ends.push_back(end);
  }
  return curve;
}

/// Nodes in which a side turns by more than 60 degrees.
std::set<int> corners_of(const SideSet& side, const Points<double>& points) {
  constexpr double least_cosine = 0.5 - 1e-9;
  std::map<int, Vec<double, 2>> ends_along;
  const auto along = [&](const std::vector<int>& facet) -> Vec<double, 2> {
    return (points.col(facet[1]) - points.col(facet[0])).head<2>().normalized();
  };
  for (const auto& facet : side.facets) ends_along.emplace(facet[1], along(facet));
  std::set<int> corners;
  for (const auto& facet : side.facets)
    if (const auto before = ends_along.find(facet[0]); before != ends_along.end())
      if (before->second.dot(along(facet)) < least_cosine) corners.insert(facet[0]);
  return corners;
}

/// Segments that the multiplier of each slave node acts on.
///
///   whole    one segment per whole slave facet, without a master, because what it faces is found later
///   corners  nodes that carry no multiplier on a facet whose other node carries one. Why: two faces that meet at an edge
///            face other masters, and one multiplier has one normal
std::map<int, std::vector<Segment>> segments_of_nodes(const Facets& master, const Pairing& pairing, bool whole,
                                                      const std::set<int>& corners) {
  const std::set<int> nodes(pairing.slave.nodes.begin(), pairing.slave.nodes.end());
  const auto edge_of = quadratic_edges(pairing.slave), edge_of_master = quadratic_edges(pairing.master);
  std::map<int, std::vector<Segment>> of_node;
  for (const auto& facet : pairing.slave.facets) {
    Segment whole_facet;
    whole_facet.slave = {facet[0], facet[1]};
    whole_facet.slave_edge = edge_of(facet[0], facet[1]);
    const auto segments = whole ? std::vector<Segment>{whole_facet} : master.search.facing(whole_facet.slave);
    const auto may_carry = [&](int end) { return nodes.count(facet[end]) > 0; };
    const auto carries = [&](int end) {
      const bool is_left = corners.count(facet[end]) > 0 && corners.count(facet[1 - end]) == 0;
      return may_carry(end) && !(is_left && may_carry(1 - end));
    };
    for (Segment segment : segments)
      for (int end = 0; end < 2; ++end)
        if (carries(end)) {
          segment.slave_edge = whole_facet.slave_edge;
          segment.master_edge = edge_of_master(segment.master[0], segment.master[1]);
          segment.carrier = end;
          segment.sole_carrier = !carries(1 - end);
          of_node[facet[end]].push_back(segment);
        }
  }
  return of_node;
}

/// Segment-integrated contact: the multiplier of each slave node on the segments of its facets.
void pair_segments(Model& model, const Points<double>& points, const Pairing& pairing) {
  const Facets master = facets_of_master(model, points, pairing);
  const bool slides = model.scene.finite_strain && !master.facets.empty();
  const auto corners = model.scene.finite_strain ? corners_of(pairing.slave, points) : std::set<int>{};
  auto of_node = segments_of_nodes(master, pairing, slides || master.facets.empty(), corners);
  const int curve = slides ? static_cast<int>(model.curves.size()) : -1;
  if (slides) model.curves.push_back(integrated_curve(model, points, pairing));
  const std::size_t first = model.points.size();
  for (int node : pairing.slave.nodes) {
    if (of_node[node].empty()) continue;
    ContactPoint point = slave_point(model, points, pairing, node);
    point.master = ContactPoint::Master::segments;
    point.curve = curve;
    point.segments = of_node[node];
    point.slave_nodes = static_cast<int>(nodes_of_segments(node, point.segments, {}, model.node_count).size());
    point.nodes = nodes_of_segments(node, point.segments, point.segments, model.node_count);
    add_point(model, std::move(point));
  }
  if (!slides) return;
  std::vector<Facing> found(model.points.size());
  find_segments(model, curve, master.points, Points<double>::Zero(master.points.rows(), master.points.cols()),
                std::vector<int>(found.size(), Patch::none), found);
  for (std::size_t p = first; p < model.points.size(); ++p) {
    model.points[p].facing = found[p];
    model.points[p].nodes = found[p].nodes;
  }
}

/// Makes the points of the contact Scene::contacts[index].
void pair_contact(Model& model, const Points<double>& points, int index) {
  const Contact& contact = model.scene.contacts[index];
  const std::string where = "/contacts/" + contact.name;
  Pairing pairing{
      index, obstacle_index(model.scene, contact.master), surface_of(model, points, model.side(contact.slave)), {}};
  if (pairing.obstacle < 0) {
    pairing.master = model.side(contact.master);  // of a side that touches itself the axis tells how thick it is
    if (!contact.is_of_itself()) pairing.master = surface_of(model, points, pairing.master);
    if (model.dimension == 3) throw ModelError("a deformable master needs a 2D space", where);
    if (pairing.master.facets.empty()) throw ModelError("the master side has no facets", where);
  } else if (model.dimension == 3 && !is_in_space(model.scene.obstacles[pairing.obstacle].shape)) {
    throw ModelError("this surface is not made for space", "/obstacles/" + contact.master);
  }
  const bool has_facets =
      pairing.obstacle < 0 || std::holds_alternative<Polyline>(model.scene.obstacles[pairing.obstacle].shape);
  const bool along_curve = model.scene.finite_strain || contact.smoothing != Smoothing::none ||
                           !contact.group.empty() || contact.is_of_itself();
  if (has_facets && along_curve && !contact.segment) return pair_along_curve(model, points, pairing);
  if (!contact.segment) return pair_nodes(model, points, pairing);
  const auto shape = model.bodies[pairing.slave.body].mesh.shape;
  if (contact.is_of_itself() && !model.scene.finite_strain)
    throw ModelError("segment integration of a side against itself needs finite strain", where);
  if (model.dimension == 3 || pairing.slave.facets.empty() || !is_continuum(shape))
    throw ModelError("segment integration needs a slave side of facets of a solid body", where);
  pair_segments(model, points, pairing);
}

}  // namespace

void pair_contacts(Model& model, const Points<double>& points) {
  for (std::size_t c = 0; c < model.scene.contacts.size(); ++c) pair_contact(model, points, static_cast<int>(c));
}

SideSet surface_of(const Model& model, const Points<double>& points, SideSet side) {
  if (model.scene.space != Space::axisymmetric) return side;
  const auto on_axis = [&](const std::vector<int>& facet) {
    return std::all_of(facet.begin(), facet.end(), [&](int node) { return model.is_on_axis(points, node); });
  };
  std::set<int> on_facets, on_surface;
  for (const auto& facet : side.facets) {
    on_facets.insert(facet.begin(), facet.end());
    if (!on_axis(facet)) on_surface.insert(facet.begin(), facet.end());
  }
  std::erase_if(side.facets, on_axis);
  std::erase_if(side.edges, on_axis);
  std::erase_if(side.nodes, [&](int node) { return on_facets.count(node) > 0 && on_surface.count(node) == 0; });
  return side;
}

std::vector<int> nodes_without_area(const Model& model, const Points<double>& points, int contact) {
  std::vector<int> nodes;
  if (model.scene.space != Space::axisymmetric) return nodes;
  const SideSet side = surface_of(model, points, model.side(model.scene.contacts[contact].slave));
  for (int node : side.nodes)
    if (has_no_area(model, points, side, node)) nodes.push_back(node);
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

}  // namespace stickslip
