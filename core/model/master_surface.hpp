/// Master surfaces of contacts: the facets of a side or of an obstacle, in order, as patches.
#pragma once

#include <array>
#include <map>
#include <utility>
#include <vector>

#include "core/model/model.hpp"

namespace stickslip {

/// Master surface of the contact Scene::contacts[contact], and the initial positions of its vertices. Throws ModelError
/// if the facets are no surface.
///
///   points    initial positions of the nodes, D x nodes, length
///   obstacle  the master in Scene::obstacles, which has facets; -1: a side of a body is
///   facets    of this side, as make_surface() takes them; not read of an obstacle
template <int D>
std::pair<MasterSurface, Places<D>> make_master(const Model& model, const Points<double>& points, int contact,
                                                int obstacle, std::vector<std::vector<int>> facets);

/// The sides of quadratic elements that facets of a side are halves of (Segment::slave_edge).
class QuadraticEdges {
 public:
  explicit QuadraticEdges(const SideSet& side);
  /// Start, end and middle; Segment::none of a facet of a linear element.
  std::array<int, 3> of_facet(int a, int b) const;

 private:
  std::map<int, std::array<int, 3>> of_middle_;
};

/// The master curve of segment-integrated contact at finite strain: with the nodes of the patches, and with what the
/// nodes of a side in contact with itself may face. `master`: the side; not read of an obstacle.
MasterSurface integrated_curve(const Model& model, const Points<double>& points, int contact, int obstacle,
                               const SideSet& master);

}  // namespace stickslip
