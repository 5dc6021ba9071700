/// How far points that slide along facets are from where these meet.
///
/// Two facets part at the line through their vertex v that halves their tangents t, t': a point x faces the second
/// where (x - v) . (t + t') > 0. Where that vanishes, derivatives are those with the facet that it faces.
#pragma once

#include "core/model/slots.hpp"
#include "core/model/state.hpp"

namespace stickslip {

/// Whether some point slides along facets, and there are vertices at which its master bends.
bool slides_along_facets(const Model& model);

/// Of segment integration at finite strain: the way of a node at which the master turns, or its facets are stretched
/// unlike one another, to an end of the slave side that touches it, over the length of the slave facet. Where that
/// vanishes, what the points integrate has two slopes, elsewhere one: an end of the master that passes by, which
/// carries no kink within 1e-6, aside. Infinity where there is none.
double integration_margin(const Model& model, const Slots<double>& slots, const State<double>& state);

/// The way of the nearest closed point to a vertex, over the length of the facet that it faces; free ends aside; or
/// integration_margin(). Infinity where no closed point slides along facets.
double vertex_margin(const Model& model, const Slots<double>& slots, const State<double>& state, double time);

}  // namespace stickslip
