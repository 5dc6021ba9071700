/// Why an increment found no solution, in words of the scene.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "core/algebra/symmetric_modes.hpp"
#include "core/contact/segment_facets.hpp"
#include "core/model/contact_assembly.hpp"
#include "core/model/loading.hpp"
#include "core/model/state.hpp"
#include "core/model/stencil.hpp"
#include "methods/rescue/statics.hpp"
#include "methods/stepping/free_bodies.hpp"
#include "methods/stepping/increment.hpp"
#include "methods/stepping/prescribed.hpp"

namespace stickslip {

namespace detail {

/// A joint of bars that they leave free to move across themselves, in words: "at (X, Y) is free to move along (x, y)";
/// empty if there is none. Not looked for in 3D, in bodies of more than 200 nodes, and where the body as a whole is
/// free. `at`, `states`: where the bodies are, and which contact points hold them. The bars' tension does not count.
///
/// The free motions are the null space of the sum of a a^T over the constraints a: the length of each bar, supports,
/// and closed contact points. The joint is the one that moves most in it.
template <class T>
std::string free_joint(const Model& model, const Slots<T>& slots, std::size_t b, const State<T>& at,
                       const std::vector<ContactState>& states) {
  constexpr int most_nodes = 200;
  constexpr double held = 1e-10, alike = 1e-6;
  const auto& mesh = model.bodies[b].mesh;
  const auto body = nodes_of_body(model, b);
  const int count = body.end - body.first;
  if (model.dimension != 2 || mesh.shape != ElementShape::bar2 || count > most_nodes ||
      !free_motion(model, slots, b, at, states).empty())
    return "";
  const auto X = [&](int node) { return Vec<double, 2>(values(slots.points.col(node)).template head<2>()); };
  const auto u = [&](int node) { return Vec<double, 2>(values(at.displacement.template segment<2>(2 * node))); };
  Matrix<double> squares = Matrix<double>::Zero(2 * count, 2 * count);
  for (int e = 0; e < mesh.element_count(); ++e) {
    const int i = mesh.connectivity[2 * e], j = mesh.connectivity[2 * e + 1];
    const Vec<double, 2> moved =
        model.effects.current_geometry ? Vec<double, 2>(u(body.first + j) - u(body.first + i)) : Vec<double, 2>(0, 0);
    const Vec<double, 2> axis = (X(body.first + j) - X(body.first + i) + moved).normalized();
    Vector<double> row = Vector<double>::Zero(2 * count);
    row.segment<2>(2 * i) = -axis;
    row.segment<2>(2 * j) = axis;
    squares += row * row.transpose();
  }
  const auto hold = [&](int node, const Vec<double, 2>& along) {
    if (body.has(node))
      squares.block<2, 2>(2 * (node - body.first), 2 * (node - body.first)) += along * along.transpose();
  };
  for (const auto& constraint : model.constraints) {
    const int node = constraint.dof / 2, framed = framed_index(model, node);
    const Vec<double, 2> axis = Vec<double, 2>::Unit(constraint.dof % 2);
    hold(node, framed < 0 ? axis : Vec<double, 2>(values(slots.frames[framed]).col(constraint.dof % 2)));
  }
  for (std::size_t p = 0; p < states.size(); ++p) {
    if (states[p] == ContactState::open) continue;
    const auto& geometry = geometry_in(at.contact, slots, p);
    for (const int node : nodes_in(model, at.contact, p)) {
      hold(node, values(geometry.normal));
      if (states[p] == ContactState::stick && model.points[p].tangents > 0)
        hold(node, values(geometry.tangents.col(0)));
    }
  }
  const SymmetricModes modes = symmetric_modes(squares);
  Eigen::Index free = 0;
  while (free < modes.values.size() && modes.values[free] < held) ++free;
  int joint = -1;
  double most = 0;
  for (int n = 0; free > 0 && n < count; ++n)
    if (const double size = modes.vectors.block(2 * n, 0, 2, free).norm(); size > (1 + alike) * most) {
      joint = n;
      most = size;
    }
  if (joint < 0) return "";
  const auto motion = modes.vectors.block(2 * joint, 0, 2, free);
  Vec<double, 2> along = symmetric_modes(motion * motion.transpose()).vectors.col(1);
  if (along[0] < -alike || (std::abs(along[0]) <= alike && along[1] < 0)) along = -along;
  return "at " + in_words(X(body.first + joint), X(body.first + joint).norm()) + " is free to move along " +
         in_words(along, 1);
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

/// The middle node of a side of a quadratic element that is pressed and folded; Segment::none if there is none. With
/// d of core/contact/segments.hpp the side runs back over itself before an end if 4 |d . (x_b - x_a)| >= |x_b - x_a|^2:
/// its middle node is then nearer to that end than a quarter of the way. What faces what there is not determined.
template <class T>
int folded_middle(const Model& model, const Slots<T>& slots, const State<T>& state) {
  const auto now = [&](int node) -> Placed<double> {
    return {values(slots.points.col(node)).template head<2>(),
            values(state.displacement.template segment<2>(2 * node))};
  };
  const auto is_folded = [&](const std::array<int, 3>& side) {
    const auto bulge = bulge_of<double, double>(side, now);
    if (!bulge.is_curved) return false;
    const Vec<double, 2> line = now(side[1]) - now(side[0]);
    return 4 * std::abs(bulge.now().dot(line)) >= line.squaredNorm();
  };
  for (std::size_t p = 0; model.slides_on_surfaces() && p < state.contact.facing.size(); ++p)
    for (const auto& segment : state.contact.facing[p].pieces)
      for (const auto& side : {segment.slave_edge, segment.master_edge})
        if (state.contact.state[p] != ContactState::open && is_folded(side)) return side[2];
  return Segment::none;
}

/// What folded_middle() finds, in words; empty if there is none.
template <class T>
std::string words_of_folded_side(const Model& model, const Slots<T>& slots, const State<T>& state) {
  const int node = folded_middle(model, slots, state);
  if (node == Segment::none) return "";
  std::size_t b = 0;
  while (!nodes_of_body(model, b).has(node)) ++b;
  const Vec<double, 2> at = values(slots.points.col(node)).template head<2>();
  return "a pressed side of " + model.scene.bodies[b].name + " is folded: its middle node, " + in_words(at, at.norm()) +
         " at the start, is nearer to one end than a quarter of the way; take more steps, a finer mesh there, a "
         "smaller motion, or elements with straight sides";
}

/// The body whose load no forces balance, and its free motion, in words; empty if there is none.
template <class T>
std::string words_of_imbalance(const Model& model, const Slots<T>& slots, double time, const State<T>& at) {
  const int b = unbalanced_body(model, slots, time);
  if (b < 0)
    return "bodies are free to move together: no forces that their contacts and supports can give balance their loads";
  const std::string name = model.scene.bodies[b].name, load = "no forces that its contacts can give balance its load";
  const bool supported = is_supported(model, b);
  if (!supported) return name + " is free to slide: no support holds it, and " + load;
  const std::string motion = free_motion(model, slots, b, at, at.contact.state);
  return name + " is free to move" + (motion.empty() ? "" : " " + motion) +
         ": neither its supports nor its contacts hold it, and " + load;
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
  for (const auto& words :
       {words_of_inversion(model, slots, failed.state), words_of_folded_side(model, slots, failed.state)})
    if (!words.empty()) {
      failed.status = Status::inverted_element;
      failed.message = words;
      return;
    }
  if (const std::string driven_in = prescribed_overlap(model, slots, time, prevents_penetration, failed.state);
      !driven_in.empty()) {
    failed.status = Status::infeasible;
    failed.message = driven_in;
    return;
  }
  if (const int p = contradicted_point(model, slots, failed.state.contact.gap); p >= 0) {
    failed.status = Status::infeasible;
    failed.message = name_of_point(model, slots, p) +
                     " has no place: the obstacles there overlap, and wherever it goes, it is inside of one of them";
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
    const auto body = nodes_of_body(model, b);
    const bool unstressed = model.effects.linear_bulk || largest_nodal_norm(failed.state.displacement, 2) == 0;
    const std::string joint = unstressed ? free_joint(model, slots, b, failed.state, states) : "";
    if (!joint.empty()) {
      failed.status = Status::no_equilibrium;
      failed.message = "the joint of " + model.scene.bodies[b].name + " " + joint +
                       ": its bars, supports and contacts bear no force across them there; support it" +
                       (model.effects.linear_bulk ? ", or take \"strain\": \"finite\", in which tension holds it" : "");
      return;
    }
    const bool supported = is_supported(model, b);
    if (supported) {
      const std::string motion = free_motion(model, slots, b, failed.state, states);
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
