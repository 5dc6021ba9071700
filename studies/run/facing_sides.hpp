/// Sides of bodies that face one another at the start: what to take where a contact names others.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "studies/run/case.hpp"

namespace stickslip {

/// Outward normal of a facet: in the plane as long as the facet, in space its area vector.
Vector<double> outward_normal(const Points<double>& points, const std::vector<int>& facet);

/// Sum of the normals of the facets around each node of a side, by node.
std::map<int, Vector<double>> outward_normals(const Points<double>& points, const SideSet& side);

/// "body.side" of all sides of a body that have facets, those with the fewest first.
std::vector<std::string> names_of_sides(const Model& model, int body);

/// Of the bodies of a contact the two sides, slave and master, that look at each other over the shortest distance at
/// the start. None if the master is an obstacle, or the bodies are one, are no continua or show no such sides.
std::optional<std::pair<std::string, std::string>> facing_sides(const Problem& problem, int contact);

}  // namespace stickslip
