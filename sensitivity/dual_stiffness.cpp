#include "sensitivity/dual_stiffness.hpp"

#include <array>
#include <stdexcept>

#include "core/model/element_nodes.hpp"

namespace stickslip {
namespace {

/// Numbers of dofs that an element has: of bars and continua, in the plane and in space.
using DofCounts = std::integer_sequence<int, 4, 6, 8, 12, 16, 24, 30, 60, 81>;

/// Calls f.operator()<count>() with the count that is n; false if there is none.
template <int... counts, class F>
bool call_with(std::integer_sequence<int, counts...>, int n, F&& f) {
  return ((n == counts && (f.template operator()<counts>(), true)) || ...);
}

}  // namespace

DualStiffness::DualStiffness(const Model& model, const Slots<Direction>& slots, const ElementLists& lists)
    : turns_(!model.framed.empty()) {
  const auto add = [&](const std::vector<int>& nodes, const Eigen::Ref<const Matrix<Direction>>& K) {
    add_element(nodes, model.dimension, K);
  };
  for (std::size_t b = 0; b < lists.size(); ++b)
    if (!lists[b].empty()) for_each_element_tangent<Direction>(model, slots, static_cast<int>(b), &lists[b], add);
}

void DualStiffness::add_element(const std::vector<int>& nodes, int dimension,
                                const Eigen::Ref<const Matrix<Direction>>& K) {
  for (int node : nodes)
    for (int i = 0; i < dimension; ++i) dofs_.push_back(node * dimension + i);
  start_.push_back(static_cast<int>(dofs_.size()));
  for (Eigen::Index c = 0; c < K.cols(); ++c)
    for (Eigen::Index r = c; r < K.rows(); ++r) {
      const Direction entry = K(r, c);
      values_.push_back(entry.v);
      gradients_.insert(gradients_.end(), entry.d.begin(), entry.d.end());
    }
}

template <int count>
void DualStiffness::add_products(const int* dofs, const double* value, const double* gradient,
                                 const Vector<Direction>& u, Vector<Direction>& forces) const {
  using Gradient = Eigen::Map<const Direction::Gradient>;
  bool is_held = true;
  for (int k = 0; k < count; ++k) is_held &= is_constant(u[dofs[k]]);
  if (is_held && !turns_) {
    std::array<double, count> own;
    for (int k = 0; k < count; ++k) own[k] = u[dofs[k]].v;
    std::array<Direction::Gradient, count> force;
    force.fill(Direction::Gradient::Zero());
    for (int c = 0; c < count; ++c)
      for (int r = c; r < count; ++r, gradient += directions) {
        force[r] += Gradient(gradient) * own[c];
        if (r > c) force[c] += Gradient(gradient) * own[r];
      }
    for (int k = 0; k < count; ++k) forces[dofs[k]].d += force[k];
    return;
  }
  for (int c = 0; c < count; ++c)
    for (int r = c; r < count; ++r, ++value, gradient += directions) {
      const Direction entry(*value, Gradient(gradient));
      forces[dofs[r]] += entry * u[dofs[c]];
      if (r > c) forces[dofs[c]] += entry * u[dofs[r]];
    }
}

void DualStiffness::add_forces(const Vector<Direction>& u, Vector<Direction>& forces) const {
  std::size_t entry = 0;
  const auto add = [&]<int count>(std::size_t e) {
    add_products<count>(dofs_.data() + start_[e], values_.data() + entry, gradients_.data() + entry * directions, u,
                        forces);
    entry += count * (count + 1) / 2;
  };
  for (std::size_t e = 0; e + 1 < start_.size(); ++e)
    if (!call_with(DofCounts(), start_[e + 1] - start_[e], [&]<int count>() { add.template operator()<count>(e); }))
      throw std::logic_error("DualStiffness: an element of a number of dofs that is not known");
}

long DualStiffness::bytes() const {
  return static_cast<long>((dofs_.size() + start_.size()) * sizeof(int) +
                           (values_.size() + gradients_.size()) * sizeof(double));
}

long DualStiffness::bytes_of(const Model& model, const ElementLists& lists) {
  long bytes = sizeof(int);
  for (std::size_t b = 0; b < lists.size(); ++b) {
    if (lists[b].empty()) continue;
    const long dofs = static_cast<long>(detail::element_nodes(model.bodies[b], 0).size()) * model.dimension;
    const long entries = dofs * (dofs + 1) / 2;
    bytes +=
        static_cast<long>(lists[b].size() * ((dofs + 1) * sizeof(int) + entries * (1 + directions) * sizeof(double)));
  }
  return bytes;
}

}  // namespace stickslip
