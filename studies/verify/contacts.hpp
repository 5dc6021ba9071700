/// Gap, normal and slip of the places of a contact: at nodes, or weighted over segments (core/README.md, Notation,
/// Finite strain, Segment integration). Small strain: what is faced, normal and weights are those of the start,
///
///   g = g_0 + offset + n . w,   w = sum of weights u - u_obstacle,   slip = what w grew by, across n
///   finite strain:  slip = y(xi) - y(xi_last) on the master as it is now, across n; of an obstacle both in its frame
///   segments:  g_j = n_j . 1/A_j int psi_j (x_s - y) dA,   along a master slip = |m_j| (Z_j - Z_j,last), e_j along
///              m_j = 1/A_j int psi_j dy/dS dA,   Z_j = 1/A_j int psi_j (S(y) + S_s) dA
#pragma once

#include "studies/verify/elements.hpp"
#include "studies/verify/masters.hpp"

namespace stickslip::verify {

/// A place of contact: a slave node, or the multiplier of one.
struct Touch {
  int node = -1;
  bool faces = false;                           ///< whether it faces its master
  double area = 0;                              ///< of the start, on which its traction acts
  double gap = 0;                               ///< negative: penetration
  Vec3 normal = Vec3::UnitY();                  ///< out of the master
  Vec3 slip = Vec3::Zero();                     ///< of this increment, across the normal
  double opening = 0;                           ///< of this increment, of the gap
  bool slip_known = false;                      ///< false: it faced nothing before
  Vec3 carried = Vec3::Zero();                  ///< motion of an obstacle's surface there in this increment
  std::vector<std::pair<int, double>> weights;  ///< of nodes: 1 of the slave, -N_i of the master
  Vec3 foot = Vec3::Zero();                     ///< in the frame of the master
  Place place;
  double along = 0;              ///< Z of segments
  Vec3 tangent = Vec3::Zero();   ///< m of segments
  Vec3 relative = Vec3::Zero();  ///< w of small strain
};

/// A contact of a slave side and a master.
class Contact {
 public:
  Contact(const Scene& scene, std::string name, const Json& of, const Json& contact);
  /// All places at displacements. Call it in order of time.
  std::vector<Touch> advance(const Field& u, double time);

  std::string name, group;
  Json given;   ///< its entry in the scene
  bool itself;  ///< it is a side that touches itself

 private:
  /// Part of a slave facet that faces one facet of the master, and the node whose multiplier acts there.
  struct Piece {
    int first, second, carrier, patch;  ///< patch -1: an obstacle without facets
    double from, to;
    bool sole;  ///< the other node carries no multiplier
  };
  Seeker seeker(int node, const Field& x) const;
  void add_pieces(const std::array<int, 2>& facet, const Field& x, const Eigen::Matrix2Xd& at,
                  std::vector<Piece>& all) const;
  void integrate(const Piece& piece, const Field& x, const Eigen::Matrix2Xd& at, Touch& touch, double& share) const;
  Touch on_pieces(int node, const std::vector<Piece>& pieces, const Field& x, const Eigen::Matrix2Xd& at) const;
  Touch at_node(int node, const Field& x, const Eigen::Matrix2Xd& at) const;
  void move_small(Touch& touch, const Touch& last, const Field& u, double time) const;
  void move_finite(Touch& touch, const Touch& last, const Eigen::Matrix2Xd& at, double time) const;

  const Scene& scene_;
  const Body& body_;
  Side side_;
  Master master_;
  std::vector<std::array<int, 2>> facets_;
  std::map<int, double> areas_;
  bool segment_;
  std::map<int, Touch> start_, last_;
  double last_time_ = at_rest;
};

}  // namespace stickslip::verify
