/// Master curves of contacts: the facets of a side or of a polyline, in order, as patches.
#pragma once

#include <utility>
#include <vector>

#include "core/model/model.hpp"

namespace stickslip {

/// Vertices of a polyline, 2 x vertices, length.
Eigen::Matrix2Xd vertices_of(const Polyline& polyline, const Numbers<double>& numbers);

/// Facets of a polyline as vertex pairs, the solid on their left. A polyline has it on its right, so they are reversed.
std::vector<std::vector<int>> facets_of(const Polyline& polyline);

/// Master curve of the contact Scene::contacts[contact], and the initial positions of its vertices, 2 x vertices.
///
///   points    initial positions of the nodes, D x nodes, length
///   obstacle  the polyline in Scene::obstacles that is the master; -1: a side of a body is
///   facets    of this side, the two nodes of each; not read of a polyline
std::pair<MasterCurve, Eigen::Matrix2Xd> make_curve(const Model& model, const Points<double>& points, int contact,
                                                    int obstacle, std::vector<std::vector<int>> facets);

/// The same of segment-integrated contact at finite strain: with the nodes of the patches.
MasterCurve integrated_curve(const Model& model, const Points<double>& points, int contact, int obstacle,
                             const std::vector<std::vector<int>>& facets);

}  // namespace stickslip
