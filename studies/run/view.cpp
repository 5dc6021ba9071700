#include "studies/run/view.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "core/mesh/sides.hpp"
#include "core/model/element_nodes.hpp"
#include "studies/run/element_fields.hpp"

namespace stickslip {
namespace {

/// The mean outward normal of the slave sides; zero where nothing touches, or it cancels.
Vec<double, 3> mean_outward(const Problem& problem) {
  Vec<double, 3> sum = Vec<double, 3>::Zero();
  for (const auto& geometry : problem.slots.geometry) sum -= geometry.area * Vec<double, 3>(geometry.normal);
  return sum.norm() > 0 ? sum.normalized() : sum;
}

}  // namespace

std::optional<View> view_of(const Problem& problem) {
  const auto& bodies = problem.model.bodies;
  if (std::none_of(bodies.begin(), bodies.end(), [](const auto& body) { return is_solid(body.mesh.shape); })) return {};
  const Vec<double, 3> aslant(0.45, -0.7, 0.55), outward = mean_outward(problem), z(0, 0, 1), y(0, 1, 0);
  // along the sides in contact, then onto them
  const Vec<double, 3> beside = aslant - aslant.dot(outward) * outward;
  View view;
  view.toward = (outward.norm() > 0 ? Vec<double, 3>(beside.normalized() + 0.6 * outward) : aslant).normalized();
  const Vec<double, 3>& upright = std::abs(view.toward.dot(z)) < 0.95 ? z : y;
  view.right = upright.cross(view.toward).normalized();
  view.up = view.toward.cross(view.right);
  return view;
}

std::vector<Piece> pieces_of(const Problem& problem, const State<double>& state, const std::optional<View>& view) {
  const auto& model = problem.model;
  std::vector<Piece> pieces;
  int first = 0;
  for (int b = 0; b < static_cast<int>(model.bodies.size()); ++b) {
    const auto& body = model.bodies[b];
    if (view && is_solid(body.mesh.shape)) {
      for (auto& [element, nodes] : free_sides(body.mesh)) {
        for (int& node : nodes) node += body.first_node;
        pieces.push_back({b, first + element, std::move(nodes)});
      }
    } else {
      for (int e = 0; e < body.mesh.element_count(); ++e)
        pieces.push_back({b, first + e, detail::element_nodes(body, e)});
    }
    first += body.mesh.element_count();
  }
  if (!view) return pieces;
  const Matrix<double> places = problem.slots.points + nodal(model, state.displacement);
  const auto at = [&](int node) -> Vec<double, 3> { return places.col(node); };
  std::erase_if(pieces, [&](const Piece& piece) {
    const auto& n = piece.nodes;
    if (n.size() < 3) return false;
    const Vec<double, 3> outward = (at(n[1]) - at(n[0])).cross(at(n[2]) - at(n[0]));
    return outward.dot(view->toward) <= 0;
  });
  const auto depth = [&](const Piece& piece) {
    double sum = 0;
    for (const int node : piece.nodes) sum += view->toward.dot(at(node)) / static_cast<double>(piece.nodes.size());
    return sum;
  };
  std::stable_sort(pieces.begin(), pieces.end(), [&](const Piece& a, const Piece& b) { return depth(a) < depth(b); });
  return pieces;
}

}  // namespace stickslip
