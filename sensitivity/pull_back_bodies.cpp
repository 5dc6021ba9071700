#include "sensitivity/pull_back_bodies.hpp"

namespace stickslip {
namespace {

/// The pairs (a, u) of one objective, a column an increment.
struct Pairs {
  Matrix<double> weights, motions;

  Pairs(const Backward& objective, Eigen::Index dofs) : weights(dofs, objective.weights.size()), motions(weights) {
    for (std::size_t n = 0; n < objective.weights.size(); ++n) {
      weights.col(n) = objective.weights[n];
      motions.col(n) = objective.motions[n];
    }
  }

  /// Sum over the increments of a u^T, over the dofs of an element.
  template <class Nodes>
  Matrix<double> share(const Nodes& nodes, int D) const {
    const auto rows = [&](const Matrix<double>& all) {
      Matrix<double> of_element(nodes.size() * D, all.cols());
      for (std::size_t n = 0; n < nodes.size(); ++n) of_element.middleRows(n * D, D) = all.middleRows(nodes[n] * D, D);
      return of_element;
    };
    return rows(weights) * rows(motions).transpose();
  }
};

/// The elements of a continuum.
template <class Shape, Kinematics kinematics>
void pull_back_continuum(const Model& model, const Slots<Reverse>& slots, int b, const std::vector<Pairs>& pairs,
                         std::vector<Backward>& objectives) {
  constexpr int coordinates = 2 * Shape::nodes;
  using Local = Dual<coordinates + 3>;  // and the law's two numbers, and the thickness
  const auto& body = model.bodies[b];
  const auto& law = std::get<LinearElasticLaw<Reverse>>(slots.laws[b]);
  const Reverse& thickness = slots.depths[b].thickness;
  const LinearElasticLaw<Local> local_law(Local::seed(law.lame.v, coordinates),
                                          Local::seed(law.shear.v, coordinates + 1));
  const Local local_thickness = Local::seed(thickness.v, coordinates + 2);
  const Mat<Local, 2, Shape::nodes> rest = Mat<Local, 2, Shape::nodes>::Constant(Local(0));
  std::array<int, Shape::nodes> nodes;
  std::array<int, coordinates + 3> entry;  // of the inputs, on the tape
  entry[coordinates] = law.lame.at;
  entry[coordinates + 1] = law.shear.at;
  entry[coordinates + 2] = thickness.at;
  for (int e = 0; e < body.mesh.element_count(); ++e) {
    Mat<Local, 2, Shape::nodes> X;
    for (int a = 0; a < Shape::nodes; ++a) {
      nodes[a] = body.first_node + body.mesh.connectivity[e * Shape::nodes + a];
      for (int i = 0; i < 2; ++i) {
        X(i, a) = Local::seed(slots.points(i, nodes[a]).v, 2 * a + i);
        entry[2 * a + i] = slots.points(i, nodes[a]).at;
      }
    }
    const auto K = element_tangent<Local, Shape, kinematics>(local_law, X, rest, local_thickness);
    for (std::size_t j = 0; j < objectives.size(); ++j) {
      const Matrix<double> share = pairs[j].share(nodes, 2);
      typename Local::Gradient derivative = Local::Gradient::Zero();
      for (Eigen::Index k = 0; k < share.size(); ++k) derivative += share.data()[k] * K.data()[k].d;
      for (std::size_t k = 0; k < entry.size(); ++k)
        if (entry[k] >= 0) objectives[j].by[entry[k]] += derivative[k];
    }
  }
}

/// Bars and springs.
void pull_back_lumped(const Model& model, const Slots<Reverse>& slots, int b, const std::vector<Pairs>& pairs,
                      Tape& tape, std::vector<Backward>& objectives) {
  const int start = tape.size();
  for_each_element_tangent(model, slots, b, nullptr, [&](const auto& nodes, const auto& K) {
    for (std::size_t j = 0; j < objectives.size(); ++j) {
      auto& by = objectives[j].by;
      by.resize(tape.size(), 0);
      const Matrix<double> share = pairs[j].share(nodes, model.dimension);
      for (Eigen::Index k = 0; k < share.size(); ++k)
        if (K.data()[k].at >= 0) by[K.data()[k].at] += share.data()[k];
      tape.pull_back(by, start);
      by.resize(start);
    }
    tape.rewind(start);
  });
}

}  // namespace

void pull_back_bodies(const Model& model, const Slots<Reverse>& slots, Tape& tape, std::vector<Backward>& objectives) {
  std::vector<Pairs> pairs;
  for (const auto& objective : objectives) pairs.emplace_back(objective, model.dof_count());
  for (int b = 0; b < static_cast<int>(model.bodies.size()); ++b) {
    if (!is_continuum(model.bodies[b].mesh.shape)) {
      pull_back_lumped(model, slots, b, pairs, tape, objectives);
      continue;
    }
    detail::with_element(model.bodies[b], [&]<class Shape, Kinematics kinematics>() {
      pull_back_continuum<Shape, kinematics>(model, slots, b, pairs, objectives);
    });
  }
}

}  // namespace stickslip
