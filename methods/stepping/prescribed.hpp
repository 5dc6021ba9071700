/// What supports alone drive into one another, which no traction can prevent.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <string>

#include "core/engine/shared_forces.hpp"
#include "core/model/stencil.hpp"
#include "methods/stepping/words.hpp"

namespace stickslip {

/// Whether supports prescribe all displacements of a node.
inline bool is_prescribed(const Model& model, int node) {
  const auto first = model.free_index.begin() + node * model.dimension;
  return std::all_of(first, first + model.dimension, [](int index) { return index < 0; });
}

/// The contact point that violates its constraint the most while supports prescribe the motion of all its nodes, in
/// words of the scene; empty where there is none. With present geometry a node that is free in one direction may slide
/// off its master, and does not count.
template <class T>
std::string prescribed_penetration(const Model& model, const Slots<T>& slots, const State<T>& state) {
  constexpr double rounding = 1e-12;
  const bool moved = model.effects.current_geometry;
  const auto decided = decided_elsewhere(model, slots, moved ? &state.contact : nullptr);
  double worst = rounding * largest_nodal_norm(state.displacement, model.dimension);
  for (const auto& point : model.points) worst = std::max(worst, moved ? 10 * point.tie_length : 0);
  int found = -1;
  for (int p = 0; !decided.empty() && p < static_cast<int>(state.contact.gap.size()); ++p) {
    if (!decided[model.points[p].multiplier] || !(-value(state.contact.gap[p]) > worst)) continue;
    const auto nodes = nodes_in(model, state.contact, p);
    if (moved && !std::all_of(nodes.begin(), nodes.end(), [&](int node) { return is_prescribed(model, node); }))
      continue;
    worst = -value(state.contact.gap[p]);
    found = p;
  }
  if (found < 0) return "";
  return name_of_point(model, slots, found) + " penetrates by " + short_number(worst) +
         ", and supports prescribe its motion: no traction can prevent that";
}

/// Facets of a contact whose nodes are all prescribed, without repetition.
struct PrescribedFacets {
  std::vector<std::array<int, 2>> slave, master;
};

inline PrescribedFacets prescribed_facets(const Model& model, int contact) {
  PrescribedFacets facets;
  const auto take = [&](std::vector<std::array<int, 2>>& to, int a, int b) {
    if (!is_prescribed(model, a) || !is_prescribed(model, b)) return;
    if (std::find(to.begin(), to.end(), std::array{a, b}) == to.end()) to.push_back({a, b});
  };
  for (const auto& point : model.points)
    for (const auto& facet : point.area_facets)
      if (point.contact == contact && point.obstacle < 0) take(facets.slave, facet[0], facet[1]);
  for (const auto& curve : model.surfaces)
    if (curve.contact == contact && curve.obstacle < 0 && model.dimension == 2)
      for (const auto& patch : curve.patches<2>())
        take(facets.master, curve.nodes[patch.corner(0)], curve.nodes[patch.corner(1)]);
  return facets;
}

/// Two facets that supports move through one another, and how far.
struct Crossing {
  double overlap = 0;  ///< length; 0: no facets cross
  std::string words;   ///< of the scene
};

/// Of the pairs of facets that cross at a time the one that overlaps the most. With present geometry; at small strain
/// the points alone tell.
template <class T>
Crossing crossing_facets(const Model& model, const Slots<T>& slots, double time) {
  constexpr double rounding = 1e-9;  // of a facet
  if (!model.effects.current_geometry || !model.effects.deformable_master) return {};
  Vector<T> displacement = Vector<T>::Constant(model.dof_count(), T(0));
  prescribe(model, slots, time, displacement);
  const auto start = [&](int node) { return values(slots.points.col(node).template head<2>()); };
  const auto place = [&](int node) -> Vec<double, 2> {
    return start(node) + values(displacement.template segment<2>(2 * node));
  };
  const auto off = [](const Vec<double, 2>& x, const Vec<double, 2>& a, const Vec<double, 2>& b) {
    const Vec<double, 2> along = b - a, arm = x - a;
    return (along[0] * arm[1] - along[1] * arm[0]) / along.norm();
  };
  Crossing crossing;
  for (int c = 0; c < static_cast<int>(model.scene.contacts.size()); ++c) {
    const auto facets = prescribed_facets(model, c);
    for (const auto& [a, b] : facets.slave)
      for (const auto& [d, e] : facets.master) {
        if (a == d || a == e || b == d || b == e) continue;
        const auto A = place(a), B = place(b), D = place(d), E = place(e);
        const std::array<double, 4> distances{off(D, A, B), off(E, A, B), off(A, D, E), off(B, D, E)};
        if (distances[0] * distances[1] >= 0 || distances[2] * distances[3] >= 0) continue;
        double overlap = std::numeric_limits<double>::infinity();
        for (double x : distances) overlap = std::min(overlap, std::abs(x));
        if (overlap <= std::max(crossing.overlap, rounding * std::max((B - A).norm(), (E - D).norm()))) continue;
        crossing.overlap = overlap;
        const auto named = [&](int node) {
          return "(" + short_number(start(node)[0]) + ", " + short_number(start(node)[1]) + ")";
        };
        crossing.words = model.scene.contacts[c].name + ": the facets from " + named(a) + " to " + named(b) +
                         " and from " + named(d) + " to " + named(e) + " cross and overlap by " +
                         short_number(overlap) +
                         ", and supports prescribe the motion of both: no traction can prevent that";
      }
  }
  return crossing;
}

/// Whether supports move facets through one another between two times, or further.
template <class T>
bool cross_between(const Model& model, const Slots<T>& slots, double start, double end) {
  constexpr double rounding = 1e-6;
  const double crossed = crossing_facets(model, slots, end).overlap;
  return crossed > 0 && crossed > (1 + rounding) * crossing_facets(model, slots, start).overlap;
}

/// What supports alone push into one another, in words; empty if there is none. A point that penetrates counts if the
/// method prevents penetration; facets that cross always do.
template <class T>
std::string prescribed_overlap(const Model& model, const Slots<T>& slots, double time, bool prevents_penetration,
                               const State<T>& state) {
  if (prevents_penetration)
    if (std::string point = prescribed_penetration(model, slots, state); !point.empty()) return point;
  return crossing_facets(model, slots, time).words;
}

}  // namespace stickslip
