/// The list of materials, as a scene describes them, and what is known of one without its law.
///
/// A description has its numbers, its keys (core/algebra/described.hpp), and what it is for, a verb first (place).
/// The law that it becomes has a file of its own. Its name is in core/solids/materials.hpp, which says what a law
/// gives. What only holds scenes need not parse laws.
#pragma once

#include <array>
#include <tuple>
#include <variant>
#include <vector>

#include "core/algebra/described.hpp"
#include "core/solids/kinematics.hpp"

namespace stickslip {

struct LinearElastic {
  static constexpr const char *key = "linear_elastic",
                              *about = "of bars, and where strains are small of all but points",
                              *place = "fills bars, and where strains are small all but points";
  Number E, nu;

  static constexpr auto keys() {
    return std::tuple{Key{&LinearElastic::E, "E", "Young's modulus (force per area)", InRange{Range::positive, 1000}},
                      Key{&LinearElastic::nu, "nu", "Poisson's ratio", InRange{Range::poisson_ratio, 0.3}}};
  }
};

struct NeoHookean {
  static constexpr const char *key = "neo_hookean", *about = "of all but bars and points where strains are finite",
                              *place = "fills all but bars and points where strains are finite";
  enum class Volumetric { quadratic, log };
  Number E, nu;
  Volumetric volumetric = Volumetric::quadratic;

  static constexpr auto keys() {
    return std::tuple{
        Key{&NeoHookean::E, "E", "Young's modulus of small strains (force per area)", InRange{Range::positive, 1000}},
        Key{&NeoHookean::nu, "nu", "Poisson's ratio of small strains", InRange{Range::poisson_ratio, 0.3}},
        Key{&NeoHookean::volumetric, "volumetric", "energy of a change of volume: lame/2 (J - 1)^2, or lame/2 (ln J)^2",
            std::array{"quadratic", "log"}}};
  }
};

/// A row of a table of hardening.
struct HardeningRow {
  Number strain, stress;
};
struct J2Plastic {
  Number E, nu, yield, hardening;        ///< `hardening`: behind the last row of the table, where there is one
  std::vector<HardeningRow> table = {};  ///< strains increase from above 0, stresses do not fall below `yield`
};

/// D x D, symmetric, positive definite.
struct GroundedSpring {
  std::vector<std::vector<Number>> stiffness;
};

using Material = std::variant<LinearElastic, NeoHookean, J2Plastic, GroundedSpring>;

/// Why a material does not go with elements of a continuum, completing "MATERIAL ..."; empty where it does.
const char* fault_of(const Material& material, Kinematics kinematics, Strains strains);

/// Numbers that a point of a continuum of a material remembers, and a bar of it.
int memory_of(const Material& material, TensorLayout layout);
int memory_of_bar(const Material& material);

/// Whether bodies of a material remember how they flowed.
bool flows(const Material& material);

/// Whether a continuum of a material hardly changes its volume.
bool is_nearly_incompressible(const Material& material);

}  // namespace stickslip
