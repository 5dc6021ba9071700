/// Options of the methods, with their defaults, meaning and range, and what all else asks of a method. One struct a
/// method; `Method` is the closed set. What a struct lacks does not compile (WholeMethod). Beside its options it says
///
///   name, title, idea         key in files; its name on pages; how it works, in a sentence or two behind its title
///   keys()                    its options as files write them (core/algebra/described.hpp): all may be left out
///   regularisation()          the option that rho is made from; regularisation_name; and automatic_multiple, the
///                             multiple of the local stiffness that "auto" stands for
///   tangential_share()        tangential over normal rho
///   multipliers               what the systems solved do with them
///   cone_radius()             which pressure the radius of its friction cones follows
///   is_globalised()           whether methods/rescue continues where an increment fails
///   prevents_penetration      whether a solution penetrates nothing. Else it is judged as contact with a layer of
///                             compliance 1/rho (studies/run/accuracy.hpp)
///   contact_tolerance()       error that its options leave in gaps, slips and tractions, relative
///   tighten(to, most)         has its iterations end no earlier than at the tolerance `to`, and at no fewer than
///                             `most` augmentations
///   conflict()                its options that do not go together
///   scheme()                  what its derivatives are
///   solve_increment()         the method: in the file of its name in this folder
///   differentiate_increment() and pull_back_increment(): its scheme, in the file of its name in sensitivity/
#pragma once

#include <algorithm>
#include <concepts>
#include <optional>
#include <string_view>
#include <tuple>
#include <variant>
#include <vector>

#include "core/algebra/described.hpp"
#include "core/contact/cone_radius.hpp"
#include "core/engine/multipliers.hpp"

namespace stickslip {

template <class T>
struct Run;
template <class T>
struct Start;
template <class T>
struct State;
template <class T>
struct Increment;
struct Differentiation;
struct AdjointProblem;

// How options are written, beside an IfGiven, a Flag and words.

struct RhoOption {};   ///< "auto", a number > 0 or {"absolute": a number > 0}
struct AtLeastOne {};  ///< a whole number
struct Nested {};      ///< an object that has keys() of its own

/// A number that steers the iteration: nothing is differentiated by it.
struct Setting {
  Range range;
};
/// "auto" or such a number.
struct AutoOrSetting {
  Range range;
  double example;
};

/// Newton's method, the same for all.
struct NewtonOptions {
  /// Relative, each residual to its own scale (methods/newton/residuals.hpp); 0 < tolerance < 1.
  double tolerance = 1e-12;
  int max_iterations = 100;  ///< per solve; >= 1. A front of slip may pass one node an iteration
  bool line_search = true;   ///< backtracking where a full step stays in its active set and the residual does not fall
  void tighten(double to) { tolerance = std::min(tolerance, to); }

  static constexpr auto keys() {
    using Self = NewtonOptions;
    return std::tuple{
        Key{&Self::tolerance, "tolerance", "residual at which it stops, relative to the scale of each residual",
            Setting{Range::below_one}},
        Key{&Self::max_iterations, "max_iterations", "of each solve; beyond: status cap", AtLeastOne{}},
        Key{&Self::line_search, "line_search",
            "backtracking where a full step stays in its active set and the residual does not fall", Flag{}}};
  }
};

/// Regularisation rho (force per length cubed) of each contact point. `relative` is a multiple of the local nodal
/// stiffness per tributary area, k_i / A_i; `absolute` is the raw value.
struct Regularisation {
  enum class Kind { automatic, relative, absolute };
  Kind kind = Kind::automatic;
  Number value = 1.0;  ///< > 0; not used where automatic
};

/// Options of a method that do not go together: the name of the one to change, and why; empty where all do.
struct OptionConflict {
  std::string_view option, reason;
};

/// A member that has no default: what leaves it out does not compile.
template <class T>
struct Required {
  T value;
  Required(T given) : value(given) {}   // NOLINT: it stands for the value
  operator T() const { return value; }  // NOLINT
};

/// What the derivatives of a method are, for all that serves every scheme.
struct Scheme {
  Required<bool> reads_regularisation;  ///< what its adjoint goes back through depends on rho
  Required<bool> of_each_augmentation;  ///< differentiates Increment::augmented one by one; else the last equilibrium
  Required<bool> keeps_tangents;        ///< solves with the tangents that the method's iterations ended with
  Required<bool> iterates;              ///< how many solves it takes is not known before
  Required<double> oversize;            ///< of what it solves: factor on rho
  Required<double> error;               ///< relative, that it is allowed; 0: rounding alone
};

/// What "auto" stands for, in multiples of the local nodal stiffness, if normals keep their directions, as those of
/// planes and all at small strain do, and if they turn.
struct AutomaticMultiple {
  double fixed, turning;
  constexpr double of(bool normals_turn) const { return normals_turn ? turning : fixed; }
};

struct Penalty {
  static constexpr std::string_view name = "penalty";
  static constexpr std::string_view title = "Penalty";
  static constexpr std::string_view idea =
      "puts stiff springs between the bodies. One solve, but they sink in a little; stiffer springs err less and make "
      "the equations harder to solve accurately.";
  static constexpr AutomaticMultiple automatic_multiple{1e3, 1e3};
  static constexpr std::string_view regularisation_name = "stiffness";
  static constexpr Multipliers multipliers = Multipliers::given;
  static constexpr bool prevents_penetration = false;
  Regularisation stiffness;
  Number tangential_ratio = 1.0;  ///< tangential over normal penalty; > 0
  NewtonOptions newton;

  static constexpr auto keys() {
    return std::tuple{Key{&Penalty::stiffness, "stiffness",
                          "penalty in multiples of the local nodal stiffness (auto: 1e3), or absolute", RhoOption{}},
                      Key{&Penalty::tangential_ratio, "tangential_ratio", "tangential over normal penalty",
                          IfGiven{Range::positive, 0.5}},
                      Key{&Penalty::newton, "newton", "Newton's method within an increment", Nested{}}};
  }
  const Regularisation& regularisation() const { return stiffness; }
  Regularisation& regularisation() { return stiffness; }
  Number tangential_share() const { return tangential_ratio; }
  ConeRadius cone_radius() const { return ConeRadius::augmented; }
  bool is_globalised() const { return true; }
  double contact_tolerance() const { return newton.tolerance; }
  void tighten(double to, int /*most*/) { newton.tighten(to); }
  OptionConflict conflict() const { return {}; }
  Scheme scheme() const {
    return {.reads_regularisation = true,  // the penetration does
            .of_each_augmentation = false,
            .keeps_tangents = true,
            .iterates = false,
            .oversize = 1,
            .error = 0};
  }

  template <class T>
  Increment<T> solve_increment(Run<T>&, const State<T>&, const std::vector<double>&, double, const Start<T>&) const;
  bool differentiate_increment(Differentiation&, const State<double>&, const Increment<double>&) const;
  bool pull_back_increment(AdjointProblem&, const State<double>&, const Increment<double>&) const;
};

struct UzawaAL {
  static constexpr std::string_view name = "uzawa_al";
  static constexpr std::string_view title = "Uzawa AL";
  static constexpr std::string_view idea =
      "(augmented Lagrangian) solves with soft springs, adds the force that was missing, and repeats until nothing is "
      "missing: exact in the limit, at the price of repetition.";
  static constexpr AutomaticMultiple automatic_multiple{100, 10};
  static constexpr std::string_view regularisation_name = "scale";
  static constexpr Multipliers multipliers = Multipliers::given;
  static constexpr bool prevents_penetration = true;
  static constexpr double automatic_oversize = 1e3;  ///< of the oversized scheme
  enum class Acceleration { none, aitken, anderson };
  enum class Cone { augmented, frozen };
  enum class Sensitivity { iterated, truncated, oversized, preconditioned };
  Regularisation scale;
  double tolerance = 1e-10;     ///< error left in the multiplier (relative), and violation; 0 < tolerance < 1
  int max_augmentations = 200;  ///< inner solves per increment; >= 1
  bool adapt = true;            ///< multiply rho by 4 where an augmentation left much of the violation
  Acceleration acceleration = Acceleration::none;  ///< of the updates of lambda (methods/augmentation/acceleration.hpp)
  Cone cone = Cone::augmented;  ///< radius -mu z_N (augmented), or -mu lambda_N of the last augmentation (frozen)
  Sensitivity sensitivity = Sensitivity::iterated;
  std::optional<double> oversize;  ///< kappa_s of the oversized and the preconditioned scheme, > 1; none: automatic
  NewtonOptions newton;

  static constexpr auto keys() {
    return std::tuple{
        Key{&UzawaAL::scale, "scale",
            "rho in multiples of the local nodal stiffness (auto: 100, or 10 if normals turn: at finite strain, but on "
            "planes), or absolute",
            RhoOption{}},
        Key{&UzawaAL::tolerance, "tolerance",
            "relative error left in the multiplier, and violation, at which the updates stop",
            Setting{Range::below_one}},
        Key{&UzawaAL::max_augmentations, "max_augmentations",
            "of an increment; beyond: status cap, with the last iterate as the result", AtLeastOne{}},
        Key{&UzawaAL::adapt, "adapt", "multiplies rho by 4 where an augmentation left much of the violation", Flag{}},
        Key{&UzawaAL::acceleration, "acceleration",
            "extrapolation of the updates; anderson takes several of the last, aitken two",
            std::array{"none", "aitken", "anderson"}},
        Key{&UzawaAL::cone, "cone",
            "frozen: radius of the last augmentation, symmetric; fails where friction is large, and says so",
            std::array{"augmented", "frozen"}},
        Key{&UzawaAL::sensitivity, "sensitivity", "scheme of the derivatives",
            std::array{"iterated", "truncated", "oversized", "preconditioned"}},
        Key{&UzawaAL::oversize, "oversize", "factor on rho of the schemes oversized (auto: 1e3) and preconditioned",
            AutoOrSetting{Range::above_one, 1e4}},
        Key{&UzawaAL::newton, "newton", "Newton's method within an increment", Nested{}}};
  }
  const Regularisation& regularisation() const { return scale; }
  Regularisation& regularisation() { return scale; }
  Number tangential_share() const { return 1.0; }
  ConeRadius cone_radius() const { return cone == Cone::augmented ? ConeRadius::augmented : ConeRadius::multiplier; }
  bool is_globalised() const { return cone == Cone::augmented; }  // (failures of a frozen cone are a subject of study)
  double contact_tolerance() const { return tolerance; }
  void tighten(double to, int most) {
    newton.tighten(to);
    tolerance = std::min(tolerance, to);
    max_augmentations = std::max(max_augmentations, most);
  }
  OptionConflict conflict() const;
  /// The fixed point does not depend on rho: Dg = 0 there, whatever rho is. What the tolerance leaves of g, times D
  /// rho, is left out: at a tolerance of 1e-5 up to 2e-9 of the derivative (docs/methods.md), as in u.
  Scheme scheme() const {
    const bool truncated = sensitivity == Sensitivity::truncated, oversized = sensitivity == Sensitivity::oversized;
    const double factor = oversized ? oversize.value_or(automatic_oversize) : 1;
    return {.reads_regularisation = truncated || oversized,
            .of_each_augmentation = truncated,
            .keeps_tangents = sensitivity == Sensitivity::iterated,
            .iterates = true,
            .oversize = factor,
            .error = oversized ? 10 / factor : 0};
  }

  template <class T>
  Increment<T> solve_increment(Run<T>&, const State<T>&, const std::vector<double>&, double, const Start<T>&) const;
  bool differentiate_increment(Differentiation&, const State<double>&, const Increment<double>&) const;
  bool pull_back_increment(AdjointProblem&, const State<double>&, const Increment<double>&) const;
};

inline OptionConflict UzawaAL::conflict() const {
  if (acceleration != Acceleration::none && sensitivity == Sensitivity::truncated)
    return {
        "sensitivity",
        "is \"truncated\", which differentiates every update as it was made; the weights of an acceleration are not "
        "differentiated; allowed with it: iterated, oversized, preconditioned"};
  const bool stiffened = sensitivity == Sensitivity::oversized || sensitivity == Sensitivity::preconditioned;
  if (cone == Cone::frozen && stiffened)
    return {"sensitivity",
            "relies on a stiffer factor, which leaves the error of a frozen cone as it is (it shrinks by mu/s a pass "
            "whatever the scale); allowed with it: iterated, truncated"};
  return {};
}

struct MonolithicAL {
  static constexpr std::string_view name = "monolithic_al";
  static constexpr std::string_view title = "Monolithic AL";
  static constexpr std::string_view idea =
      "makes the contact forces unknowns of the same equations: exact at once, with a larger and less friendly system.";
  static constexpr AutomaticMultiple automatic_multiple{1, 1};
  static constexpr std::string_view regularisation_name = "scale";
  static constexpr Multipliers multipliers = Multipliers::unknown;
  static constexpr bool prevents_penetration = true;
  enum class Cone { augmented, multiplier };
  Regularisation scale;
  Cone cone = Cone::augmented;  ///< radius -mu z_N (augmented) or -mu lambda_N (multiplier): same zeros, another path
  NewtonOptions newton;

  static constexpr auto keys() {
    return std::tuple{Key{&MonolithicAL::scale, "scale",
                          "rho in multiples of the local nodal stiffness (auto: 1), or absolute", RhoOption{}},
                      Key{&MonolithicAL::cone, "cone",
                          "radius by the trial pressure, or by the multiplier: same solution, another path",
                          std::array{"augmented", "multiplier"}},
                      Key{&MonolithicAL::newton, "newton", "Newton's method within an increment", Nested{}}};
  }
  const Regularisation& regularisation() const { return scale; }
  Regularisation& regularisation() { return scale; }
  Number tangential_share() const { return 1.0; }
  ConeRadius cone_radius() const { return cone == Cone::augmented ? ConeRadius::augmented : ConeRadius::multiplier; }
  bool is_globalised() const { return true; }
  double contact_tolerance() const { return newton.tolerance; }
  void tighten(double to, int /*most*/) { newton.tighten(to); }
  OptionConflict conflict() const { return {}; }
  Scheme scheme() const {
    return {.reads_regularisation = false,
            .of_each_augmentation = false,
            .keeps_tangents = true,
            .iterates = false,
            .oversize = 1,
            .error = 0};
  }

  template <class T>
  Increment<T> solve_increment(Run<T>&, const State<T>&, const std::vector<double>&, double, const Start<T>&) const;
  bool differentiate_increment(Differentiation&, const State<double>&, const Increment<double>&) const;
  bool pull_back_increment(AdjointProblem&, const State<double>&, const Increment<double>&) const;
};

/// The closed set: what is missing in a visit over it does not compile.
using Method = std::variant<Penalty, UzawaAL, MonolithicAL>;

template <class M>
concept WholeMethod = std::copyable<M> && requires(const M& method, M& changed) {
  { M::name } -> std::convertible_to<std::string_view>;
  { M::title } -> std::convertible_to<std::string_view>;
  { M::idea } -> std::convertible_to<std::string_view>;
  { M::automatic_multiple } -> std::convertible_to<AutomaticMultiple>;
  { M::regularisation_name } -> std::convertible_to<std::string_view>;
  M::keys();
  { M::multipliers } -> std::convertible_to<Multipliers>;
  { M::prevents_penetration } -> std::convertible_to<bool>;
  { method.regularisation() } -> std::same_as<const Regularisation&>;
  { changed.regularisation() } -> std::same_as<Regularisation&>;
  { method.tangential_share() } -> std::same_as<Number>;
  { method.cone_radius() } -> std::same_as<ConeRadius>;
  { method.is_globalised() } -> std::same_as<bool>;
  { method.contact_tolerance() } -> std::same_as<double>;
  { changed.tighten(1e-12, 1) } -> std::same_as<void>;
  { method.conflict() } -> std::same_as<OptionConflict>;
  { method.scheme() } -> std::same_as<Scheme>;
  { method.newton } -> std::convertible_to<NewtonOptions>;
};

namespace detail {

template <class M>
constexpr bool is_whole_method() {
  static_assert(WholeMethod<M>, "the options of a method lack something");
  return true;
}
template <class... M>
constexpr bool are_whole_methods(const std::variant<M...>*) {
  return (is_whole_method<M>() && ...);
}
static_assert(are_whole_methods(static_cast<const Method*>(nullptr)));

}  // namespace detail

inline std::string_view name_of(const Method& method) {
  return std::visit([](const auto& m) { return std::string_view(m.name); }, method);
}
inline Scheme scheme_of(const Method& method) {
  return std::visit([](const auto& m) { return m.scheme(); }, method);
}
inline ConeRadius cone_radius_of(const Method& method) {
  return std::visit([](const auto& m) { return m.cone_radius(); }, method);
}
inline const NewtonOptions& newton_of(const Method& method) {
  return std::visit([](const auto& m) -> const NewtonOptions& { return m.newton; }, method);
}
inline Multipliers multipliers_of(const Method& method) {
  return std::visit([](const auto& m) { return m.multipliers; }, method);
}
inline bool prevents_penetration(const Method& method) {
  return std::visit([](const auto& m) { return m.prevents_penetration; }, method);
}
inline bool is_globalised(const Method& method) {
  return std::visit([](const auto& m) { return m.is_globalised(); }, method);
}

/// Which linear algebra carries the run; both give the same solution (scene key "linear_solver", results name what was
/// used).
struct LinearAlgebra {
  enum class Engine { automatic, sparse, condensed };
  Engine engine = Engine::automatic;
};

}  // namespace stickslip
