#include "sensitivity/sided_geometry.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <map>
#include <optional>

#include "core/model/contact_geometry.hpp"
#include "core/model/pairing.hpp"
#include "sensitivity/ties/scales.hpp"

namespace stickslip {
namespace {

/// Whether a point may come to face another part of its master, which is that of the start: it may be at a vertex, or
/// its segment may end there. Of what moves with displacements see VertexTie and EdgeTie.
bool may_leave(const Model& model, const ContactPoint& point) {
  using Master = ContactPoint::Master;
  if (!point.overlaps.empty()) return point.overlaps[0].master.corners > 0;
  if (point.is_integrated()) return point.surface < 0 && point.segments[0].master[0] != Segment::none;
  return point.master != Master::obstacle && !model.slides_on_surfaces();
}

bool same_part(const ContactPoint& a, const ContactPoint& b) {
  const bool same_faces = std::equal(a.faces.begin(), a.faces.end(), b.faces.begin(), b.faces.end(),
                                     [](const auto& one, const auto& other) { return one.is_part_of(other); });
  return a.master == b.master && a.nodes == b.nodes && a.corners == b.corners && a.segments == b.segments &&
         a.overlaps == b.overlaps && a.facing.patch == b.facing.patch && same_faces;
}

/// The point with the same slave node; nullptr if there is none.
const ContactPoint* counterpart(const std::vector<ContactPoint>& points, const ContactPoint& of) {
  const auto found = std::find_if(points.begin(), points.end(), [&](const ContactPoint& point) {
    return point.contact == of.contact && point.nodes[0] == of.nodes[0];
  });
  return found == points.end() ? nullptr : &*found;
}

/// The contact points of the model with all nodes and obstacles moved to one side.
std::vector<ContactPoint> paired_beside(const Model& model, const Points<Direction>& points,
                                        const Numbers<Direction>& numbers, double step) {
  Model beside;
  beside.scene = model.scene;
  beside.dimension = model.dimension;
  beside.node_count = model.node_count;
  beside.bodies = model.bodies;
  beside.contact_sides = model.contact_sides;
  for (std::size_t i = 0; i < beside.scene.numbers.size(); ++i)
    beside.scene.numbers[i] += step * numbers.at_slot[i].d[0];
  Points<double> moved(points.rows(), points.cols());
  for (Eigen::Index i = 0; i < moved.size(); ++i) moved.data()[i] = points.data()[i].v + step * points.data()[i].d[0];
  pair_contacts(beside, moved);
  return beside.points;
}

/// Vertices of the obstacle that a point faces; the first two are those of a facet.
std::vector<int> vertices_faced(const Model& model, const ContactPoint& point) {
  std::vector<int> vertices;
  const auto add = [&](int node) {
    if (node >= model.node_count) vertices.push_back(node - model.node_count);
  };
  std::for_each(point.corners.begin(), point.corners.end(), add);
  for (const auto& overlap : point.overlaps)
    std::for_each(overlap.master.nodes.begin(), overlap.master.nodes.begin() + overlap.master.corners, add);
  for (const auto& segment : point.segments) std::for_each(segment.master.begin(), segment.master.end(), add);
  if (point.surface >= 0 && model.surfaces[point.surface].is_rigid() && model.dimension == 2)
    for (int vertex : model.surfaces[point.surface].vertices(point.facing.patch))
      if (vertex != no_vertex) vertices.push_back(vertex);
  return vertices;
}

/// Largest derivative of a contact node or of a number of an obstacle, over the mesh size of the slave.
double speed(const Model& model, const Points<Direction>& points, const Numbers<Direction>& numbers) {
  double fastest = 0, size = std::numeric_limits<double>::infinity();
  std::map<int, Points<Direction>> of_obstacle;
  for (const auto& point : model.points) {
    if (!may_leave(model, point)) continue;
    size = point.mesh_size > 0 ? std::min(size, point.mesh_size) : size;
    for (const auto* nodes : {&point.nodes, &point.corners})
      for (int node : *nodes)
        for (Eigen::Index i = 0; node < model.node_count && i < points.rows(); ++i)
          fastest = std::max(fastest, std::abs(points(i, node).d[0]));
    const auto vertices = vertices_faced(model, point);
    if (vertices.empty()) continue;
    Points<Direction>& of = of_obstacle[point.obstacle];
    if (of.size() == 0) of = vertices_of(model.scene.obstacles[point.obstacle].shape, numbers);
    for (int v : vertices)
      for (const Direction& x : of.col(v)) fastest = std::max(fastest, std::abs(x.d[0]));
    const Points<double> way = values(Points<Direction>(of.col(vertices[1]) - of.col(vertices[0])));
    size = std::min(size, way.norm());
  }
  return std::isfinite(size) ? fastest / size : 0;
}

/// The geometry of a point with its weights in the order of `nodes`; none if a node that is not in `nodes` has a
/// weight.
std::optional<PointGeometry<Direction>> on_nodes(PointGeometry<Direction> geometry, const std::vector<int>& of,
                                                 const std::vector<int>& nodes) {
  constexpr double negligible = 1e-12;
  decltype(geometry.weights) weights = decltype(geometry.weights)::Constant(nodes.size(), Direction(0));
  for (Eigen::Index n = 0; n < geometry.weights.size(); ++n) {
    const auto found = std::find(nodes.begin(), nodes.end(), of[n]);
    const Direction& weight = geometry.weights[n];
    if (found != nodes.end())
      weights[found - nodes.begin()] += weight;
    else if (std::abs(weight.v) > negligible || std::abs(weight.d[0]) > negligible)
      return std::nullopt;
  }
  geometry.weights = weights;
  return geometry;
}

/// Whether two geometries of the same nodes have the same values, so that nothing jumps.
bool meets(const PointGeometry<Direction>& a, const PointGeometry<Direction>& b, double size) {
  return (values(a.normal) - values(b.normal)).cwiseAbs().maxCoeff() <= straight &&
         (values(a.weights) - values(b.weights)).cwiseAbs().maxCoeff() <= straight &&
         std::abs(a.gap.v - b.gap.v) <= straight * size && std::abs(a.area.v - b.area.v) <= straight * a.area.v;
}

}  // namespace

SidedPairing sided_pairing(const Model& model, int parameter, double side) {
  constexpr double step = 1e-7, beyond_end = 2e-6;  // widths: a vertex 1e-9 (at_facet_end), a free end 1e-6
  SidedPairing out;
  const auto may = [&](const ContactPoint& point) { return may_leave(model, point); };
  if (std::none_of(model.points.begin(), model.points.end(), may)) return out;
  const auto numbers = seeded(model.scene, {parameter});
  const auto points = initial_points(model, numbers);
  const double fastest = speed(model, points, numbers);
  if (!(fastest > 0)) return out;
  out.points = paired_beside(model, points, numbers, side * step / fastest);
  out.kink = out.points.size() != model.points.size();
  for (const auto& point : model.points) {
    if (!may_leave(model, point)) continue;
    const auto* other = counterpart(out.points, point);
    out.kink |= !other || !same_part(*other, point);
  }
  const auto beyond = paired_beside(model, points, numbers, side * beyond_end / fastest);
  for (std::size_t p = 0; p < model.points.size(); ++p)
    if (may_leave(model, model.points[p]) && !counterpart(beyond, model.points[p]))
      out.leaving.push_back(static_cast<int>(p));
  const auto joins = [&](const ContactPoint& point) {
    return !counterpart(model.points, point) && !counterpart(out.points, point);
  };
  const std::size_t beside = out.points.size();
  std::copy_if(beyond.begin(), beyond.end(), std::back_inserter(out.points), joins);
  out.kink |= !out.leaving.empty() || out.points.size() > beside;
  return out;
}

bool take_side(const Model& model, const SidedPairing& pairing, const std::vector<char>& engaged,
               Slots<Direction>& slots) {
  bool continuous = std::none_of(pairing.leaving.begin(), pairing.leaving.end(), [&](int p) { return engaged[p]; });
  Model sided = model;  // with what the points face on the side, at the unmoved nodes
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    const auto& point = model.points[p];
    const auto* other = counterpart(pairing.points, point);
    if (!may_leave(model, point) || (other && same_part(*other, point))) continue;
    std::optional<PointGeometry<Direction>> geometry;
    if (other) geometry = on_nodes(detail::initial_geometry(model, *other, slots), other->nodes, point.nodes);
    const double size = point.mesh_size > 0 ? point.mesh_size : 1;
    if (!geometry || !meets(*geometry, slots.geometry[p], size)) {
      continuous &= !engaged[p];
      continue;
    }
    slots.geometry[p] = *geometry;
    sided.points[p].master = other->master;
    sided.points[p].corners = other->corners;
  }
  for (const auto& other : pairing.points)  // points that face the master on this side alone
    if (!counterpart(model.points, other))
      for (std::size_t p = 0; p < model.points.size(); ++p)
        continuous &= !(engaged[p] && model.points[p].contact == other.contact);
  slots.stiffness = contact_stiffness(model, slots);
  for (std::size_t p = 0; p < slots.spins.size(); ++p) slots.spins[p] = detail::spin(sided, static_cast<int>(p), slots);
  return continuous;
}

}  // namespace stickslip
