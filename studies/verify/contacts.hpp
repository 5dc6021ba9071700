/// Gap, normal and slip of the places of a contact: at nodes, or weighted over segments (core/README.md, Notation,
/// Finite strain, A point that comes on, Segment integration). At small strain what is faced, n and weights are of the
/// start:
///
///   g = g_0 + offset + n . w,   w = sum of weights u - u_obstacle,   slip = what w grew by, across n
///   finite strain:  slip = y(xi) - y(xi_last) on the master as it is now, across n; of an obstacle both in its frame
///   segments:  g_j = n_j . 1/A_j int psi_j (x_s - y) dA,   along a master slip = |m_j| (Z_j - Z_j,last), e_j along
///              m_j = 1/A_j int psi_j dy/dS dA,   Z_j = 1/A_j int psi_j (S(y) + S_s) dA
#pragma once

#include "studies/verify/masters.hpp"
#include "studies/verify/solids.hpp"

namespace stickslip::verify {

/// A place of contact: a slave node, or the multiplier of one. Its foot is in the frame of the master; its weights are
/// 1 of the slave, -N_i of the master.
struct Touch : Foot {
  int node = -1;
  double area = 0;                                       ///< of the start, on which its traction acts
  Vec3 slip = Vec3::Zero();                              ///< of this increment, across the normal
  bool slip_known = false;                               ///< false: it faced nothing before
  double opening = 0;                                    ///< of the gap in this increment
  Vec3 carried = Vec3::Zero();                           ///< motion of an obstacle's surface there in this increment
  Vec3 relative = Vec3::Zero(), tangent = Vec3::Zero();  ///< w of small strain; m of segments
  double along = 0;                                      ///< Z of segments
};

/// A contact of a slave side and a master.
class Contact {
 public:
  /// `sides`: {"of": entry of the scene, "slave", "master"}.
  Contact(const Scene& scene, const std::string& called, const Json& sides);
  /// All places at displacements. Call it in order of time.
  std::vector<Touch> advance(const Field& u, double time);

  std::string name, group;
  Json given;            ///< its entry in the scene
  bool itself, segment;  ///< it is a side that touches itself; it is integrated over segments

 private:
  /// Part of a slave facet that faces one patch of the master (-1: an obstacle without patches), and the node whose
  /// multiplier acts there; `sole`: the other node carries none.
  struct Piece {
    int first, second, carrier, patch;
    double from, to;
    bool sole;
  };
  Seeker seeker(int node, const Field& x) const;
  void cut(const std::array<int, 2>& facet, const Field& x, const Places& at, std::vector<Piece>& all) const;
  void integrate(const Piece& piece, const Field& x, const Places& at, Touch& touch, double& share) const;
  Touch on_pieces(int node, const std::vector<Piece>& pieces, const Field& x, const Places& at) const;
  void move(Touch& touch, const Touch& last, const Field& u, const Places& at, double time) const;

  const Scene& scene_;
  const Body& body_;
  Side side_;
  Master master_;
  std::vector<std::array<int, 2>> facets_;
  std::map<int, double> areas_;
  std::map<int, Touch> start_, last_;
  double last_time_ = at_rest;
};

}  // namespace stickslip::verify
