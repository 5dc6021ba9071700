#include "core/model/slots.hpp"

#include "core/model/element_nodes.hpp"
#include "core/model/flow_points.hpp"
#include "core/model/slots_impl.hpp"
#include "core/model/with_law.hpp"

namespace stickslip {

ElementLists inverted_elements(const Model& model, const Slots<double>& slots, const Vector<double>& u) {
  ElementLists inverted(model.bodies.size());
  for (int b = 0; b < static_cast<int>(model.bodies.size()); ++b) {
    const auto& body = model.bodies[b];
    const auto continuum = [&]<class Shape, Kinematics kinematics, class L>(const L& law) {
      for (int e = 0; law.is_finite && e < body.mesh.element_count(); ++e) {
        const auto nodes = detail::element_nodes(body, e);
        const auto local = detail::gather_displacements<double, Shape>(u, nodes.data());
        bool positive = true;
        for_each_strain_in<double, Shape, kinematics>(
            law.is_finite, detail::gather_coordinates<double, Shape>(slots.points, nodes.data()), 1.0, local,
            [&](const auto& H, double) {
              positive &= !is_inverted(H);
              if constexpr (kinematics == Kinematics::plane && !Remembers<L>) positive &= law.stretch_across(H) > 0;
            });
        if (!positive) inverted[b].push_back(e);
      }
    };
    detail::with_law<double>(model, slots, b, continuum, []<int>(const auto&) {});
  }
  return inverted;
}

double yield_margin(const Model& model, const Slots<double>& slots, const BodyMotion<double>& at) {
  double least = std::numeric_limits<double>::infinity();
  for_each_flow_point<double>(model, slots, at, nullptr, [&](const FlowPoint<double>& point) {
    least = std::min(least, point.trial.margin(point.hardening));
  });
  return least;
}

std::vector<char> flowing_points(const Model& model, const Slots<double>& slots, const BodyMotion<double>& at) {
  std::vector<char> flow;
  for_each_flow_point<double>(model, slots, at, nullptr, [&](const FlowPoint<double>& point) {
    flow.push_back(point.trial.stress > point.hardening.bound(point.trial.before));
  });
  return flow;
}

STICKSLIP_SLOTS(, double);

}  // namespace stickslip
