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

/// The way of the nearest closed point to a vertex, over the length of the facet that it faces; free ends aside.
/// Infinity where no closed point slides along facets.
double vertex_margin(const Model& model, const Slots<double>& slots, const State<double>& state, double time);

}  // namespace stickslip
