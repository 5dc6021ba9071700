#include "studies/run/picture_json.hpp"

#include "core/model/element_nodes.hpp"
#include "core/model/positions.hpp"
#include "methods/stepping/checkpoints.hpp"
#include "studies/input/obstacle_kinds.hpp"
#include "studies/input/response_kinds.hpp"
#include "studies/run/contact_points.hpp"
#include "studies/run/element_fields.hpp"
#include "studies/run/fields.hpp"
#include "studies/run/obstacle_wires.hpp"
#include "studies/run/view.hpp"

namespace stickslip {
namespace {

using nlohmann::json;

json point_json(const Eigen::Ref<const Vector<double>>& x) {
  return json(std::vector<double>(x.data(), x.data() + x.size()));
}

json numbers_json(const std::vector<Number>& numbers) {
  json out = json::array();
  for (const auto& n : numbers) out.push_back(n.value);
  return out;
}

/// The shape at the start, and what it moved by until `time`: a displacement, and where it rotates an angle in degrees
/// about a center.
json obstacle_json(const Obstacle& obstacle, double time, bool finite, const Numbers<double>& numbers) {
  json shape = drawn(obstacle.shape, numbers);
  json moved = {{"by", {0.0, 0.0}}};
  for (const auto& [axis, table] : obstacle.move)
    if (axis < 'z') moved["by"][axis == 'x' ? 0 : 1] = evaluate(table, time, numbers);
  if (obstacle.rotate) {
    moved["degrees"] = evaluate(obstacle.rotate->angle, time, numbers);
    moved["center"] = numbers_json(obstacle.rotate->center);
    if (finite) moved["finite"] = true;
  }
  if (!obstacle.move.empty() || obstacle.rotate) shape.begin().value()["moved"] = moved;
  return shape;
}

/// What a picture is made of: the view, and what is seen in it.
struct Shown {
  std::optional<View> view;
  std::vector<Piece> pieces;

  /// A place or a displacement as it is drawn.
  json seen(const Eigen::Ref<const Vector<double>>& x) const {
    if (view) return point_json(view->seen(x));
    return point_json(x);
  }
};

/// Adds the lines of an obstacle in space. Where it only shifts at small strain, by how
/// much, so that it is enlarged as the bodies are.
void add_wires(const Problem& problem, const Obstacle& obstacle, double time, const Shown& shown, json& out) {
  const bool shifts = !problem.model.scene.finite_strain && !obstacle.rotate;
  const auto frame = detail::frame_of_obstacle<3>(obstacle, time, problem.slots.numbers);
  for (const auto& wire : wires_of(obstacle, problem.slots.numbers, problem.slots.points)) {
    json points = json::array();
    for (const Vec<double, 3>& X : wire)
      points.push_back(shown.seen(shifts ? X : Vec<double, 3>(X + frame.displacement(X))));
    out.push_back({{"wire", {{"points", points}}}});
    if (shifts) out.back()["wire"]["moved"] = {{"by", shown.seen(frame.displacement(wire[0]))}};
  }
}

/// Nodes of all bodies, what moved and stresses them, and their elements by nodes; of solid bodies their faces.
json bodies_json(const Problem& problem, const State<double>& state, const Shown& shown) {
  const auto& model = problem.model;
  json points = json::array(), displacement = json::array(), elements = json::array(), bodies = json::array(),
       mises = json::array(), names = json::array();
  const Matrix<double> u = nodal(model, state.displacement), stress = element_stress(problem, state);
  for (int node = 0; node < model.node_count; ++node) {
    points.push_back(shown.seen(problem.slots.points.col(node)));
    displacement.push_back(shown.seen(u.col(node)));
  }
  for (const auto& body : model.scene.bodies) names.push_back(body.name);
  for (const auto& piece : shown.pieces) {
    elements.push_back(piece.nodes);
    bodies.push_back(piece.body);
    mises.push_back(von_mises(stress.col(piece.element)));
  }
  json out = {{"points", points}, {"displacement", displacement}, {"elements", elements},
              {"bodies", bodies}, {"body_names", names},          {"von_mises", mises}};
  if (model.effects.plasticity) {
    const Matrix<double> strain = element_plastic_strain(problem, state);
    for (const auto& piece : shown.pieces) out["plastic_strain"].push_back(strain(0, piece.element));
  }
  return out;
}

/// Contact points where they have moved to, with their states and tractions.
json contact_json(const Problem& problem, const State<double>& state, const Shown& shown) {
  const auto& model = problem.model;
  const Matrix<double> u = nodal(model, state.displacement);
  json contact = json::array();
  for (int p = 0; p < static_cast<int>(model.points.size()); ++p) {
    const auto& point = model.points[p];
    const int node = point.nodes[0];
    const auto t = state.contact.traction.segment(point.multiplier + 1, point.tangents);
    const json place = shown.seen(problem.slots.points.col(node) + u.col(node));
    contact.push_back({{"name", model.scene.contacts[point.contact].name},
                       {"x", place[0]},
                       {"y", place[1]},
                       {"node", node},
                       {"state", state_name(point, state.contact.state[p])},
                       {"normal", state.contact.traction[point.multiplier]},
                       {"tangential", point.tangents == 1 ? t[0] : t.norm()}});
  }
  return contact;
}

/// The displacements, step by step, of points on springs and of their anchors; of many steps some, the last among them,
/// and none of those that an adjoint let go.
json paths_json(const CaseResult& result) {
  constexpr std::size_t most = 200;  // of a path: more than a picture shows
  const auto& model = result.problem->model;
  const auto steps = solved_steps(result);
  const std::size_t stride = (steps.size() + most - 1) / most;
  json paths = json::array();
  for (const auto& body : model.bodies) {
    const auto nodes = body.mesh.element_count() == 1 ? detail::element_nodes(body, 0) : std::vector<int>{};
    const auto place = [&](int node) { return result.problem->slots.points.col(node); };
    if (nodes.size() != 2 || place(nodes[0]) != place(nodes[1])) continue;
    for (const int node : nodes) {
      json displacement = json::array();
      for (std::size_t n = steps.empty() ? 0 : (steps.size() - 1) % stride; n < steps.size(); n += stride)
        if (const auto& state = steps[n].increment->state; is_whole(state))
          displacement.push_back(point_json(nodal(model, state.displacement).col(node)));
      paths.push_back({{"node", node}, {"displacement", displacement}});
    }
  }
  return paths;
}

}  // namespace

json picture_json(const CaseResult& result, int every) {
  if (result.steps.empty()) return nullptr;
  const auto& problem = *result.problem;
  const auto& scene = problem.model.scene;
  const auto solved = solved_steps(result);  // where there is none, the picture is of the start
  const State<double>& state = solved.empty() ? result.trajectory.initial : solved.back().increment->state;
  const double time = solved.empty() ? 0 : solved.back().increment->time;
  const auto view = view_of(problem);
  const Shown shown{view, pieces_of(problem, state, view)};
  json picture = bodies_json(problem, state, shown);
  picture["contact"] = contact_json(problem, state, shown);
  if (view) picture["aslant"] = true;
  if (json paths = paths_json(result); !paths.empty()) picture["paths"] = std::move(paths);
  if (scene.finite_strain) picture["finite"] = true;  // it is drawn at true scale
  const auto obstacles_at = [&](double t) {
    json out = json::array();
    for (const auto& obstacle : scene.obstacles)
      if (view)
        add_wires(problem, obstacle, t, shown, out);
      else
        out.push_back(obstacle_json(obstacle, t, scene.finite_strain, problem.slots.numbers));
    return out;
  };
  picture["obstacles"] = obstacles_at(time);
  if (every > 0)
    for (const auto& moment : kept_moments(result, every)) {
      const json bodies = bodies_json(problem, moment.state, shown);
      picture["frames"].push_back({{"step", moment.number},
                                   {"time", moment.time},
                                   {"displacement", bodies["displacement"]},
                                   {"von_mises", bodies["von_mises"]},
                                   {"contact", contact_json(problem, moment.state, shown)},
                                   {"obstacles", obstacles_at(moment.time)}});
      if (bodies.contains("plastic_strain")) picture["frames"].back()["plastic_strain"] = bodies["plastic_strain"];
    }
  picture["responses"] = json::object();
  for (const auto& response : scene.responses) picture["responses"][response.name] = name_of(response.kind);
  return picture;
}

}  // namespace stickslip
