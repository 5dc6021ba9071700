/// Design velocities: how the nodes of a body move with a shape parameter whose value is the distance that a side (or
/// one node of it) moves along a direction. The motion is extended into the body by Laplace's equation,
///
///   div grad w = 0,   w = 1 where it moves,   w = 0 where the body stays,   x <- x + w d phi
///
/// discretised on the mesh itself, so that neighbouring nodes move alike and elements keep their shape.
#pragma once

#include <memory>
#include <vector>

#include "core/mesh/mesh.hpp"

namespace stickslip {

struct Scene;

/// Solves the equation for one body and one set of nodes whose values are given; factorised once.
class ShapeExtension {
 public:
  /// `points`: of the body, D x nodes; `given`: per node. Throws std::runtime_error where a part of the body has no
  /// given node.
  ShapeExtension(const Mesh& mesh, const Points<double>& points, std::vector<char> given);
  ~ShapeExtension();

  const std::vector<char>& given() const { return given_; }
  /// The field with these values at the given nodes (zero elsewhere): linear in them.
  Vector<double> extend(const Vector<double>& values) const;
  /// extend() transposed: from derivatives by the field to derivatives by the values at the given nodes.
  Vector<double> pull_back(const Vector<double>& by_field) const;

 private:
  struct Factor;
  std::vector<char> given_;
  std::vector<int> free_;
  std::unique_ptr<Factor> factor_;
};

/// Of one shape motion of the scene.
struct DesignVelocity {
  int body = 0;
  int slot = 0;            ///< of the parameter in Scene::numbers
  std::vector<int> moved;  ///< nodes of the body that move by the whole of it
  std::vector<double> direction;
  std::shared_ptr<const ShapeExtension> extension;

  /// w: what each node of the body moves along the direction, per unit of the parameter. One solve.
  Vector<double> share() const;
};

/// Design velocities of the shape motions of one body, in their order; motions alike share a factor.
std::vector<DesignVelocity> design_velocities(const Scene& scene, int body, const Mesh& mesh,
                                              const Points<double>& points);

}  // namespace stickslip
