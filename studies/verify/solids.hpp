/// Elements, bodies and loads, without tangents, which a check does not need (core/README.md, Elements, Shares).
/// Corners come first, then the middles of the sides in turn, counter-clockwise. A square is [-1, 1]^2, a triangle r, s
/// >= 0, r + s <= 1.
///
///   f_a = int P grad N_a dV,   of revolution + e_r int P_33 N_a / R dV,   H = sum u_a (x) grad N_a,  H_33 = u_r / R
///   mean dilatation: F -> (theta / J)^(1/3) F, theta the mean of J; small: H -> H + (theta - tr H) / 3 I  [H80, MOS90]
///   bar:  N = E A e,  e = (T.d + d.d / 2) / L^2 at finite strain, T.d / L^2 at small;  spring: f = K (u - u_anchor)
#pragma once

#include "studies/verify/scene.hpp"

namespace stickslip::verify {

Places natural_nodes(const Body& body);  ///< r, s of each node of an element

/// Shape functions N at a place: the polynomials that are 1 at their node and 0 at the others; their gradients by r, s.
struct Shape {
  Eigen::VectorXd value;
  Eigen::MatrixX2d gradient;
};
Shape shape(const Body& body, const Vec2& at);

/// A Gauss point of an edge: weight, place from its first end to its second, shape functions and their slopes.
struct EdgePoint {
  double weight, s;
  Eigen::VectorXd value, slope;
};
std::vector<EdgePoint> edge_points(std::size_t nodes, bool of_revolution);

/// Areas of the start that belong to the nodes of a side: int N dA; 1 of each where it has no edges.
std::map<int, double> areas_of(const Scene& scene, const Body& body, const Side& side);

/// What a point of a body remembers: plastic strain (at finite strain C_p^-1 - I), and the equivalent plastic strain.
struct Particle {
  Mat3 strain = Mat3::Zero();
  double equivalent = 0, volume = 0;
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
