/// A scene and a mesh as `verify` reads them: from JSON alone, by code that shares nothing with the solver. Vectors
/// have three components; in a plane the third is zero. What keys mean: docs/scene.md, docs/verify.md.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <ranges>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

namespace stickslip::verify {

using Json = nlohmann::json;
using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Nodes = std::vector<int>;
using Field = Eigen::Matrix3Xd;   ///< a vector a node
using Places = Eigen::Matrix2Xd;  ///< the same in a plane

constexpr double infinity = std::numeric_limits<double>::infinity();
/// The time before a run, when nothing has moved yet: a motion that is there at the time 0 is made in the first step.
constexpr double at_rest = -infinity;

/// A file that cannot be read, or does not fit the scene.
struct BadFile : std::runtime_error {
  using std::runtime_error::runtime_error;
};

Vec3 vec3(const Json& json);                                 ///< of two or three numbers
const Json& part(const Json& json, const std::string& key);  ///< an empty object where the key is missing

/// A value in time: a number, or a table that is linear between its rows, and may be repeated; 0 at rest.
double value_at(const Json& value, double time);

/// A rigid motion x = c + R (X - c) + move of a support or an obstacle, by the axes and the angle that it prescribes.
struct Motion {
  Json move, rotate;
  Vec3 center = Vec3::Zero(), axis = Vec3::UnitZ();
  explicit Motion(const Json& json);
  bool prescribes(int i) const { return !rotate.empty() || move.contains(std::string(1, "xyz"[i])); }
  double angle(double time) const;  ///< radians
  Mat3 turn(double time) const { return Eigen::AngleAxisd(angle(time), axis).toRotationMatrix(); }
  /// Displacement of what is at X at the start; where strains are small, linear in the angle.
  Vec3 displacement(const Vec3& X, double time, bool finite) const;
  Vec3 back(const Vec3& x, double time) const;  ///< where it was at the start
};

/// An element in natural coordinates, 0 <= r, s, t <= 1, of triangles and tetrahedra r + s + t <= 1 too.
struct Reference {
  Field nodes = {};  ///< corners, counter-clockwise, then the middles of the sides in turn; in space t = 0 first
  std::vector<Nodes> sides = {};  ///< edges: two ends, and a middle; in space faces, counter-clockwise from outside
  /// Gauss points of full rank: the first nodes and then the middle, drawn to the middle.
  double drawn = 0;
  Eigen::VectorXd weights = {};
};
const Reference& reference(const std::string& element);  ///< L2, L3: edges; without nodes: there is no such element

struct Body {
  std::string name, element;
  Json given;  ///< its entry in the scene
  std::vector<Nodes> elements;
  std::map<std::string, Nodes> sides;
  std::vector<Nodes> edges = {};  ///< of the boundary, as sides of a Reference
  bool in_space() const { return element.starts_with("H8") || element == "T4"; }
  bool averages() const { return element.ends_with("mean_dilatation"); }
  bool quadratic() const { return element == "Q8" || element == "T6"; }
  bool spring() const { return element == "point"; }
  bool solid() const { return element != "bar" && !spring(); }
  double area() const { return given.value("area", 1.0); }  ///< of bars
  Mat3 stiffness() const;                                   ///< of a spring
};

/// Nodes of a side, and the edges of the boundary that belong to it, in space its faces.
struct Side {
  std::set<int> nodes;
  std::vector<Nodes> edges;
  bool has(int node) const { return nodes.contains(node); }
};

/// An edge of a side in the plane, or half of one that has a middle: x(s) = (1 - s) x_a + s x_b, and of a half in addition
/// s (1 - s) (x_middle - (x_start + x_end) / 2).
struct Facet {
  std::array<int, 2> ends;
  Nodes edge = {};  ///< of a half: start, end, middle
  bool has(int node) const { return ends[0] == node || ends[1] == node; }
  /// Of the nodes, at s, or their derivatives.
  std::vector<std::pair<int, double>> weights(double s, int derivative = 0) const;
  Vec3 at(const Field& x, double s, int derivative = 0) const;
};
using Facets = std::vector<Facet>;
Facets facets_of(const Side& side);

struct Scene {
  Json json;
  bool finite = false, axisymmetric = false, plane_stress = false;
  int dimension = 2;
  Field points;  ///< of all nodes at the start
  std::vector<Body> bodies;

  Scene(const Json& scene, const Json& mesh);
  const Body& body(const std::string& expression) const;  ///< that a side expression begins with
  /// `block.left`, `block.left & block.bottom` (what both share), `block.left - block.top` (without the nodes of the
  /// other; edges stay as long as one of their nodes does).
  Side side(const std::string& expression) const;
  /// What a length at the radius x is multiplied by to be an area.
  double depth(const Body& body, double x) const;
  /// Whether a node is on the axis of revolution, where it has no radial motion.
  bool on_axis(int node) const;
  /// Where nodes count as being: at small strain at their places of the start.
  Field places(const Field& u) const { return points + (finite ? 1.0 : 0.0) * u; }
};

}  // namespace stickslip::verify
