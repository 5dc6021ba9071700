/// What a state is made of: elements, bodies and loads; masters, and places of contact on them; and responses, measured
/// again (docs/scene.md, Responses). The sources have the laws of materials.
#pragma once

#include "studies/verify/scene.hpp"

namespace stickslip::verify {

// --- solids ----------------------------------------------------------------------------------------------------------
// Without tangents, which a check does not need (core/README.md, Elements, Shares).
//
//   f_a = int P grad N_a dV,   of revolution + e_r int P_33 N_a / R dV,   H = sum u_a (x) grad N_a,  H_33 = u_r / R
//   mean dilatation: F -> (theta / J)^(1/3) F, theta the mean of J; small: H -> H + (theta - tr H) / 3 I  [H80, MOS90]
//   bar:  N = E A e,  e = (T.d + d.d / 2) / L^2 at finite strain, T.d / L^2 at small;  spring: f = K (u - u_anchor)

/// Shape functions N at a place: the polynomials that are 1 at their node and 0 at the others; their gradients by r, s, t.
struct Shape {
  Vec3 at;
  Eigen::VectorXd value;
  Eigen::MatrixX3d gradient;
  double weight = 0;  ///< of a Gauss point
};
Shape shape(const std::string& element, const Vec3& at);
/// Of full rank; of revolution the linear elements need more than one.
const std::vector<Shape>& gauss_points(const std::string& element, bool of_revolution = false);

/// Areas of the start that belong to the nodes of a side: int N dA; 1 of each where it has no edges.
std::map<int, double> areas_of(const Scene& scene, const Body& body, const Side& side);

/// What a point of a body remembers.
struct Particle {
  Mat3 strain = Mat3::Zero();  ///< plastic; at finite strain C_p^-1 - I
  double equivalent = 0;       ///< plastic strain
};

/// A Gauss point of a body.
struct Point : Particle {
  double volume;
  Eigen::VectorXd value;      ///< N
  Eigen::MatrixX3d gradient;  ///< of N, by coordinates of the start
  double hoop = 0;            ///< 1 / R of revolution
  Mat3 displacement_gradient(const Field& u) const;
  Field forces(const Mat3& stress) const;  ///< of the nodes
};

/// What bodies do at a motion.
struct Bodies {
  Field forces;                                         ///< f_int of each node
  double largest = 0;                                   ///< force of an element on a node, of all
  double energy = 0, plastic_work = 0;                  ///< stored; of this increment
  double stiffness = 0;                                 ///< force per length: largest modulus times a depth
  bool inverted = false;                                ///< whether an element is
  std::vector<std::vector<std::vector<Point>>> points;  ///< of each body and element

  explicit Bodies(const Scene& scene);
  /// To displacements u, from what they were at the end of the last increment.
  void deform(const Scene& scene, const Field& u);
};

/// Nodal forces of the loads at a time. A pressure follows its side at finite strain.
Field load_forces(const Scene& scene, const Field& u, double time);

// --- contacts --------------------------------------------------------------------------------------------------------
// Masters, the foot of a point on them by the plainest search there is, every point against every facet, and the gap,
// normal and slip of the places of a contact: at nodes, or weighted over segments (core/README.md, Notation, Along a
// curve, Finite strain, A side that touches itself, A point that comes on, Segment integration). All in the frame of
// the master: of an obstacle the one that moves with it. At small strain what is faced, n and weights are of the
// start.
//
//   y(xi) = sum N_i(xi) y_i,   (x - y) . y' = 0,   n across y',   g = n . (x - y)      on facets and smooth patches
//   g = n . (x - p);   g = +- (|x - c| - r)                                            on a plane; a circle or sphere; a cylinder from its axis
//   small strain:   g = g_0 + offset + n . w,   w = sum of weights u - u_obstacle,   slip = what w grew by, across n
//   finite strain:  slip = y(xi) - y(xi_last) on the master as it is now, across n; of an obstacle both in its frame
//   segments:  g_j = n_j . 1/A_j int psi_j (x_s - y) dA,   along a master slip = |m_j| (Z_j - Z_j,last), e_j along
//              m_j = 1/A_j int psi_j dy/dS dA,   Z_j = 1/A_j int psi_j (S(y) + S_s) dA

constexpr double at_end = 1e-9;  ///< share of a facet within which a foot is at its end: rounding of coordinates

inline Vec2 right_of(const Vec2& tau) { return {tau[1], -tau[0]}; }  ///< out of a solid on the left
inline Vec3 in_space(const Vec2& v) { return {v[0], v[1], 0}; }
inline double cross(const Vec2& a, const Vec2& b) { return a[0] * b[1] - a[1] * b[0]; }

struct Line {
  Vec2 from, to, tau = to - from;
  Vec2 at(double xi) const { return from + xi * tau; }
  double xi(const Vec2& x) const { return (x - from).dot(tau) / tau.squaredNorm(); }
  /// Where it is met from x, along a direction.
  double xi(const Vec2& x, const Vec2& along) const { return cross(x - from, along) / cross(tau, along); }
  double distance(const Vec2& x) const { return (x - at(std::clamp(xi(x), 0.0, 1.0))).norm(); }
};

/// From vertex 1 to vertex 2; 0 and 3 are their neighbours, where the master is smooth there.
struct Patch {
  std::array<int, 4> vertex;             ///< nodes, or points of an obstacle's polyline
  std::array<int, 2> beside = {-1, -1};  ///< the patches before and behind it; -1: a free end
  double length = 0, arc = -1;           ///< of the start; along the master to its beginning
  /// Whether it goes on smoothly, into the patch before or behind it.
  bool goes_on(bool end) const { return end ? vertex[3] != vertex[2] : vertex[0] != vertex[1]; }
};

struct Place {
  int patch = -1;  ///< -1: none
  double xi = 0;
};

struct Foot {
  bool faces = false;
  Vec3 y = Vec3::Zero(), normal = Vec3::UnitY();
  double gap = 0;                                    ///< of what faces nothing the distance
  Place place;                                       ///< of what faces nothing the nearest
  std::vector<std::pair<int, double>> weights = {};  ///< -N_i of the nodes of a master that deforms
};

/// A slave point that looks for its foot.
struct Seeker {
  int node = -1;
  Vec3 x = Vec3::Zero();
  Vec2 outward = Vec2::Zero();  ///< sum of the normals of its facets, times their lengths; zero: it has none
};

struct Touch;

class Master {
 public:
  /// `slave`: side expression; the same as `master` where a side touches itself. `integrated`: over segments.
  Master(const Scene& scene, const Json& contact, const std::string& slave, const std::string& master, bool integrated);
  bool rigid() const { return !obstacle.empty(); }
  void place_vertices(const Field& x);  ///< where they are from now on, of nodes at x
  Line line_of(const Patch& patch) const { return {at_.col(patch.vertex[1]), at_.col(patch.vertex[2])}; }
  Vec2 position(const Place& place, int derivative = 0) const;
  Foot foot(const Seeker& seeker) const;
  Foot foot(const Place& place) const;  ///< there
  /// What a point of a side that touches itself does not face: its own wall. `seeker`: the point at the start; `size`:
  /// of its facets, length.
  void set_wall(const Seeker& seeker, double size);
  /// How deep a facet of a side that touches itself may be inside of a patch; negative: it may not face it.
  double depth_in(const Facet& facet, int patch, const std::map<int, Touch>& last) const;

  std::vector<Patch> patches;
  Facets facets;    ///< of a side of a body: those of the patches
  double loop = 0;  ///< length of a closed master; 0: it is open
  Json obstacle;    ///< empty: the master deforms
  Motion motion;    ///< of an obstacle

 private:
  void link(double corner);
  void number_nodes();
  Eigen::Vector4d functions(const Place& place, int derivative = 0) const;  ///< N_i
  bool may_face(const Seeker& seeker, int patch) const;
  Place closest(const Seeker& seeker) const;
  Place find(const Seeker& seeker) const;
  void share_vertex(const Seeker& seeker, Foot& foot) const;

  const Scene& scene_;
  Places at_;                               ///< where nodes are, or the points of an obstacle's polyline
  int smooth_ = 0;                          ///< 0: facets, 1: Catmull-Rom, 2: B-spline
  bool itself_ = false, frozen_ = false;    ///< frozen: facets of the start, at small strain
  std::map<int, std::vector<char>> walls_;  ///< of each node, the patches of its own wall
  std::map<int, double> depths_;            ///< of each node: the thickness of the wall, or the size of its facets
  std::map<int, int> number_;               ///< of each node of a side that touches itself, along it
};

/// A place of contact: a slave node, or the multiplier of one. Its weights are 1 of the slave, -N_i of the master. The
/// traction and the springs are of whoever solved it.
struct Touch : Foot {
  int node = -1;
  double area = 0;                                       ///< of the start, on which its traction acts
  Vec3 slip = Vec3::Zero();                              ///< of this increment, across the normal
  bool slip_known = false;                               ///< false: it faced nothing before
  double opening = 0;                                    ///< of the gap in this increment
  Vec3 carried = Vec3::Zero();                           ///< motion of an obstacle's surface there in this increment
  Vec3 relative = Vec3::Zero(), tangent = Vec3::Zero();  ///< w of small strain; m of segments
  double along = 0;                                      ///< Z of segments
  std::vector<std::pair<int, double>> slave = {};        ///< weights of the slave's nodes, without those of the master
  int faced = -1;                                        ///< of segments: the patch of the first
  Vec3 traction = Vec3::Zero();                          ///< on the slave, force per area of the start
  Vec2 compliance = Vec2::Zero();  ///< of the springs of a penalty, normal and tangential; zero: multipliers
  double slid = 0;                 ///< slip since the start along e
  Vec3 e() const { return {-normal[1], normal[0], 0}; }
  double pressure() const { return traction.dot(normal); }
  Vec3 friction() const { return traction - pressure() * normal; }
};

/// A contact of a slave side and a master.
class Contact {
 public:
  /// `sides`: {"of": entry of the scene, "slave", "master"}.
  Contact(const Scene& scene, const std::string& called, const Json& sides);
  /// Moves all places to displacements. Call it in order of time.
  void advance(const Field& u, double time);

  std::string name, group;
  Json given;                          ///< its entry in the scene
  bool itself, segment;                ///< it is a side that touches itself; it is integrated over segments
  std::map<int, Touch> touches, last;  ///< the places by slave node, now and in the last increment
  double heat = 0;                     ///< of plastic slip since the start; NaN: not known

 private:
  /// Part of a slave facet that faces one patch of the master (-1: an obstacle without patches).
  struct Piece {
    Facet facet;
    int patch;
    double from, to;
  };
  Seeker seeker(int node, const Field& x) const;
  bool carries(int node, const Facet& facet) const;
  std::vector<Piece> cut(const Facet& facet, const Field& x) const;
  double integrate(const Piece& piece, int node, const Field& x, Touch& touch) const;
  Touch on_pieces(int node, const Field& x) const;
  void move(Touch& touch, const Touch& last, const Field& u, double time) const;

  const Scene& scene_;
  const Body& body_;
  Side side_;
  Master master_;
  Facets facets_;
  std::map<int, double> areas_;
  std::set<int> corners_;  ///< where the slave side turns by more than 60 degrees
  double last_time_ = at_rest;
};

// --- responses -------------------------------------------------------------------------------------------------------

/// What responses are measured on.
struct State {
  const Scene& scene;
  const Field& u;
  const Bodies& bodies;
  const std::vector<Contact>& contacts;
  const Field& held;  ///< forces of the supports
  Vec3 place(int node) const { return scene.points.col(node) + (scene.finite ? 1.0 : 0.0) * u.col(node); }
};

/// The value of a response; none of those that are not measured again.
std::optional<double> measure(const State& state, const Json& response);

}  // namespace stickslip::verify
