/// A scene and a mesh as `verify` reads them: from JSON alone, by code that shares nothing with the solver. Vectors
/// have three components; in a plane the third is zero. What keys mean: docs/scene.md, docs/verify.md.
#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

namespace stickslip::verify {

using Json = nlohmann::json;
using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Field = Eigen::Matrix3Xd;  ///< a vector a node

/// A file that cannot be read, or does not fit the scene.
struct BadFile : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The time before a run, when nothing has moved yet: a motion that is there at the time 0 is made in the first step.
constexpr double at_rest = -std::numeric_limits<double>::infinity();

/// A value in time: a number, or a table that is linear between its rows, and may be repeated.
class Value {
 public:
  explicit Value(const Json& json);
  double at(double time) const;

 private:
  std::vector<std::array<double, 2>> rows_;
  double repeats_ = 1;
};

/// A rigid motion: a displacement by axis, and a turn by an angle, x = c + R (X - c) + move.
struct Motion {
  std::array<std::optional<Value>, 3> move;
  std::optional<Value> angle;  ///< degrees
  Vec3 center = Vec3::Zero(), axis = Vec3::UnitZ();

  Motion() = default;
  explicit Motion(const Json& json);
  Mat3 turn(double time) const;
  Vec3 shift(double time) const;
  /// Displacement of what is at X at the start; where strains are small, linear in the angle.
  Vec3 displacement(const Vec3& X, double time, bool finite) const;
  Vec3 forth(const Vec3& X, double time) const { return X + displacement(X, time, true); }
  Vec3 back(const Vec3& x, double time) const;  ///< where it was at the start
};

struct Body {
  std::string name, element;
  double thickness = 1, area = 1;  ///< of a body in a plane; of bars
  Json material;                   ///< {name: numbers}
  std::vector<std::vector<int>> elements;
  std::map<std::string, std::vector<int>> sides;
  std::vector<std::vector<int>> edges;  ///< of the boundary, the solid on the left: two ends, and a middle
  bool quadratic() const { return element == "Q8" || element == "T6"; }
  bool solid() const { return element != "bar" && element != "point"; }
};

/// Nodes of a side, and the edges of the boundary that belong to it.
struct Side {
  std::set<int> nodes;
  std::vector<std::vector<int>> edges;
};

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
  /// Where a node counts as being: at small strain at its place of the start.
  Vec3 place(int node, const Field& u) const { return points.col(node) + (finite ? 1.0 : 0.0) * u.col(node); }

 private:
  Side named(const std::string& word) const;
};

/// A list of two or three numbers.
Vec3 vec3(const Json& json);

/// An object of the scene, or an empty one where the key is missing.
const Json& part(const Json& json, const char* key);

}  // namespace stickslip::verify
