/// Laws of materials, from their formulas (core/README.md, Plasticity, Plane stress). H = F - I is the displacement
/// gradient, 3 x 3; lame = E nu / ((1 + nu) (1 - 2 nu)), G = E / (2 (1 + nu)).
///
///   linear        sigma = lame tr(e) I + 2 G e,             e = sym H
///   neo-Hookean   P = (G (F F^T - I) + V U'(V) I) F^-T,     U = lame/2 (V - 1)^2 or lame/2 (ln V)^2, V = det F
///   J2 [SH98]     q = sqrt(3/2) |dev tau| <= bound(a),      e -= d n,  n = 3/2 dev tau / q,  a += d
///                 small: e = sym H - e_p;  finite [S92]: e = ln(F C_p^-1 F^T) / 2,  P = tau F^-T
#pragma once

#include "studies/verify/scene.hpp"

namespace stickslip::verify {

/// The numbers of a material.
struct Material {
  explicit Material(const Json& json);
  /// Growth d >= 0 of the equivalent plastic strain a where the trial q falls by `modulus` per growth:
  /// q - modulus d = bound(a + d).
  double growth(double q, double modulus, double a) const;

  double lame = 0, G = 0, E = 0;
  bool log_volume = false, plastic = false;
  std::vector<std::array<double, 2>> rows;  ///< (equivalent plastic strain, bound), from 0 to infinity
};

/// What a point remembers: plastic strain (at finite strain C_p^-1 - I), and the equivalent plastic strain.
struct Memory {
  Mat3 strain = Mat3::Zero();
  double equivalent = 0;
};

/// A point at a motion. The memory of the point has moved along.
struct Answer {
  Mat3 stress = Mat3::Zero();           ///< Cauchy at small strain, first Piola-Kirchhoff at finite strain
  double energy = 0, plastic_work = 0;  ///< per volume: stored; q d of the increment
  bool inverted = false;
};
Answer respond(const Material& material, const Mat3& H, bool finite, Memory& memory);
/// The same without stress across the plane; H(2, 2) is what makes it so.
Answer respond_in_plane_stress(const Material& material, Mat3& H, bool finite, Memory& memory);

/// det(I + H) - 1, without loss of digits where H is small.
double volume_change(const Mat3& H);

}  // namespace stickslip::verify
