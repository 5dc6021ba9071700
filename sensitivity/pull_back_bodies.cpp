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

/// The elements of a continuum whose forces are not linear in the displacements, increment by increment.
template <class Shape>
void pull_back_nonlinear(const Model& model, const Slots<Reverse>& slots, int b, std::vector<Backward>& objectives) {
  constexpr int coordinates = 2 * Shape::nodes;
  using Local = Dual<coordinates + 3>;  // and the law's two numbers, and the thickness
  const auto& body = model.bodies[b];
  const auto& law = std::get<NeoHookeanLaw<Reverse>>(slots.laws[b]);
  const Reverse& thickness = slots.depths[b].thickness;
  const auto local_law = law.with(Local::seed(law.lame.v, coordinates), Local::seed(law.shear.v, coordinates + 1));
  const Local local_thickness = Local::seed(thickness.v, coordinates + 2);
  for (int e = 0; e < body.mesh.element_count(); ++e) {
    const auto nodes = detail::element_nodes(body, e);
    Mat<Local, 2, Shape::nodes> X;
    for (int a = 0; a < Shape::nodes; ++a)
      for (int i = 0; i < 2; ++i) X(i, a) = Local::seed(slots.points(i, nodes[a]).v, 2 * a + i);
    for (auto& objective : objectives) {
      typename Local::Gradient derivative = Local::Gradient::Zero();
      for (std::size_t n = 0; n < objective.weights.size(); ++n) {
        Mat<Local, 2, Shape::nodes> u;
        for (int a = 0; a < Shape::nodes; ++a)
          for (int i = 0; i < 2; ++i) u(i, a) = Local(objective.motions[n][2 * nodes[a] + i]);
        const auto forces = element_forces<Local, Shape>(local_law, X, u, local_thickness);
        for (int a = 0; a < Shape::nodes; ++a)
          for (int i = 0; i < 2; ++i) derivative += objective.weights[n][2 * nodes[a] + i] * forces(i, a).d;
      }
      const auto add = [&](const Reverse& input, int k) {
        if (input.at >= 0) objective.by[input.at] += derivative[k];
      };
      for (int k = 0; k < coordinates; ++k) add(slots.points(k % 2, nodes[k / 2]), k);
      add(law.lame, coordinates);
      add(law.shear, coordinates + 1);
      add(thickness, coordinates + 2);
    }
  }
}

/// Bars of Green strain, increment by increment.
void pull_back_green_bars(const Model& model, const Slots<Reverse>& slots, int b, Tape& tape,
                          std::vector<Backward>& objectives) {
  const int start = tape.size(), D = model.dimension;
  const auto& body = model.bodies[b];
  for (int e = 0; e < body.mesh.element_count(); ++e) {
    const auto nodes = detail::element_nodes(body, e);
    for (auto& objective : objectives)
      for (std::size_t n = 0; n < objective.weights.size(); ++n) {
        with_dimension(D, [&]<int d>() {
          Vec<Reverse, d> stretch;
          for (int i = 0; i < d; ++i)
            stretch[i] = Reverse(objective.motions[n][nodes[1] * d + i] - objective.motions[n][nodes[0] * d + i]);
          const auto force = green_bar_force<Reverse, d>(detail::bar_coordinates<Reverse, d>(slots, nodes),
                                                         std::get<BarLaw<Reverse>>(slots.laws[b]).axial, stretch);
          objective.by.resize(tape.size(), 0);
          for (int i = 0; i < d; ++i)
            if (force[i].at >= 0)
              objective.by[force[i].at] +=
                  objective.weights[n][nodes[1] * d + i] - objective.weights[n][nodes[0] * d + i];
        });
        tape.pull_back(objective.by, start);
        objective.by.resize(start);
        tape.rewind(start);
      }
  }
}

/// Bars and springs of a constant stiffness.
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
    if (detail::is_green(slots.laws[b])) {
      pull_back_green_bars(model, slots, b, tape, objectives);
      continue;
    }
    if (!is_continuum(model.bodies[b].mesh.shape)) {
      pull_back_lumped(model, slots, b, pairs, tape, objectives);
      continue;
    }
    if (std::holds_alternative<NeoHookeanLaw<Reverse>>(slots.laws[b])) {
      with_shape(model.bodies[b].mesh.shape,
                 [&]<class Shape>(Shape) { pull_back_nonlinear<Shape>(model, slots, b, objectives); });
      continue;
    }
    detail::with_element(model.bodies[b], [&]<class Shape, Kinematics kinematics>() {
      pull_back_continuum<Shape, kinematics>(model, slots, b, pairs, objectives);
    });
  }
}

}  // namespace stickslip
