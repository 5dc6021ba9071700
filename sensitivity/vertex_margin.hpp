/// Distance of points that slide along facets from the vertices of these facets.
///
/// Two facets are separated by the line through their vertex v perpendicular to t + t', t and t' their unit tangents: a
/// point x faces the second facet if (x - v) . (t + t') > 0. On the line itself, derivatives are those with the facet
/// that x faces.
#pragma once

#include "core/model/slots.hpp"
#include "core/model/state.hpp"

namespace stickslip {

/// Whether a point slides along facets whose master has a vertex with a turn.
bool slides_along_facets(const Model& model);

/// Margin of segment integration at finite strain: least distance, along a slave facet and over its length, between an
/// end of the slave side and a master node with a kink. At such a node the master turns, or its two facets are
/// stretched differently. At margin 0 the integrals have two slopes; elsewhere one. Ends of the master are left out:
/// they have no kink within 1e-6. Infinity if there is no such pair. `time`: of the state.
double integration_margin(const Model& model, const Slots<double>& slots, const State<double>& state, double time);

/// Least distance of a closed point from a vertex, over the length of the facet that it faces, free ends left out; or
/// integration_margin(), if that is less. Infinity if no closed point slides along facets.
double vertex_margin(const Model& model, const Slots<double>& slots, const State<double>& state, double time);

/// Per contact: whether a point that is closed in `reached` is at a vertex of facets there, or was in `left`. Each of
/// the two facets leads to a solution of its own then, and rounding decides between them. At a vertex that stands out
/// of the solid this holds of a whole strip: the force N turns by the angle alpha between the facets, which takes the
/// node N alpha / k further, k its stiffness; on either facet it stays within so much of the vertex. Free ends and
/// facets in line are left out. Empty if there is no such point. `start`, `end`: times of `left` and `reached`;
/// `compliance`: per point, length^3 / force, of the tangential springs of a penalty, which take points off a vertex;
/// empty if there are none.
std::vector<char> contacts_at_vertices(const Model& model, const Slots<double>& slots, const State<double>& left,
                                       double start, const State<double>& reached, double end,
                                       const std::vector<double>& compliance);

}  // namespace stickslip
