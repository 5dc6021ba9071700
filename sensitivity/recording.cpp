#include "sensitivity/recording.hpp"

#include "core/model/slots_impl.hpp"

namespace stickslip {

Recording::Recording(const Model& model, const Slots<double>& values, bool reads_stiffness) : model_(model) {
  numbers_ = model.scene.as<Reverse>();
  for (const auto& parameter : model.scene.parameters)
    for (const auto& [slot, weight] : parameter.slots)
      if (numbers_.at_slot[slot].entry < 0) numbers_.at_slot[slot] = Reverse::leaf(numbers_.at_slot[slot].v, tape_);
  Numbers<Reverse> unshaped = numbers_;
  for (const auto& velocity : model.velocities) unshaped.at_slot[velocity.slot] = numbers_.at_slot[velocity.slot].v;
  made_ = initial_points(model, unshaped);
  points_ = made_;
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    auto of_body = points_.middleCols(model.bodies[b].first_node, model.bodies[b].mesh.node_count);
    const auto is_of_body = [&](const auto& velocity) { return velocity.body == static_cast<int>(b); };
    bool shaped = std::any_of(model.velocities.begin(), model.velocities.end(), is_of_body);
    for (const auto& x : of_body.reshaped()) shaped |= x.entry >= 0;
    if (!shaped) continue;
    for (auto& x : of_body.reshaped()) x = Reverse::leaf(x.v, tape_);
  }
  points_end_ = tape_.size();
  slots_ = make_slots(model, numbers_, points_, &values.stiffness);
  if (!reads_stiffness) return;
  for (const auto& block : nodal_stiffness(model, values))
    blocks_.push_back(block.unaryExpr([&](double k) { return Reverse::leaf(k, tape_); }));
  slots_.stiffness = contact_stiffness(model, slots_, blocks_);
}

/// Moves derivatives by the stiffness of contact nodes to coordinates and materials: each element's tangent is recorded
/// behind what the tape holds, and taken off again.
void Recording::pull_back_stiffness(std::vector<double>& by) {
  if (blocks_.empty()) return;
  const int end = tape_.size();
  detail::for_each_touching(model_, [&](int b, const std::vector<int>& touching, const std::vector<int>& place) {
    const auto pull_back = [&](const std::vector<int>& nodes, const Eigen::Ref<const Matrix<Reverse>>& K) {
      by.resize(tape_.size(), 0);
      detail::for_each_block_entry<Reverse>(model_.dimension, nodes, place, K,
                                            [&](int block, int i, int j, const Reverse& k) {
                                              if (k.entry >= 0) by[k.entry] += by[blocks_[block](i, j).entry];
                                            });
      tape_.pull_back(by, end);
      by.resize(end);
      tape_.rewind(end);
    };
    for_each_element_tangent(model_, slots_, b, &touching, std::ref(pull_back));
  });
}

Vector<double> Recording::by_numbers(std::vector<double>& by) {
  tape_.pull_back(by, points_end_);
  pull_back_stiffness(by);
  tape_.pull_back(by, points_end_);  // (materials are functions of numbers)
  const auto derivative = [&](const Reverse& x) { return x.entry >= 0 ? by[x.entry] : 0; };
  const Matrix<double> of_points = points_.unaryExpr(derivative);
  for (Eigen::Index i = 0; i < made_.size(); ++i)
    if (made_.data()[i].entry >= 0) by[made_.data()[i].entry] += of_points.data()[i];
  tape_.pull_back(by, 0);
  Vector<double> out(numbers_.at_slot.size());
  for (std::size_t i = 0; i < numbers_.at_slot.size(); ++i) out[i] = derivative(numbers_.at_slot[i]);
  const ShapeExtension* extension = nullptr;
  Matrix<double> of_given;  // by the motion of given nodes along each axis, for velocities that share the extension
  for (const auto& velocity : model_.velocities) {
    if (velocity.extension.get() != extension) {
      extension = velocity.extension.get();
      of_given.resize(model_.dimension, extension->given().size());
      for (int i = 0; i < model_.dimension; ++i)
        of_given.row(i) = extension->pull_back(
            of_points.row(i).segment(model_.bodies[velocity.body].first_node, of_given.cols()).transpose());
    }
    for (int node : velocity.moved)
      for (int i = 0; i < model_.dimension; ++i) out[velocity.slot] += velocity.direction[i] * of_given(i, node);
  }
  return out;
}

}  // namespace stickslip
