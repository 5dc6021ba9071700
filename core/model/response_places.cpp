#include "core/model/response_places.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <optional>
#include <utility>

#include "core/mesh/shapes.hpp"

namespace stickslip {
namespace {

/// Shape function values at x of an element of a continuum, if it holds x (to rounding).
template <class Shape>
std::optional<std::vector<double>> weights_in(Shape, const Points<double>& points, const std::vector<int>& nodes,
                                              const Eigen::VectorXd& x) {
  constexpr double band = 1e-9;
  constexpr int D = Shape::dimension;
  const auto shape_at = [](const Vec<double, D>& xi) {
    if constexpr (D == 3)
      return Shape::at(xi[0], xi[1], xi[2], 1);
    else
      return Shape::at(xi[0], xi[1], 1);
  };
  Vec<double, D> xi = Vec<double, D>::Constant(Shape::is_simplex ? 1.0 / (D + 1) : 0);
  for (int iteration = 0; iteration < 20; ++iteration) {  // Newton for the natural coordinates
    const auto at = shape_at(xi);
    Vec<double, D> defect = -x;
    Mat<double, D> J = Mat<double, D>::Zero();
    for (std::size_t a = 0; a < nodes.size(); ++a) {
      defect += at.value[a] * points.col(nodes[a]);
      J += points.col(nodes[a]) * at.gradient.col(a).transpose();
    }
    const Vec<double, D> step = J.partialPivLu().solve(defect);
    xi -= step;
    if (!(xi.norm() < 1e3)) return std::nullopt;
    if (step.norm() < 1e-14) break;
  }
  const bool inside =
      Shape::is_simplex ? xi.minCoeff() > -band && xi.sum() < 1 + band : xi.cwiseAbs().maxCoeff() < 1 + band;
  if (!inside) return std::nullopt;
  const auto N = shape_at(xi).value;
  return std::vector<double>(N.data(), N.data() + N.size());
}

/// Shape function values at x of an element, if it holds x (to rounding).
std::optional<std::vector<double>> weights_at(ElementShape shape, const Points<double>& points,
                                              const std::vector<int>& nodes, const Eigen::VectorXd& x) {
  constexpr double band = 1e-9;
  if (shape == ElementShape::point) {
    if ((points.col(nodes[0]) - x).norm() > 0) return std::nullopt;
    return std::vector<double>{1, 0};
  }
  if (shape == ElementShape::bar2) {
    const Eigen::VectorXd a = points.col(nodes[0]), tau = points.col(nodes[1]) - a;
    const double s = (x - a).dot(tau) / tau.squaredNorm();
    if (s < -band || s > 1 + band || (x - a - s * tau).norm() > band * tau.norm()) return std::nullopt;
    return std::vector<double>{1 - s, s};
  }
  std::optional<std::vector<double>> weights;
  with_shape(shape, [&](auto kind) { weights = weights_in(kind, points, nodes, x); });
  return weights;
}

/// Nodes of an element, and their weights at a place in it.
struct WeightedNodes {
  std::vector<int> nodes;
  std::vector<double> weights;
};

/// The nodes of the first element of a body that holds x; none where no element does.
std::optional<WeightedNodes> find_in_body(const BodyMesh& body, const Points<double>& points,
                                          const Eigen::VectorXd& x) {
  const int count = nodes_of(body.mesh.shape);
  std::vector<int> nodes(count);
  Eigen::VectorXd low(x.size()), high(x.size());
  for (int e = 0; e < body.mesh.element_count(); ++e) {
    for (int a = 0; a < count; ++a) nodes[a] = body.first_node + body.mesh.connectivity[e * count + a];
    low.setConstant(INFINITY);
    high.setConstant(-INFINITY);
    for (const int node : nodes) {
      low = low.cwiseMin(points.col(node));
      high = high.cwiseMax(points.col(node));
    }
    const double slack = 1e-6 * (high - low).norm();
    if ((x.array() < low.array() - slack).any() || (x.array() > high.array() + slack).any()) continue;
    if (const auto weights = weights_at(body.mesh.shape, points, nodes, x)) return WeightedNodes{nodes, *weights};
  }
  return std::nullopt;
}

/// Finds a point x in the bodies of `place`, and leaves those that hold it. Throws ModelError if none does.
void locate_in_bodies(const Model& model, const Points<double>& points, const Eigen::VectorXd& x,
                      const Response& response, ResponsePlace& place) {
  for (int b : std::exchange(place.bodies, {})) {
    auto found = find_in_body(model.bodies[b], points, x);
    if (!found) continue;
    place.bodies.push_back(b);
    if (place.bodies.size() > 1) continue;
    place.nodes = std::move(found->nodes);
    place.weights = std::move(found->weights);
  }
  const std::string of_body = response.on.empty() ? "" : " of " + response.on;
  if (place.nodes.empty())
    throw ModelError("no element" + of_body + " holds the point of `at`", "/responses/" + response.name);
}

/// Leaves of the points of `place` the one that is nearest to x, the first of equals. Throws ModelError if it has none.
void locate_on_contact(const Model& model, const Points<double>& points, const Eigen::VectorXd& x,
                       const Response& response, ResponsePlace& place) {
  const auto distance = [&](int p) { return (points.col(model.points[p].nodes[0]) - x).norm(); };
  const auto nearest = std::min_element(place.points.begin(), place.points.end(),
                                        [&](int p, int q) { return distance(p) < distance(q); });
  if (nearest == place.points.end())
    throw ModelError("no slave node of the contact faces its master", "/responses/" + response.name);
  place.points = {*nearest};
}

}  // namespace

ResponsePlace place_of(const Model& model, const Points<double>& points, const Response& response) {
  using Kind = Response::Kind;
  const auto& scene = model.scene;
  ResponsePlace place;
  if (response.kind == Kind::strain_energy) return place;
  const bool at_point = !response.at.empty();
  const Eigen::VectorXd x = Eigen::VectorXd::NullaryExpr(static_cast<Eigen::Index>(response.at.size()),
                                                         [&](Eigen::Index i) { return response.at[i].value; });
  const bool of_side = response.kind == Kind::reaction || (response.kind == Kind::displacement && !at_point);
  if (of_side) {
    place.nodes = model.side(response.on).nodes;
  } else if (response.kind == Kind::displacement || response.kind == Kind::plastic_strain) {
    for (int b = 0; b < static_cast<int>(scene.bodies.size()); ++b)
      if (response.on.empty() || scene.bodies[b].name == response.on) place.bodies.push_back(b);
    if (at_point) locate_in_bodies(model, points, x, response, place);
  } else {
    for (int c = 0; c < static_cast<int>(scene.contacts.size()); ++c)
      if (scene.contacts[c].name == response.on || scene.contacts[c].group == response.on) place.contacts.push_back(c);
    const auto is_of = [&](int contact) {
      return std::find(place.contacts.begin(), place.contacts.end(), contact) != place.contacts.end();
    };
    for (int p = 0; p < static_cast<int>(model.points.size()); ++p)
      if (is_of(model.points[p].contact)) place.points.push_back(p);
    if (at_point) locate_on_contact(model, points, x, response, place);
  }
  return place;
}

ElementLists elements_at_reactions(const Model& model) {
  const auto& responses = model.scene.responses;
  const auto is_reaction = [](const Response& response) { return response.kind == Response::Kind::reaction; };
  if (std::none_of(responses.begin(), responses.end(), is_reaction)) return {};
  std::vector<char> wanted(model.node_count, 0);
  for (std::size_t i = 0; i < responses.size(); ++i)
    if (is_reaction(responses[i]))
      for (int node : model.response_places[i].nodes) wanted[node] = 1;
  ElementLists lists(model.bodies.size());
  for (std::size_t b = 0; b < lists.size(); ++b) {
    const auto& body = model.bodies[b];
    const int nodes = nodes_of(body.mesh.shape);
    for (int e = 0; e < body.mesh.element_count(); ++e) {
      const auto begin = body.mesh.connectivity.begin() + static_cast<std::ptrdiff_t>(e) * nodes;
      if (std::any_of(begin, begin + nodes, [&](int node) { return wanted[body.first_node + node] != 0; }))
        lists[b].push_back(e);
    }
  }
  return lists;
}

}  // namespace stickslip
