/// Slots: every number that a residual reads, in the scalar T: nodal coordinates, material numbers, initial contact
/// geometry, friction, loads. T is double in the solver, Dual<N> for derivatives by parameters (pseudo-loads), complex
/// in the oracle.
#pragma once

#include <functional>
#include <type_traits>
#include <variant>
#include <vector>

#include "core/contact/contact_point.hpp"
#include "core/contact/segments.hpp"
#include "core/contact/surfaces.hpp"
#include "core/mesh/generators.hpp"
#include "core/model/history.hpp"
#include "core/model/model.hpp"
#include "core/model/supports.hpp"
#include "core/solids/edges.hpp"
#include "core/solids/elements.hpp"
#include "core/solids/materials.hpp"

namespace stickslip {

/// Nodal forces of a load at history = 1, on the dofs on which it acts.
template <class T>
struct NodalLoad {
  std::vector<int> dofs;  ///< ascending
  std::vector<T> forces;

  explicit NodalLoad(const Vector<T>& all) {
    for (int dof = 0; dof < all.size(); ++dof)
      if (!vanishes(all[dof])) {
        dofs.push_back(dof);
        forces.push_back(all[dof]);
      }
  }
  Vector<T> all(int dof_count) const {
    Vector<T> spread = Vector<T>::Constant(dof_count, T(0));
    for (std::size_t k = 0; k < dofs.size(); ++k) spread[dofs[k]] = forces[k];
    return spread;
  }
};

template <class T>
struct Slots {
  Numbers<T> numbers;
  Points<T> points;                        ///< D x nodes
  std::vector<Law<T>> laws;                ///< per body
  std::vector<Depth<T>> depths;            ///< per body
  std::vector<PointGeometry<T>> geometry;  ///< per contact point
  std::vector<T> stiffness;                ///< per contact point: local nodal stiffness k_i (force per length)
  std::vector<FrictionLaw<T>> friction;    ///< per contact; not read if frictionless
  std::vector<NodalLoad<T>> loads;         ///< per load
  std::vector<Matrix<T>> frames;           ///< per framed node: D x D, frame vectors as columns
  std::vector<Vector<T>> spins;            ///< per contact point: displacement of its obstacle per degree of rotation,
                                           ///< length; empty: no obstacle rotates
  std::vector<Vector<T>> arcs;    ///< per curve that is integrated: initial arc length along it to the beginning
                                  ///< of each facet, and of all; empty for another; no entry: none is
  bool current_geometry = false;  ///< of the model's effects
};

/// Gap of a point, length, up to which it counts as zero. If the initial gap is not exactly zero: the rounding of the
/// coordinates. If it is: the rounding of the displacements alone, so a contact that begins closed has the same
/// branches under every load, however small. `largest_displacement`: of the point's nodes, length.
template <class T>
double tie_length(const ContactPoint& point, const PointGeometry<T>& geometry, double largest_displacement = 0) {
  constexpr double terms = 256;  // terms summed in a displacement, times some condition number
  return value(geometry.gap) == 0 ? terms * unit_roundoff * largest_displacement : point.tie_length;
}

namespace detail {

template <class T>
Vec<T, 2> point2(const Points<T>& points, int node) {
  return {points(0, node), points(1, node)};
}

/// Law of a body: that of its material, or that of bars made of it.
template <class T>
Law<T> make_law(const Scene& scene, const Body& body, const Mesh& mesh, const Numbers<T>& numbers) {
  return std::visit(
      [&]<class M>(const M& material) -> Law<T> {
        if constexpr (HoldsPoint<M>) {
          return law_of<T>(material, numbers);
        } else {
          if constexpr (FillsBars<M>)
            if (mesh.shape == ElementShape::bar2) {
              const BarLaw<T> bar{numbers(material.E) * numbers(body.area), numbers(body.area), scene.finite_strain};
              return bar_of<T>(material, bar, numbers);
            }
          return law_of<T>(material, scene.space, scene.finite_strain, numbers);
        }
      },
      body.material);
}

/// Cross-section of bars, area.
template <class T>
T area_of(const Law<T>& bars) {
  if (const auto* plastic = std::get_if<PlasticBarLaw<T>>(&bars)) return plastic->elastic.area;
  return std::get<BarLaw<T>>(bars).area;
}

template <class T>
T tributary_area(const ContactPoint& point, const Slots<T>& slots) {
  if (point.area_of_bar) return area_of(slots.laws[point.slave_body]);
  if (point.area_edges.empty()) return T(1);
  T area{};
  for (const auto& edge : point.area_edges) {
    const auto shares = edge_shares(slots.points, edge, slots.depths[point.slave_body]);
    for (std::size_t a = 0; a < edge.size(); ++a)
      if (edge[a] == point.nodes[0]) area += shares[a];
  }
  return area;
}

/// Initial area of a point, whether all of it faces the master or not. pre: present geometry, or the point is not
/// segment-integrated.
template <class T>
T whole_area(const ContactPoint& point, const Slots<T>& slots) {
  if (point.segments.empty()) return tributary_area(point, slots);
  return area_of_facets<T>(
      point.segments, [&](int node) { return point2(slots.points, node); }, slots.depths[point.slave_body]);
}

/// Initial position of a node, or of a vertex of the polyline that is an obstacle (core/contact/segment.hpp).
template <class T>
Vec<T, 2> start_of(const Model& model, int obstacle, const Slots<T>& slots, int node) {
  if (node < model.node_count) return point2(slots.points, node);
  const auto& x = std::get<Polyline>(model.scene.obstacles[obstacle].shape).points[node - model.node_count];
  return {slots.numbers(x[0]), slots.numbers(x[1])};
}

/// Slots::arcs of a curve.
template <class T>
Vector<T> arcs_of(const Model& model, const MasterCurve& curve, const Slots<T>& slots) {
  if (!curve.is_integrated()) return {};
  Vector<T> arcs(static_cast<Eigen::Index>(curve.facets.size()) + 1);
  arcs[0] = T(0);
  for (std::size_t f = 0; f < curve.facets.size(); ++f) {
    const auto end = [&](int k) { return start_of(model, curve.obstacle, slots, curve.facets[f][k]); };
    arcs[f + 1] = arcs[f] + norm(Vec<T, 2>(end(1) - end(0)));
  }
  return arcs;
}

/// The facet of an integrated curve from which the arc lengths of a point are measured.
inline int facet_of_arcs(const ContactPoint& point) { return std::max(point.facing.patch, 0); }

/// Where a point is along its integrated curve at the start, from the beginning of facet_of_arcs(): that facet's line
/// at its slave node. Arc lengths are measured from there, so that those of small motions are small.
template <class T>
double origin_of_arcs(const Model& model, const ContactPoint& point, const Slots<T>& slots) {
  const auto& curve = model.curves[point.curve];
  const auto& facet = curve.facets[facet_of_arcs(point)];
  const auto place = [&](int node) -> Vec<double, 2> { return values(start_of(model, curve.obstacle, slots, node)); };
  const Vec<double, 2> c = place(facet[0]), tau = place(facet[1]) - c;
  return (place(point.nodes[0]) - c).dot(tau) / tau.norm();
}

/// Initial arc length along an integrated curve from the beginning of facet_of_arcs() to that of a facet. `first`: a
/// facet near it; on a closed curve the way to `first` is the shorter one.
template <class T>
T arc_to(const Model& model, const ContactPoint& point, const Slots<T>& slots, int first, int facet) {
  const auto& curve = model.curves[point.curve];
  const Vector<T>& arcs = slots.arcs[point.curve];
  const int count = static_cast<int>(curve.facets.size()), origin = facet_of_arcs(point);
  const bool loop = curve.patches.back().next == 0;
  const auto way = [&](int from, int to) {
    const bool is_longer = loop && 2 * std::abs(to - from) > count;
    return to - from + (!is_longer ? 0 : to < from ? count : -count);
  };
  const int turns = (origin + way(origin, first) + way(first, facet) - facet) / count;
  const T arc = arcs[facet] - arcs[origin];
  return turns == 0 ? arc : T(arc + T(static_cast<double>(turns)) * arcs[count]);
}

/// Kinematics of a segment-integrated point, in the scalar U built on T. `facing`: its segments, not read against an
/// obstacle; `at(node)`: Placed, on an obstacle in its frame; `numbers`: of the scene.
template <class U, class T, class At, class Read>
SegmentKinematics<U> integrated_kinematics(const Model& model, const ContactPoint& point, const Slots<T>& slots,
                                           const Facing& facing, At&& at, const Read& numbers) {
  const bool along_curve = point.curve >= 0;
  const auto rigid_foot = [&](const Vec<U, 2>& X, const Vec<U, 2>& u) {
    const auto g = against_rigid<U>(X, u, model.scene.obstacles[point.obstacle].shape, numbers);
    Foot<U> foot;
    for (int i = 0; i < 2; ++i) {
      foot.normal[i] = g.normal[i];
      foot.off[i] = g.gap * g.normal[i];
      foot.moved[i] = u[i] - foot.off[i];
    }
    return foot;
  };
  const double origin = along_curve ? origin_of_arcs(model, point, slots) : 0;
  const auto begin = [&](int facet) {
    return along_curve ? T(arc_to(model, point, slots, facing.patch, facet) - T(origin)) : T(0);
  };
  const auto& depth = slots.depths[point.slave_body];
  return segment_kinematics<U, T>(along_curve ? facing.pieces : point.segments,
                                  along_curve ? facing.nodes : point.nodes, at,
                                  Depth<U>{depth.of_revolution, U(depth.thickness)}, rigid_foot, begin, !along_curve);
}

/// Kinematics of a segment-integrated point at the start. pre: it faces its master.
template <class T>
SegmentKinematics<T> initial_kinematics(const Model& model, const ContactPoint& point, const Slots<T>& slots) {
  const auto at = [&](int node) { return at_start<T>(start_of(model, point.obstacle, slots, node)); };
  return integrated_kinematics<T>(model, point, slots, point.facing, at, slots.numbers);
}

/// Position of vertex k of ContactPoint::of_polyline.
template <class T>
Vec<T, 2> polyline_vertex(const Model& model, const ContactPoint& point, int k, const Numbers<T>& numbers) {
  const auto& x = std::get<Polyline>(model.scene.obstacles[point.obstacle].shape).points[point.of_polyline[k]];
  return {numbers(x[0]), numbers(x[1])};
}

template <class T>
PointGeometry<T> against_polyline(const Model& model, const ContactPoint& point, const Slots<T>& slots) {
  const Vec<T, 2> x = point2(slots.points, point.nodes[0]);
  auto vertex = [&](int k) { return polyline_vertex(model, point, k, slots.numbers); };
  if (point.master == ContactPoint::Master::facet) return against_facet<T>(x, vertex(0), vertex(1));
  return against_vertex<T>(x, vertex(0), vertex(1), vertex(2));
}

/// Initial position of a vertex of a curve.
template <class T>
Vec<T, 2> vertex_of_start(const Model& model, const MasterCurve& curve, const Slots<T>& slots, int vertex) {
  if (curve.obstacle < 0) return point2(slots.points, curve.nodes[vertex]);
  return start_of(model, curve.obstacle, slots, model.node_count + vertex);
}

/// Coordinate on a patch from which the foot of a point is measured: that of its foot at the start, and on the patch
/// before this one its end. So a small motion makes a small difference, also across a vertex.
inline double foot_reference(const Model& model, const ContactPoint& point, int patch) {
  const Facing& start = point.facing;
  if (patch == start.patch) return start.xi;
  return start.patch != Patch::none && model.curves[point.curve].patches[start.patch].previous == patch ? 1 : 0;
}

/// Foot of a point on its curve at the start. pre: it faces the curve.
template <class T>
CurveFoot<T> foot_of_start(const Model& model, const ContactPoint& point, const Slots<T>& slots) {
  const auto& curve = model.curves[point.curve];
  const auto place = [&](int vertex) { return vertex_of_start(model, curve, slots, vertex); };
  const Vec<T, 2> x = point2(slots.points, point.nodes[0]);
  return foot_on_patch<T>(curve.patches[point.facing.patch], point.facing.xi, x, place);
}

/// Placement along its curve of a point that faces nothing of it, as History::foot stores it: from there it slides in
/// the increment in which it comes to face the curve. It is the place of the patch `nearest` that is nearest to the
/// slave node; for a segment-integrated point past a free end, where such a point comes on. `x`: of the slave node;
/// `at(vertex)`: Placed; of a segment-integrated point `at(node)`.
template <class U, class T, class At>
U place_beside(const Model& model, const ContactPoint& point, const Slots<T>& slots, int nearest, const Placed<U, T>& x,
               At&& at) {
  const auto& curve = model.curves[point.curve];
  const auto& patch = curve.patches[nearest];
  if (!curve.is_integrated())
    return beside_facet<U, T>(x, at(patch.vertices[1]), at(patch.vertices[2])) -
           U(foot_reference(model, point, nearest));
  const auto of_start = [&](int node) { return start_of(model, point.obstacle, slots, node); };
  const auto& facet = curve.facets[nearest];
  const U xi = beside_facet<U, T>(x, at(facet[0]), at(facet[1]));
  const U place = U(arc_to(model, point, slots, nearest, nearest) - T(origin_of_arcs(model, point, slots))) +
                  xi * U(norm(Vec<T, 2>(of_start(facet[1]) - of_start(facet[0]))));
  if (value(xi) <= 0 && patch.previous == Patch::none)
    return place - U(way_outside_of_end<T>(point.segments, 1, of_start));
  if (value(xi) >= 1 && patch.next == Patch::none) return place + U(way_outside_of_end<T>(point.segments, 0, of_start));
  return place;
}

/// place_beside() of the start.
template <class T>
T place_beside_at_start(const Model& model, const ContactPoint& point, const Slots<T>& slots) {
  const auto& curve = model.curves[point.curve];
  const auto place = [&](int of) {
    return at_start<T>(curve.is_integrated() ? start_of(model, point.obstacle, slots, of)
                                             : vertex_of_start(model, curve, slots, of));
  };
  const auto x = at_start<T>(point2(slots.points, point.nodes[0]));
  return place_beside<T, T>(model, point, slots, point.facing.nearest, x, place);
}

/// Initial geometry of a point that faces nothing of its curve. The gap is its distance; the normal is opposite to the
/// normal of its own side. So it transmits no force.
template <class T>
PointGeometry<T> facing_nothing(const ContactPoint& point, const Slots<T>& slots) {
  decltype(PointGeometry<T>::normal) normal(2);
  normal << T(0), T(1);
  if (!point.area_facets.empty()) {
    const Vec<T, 2> outward = slave_normal(point.area_facets, slots.points);
    const T length = norm(outward);
    normal << -outward[0] / length, -outward[1] / length;
  }
  return alone<T>(T(point.facing.distance), normal, point.slave_nodes);
}

/// Initial geometry of a point against its curve.
template <class T>
PointGeometry<T> against_curve(const Model& model, const ContactPoint& point, const Slots<T>& slots) {
  if (point.facing.patch == Patch::none) return facing_nothing(point, slots);
  PointGeometry<T> geometry;
  const auto foot = foot_of_start(model, point, slots);
  const auto& curve = model.curves[point.curve];
  geometry.gap = foot.gap;
  geometry.normal = foot.normal;
  geometry.tangents = tangent_frame<T>(geometry.normal);
  geometry.weights = foot_weights(curve.patches[point.facing.patch], foot.weights, curve.obstacle >= 0);
  return geometry;
}

/// Displacement of the obstacle at the initial foot of point p per degree of rotation, length; zero if it does not
/// rotate. If the point is segment-integrated: at its mean foot.
template <class T>
Vector<T> spin(const Model& model, int p, const Slots<T>& slots) {
  const auto& point = model.points[p];
  const auto& geometry = slots.geometry[p];
  Vector<T> foot = Vector<T>::Constant(model.dimension, T(0));
  if (point.obstacle < 0 || !model.scene.obstacles[point.obstacle].rotate) return foot;
  const T gap = geometry.gap - slots.numbers(model.scene.contacts[point.contact].offset);
  const bool at_vertex = !point.of_polyline.empty() && point.master == ContactPoint::Master::vertex;
  for (int i = 0; i < model.dimension; ++i) {
    if (at_vertex) {
      foot[i] = polyline_vertex(model, point, 1, slots.numbers)[i];
      continue;
    }
    for (int n = 0; n < point.slave_nodes; ++n) foot[i] += geometry.weights[n] * slots.points(i, point.nodes[n]);
    foot[i] -= gap * geometry.normal[i];
  }
  return displacement_per_degree(*model.scene.obstacles[point.obstacle].rotate, foot, slots.numbers);
}

template <class T>
PointGeometry<T> initial_geometry(const Model& model, const ContactPoint& point, const Slots<T>& slots) {
  const auto& numbers = slots.numbers;
  PointGeometry<T> geometry;
  const bool integrated = point.master == ContactPoint::Master::segments;
  if (integrated && (point.curve < 0 || point.facing.patch != Patch::none)) {
    geometry = initial_kinematics(model, point, slots).geometry;
  } else if (integrated) {
    geometry = facing_nothing(point, slots);
  } else if (point.master == ContactPoint::Master::curve) {
    geometry = against_curve(model, point, slots);
  } else if (point.master == ContactPoint::Master::obstacle) {
    const Vector<T> x = slots.points.col(point.nodes[0]);
    geometry = against_rigid<T>(x, model.scene.obstacles[point.obstacle].shape, numbers);
  } else if (!point.of_polyline.empty()) {
    geometry = fixed(against_polyline(model, point, slots));
  } else if (point.master == ContactPoint::Master::facet) {
    geometry = against_facet<T>(point2(slots.points, point.nodes[0]), point2(slots.points, point.nodes[1]),
                                point2(slots.points, point.nodes[2]));
  } else {
    const Vec<T, 2> x = point2(slots.points, point.nodes[0]), v = point2(slots.points, point.nodes[1]);
    geometry =
        against_vertex<T>(x, point2(slots.points, point.neighbours[0]), v, point2(slots.points, point.neighbours[1]));
    for (std::size_t n = 2; n < point.nodes.size(); ++n)
      slide_off<T>(geometry, x, v, point2(slots.points, point.nodes[n]));
  }
  if (point.shares_normal) {
    share_normal(geometry, slave_normal(point.area_facets, slots.points));
    geometry.gap = T(0);
    for (std::size_t n = 0; n < point.nodes.size(); ++n)
      geometry.gap += geometry.weights[n] * dot(geometry.normal, point2(slots.points, point.nodes[n]));
  }
  geometry.gap += numbers(model.scene.contacts[point.contact].offset);
  if (!integrated || point.curve >= 0) geometry.area = whole_area(point, slots);
  return geometry;
}

}  // namespace detail

/// Motion of the bodies in an increment: displacements at its end, and the bodies' memory at its start
/// (History::bodies).
template <class T>
struct BodyMotion {
  const Vector<T>& displacement;  ///< all dofs, along the axes
  const Vector<T>& last_memory;
  double time = 0;  ///< at its end, for pressures that follow the sides
  const FlowBranches* branches = nullptr;
};

/// Memory of the bodies (History::bodies) at displacements of all dofs; empty if there is none. `before`: at the start
/// of the increment.
template <class T>
Vector<T> bulk_flow(const Model& model, const Slots<T>& slots, const Vector<T>& u, const Vector<T>& before,
                    const FlowBranches& branches = {});

/// Internal nodal forces of all bodies, all dofs. `u`: all dofs; `memory`: at u; `only`: elements to visit, per body;
/// nullptr: all.
template <class T>
Vector<T> bulk_forces(const Model& model, const Slots<T>& slots, const Vector<T>& u, const Vector<T>& memory,
                      const ElementLists* only = nullptr);

/// Nodal forces of Scene::loads[load] at history = 1, all dofs; zero for a pressure that follows its side.
template <class T>
Vector<T> load_vector(const Model& model, int load, const Slots<T>& slots);

/// Receives the nodes of an element and its tangent, node-major. It is a function and no template parameter, so that
/// elements of all shapes and laws are compiled once per scalar, and not once per caller.
template <class T>
using ElementSink = std::function<void(const std::vector<int>& nodes, const Eigen::Ref<const Matrix<T>>& K)>;

/// Calls sink(nodes, K) for each element of body b, or for those in `only`. `at`: motion at which the tangent is taken,
/// with its plastic flow (pre: T is double or complex); nullptr: tangent of the start, for bodies of constant tangent.
template <class T>
void for_each_element_tangent(const Model& model, const Slots<T>& slots, int b, const std::vector<int>* only,
                              const std::type_identity_t<ElementSink<T>>& sink, const BodyMotion<T>* at = nullptr);

/// The bodies' tangent at a motion times a vector, all dofs. `only`: as in bulk_forces().
template <class T>
Vector<T> bulk_tangent_times(const Model& model, const Slots<T>& slots, const BodyMotion<T>& at,
                             const Vector<T>& vector, const ElementLists* only = nullptr);

/// Strain energy of all bodies at displacements of all dofs with the memory there.
template <class T>
T bulk_energy(const Model& model, const Slots<T>& slots, const Vector<T>& u, const Vector<T>& memory);

/// Least FlowTrial::margin of a motion: distance of the nearest material point from the change between elastic and
/// plastic. Infinity if no body is plastic.
double yield_margin(const Model& model, const Slots<double>& slots, const BodyMotion<double>& at);

/// Whether each point of the bodies that remember flows at a motion, in the order of their memory.
std::vector<char> flowing_points(const Model& model, const Slots<double>& slots, const BodyMotion<double>& at);

/// Stretch of the thickness of plane stress at finite strain, and its derivatives by the displacements of the nodes of
/// an element, node-major.
template <class T>
struct ThicknessStretch {
  T value;
  Vector<T> by_motion;
};

/// The stretches at the points of the quadrature of an edge of body b. pre: its law remembers nothing.
template <class T>
std::vector<ThicknessStretch<T>> edge_stretches(const Model& model, const Slots<T>& slots, int b,
                                                const ElementEdge& edge, const Vector<T>& u);

/// Calls f(a, volume) at each point of body b with its equivalent plastic strain and volume (of a bar, length times
/// cross-section); nothing where it does not flow. `memory`: what bodies remember.
template <class T>
void for_each_plastic_strain(const Model& model, const Slots<T>& slots, int b, const Vector<T>& memory,
                             const std::type_identity_t<std::function<void(const T& a, const T& volume)>>& f);

/// Elements that displacements invert, body by body; none where the bodies' strains are small.
ElementLists inverted_elements(const Model& model, const Slots<double>& slots, const Vector<double>& u);

/// Nodal coordinates, D x nodes: of the generators, moved by the shape parameters.
template <class T>
Points<T> initial_points(const Model& model, const Numbers<T>& numbers);

/// All slots of a model in the scalar of `numbers`; `points`: initial_points, or variables in their place. `stiffness`:
/// k_i without derivatives, for what does not depend on rho; none: functions of the slots, like all else.
template <class T>
Slots<T> make_slots(const Model& model, const Numbers<T>& numbers, Points<T> points,
                    const std::vector<double>* stiffness = nullptr);
template <class T>
Slots<T> make_slots(const Model& model, const Numbers<T>& numbers);

}  // namespace stickslip

#include "core/model/bodies_impl.hpp"
#include "core/model/slots_impl.hpp"

namespace stickslip {

/// The templates that take most time to compile, in a scalar: STICKSLIP_SLOTS(extern, T) in a header,
/// STICKSLIP_SLOTS(, T) in one source.
#define STICKSLIP_SLOTS(EXTERN, T)                                                                             \
  EXTERN template Vector<T> bulk_forces(const Model&, const Slots<T>&, const Vector<T>&, const Vector<T>&,     \
                                        const ElementLists*);                                                  \
  EXTERN template Vector<T> bulk_flow(const Model&, const Slots<T>&, const Vector<T>&, const Vector<T>&,       \
                                      const FlowBranches&);                                                    \
  EXTERN template T bulk_energy(const Model&, const Slots<T>&, const Vector<T>&, const Vector<T>&);            \
  EXTERN template void for_each_plastic_strain(const Model&, const Slots<T>&, int, const Vector<T>&,           \
                                               const std::function<void(const T&, const T&)>&);                \
  EXTERN template void for_each_element_tangent(const Model&, const Slots<T>&, int, const std::vector<int>*,   \
                                                const ElementSink<T>&, const BodyMotion<T>*);                  \
  EXTERN template std::vector<ThicknessStretch<T>> edge_stretches(const Model&, const Slots<T>&, int,          \
                                                                  const ElementEdge&, const Vector<T>&);       \
  EXTERN template Vector<T> load_vector(const Model&, int, const Slots<T>&);                                   \
  EXTERN template Points<T> initial_points(const Model&, const Numbers<T>&);                                   \
  EXTERN template Slots<T> make_slots(const Model&, const Numbers<T>&, Points<T>, const std::vector<double>*); \
  EXTERN template Slots<T> make_slots(const Model&, const Numbers<T>&)

STICKSLIP_SLOTS(extern, double);

}  // namespace stickslip
