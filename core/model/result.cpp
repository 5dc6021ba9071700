#include "core/model/result.hpp"

namespace stickslip {

std::string_view name_of(Status status) {
  switch (status) {
    case Status::converged:
      return "converged";
    case Status::converged_at_roundoff:
      return "converged_at_roundoff";
    case Status::cap:
      return "cap";
    case Status::cycle:
      return "cycle";
    case Status::stagnated:
      return "stagnated";
    case Status::infeasible:
      return "infeasible";
    case Status::no_equilibrium:
      return "no_equilibrium";
    case Status::inaccurate:
      return "inaccurate";
    case Status::singular:
      return "singular";
    case Status::inverted_element:
      return "inverted_element";
    case Status::not_finite:
      return "not_finite";
  }
  return "";
}

bool is_converged(Status status) { return status == Status::converged || status == Status::converged_at_roundoff; }

Counters& Counters::operator+=(const Counters& o) {
  assemblies += o.assemblies;
  factorizations += o.factorizations;
  analyses += o.analyses;
  backsolves += o.backsolves;
  sensitivity_backsolves += o.sensitivity_backsolves;
  sensitivity_factorizations += o.sensitivity_factorizations;
  newton += o.newton;
  augmentations += o.augmentations;
  cutbacks += o.cutbacks;
  contact_evaluations += o.contact_evaluations;
  return *this;
}

}  // namespace stickslip
