#include "core/model/pairing.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "core/contact/face_search.hpp"
#include "core/contact/facet_search.hpp"
#include "core/contact/segments.hpp"
#include "core/contact/surface_search.hpp"
#include "core/mesh/sides.hpp"
#include "core/model/facings_impl.hpp"
#include "core/model/master_surface.hpp"
#include "core/model/overlap_pairing.hpp"
#include "core/model/segment_search.hpp"
#include "core/model/slave_point.hpp"

namespace stickslip {
namespace {

/// What a contact is searched in: the facets of a master side, or of an obstacle; empty of an obstacle without facets.
struct Facets {
  Points<double> points;  ///< of the model's nodes and, behind these, the vertices of the obstacle
  std::vector<std::vector<int>> facets;
  FacetSearch search;
  Facets(Points<double> at, std::vector<std::vector<int>> of)
      : points(std::move(at)), facets(std::move(of)), search(points, facets) {}
  Facets(const Facets&) = delete;
  Vec<double, 2> place(int node) const { return points.col(node).head<2>(); }
  Points<double> still() const { return Points<double>::Zero(points.rows(), points.cols()); }  ///< displacements
};

/// Leaves a slave node at a corner of its side the facets that face a master of normal `across`, any length: those
/// within 60 degrees. If none is, it keeps all. Its normal, which the bisector takes, is of these.
template <int D>
void keep_facets_that_face(const Points<double>& points, const Vec<double, D>& across, ContactPoint& point) {
  constexpr double within = 0.5;
  auto facets = point.area_facets;
  std::erase_if(facets, [&](const auto& facet) {
    const Vec<double, D> outward = slave_normal<D>({facet}, points);
    return outward.dot(across) > -within * outward.norm() * across.norm();
  });
  if (!facets.empty()) point.area_facets = std::move(facets);
}

/// Sets the facet or vertex that a slave node faces. False if it faces none.
bool find_corners(const Points<double>& points, const Facets& master, ContactPoint& point) {
  const Vec<double, 2> x = points.col(point.nodes[0]).head<2>();
  const auto closest = master.search.closest(x);
  if (!closest) return false;
  const auto normal = [&](int f) {
    const Vec<double, 2> tau = master.place(master.facets[f][1]) - master.place(master.facets[f][0]);
    return Vec<double, 2>(tau[1], -tau[0]);
  };
  const auto is_faced = [&](int f) {
    return !point.shares_normal || opposes<2>(normal(f), slave_normal<2>(point.area_facets, points));
  };
  const bool deformable = point.obstacle < 0;
  const bool first = is_faced(closest->facet), second = closest->second >= 0 && is_faced(closest->second);
  if (!first && !second) return false;
  if (closest->second < 0 || first != second) {  // at a corner the master may end: only one of its facets opposes
    const int facet = first ? closest->facet : closest->second;
    if (closest->second >= 0 && master.search.is_past_end(facet, x)) return false;
    if (point.shares_normal) keep_facets_that_face<2>(points, normal(facet), point);
    point.master = ContactPoint::Master::facet;
    point.corners = master.facets[facet];
    if (deformable) point.nodes.insert(point.nodes.end(), point.corners.begin(), point.corners.end());
    return true;
  }
  point.master = ContactPoint::Master::vertex;
  const auto &before = master.facets[closest->facet], &after = master.facets[closest->second];
  point.corners = {before[0], before[1], after[1]};
  if (point.shares_normal)
    keep_facets_that_face<2>(points, normal(closest->facet).normalized() + normal(closest->second).normalized(), point);
  if (!deformable) return true;
  point.nodes.push_back(before[1]);
  const Vec<double, 2> v = master.place(before[1]);
  for (int to : {before[0], after[1]}) {
    const Vec<double, 2> along = master.place(to) - v;
    if (std::abs((x - v).dot(along)) <= at_facet_end * along.squaredNorm()) point.nodes.push_back(to);
  }
  return true;
}

/// Sets the faces that a slave node faces, of those that oppose its own side. False if it faces none.
bool find_faces(const Points<double>& points, const FaceSearch& master, ContactPoint& point) {
  const Vec<double, 3> own = slave_normal<3>(point.area_facets, points);
  point.faces = master.closest(points.col(point.nodes[0]), point.shares_normal ? own : Vec<double, 3>::Zero());
  const auto normal = [&](const FacePlace& face) {
    return slave_normal<3>({{face.nodes.begin(), face.nodes.begin() + face.corners}}, points);
  };
  if (point.faces.empty()) return false;
  Vec<double, 3> across = Vec<double, 3>::Zero();
  for (const auto& face : point.faces) across += normal(face).normalized();
  if (point.shares_normal) keep_facets_that_face<3>(points, across, point);
  point.master = ContactPoint::Master::faces;
  for (const auto& face : point.faces)
    for (int k = 0; k < face.corners; ++k)
      if (std::find(point.nodes.begin(), point.nodes.end(), face.nodes[k]) == point.nodes.end())
        point.nodes.push_back(face.nodes[k]);
  return true;
}

/// Sets what a slave node faces. False if it faces nothing. Throws ModelError if all places of an obstacle are equally
/// near.
bool find_master(const Points<double>& points, const Model& model, const Facets& facets, ContactPoint& point) {
  if (point.obstacle < 0) return find_corners(points, facets, point);
  const Obstacle& obstacle = model.scene.obstacles[point.obstacle];
  if (has_facets(obstacle.shape)) return find_corners(points, facets, point);
  if (const char* key = ambiguity(points.col(point.nodes[0]), obstacle.shape, model.scene.as<double>()))
    throw ModelError("is where a slave node is, from which no place of the surface is nearer than another",
                     "/obstacles/" + obstacle.name + "/" + key);
  return true;
}

Facets facets_of_master(const Model& model, const Points<double>& points, const Pairing& pairing) {
  if (pairing.obstacle < 0 && model.dimension == 3) return {points, {}};
  if (pairing.obstacle < 0) return {points, pairing.master.facets};
  const Obstacle& obstacle = model.scene.obstacles[pairing.obstacle];
  if (!has_facets(obstacle.shape)) return {points, {}};
  const auto vertices = vertices_of(obstacle.shape, model.scene.as<double>());
  Points<double> all(2, points.cols() + vertices.cols());
  all << points, vertices;
  auto facets = facets_of(obstacle.shape);
  for (auto& facet : facets)
    for (int& vertex : facet) vertex += model.node_count;
  return {std::move(all), std::move(facets)};
}

/// Whether a node of the surface of a body has no tributary area. On the axis of revolution the share of a corner of a
/// quadratic element is the integral of (1 - s) (1 - 2 s) s, which is zero.
bool has_no_area(const Model& model, const Points<double>& points, const SideSet& side, int node) {
  return is_quadratic(model.bodies[side.body].mesh.shape) && model.is_on_axis(points, node);
}

/// Node-to-segment contact, in space node-to-face: each slave node against the closest point of its master.
void pair_nodes(Model& model, const Points<double>& points, const Pairing& pairing) {
  const auto shape = model.bodies[pairing.slave.body].mesh.shape;
  const bool has_faces = model.dimension == 3 && pairing.obstacle < 0;
  const FaceSearch faces(points, has_faces ? pairing.master.facets : std::vector<std::vector<int>>());
  const Facets facets = facets_of_master(model, points, pairing);
  for (int node : pairing.slave.nodes) {
    if (has_no_area(model, points, pairing.slave, node)) continue;
    ContactPoint point = slave_point(model, points, pairing, node);
    point.shares_normal = pairing.obstacle < 0 && is_continuum(shape) && !point.area_facets.empty();
    if (has_faces ? find_faces(points, faces, point) : find_master(points, model, facets, point))
      add_point(model, std::move(point));
  }
}

/// The vertices of a side in contact with itself: what each may face.
template <int D>
class OwnVertices {
 public:
  /// Both must outlive this. `places`: initial positions of the vertices.
  OwnVertices(const MasterSurface& side, const Places<D>& places) : side_(side), places_(places) {
    if constexpr (D == 3) faces_.emplace(places, corners_of(side.patches<3>()));
  }
  OwnVertex at(int node, const Vec<double, D>& outward, double mesh_size) const {
    const auto found = std::find(side_.nodes.begin(), side_.nodes.end(), node);
    const int vertex = static_cast<int>(found - side_.nodes.begin());
    if constexpr (D == 2)
      return own_vertex(side_.patches<2>(), places_, vertex, outward, mesh_size);
    else
      return own_vertex(*faces_, vertex, outward, mesh_size);
  }
  /// Whether a vertex comes before some patch. (In space there is always a place beyond; the last vertex faces none.)
  bool may_face_some(const OwnVertex& own) const {
    if constexpr (D == 2)
      return own.may_face_some(side_.patches<2>());
    else
      return own.vertex + 1 < side_.vertex_count;
  }

 private:
  const MasterSurface& side_;
  const Places<D>& places_;
  std::optional<FaceSearch> faces_;  ///< in space
};

/// What a slave node faces of a surface at the start; in space it sets this place on each patch that has it.
template <int D>
Facing facing_of(const SurfaceSearch<D>& search, const MasterSurface& master, const SurfaceQuery<D>& query,
                 ContactPoint& point) {
  Facing facing = query.own ? search.facing_itself(query) : search.facing(query);
  if (query.own && facing.patch == no_patch) facing.nearest = search.nearest_of_itself(query);
  if constexpr (D == 3)
    if (facing.patch != no_patch) point.starts = patches_at(master.patches<3>(), facing);
  return facing;
}

/// Normal of the facet of a patch, of any length.
template <int D>
Vec<double, D> normal_of_patch(const Points<double>& points, const MasterSurface& master, int patch) {
  const auto& of = master.patches<D>()[patch];
  std::vector<int> corners;
  for (int k = 0; k < of.corners; ++k) corners.push_back(master.nodes[of.corner(k)]);
  return slave_normal<D>({corners}, points);
}

/// Contact along a surface: each slave node against the place of it that it faces. At finite strain a node that faces
/// nothing yet is a point too.
template <int D>
void pair_along_surface(Model& model, const Points<double>& points, const Pairing& pairing) {
  auto [master, places] = make_master<D>(model, points, pairing.index, pairing.obstacle, pairing.master.facets);
  const auto shape = model.bodies[pairing.slave.body].mesh.shape;
  const SurfaceSearch<D> search(master.template patches<D>(), places);
  if (model.scene.finite_strain && master.is_rigid())
    master.still =
        std::make_shared<const StillSurface<D>>(std::get<std::shared_ptr<const Surface<D>>>(master.surface), places);
  std::optional<OwnVertices<D>> own;
  if (model.scene.contacts[pairing.index].is_of_itself()) own.emplace(master, places);
  for (int node : pairing.slave.nodes) {
    if (has_no_area(model, points, pairing.slave, node)) continue;
    ContactPoint point = slave_point(model, points, pairing, node);
    const bool has_side = is_continuum(shape) && !point.area_facets.empty();
    const Vec<double, D> outward =
        has_side ? slave_normal<D>(point.area_facets, points) : Vec<double, D>::Zero().eval();
    point.master = ContactPoint::Master::surface;
    point.surface = static_cast<int>(model.surfaces.size());
    if (own) {
      point.own = own->at(node, outward, point.mesh_size);
      if (!own->may_face_some(point.own)) continue;
    }
    auto query = detail::query_of<D>(point, master, points.col(node), outward, no_patch);
    if (!model.scene.finite_strain) query.size = 0;
    point.facing = facing_of<D>(search, master, query, point);
    const bool faces = point.facing.patch != no_patch;
    if (!faces && !model.scene.finite_strain) continue;
    point.shares_normal = !model.scene.finite_strain && pairing.obstacle < 0 && has_side;
    if (faces && point.shares_normal)
      keep_facets_that_face<D>(points, normal_of_patch<D>(points, master, point.facing.patch), point);
    if (faces && pairing.obstacle < 0)
      for (int vertex : master.vertices(point.facing.patch))
        if (vertex != no_vertex) point.nodes.push_back(master.nodes[vertex]);
    add_point(model, std::move(point));
  }
  model.effects.smoothing |= model.scene.contacts[pairing.index].smoothing != Smoothing::none;
  model.surfaces.push_back(std::move(master));
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
///   corners  nodes that carry no multiplier on a facet whose other node carries one. Why: two faces that meet at an
///            edge face other masters, and one multiplier has one normal
std::map<int, std::vector<Segment>> segments_of_nodes(const Facets& master, const Pairing& pairing, bool whole,
                                                      const std::set<int>& corners) {
  const std::set<int> nodes(pairing.slave.nodes.begin(), pairing.slave.nodes.end());
  const QuadraticEdges slave_edges(pairing.slave), master_edges(pairing.master);
  std::map<int, std::vector<Segment>> of_node;
  for (const auto& facet : pairing.slave.facets) {
    Segment whole_facet;
    whole_facet.slave = {facet[0], facet[1]};
    whole_facet.slave_edge = slave_edges.of_facet(facet[0], facet[1]);
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
          segment.master_edge = master_edges.of_facet(segment.master[0], segment.master[1]);
          segment.carrier = end;
          segment.sole_carrier = !carries(1 - end);
          of_node[facet[end]].push_back(segment);
        }
  }
  return of_node;
}

/// Whether the segments of a point weigh nothing (weight_of_angle()), as they may along the curved sides of quadratic
/// elements.
bool all_are_too_steep(const Model& model, const Facets& master, const ContactPoint& point) {
  constexpr double nothing = 1e-12;
  ContactPoint unweighed = point;  // without masters no angle is asked for
  for (Segment& segment : unweighed.segments) segment.master = {Segment::none, Segment::none};
  return !(area_share(point.segments, unweighed, master.points, master.still(), model.node_count) > nothing);
}

/// Segment-integrated contact: the multiplier of each slave node on the segments of its facets.
void pair_segments(Model& model, const Points<double>& points, const Pairing& pairing) {
  const Facets master = facets_of_master(model, points, pairing);
  const bool slides = model.scene.finite_strain && !master.facets.empty();
  const auto corners = model.scene.finite_strain ? corners_of(pairing.slave, points) : std::set<int>{};
  auto of_node = segments_of_nodes(master, pairing, slides || master.facets.empty(), corners);
  const int curve = slides ? static_cast<int>(model.surfaces.size()) : -1;
  if (slides)
    model.surfaces.push_back(integrated_curve(model, points, pairing.index, pairing.obstacle, pairing.master));
  const std::size_t first = model.points.size();
  for (int node : pairing.slave.nodes) {
    if (of_node[node].empty()) continue;
    ContactPoint point = slave_point(model, points, pairing, node);
    point.master = ContactPoint::Master::segments;
    point.surface = curve;
    point.segments = of_node[node];
    if (!slides && !master.facets.empty() && all_are_too_steep(model, master, point)) continue;
    point.slave_nodes = static_cast<int>(nodes_of_segments(node, point.segments, {}, model.node_count).size());
    point.nodes = nodes_of_segments(node, point.segments, point.segments, model.node_count);
    add_point(model, std::move(point));
  }
  if (!slides) return;
  std::vector<Facing> found(model.points.size());
  find_segments(model, curve, master.points, master.still(), std::vector<int>(found.size(), no_patch), found);
  for (std::size_t p = first; p < model.points.size(); ++p) {
    model.points[p].facing = found[p];
    model.points[p].nodes = found[p].nodes;
  }
}

/// Makes the points of the contact Scene::contacts[index].
void pair_contact(Model& model, const Points<double>& points, int index) {
  const Contact& contact = model.scene.contacts[index];
  const std::string where = "/contacts/" + contact.name;
  const ContactSides& sides = model.contact_sides[index];
  Pairing pairing{index, sides.obstacle, surface_of(model, points, sides.slave), {}};
  if (pairing.obstacle < 0) {
    pairing.master = sides.master;  // of a side that touches itself the axis tells how thick it is
    if (!contact.is_of_itself()) pairing.master = surface_of(model, points, pairing.master);
    if (pairing.master.facets.empty()) throw ModelError("the master side has no facets", where);
  } else if (model.dimension == 3 && !is_in_space(model.scene.obstacles[pairing.obstacle].shape)) {
    throw ModelError("this surface is not made for space", "/obstacles/" + contact.master);
  }
  const bool is_obstacle = pairing.obstacle >= 0;
  const bool is_surface = !is_obstacle || has_facets(model.scene.obstacles[pairing.obstacle].shape);
  const bool slides = model.scene.finite_strain || contact.smoothing != Smoothing::none || contact.is_of_itself() ||
                      (is_obstacle && model.dimension == 3);
  if (is_surface && slides && !contact.segment)
    return with_dimension(model.dimension, [&]<int D>() { pair_along_surface<D>(model, points, pairing); });
  if (!contact.segment) return pair_nodes(model, points, pairing);
  const auto shape = model.bodies[pairing.slave.body].mesh.shape;
  if (contact.is_of_itself() && !model.scene.finite_strain)
    throw ModelError("segment integration of a side against itself needs finite strain", where);
  if (pairing.slave.facets.empty() || !is_continuum(shape))
    throw ModelError("segment integration needs a slave side of facets of a solid body", where);
  if (model.dimension == 3 && model.scene.finite_strain)
    throw ModelError("segment integration in space needs small strain", where);
  model.dimension == 3 ? pair_overlaps(model, points, pairing) : pair_segments(model, points, pairing);
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
  const SideSet side = surface_of(model, points, model.contact_sides[contact].slave);
  for (int node : side.nodes)
    if (has_no_area(model, points, side, node)) nodes.push_back(node);
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

}  // namespace stickslip
