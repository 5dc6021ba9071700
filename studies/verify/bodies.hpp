/// Forces, energy and plastic flow of bodies, and forces of loads. No tangents: a check needs none.
///
///   f_a = int P grad N_a dV,   of revolution + e_r int P_33 N_a / R dV,   H = sum u_a (x) grad N_a,  H_33 = u_r / R
///   mean dilatation: F -> (theta / J)^(1/3) F, theta the mean of J; small: H -> H + (theta - tr H) / 3 I  [H80, MOS90]
///   bar:  N = E A e,  e = (T.d + d.d / 2) / L^2 at finite strain, T.d / L^2 at small;  spring: f = K (u - u_anchor)
#pragma once

#include "studies/verify/elements.hpp"
#include "studies/verify/materials.hpp"

namespace stickslip::verify {

/// A point of a body, with its volume.
struct Particle : Memory {
  double volume = 0;
};

/// What bodies do at a motion.
struct Bodies {
  Field forces;                                  ///< f_int of each node
  double largest = 0;                            ///< force of an element on a node, of all
  double energy = 0, plastic_work = 0;           ///< stored; of this increment
  double stiffness = 0;                          ///< force per length: largest modulus times a depth
  bool inverted = false;                         ///< whether an element is
  std::vector<std::vector<Particle>> particles;  ///< of each body, element by element
};

/// The bodies at displacements u, from what they were at the end of the last increment; `{}` at the start.
Bodies deform(const Scene& scene, const Field& u, const Bodies& before);

/// Nodal forces of the loads at a time. A pressure follows its side at finite strain.
Field load_forces(const Scene& scene, const Field& u, double time);

}  // namespace stickslip::verify
