/// Record of every iterate of a run, if RunOptions::trace asks for it.
#pragma once

#include <vector>

#include "core/model/contact_input.hpp"

namespace stickslip {

struct Iterate {
  double time = 0;            ///< end of the increment
  int solve = 0, number = 0;  ///< number of the equilibrium in the run, from 1; of the iterate in it, from 0
  IterationRecord record;
  std::vector<ContactState> state;             ///< per contact point, by classification
  Vector<double> multiplier, trial, traction;  ///< lambda, z and t, laid out as multipliers
  std::vector<char> flows;                     ///< of bodies that remember: whether each point flows
  bool in_sequence = false;  ///< the solution of one of the contact problems of methods/rescue/sequential.hpp
};

struct Trace {
  /// Largest number of contact points for which tractions are recorded.
  static constexpr std::size_t most_points = 4;
  std::vector<Iterate> iterates;

  /// `displacement`: all dofs, in the axes.
  template <class T>
  void take(const ContactInput<T>& input, const Vector<T>& displacement, const Vector<T>& multiplier,
            const ContactField<T>& field, const IterationRecord& record, int number) {
    const int solve = (iterates.empty() ? 0 : iterates.back().solve) + (number == 0 ? 1 : 0);
    iterates.push_back({input.time, solve, number, record, field.state});
    const Model& model = input.model;
    if constexpr (std::is_same_v<T, double>)
      if (model.memory_count > 0)
        iterates.back().flows = flowing_points(model, input.slots, {displacement, input.previous.bodies, input.time});
    if (model.points.size() > most_points) return;
    Iterate& now = iterates.back();
    now.multiplier = values(multiplier);
    now.traction = values(field.traction);
    now.trial = now.multiplier;
    for (int p = 0; p < static_cast<int>(model.points.size()); ++p) {
      const auto& point = model.points[p];
      now.trial[point.multiplier] += value(input.rho[p].normal) * value(field.gap[p]);
      for (int a = 0; a < point.tangents; ++a)
        now.trial[point.multiplier + 1 + a] +=
            value(input.rho[p].tangential) * value(field.slip[tangential_offset(model, p) + a]);
    }
  }
};

}  // namespace stickslip
