/// Objects that hold settings alone, of a scene or a study: their keys, which reader and schema are made from.
#pragma once

#include <optional>

#include "studies/input/described.hpp"

namespace stickslip {

struct LinearSolverObject {
  static constexpr const char *key = "linear_solver", *about = "what carries the run; the solution is the same",
                              *example = R"({"engine": "sparse"})";
  LinearAlgebra::Engine engine = LinearAlgebra::Engine::automatic;
  Backend backend = Backend::automatic;

  static constexpr auto keys() {
    using Self = LinearSolverObject;
    return std::tuple{Key{&Self::engine, "engine",
                          "sparse: one large matrix; condensed: bodies reduced to contact unknowns; auto: the cheaper",
                          std::array{"auto", "sparse", "condensed"}},
                      Key{&Self::backend, "backend", "library of the sparse factorisations, where the build has it",
                          std::array{"auto", "cholmod", "mumps", "eigen"}}};
  }
};

struct SensitivityObject {
  static constexpr const char *key = "sensitivity", *about = "how derivatives are taken",
                              *example = R"({"mode": "adjoint"})";
  SensitivityMode mode = SensitivityMode::direct;
  double memory = default_state_memory / megabyte;

  static constexpr auto keys() {
    using Self = SensitivityObject;
    return std::tuple{
        Key{&Self::mode, "mode", "direct: of all responses and objectives; adjoint: of the objectives alone",
            std::array{"direct", "adjoint"}},
        Key{&Self::memory, "memory",
            "adjoint: megabytes for the displacements, and for what bodies remember, of all steps; beyond them states "
            "are let go, and solved again on the way back",
            PlainNumber{Range::positive, 100}}};
  }
};

struct TimingObject {
  static constexpr const char *key = "timing", *about = "a pass of its own that measures seconds",
                              *example = R"({"repeat": 3})";
  std::optional<int> repeat;

  static constexpr auto keys() {
    constexpr int most = 1000;  // the least of so many is as good as it gets
    return std::tuple{Key{&TimingObject::repeat, "repeat",
                          "how often every converged cell is run again; left out: no timing pass",
                          WholeNumber{"whole number >= 1", 1, most, 3}}};
  }
};

struct ErrorBudgetObject {
  int copies = 4;

  static constexpr auto keys() {
    return std::tuple{Key{&ErrorBudgetObject::copies, "copies",
                          "runs of the scene with numbers moved by a rounding, for each that is compared",
                          WholeNumber{"whole number from 2 to 64", 2, 64, 8}}};
  }
};

}  // namespace stickslip
