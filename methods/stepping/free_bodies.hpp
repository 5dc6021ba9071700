/// Bodies that their supports and contacts leave free to move.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "core/algebra/symmetric_modes.hpp"
#include "core/model/contact_assembly.hpp"
#include "core/model/frames.hpp"
#include "core/model/state.hpp"
#include "core/model/stencil.hpp"
#include "methods/stepping/words.hpp"

namespace stickslip {

/// Nodes of a body: first <= node < end.
struct NodeRange {
  int first, end;
  bool has(int node) const { return node >= first && node < end; }
};

inline NodeRange nodes_of_body(const Model& model, std::size_t b) {
  return {model.bodies[b].first_node, model.bodies[b].first_node + model.bodies[b].mesh.node_count};
}

/// Whether a support, or the axis of revolution, holds a node of a body.
inline bool is_supported(const Model& model, std::size_t b) {
  return std::any_of(
      model.constraints.begin(), model.constraints.end(),
      [&, body = nodes_of_body(model, b)](const Constraint& c) { return body.has(c.dof / model.dimension); });
}

namespace detail {

/// A place or a direction, in words: "(x, y)". What is 1e-6 of `unit` counts as 0.
inline std::string in_words(const Vec<double, 2>& x, double unit) {
  const auto number = [&](double of) { return short_number(std::abs(of) <= 1e-6 * unit ? 0 : of); };
  return "(" + number(x[0]) + ", " + number(x[1]) + ")";
}

}  // namespace detail

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
  nodal = into_frames(model, frames, NodalLayout::all, std::move(nodal));
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
  const SymmetricModes modes = symmetric_modes(squares);
  const Eigen::Vector3d least = modes.vectors.col(0);
  for (const Eigen::Vector3d& mode : {Eigen::Vector3d::Unit(0).eval(), Eigen::Vector3d::Unit(1).eval(), least}) {
    if ((squares * mode).norm() > held * std::max(1.0, modes.values[2])) continue;
    const Vec<double, 2> along = mode.head(2) * (mode[0] < 0 ? -1 : 1);
    if (std::abs(mode[2]) <= straight) return "along " + detail::in_words(along, 1);
    return "about " + detail::in_words(centre + Vec<double, 2>(-mode[1], mode[0]) * size / mode[2], size);
  }
  return "";
}

/// Bodies that their supports and closed contacts leave free to move.
struct FreeBodies {
  std::string words;           ///< the first of them and its motion; empty if there is none
  std::vector<char> floating;  ///< per body: it is free, and no contact presses on it; empty if there is none
  std::vector<char> movable;   ///< if one floats, per body: supports alone leave it free to move; else empty
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

/// States in which points that touch at the start are closed.
template <class T>
std::vector<ContactState> touching_states(const Model& model, const Slots<T>& slots, std::vector<ContactState> states) {
  for (std::size_t p = 0; p < states.size(); ++p)
    if (value(slots.geometry[p].gap) <= model.points[p].tie_length)
      states[p] = model.points[p].tangents > 0 ? ContactState::stick : ContactState::slip;
  return states;
}

/// The bodies that are free to move in the state that an increment starts from. `begins`: the run starts there; the
/// points that touch then count as closed.
template <class T>
FreeBodies free_bodies(const Model& model, const Slots<T>& slots, const State<T>& at, bool begins) {
  const auto states = begins ? touching_states(model, slots, at.contact.state) : at.contact.state;
  FreeBodies free;
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const std::string motion = free_motion(model, slots, b, at, states);
    if (motion.empty()) continue;
    if (free.words.empty())
      free.words = model.scene.bodies[b].name + " is free to move " + motion +
                   ": neither its supports nor the contacts that are closed hold it";
    if (is_pressed(model, slots, b, at)) continue;
    free.floating.resize(model.bodies.size());
    free.floating[b] = 1;
  }
  const std::vector<ContactState> open(model.points.size(), ContactState::open);
  for (std::size_t b = 0; b < free.floating.size(); ++b)
    free.movable.push_back(!free_motion(model, slots, b, at, open).empty());
  return free;
}

}  // namespace stickslip
