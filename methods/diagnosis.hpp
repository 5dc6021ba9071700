/// Why an increment found no solution, in words of the scene.
#pragma once

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <string>

#include "core/model/contact_assembly.hpp"
#include "core/model/loading.hpp"
#include "core/model/state.hpp"
#include "methods/increment.hpp"
#include "methods/statics.hpp"

namespace stickslip {

namespace detail {

/// Nodes of a body: first <= node < end.
struct NodeRange {
  int first, end;
  bool has(int node) const { return node >= first && node < end; }
};

inline NodeRange nodes_of_body(const Model& model, std::size_t b) {
  return {model.bodies[b].first_node, model.bodies[b].first_node + model.bodies[b].mesh.node_count};
}

/// Rigid motion of a body that its supports and its contact points, in these states, leave free: "along (0, 1)" or
/// "about (X, Y)"; empty if there is none. 2D only. `at`: where the bodies are. What the body touches counts as fixed.
template <class T>
std::string free_motion(const Model& model, const Slots<T>& slots, std::size_t b, const State<T>& at,
                        const std::vector<ContactState>& states) {
  constexpr double held = 1e-8, straight = 1e-6;
  if (model.dimension != 2 || model.bodies[b].mesh.shape == ElementShape::point) return "";
  const auto body = nodes_of_body(model, b);
  Matrix<double> points = slots.points.unaryExpr([](const T& x) { return value(x); });
  if (model.effects.current_geometry) points += values(at.displacement).reshaped(2, points.cols());
  const auto own = points.middleCols(body.first, body.end - body.first);
  const Vec<double, 2> low = own.rowwise().minCoeff(), high = own.rowwise().maxCoeff(), centre = (low + high) / 2;
  const double size = (high - low).norm();
  // Columns: translation along x, along y, rotation about the centre by 1 / size.
  const auto motions_at = [&](const Vec<double, 2>& x) {
    Eigen::Matrix<double, 2, 3> motions;
    motions << 1, 0, -(x[1] - centre[1]) / size, 0, 1, (x[0] - centre[0]) / size;
    return motions;
  };
  Matrix<double> nodal = Matrix<double>::Zero(model.dof_count(), 3);
  for (int node = body.first; node < body.end; ++node) nodal.middleRows(2 * node, 2) = motions_at(points.col(node));
  std::vector<Matrix<double>> frames;
  for (const auto& frame : slots.frames) frames.push_back(frame.unaryExpr([](const T& x) { return value(x); }));
  nodal = into_frames(model, frames, Layout::all, std::move(nodal));
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();  // sum of the constraints; its null space is the free motions
  const auto hold = [&](const Eigen::RowVector3d& row) { squares += row.transpose() * row; };
  if (model.scene.space == Space::axisymmetric) {  // a body of revolution moves rigidly along its axis only
    hold(Eigen::RowVector3d::Unit(0));
    hold(Eigen::RowVector3d::Unit(2));
  }
  for (int dof = 2 * body.first; dof < 2 * body.end; ++dof)
    if (model.free_index[dof] < 0) hold(nodal.row(dof));
  for (std::size_t p = 0; p < states.size(); ++p) {
    const auto& point = model.points[p];
    if (states[p] == ContactState::open || (!body.has(point.nodes[0]) && !body.has(master_node(model, point))))
      continue;
    const auto motions = motions_at(points.col(point.nodes[0]));
    const auto& geometry = geometry_in(at.contact, slots, p);
    hold(values(geometry.normal).transpose() * motions);
    if (states[p] == ContactState::stick && point.tangents > 0)
      hold(values(geometry.tangents.col(0)).transpose() * motions);
  }
  const auto in_words = [](const Vec<double, 2>& x, double unit) {
    const auto number = [&](double of) { return short_number(std::abs(of) <= straight * unit ? 0 : of); };
    return "(" + number(x[0]) + ", " + number(x[1]) + ")";
  };
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> modes(squares);
  const Eigen::Vector3d least = modes.eigenvectors().col(0);
  for (const Eigen::Vector3d& mode : {Eigen::Vector3d::Unit(0).eval(), Eigen::Vector3d::Unit(1).eval(), least}) {
    if ((squares * mode).norm() > held * std::max(1.0, modes.eigenvalues()[2])) continue;
    const Vec<double, 2> along = mode.head(2) * (mode[0] < 0 ? -1 : 1);
    if (std::abs(mode[2]) <= straight) return "along " + in_words(along, 1);
    return "about " + in_words(centre + Vec<double, 2>(-mode[1], mode[0]) * size / mode[2], size);
  }
  return "";
}

/// The first inverted element of a state, in words; empty if there is none.
template <class T>
std::string words_of_inversion(const Model& model, const Slots<T>& slots, const State<T>& state) {
  if constexpr (std::is_same_v<T, double>) {
    if (model.effects.linear_bulk) return "";
    const auto inverted = inverted_elements(model, slots, state.displacement);
    for (std::size_t b = 0; b < inverted.size(); ++b)
      if (!inverted[b].empty())
        return "element " + std::to_string(inverted[b].front()) + " of " + model.scene.bodies[b].name +
               " is inverted (" + std::to_string(inverted[b].size()) +
               " of them are); take more steps, a finer mesh there, or a smaller motion";
  }
  return "";
}

/// The body whose load no forces balance, and its free motion, in words; empty if there is none.
template <class T>
std::string words_of_imbalance(const Model& model, const Slots<T>& slots, double time, const State<T>& at) {
  const int b = unbalanced_body(model, slots, time);
  if (b < 0)
    return "bodies are free to move together: no forces that their contacts and supports can give balance their loads";
  const auto body = nodes_of_body(model, b);
  const std::string name = model.scene.bodies[b].name, load = "no forces that its contacts can give balance its load";
  const bool supported = std::any_of(model.constraints.begin(), model.constraints.end(),
                                     [&](const Constraint& c) { return body.has(c.dof / model.dimension); });
  if (!supported) return name + " is free to slide: no support holds it, and " + load;
  const std::string motion = free_motion(model, slots, b, at, at.contact.state);
  return name + " is free to move" + (motion.empty() ? "" : " " + motion) +
         ": neither its supports nor its contacts hold it, and " + load;
}

/// A body that its supports and closed contacts leave free to move.
struct FreeBody {
  std::string words;     ///< the body and its motion; empty if there is none
  bool pressed = false;  ///< some contact presses on it
};

/// Whether a contact presses on a body. Tractions that are rounding of the displacements do not count.
template <class T>
bool is_pressed(const Model& model, const Slots<T>& slots, std::size_t b, const State<T>& at) {
  constexpr double telling = 1e-9;  // more than half of the digits are left
  const double reach = telling * largest_nodal_norm(at.displacement, model.dimension);
  const auto body = nodes_of_body(model, b);
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    const auto nodes = nodes_in(model, at.contact, p);
    const double compliance = value(slots.geometry[p].area) / value(slots.stiffness[p]);
    if (-value(at.contact.traction[model.points[p].multiplier]) * compliance > reach &&
        std::any_of(nodes.begin(), nodes.end(), [&](int node) { return body.has(node); }))
      return true;
  }
  return false;
}

/// The first body that is free to move in the state that an increment starts from. `begins`: the run starts there; the
/// points that touch then count as closed.
template <class T>
FreeBody free_body(const Model& model, const Slots<T>& slots, const State<T>& at, bool begins) {
  auto states = at.contact.state;
  for (std::size_t p = 0; begins && p < states.size(); ++p)
    if (value(slots.geometry[p].gap) <= model.points[p].tie_length)
      states[p] = model.points[p].tangents > 0 ? ContactState::stick : ContactState::slip;
  for (std::size_t b = 0; b < model.bodies.size(); ++b)
    if (const std::string motion = free_motion(model, slots, b, at, states); !motion.empty())
      return {model.scene.bodies[b].name + " is free to move " + motion +
                  ": neither its supports nor the contacts that are closed hold it",
              is_pressed(model, slots, b, at)};
  return {};
}

/// A body that flows plastically in a state, in words; empty if there is none.
template <class T>
std::string words_of_flow(const Model& model, const Slots<T>& slots, const State<T>& state) {
  for (int b = 0; b < static_cast<int>(model.bodies.size()); ++b) {
    bool flows = false;
    for_each_plastic_strain(model, slots, b, state.history.bodies,
                            [&](const T& strain, const T&) { flows |= value(strain) > 0; });
    if (flows)
      return model.scene.bodies[b].name +
             " flows: its loads may be more than it bears; control a displacement, give it hardening, or take more "
             "steps";
  }
  return "";
}

/// Cause of a failure that supports explain, in words; empty if they do not. Either supports push what touches into one
/// another, as prescribed_overlap() says. Or the tangent is singular because a body can move: it has no
/// support and no contact point sticks, or its supports leave a motion free.
template <class T>
void name_failure(const Model& model, const Slots<T>& slots, double time, bool prevents_penetration,
                  Increment<T>& failed) {
  if (const std::string inverted = detail::words_of_inversion(model, slots, failed.state); !inverted.empty()) {
    failed.status = Status::inverted_element;
    failed.message = inverted;
    return;
  }
  if (const std::string driven_in = prescribed_overlap(model, slots, time, prevents_penetration, failed.state);
      !driven_in.empty()) {
    failed.status = Status::infeasible;
    failed.message = driven_in;
    return;
  }
  if (failed.status == Status::no_equilibrium) {
    if (unbalanced_body(model, slots, time) != balanced)
      failed.message = detail::words_of_imbalance(model, slots, time, failed.state);
    return;
  }
  if (failed.status != Status::singular) return;
  const auto& states = failed.state.contact.state;
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const auto body = detail::nodes_of_body(model, b);
    const bool supported = std::any_of(model.constraints.begin(), model.constraints.end(),
                                       [&](const Constraint& c) { return body.has(c.dof / model.dimension); });
    if (supported) {
      const std::string motion = detail::free_motion(model, slots, b, failed.state, states);
      if (motion.empty()) continue;
      failed.message = model.scene.bodies[b].name + " is free to move " + motion +
                       ": neither its supports nor its closed contacts hold it there (" + failed.message + ")";
      return;
    }
    bool sticks = false;
    for (std::size_t p = 0; p < states.size(); ++p)
      sticks |=
          states[p] == ContactState::stick && std::any_of(model.points[p].nodes.begin(), model.points[p].nodes.end(),
                                                          [&](int node) { return body.has(node); });
    if (sticks) continue;
    failed.message = model.scene.bodies[b].name +
                     " is free to slide: no support holds it, and none of its contact points sticks (" +
                     failed.message + ")";
    return;
  }
}

}  // namespace detail

/// Appends the cause of a failure to the message of an increment.
template <class T>
void diagnose(const Model& model, const Slots<T>& slots, double time, bool prevents_penetration, Increment<T>& failed) {
  detail::name_failure(model, slots, time, prevents_penetration, failed);
  const bool may_collapse =
      failed.status == Status::singular || failed.status == Status::stagnated || failed.status == Status::not_finite;
  if (!model.effects.plasticity || !may_collapse) return;
  if (const std::string flow = detail::words_of_flow(model, slots, failed.state); !flow.empty())
    failed.message += (failed.message.empty() ? "" : "; ") + flow;
}

}  // namespace stickslip
