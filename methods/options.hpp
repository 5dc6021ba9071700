/// Options of the methods, with their defaults, meaning and range. One struct a method; `Method` is the closed set.
///
/// Each says its name; the option that rho is made from (regularisation), with its name and the multiple of the local
/// stiffness that "auto" stands for (automatic_multiple); and whether multipliers are unknowns of the systems solved.
#pragma once

#include <optional>
#include <string_view>
#include <variant>

#include "core/model/scene.hpp"

namespace stickslip {

/// Newton's method, the same for all.
struct NewtonOptions {
  double tolerance = 1e-12;  ///< relative, each residual to its own scale (methods/residuals.hpp); 0 < tolerance < 1
  int max_iterations = 100;  ///< per solve; >= 1. A front of slip may pass one node an iteration
  bool line_search = true;   ///< backtracking where a full step stays in its active set and the residual does not fall
};

/// Regularisation rho (force per length cubed) of each contact point. `relative` is a multiple of the local nodal
/// stiffness per tributary area, k_i / A_i; `absolute` is the raw value.
struct Regularisation {
  enum class Kind { automatic, relative, absolute };
  Kind kind = Kind::automatic;
  Number value = 1.0;  ///< > 0; not used where automatic
};

struct Penalty {
  static constexpr std::string_view name = "penalty";
  static constexpr double automatic_multiple = 1e3;
  static constexpr std::string_view regularisation_name = "stiffness";
  static constexpr bool has_unknown_multipliers = false;
  Regularisation stiffness;
  Number tangential_ratio = 1.0;  ///< tangential over normal penalty; > 0
  NewtonOptions newton;
  Regularisation& regularisation() { return stiffness; }
};

struct UzawaAL {
  static constexpr std::string_view name = "uzawa_al";
  static constexpr double automatic_multiple = 10;
  static constexpr std::string_view regularisation_name = "scale";
  static constexpr bool has_unknown_multipliers = false;
  static constexpr double automatic_oversize = 1e3;  ///< of the oversized scheme
  enum class Acceleration { none, aitken, anderson };
  enum class Cone { augmented, frozen };
  enum class Sensitivity { iterated, truncated, oversized, preconditioned };
  Regularisation scale;
  double tolerance = 1e-10;     ///< error left in the multiplier (relative), and violation; 0 < tolerance < 1
  int max_augmentations = 200;  ///< inner solves per increment; >= 1
  bool adapt = true;            ///< multiply rho by 4 where an augmentation did not shrink the violation by 4
  Acceleration acceleration = Acceleration::none;  ///< of the updates of lambda (methods/acceleration.hpp)
  Cone cone = Cone::augmented;  ///< radius -mu z_N (augmented), or -mu lambda_N of the last augmentation (frozen)
  Sensitivity sensitivity = Sensitivity::iterated;
  std::optional<double> oversize;  ///< kappa_s of the oversized and the preconditioned scheme, > 1; none: automatic
  NewtonOptions newton;
  Regularisation& regularisation() { return scale; }
};

/// Options of a method that do not go together: the name of the one to change, and why; empty where all do.
struct OptionConflict {
  std::string_view option, reason;
};
inline OptionConflict conflict(const UzawaAL& m) {
  using Sensitivity = UzawaAL::Sensitivity;
  if (m.acceleration != UzawaAL::Acceleration::none && m.sensitivity == Sensitivity::truncated)
    return {
        "sensitivity",
        "is \"truncated\", which differentiates every update as it was made; the weights of an acceleration are not "
        "differentiated; allowed with it: iterated, oversized, preconditioned"};
  const bool stiffened = m.sensitivity == Sensitivity::oversized || m.sensitivity == Sensitivity::preconditioned;
  if (m.cone == UzawaAL::Cone::frozen && stiffened)
    return {"sensitivity",
            "relies on a stiffer factor, which leaves the error of a frozen cone as it is (it shrinks by mu/s a pass "
            "whatever the scale); allowed with it: iterated, truncated"};
  return {};
}
template <class M>
OptionConflict conflict(const M&) {
  return {};
}

struct MonolithicAL {
  static constexpr std::string_view name = "monolithic_al";
  static constexpr double automatic_multiple = 1;
  static constexpr std::string_view regularisation_name = "scale";
  static constexpr bool has_unknown_multipliers = true;
  enum class Cone { augmented, multiplier };
  Regularisation scale;
  Cone cone = Cone::augmented;  ///< radius -mu z_N (augmented) or -mu lambda_N (multiplier): same zeros, another path
  NewtonOptions newton;
  Regularisation& regularisation() { return scale; }
};

/// The closed set: what is missing in a visit over it does not compile.
using Method = std::variant<Penalty, UzawaAL, MonolithicAL>;

inline std::string_view name_of(const Method& method) {
  return std::visit([](const auto& m) { return std::string_view(m.name); }, method);
}

/// Which linear algebra carries the run; both give the same solution (scene key "linear_solver", results name what was
/// used).
struct LinearAlgebra {
  enum class Engine { automatic, sparse, condensed };
  Engine engine = Engine::automatic;
};

}  // namespace stickslip
