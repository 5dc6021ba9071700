#include "core/model/master_surface.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "core/model/positions.hpp"

namespace stickslip {
namespace {

/// The facets of a side in contact with itself, or of a segment-integrated one, in order along the side. The order does
/// not depend on numbering. Longer chains of facets come first. A closed chain starts at the vertex farthest from its
/// mean vertex; among equally far ones at the one with least x, then least y.
std::vector<std::vector<int>> ordered_facets(const std::vector<std::vector<int>>& facets,
                                             const Points<double>& points) {
  std::map<int, int> starting;
  std::set<int> ends;
  for (std::size_t f = 0; f < facets.size(); ++f) {
    starting[facets[f][0]] = static_cast<int>(f);
    ends.insert(facets[f][1]);
  }
  struct Chain {
    double length = 0;
    std::vector<int> facets;
  };
  std::vector<Chain> chains;
  std::vector<char> taken(facets.size(), 0);
  const auto follow = [&](int f) {
    Chain chain;
    for (auto next = starting.find(facets[f][0]); next != starting.end() && !taken[next->second];
         next = starting.find(facets[chain.facets.back()][1])) {
      taken[next->second] = 1;
      chain.facets.push_back(next->second);
      chain.length += (points.col(facets[next->second][1]) - points.col(facets[next->second][0])).norm();
    }
    chains.push_back(std::move(chain));
  };
  for (std::size_t f = 0; f < facets.size(); ++f)
    if (ends.count(facets[f][0]) == 0) follow(static_cast<int>(f));
  for (std::size_t f = 0; f < facets.size(); ++f) {
    if (taken[f]) continue;
    follow(static_cast<int>(f));
    auto& loop = chains.back().facets;
    const auto place = [&](int facet) -> Vec<double, 2> { return points.col(facets[facet][0]).head<2>(); };
    Vec<double, 2> middle = Vec<double, 2>::Zero();
    for (int facet : loop) middle += place(facet) / static_cast<double>(loop.size());
    const double same = 1e-9 * chains.back().length;
    const auto comes_first = [&](int a, int b) {
      const double apart = (place(a) - middle).norm() - (place(b) - middle).norm();
      if (std::abs(apart) > same) return apart > 0;
      if (std::abs(place(a)[0] - place(b)[0]) > same) return place(a)[0] < place(b)[0];
      return place(a)[1] < place(b)[1];
    };
    std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end(), comes_first), loop.end());
  }
  std::stable_sort(chains.begin(), chains.end(),
                   [](const Chain& a, const Chain& b) { return a.length > b.length * (1 + 1e-9); });
  std::vector<std::vector<int>> ordered;
  for (const auto& chain : chains)
    for (int f : chain.facets) ordered.push_back(facets[f]);
  return ordered;
}

/// Sets what the vertices of a curve in contact with itself may face.
void set_own_vertices(const Eigen::Matrix2Xd& places, MasterSurface& curve) {
  const Surface<2>& patches = curve.patches<2>();
  for (const Patch<2>& patch : patches)
    for (int vertex : {patch.corner(0), patch.corner(1)}) {
      if (curve.own.count(curve.nodes[vertex]) > 0) continue;
      Vec<double, 2> outward = Vec<double, 2>::Zero();
      double size = 0;
      int count = 0;
      for (const Patch<2>& at : patches)
        if (at.corner(0) == vertex || at.corner(1) == vertex) {
          const Vec<double, 2> along = places.col(at.corner(1)) - places.col(at.corner(0));
          outward += Vec<double, 2>(along[1], -along[0]);
          size += along.norm();
          ++count;
        }
      curve.own.emplace(curve.nodes[vertex], own_vertex(patches, places, vertex, outward, size / count));
    }
}

/// Numbers the nodes of facets as vertices of a curve, in the order in which they come.
void number_vertices(std::vector<std::vector<int>>& facets, MasterSurface& curve) {
  std::map<int, int> number;
  for (auto& facet : facets)
    for (int& node : facet) {
      const auto [found, is_new] = number.emplace(node, static_cast<int>(number.size()));
      if (is_new) curve.nodes.push_back(node);
      node = found->second;
    }
}

/// Numbers the vertices of a side in space that touches itself in their order.
void order_vertices(const Points<double>& points, std::vector<std::vector<int>>& facets, MasterSurface& side) {
  const auto order = order_in_space(facets, points(Eigen::all, side.nodes));
  std::vector<int> number(order.size()), nodes(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    number[order[k]] = static_cast<int>(k);
    nodes[k] = side.nodes[order[k]];
  }
  side.nodes = std::move(nodes);
  for (auto& facet : facets)
    for (int& vertex : facet) vertex = number[vertex];
}

}  // namespace

QuadraticEdges::QuadraticEdges(const SideSet& side) {
  for (const auto& edge : side.edges)
    if (edge.size() == 3) of_middle_[edge[2]] = {edge[0], edge[1], edge[2]};
}

std::array<int, 3> QuadraticEdges::of_facet(int a, int b) const {
  for (int node : {a, b})
    if (const auto found = of_middle_.find(node); found != of_middle_.end()) return found->second;
  return Segment{}.slave_edge;
}

template <int D>
std::pair<MasterSurface, Places<D>> make_master(const Model& model, const Points<double>& points, int contact_index,
                                                int obstacle, std::vector<std::vector<int>> facets) {
  const Contact& contact = model.scene.contacts[contact_index];
  MasterSurface master;
  master.contact = contact_index;
  master.obstacle = obstacle;
  Places<D> places;
  if (obstacle >= 0) {
    const RigidSurface& shape = model.scene.obstacles[obstacle].shape;
    places = vertices_of(shape, model.scene.as<double>());
    facets = facets_of(shape);
    if constexpr (D == 2) {  // each begins where the one before ends
      if (contact.segment && std::holds_alternative<Polyline>(shape)) std::reverse(facets.begin(), facets.end());
      if (contact.segment && std::holds_alternative<MeshSide>(shape)) facets = ordered_facets(facets, places);
    }
  } else {
    if constexpr (D == 2)
      if (contact.is_of_itself() || contact.segment) facets = ordered_facets(facets, points);
    number_vertices(facets, master);
    if constexpr (D == 3)
      if (contact.is_of_itself()) order_vertices(points, facets, master);
    places.resize(D, static_cast<Eigen::Index>(master.nodes.size()));
    for (std::size_t v = 0; v < master.nodes.size(); ++v)
      places.col(static_cast<Eigen::Index>(v)) = points.col(master.nodes[v]).template head<D>();
  }
  master.vertex_count = static_cast<int>(places.cols());
  if constexpr (D == 3)
    if (contact.is_of_itself()) master.start = places;
  try {
    master.surface =
        std::make_shared<const Surface<D>>(make_surface<D>(facets, contact.smoothing, contact.corner, places));
  } catch (const std::runtime_error& error) {
    throw ModelError(contact.master + ": " + error.what(), "/contacts/" + contact.name + "/master");
  }
  return {std::move(master), std::move(places)};
}

template std::pair<MasterSurface, Places<2>> make_master<2>(const Model&, const Points<double>&, int, int,
                                                            std::vector<std::vector<int>>);
template std::pair<MasterSurface, Places<3>> make_master<3>(const Model&, const Points<double>&, int, int,
                                                            std::vector<std::vector<int>>);

MasterSurface integrated_curve(const Model& model, const Points<double>& points, int contact, int obstacle,
                               const SideSet& master) {
  auto [curve, places] = make_master<2>(model, points, contact, obstacle, master.facets);
  if (model.scene.contacts[contact].is_of_itself()) set_own_vertices(places, curve);
  const QuadraticEdges edges(master);
  const auto node_of = [&, &nodes = curve.nodes](int vertex) {
    return obstacle >= 0 ? model.node_count + vertex : nodes[vertex];
  };
  for (const auto& patch : curve.patches<2>()) {
    const int begin = node_of(patch.corner(0)), end = node_of(patch.corner(1));
    curve.facets.push_back({begin, end});
    curve.edges.push_back(edges.of_facet(begin, end));
    if (patch.across[0] == no_patch) curve.ends.push_back(begin);
    if (patch.across[1] == no_patch) curve.ends.push_back(end);
  }
  return curve;
}

}  // namespace stickslip
