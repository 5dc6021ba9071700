#include "core/model/slots.hpp"

namespace stickslip {

ElementLists inverted_elements(const Model& model, const Slots<double>& slots, const Vector<double>& u) {
  ElementLists inverted(model.bodies.size());
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const auto& body = model.bodies[b];
    if (!std::holds_alternative<NeoHookeanLaw<double>>(slots.laws[b])) continue;
    for (int e = 0; e < body.mesh.element_count(); ++e) {
      const auto nodes = detail::element_nodes(body, e);
      with_shape(body.mesh.shape, [&]<class Shape>(Shape) {
        const auto local = detail::gather_displacements<double, Shape>(u, nodes.data());
        bool positive = true;
        for_each_gradient<double, Shape, Kinematics::plane>(
            detail::gather_coordinates<double, Shape>(slots.points, nodes.data()), 1.0, [&](const auto& gradient) {
              const Mat<double, 2> F = Mat<double, 2>::Identity() + gradient.of(local);
              positive &= F(0, 0) * F(1, 1) - F(0, 1) * F(1, 0) > 0;
            });
        if (!positive) inverted[b].push_back(e);
      });
    }
  }
  return inverted;
}

template Vector<double> bulk_forces(const Model&, const Slots<double>&, const Vector<double>&, const ElementLists*);
template Vector<double> load_vector(const Model&, const Load&, const Slots<double>&);
template Points<double> initial_points(const Model&, const Numbers<double>&);
template Slots<double> make_slots(const Model&, const Numbers<double>&, Points<double>);
template Slots<double> make_slots(const Model&, const Numbers<double>&);
template Vector<std::complex<double>> bulk_forces(const Model&, const Slots<std::complex<double>>&,
                                                  const Vector<std::complex<double>>&, const ElementLists*);
template Vector<std::complex<double>> load_vector(const Model&, const Load&, const Slots<std::complex<double>>&);
template Points<std::complex<double>> initial_points(const Model&, const Numbers<std::complex<double>>&);
template Slots<std::complex<double>> make_slots(const Model&, const Numbers<std::complex<double>>&,
                                                Points<std::complex<double>>);
template Slots<std::complex<double>> make_slots(const Model&, const Numbers<std::complex<double>>&);

}  // namespace stickslip
