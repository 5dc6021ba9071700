/// Nodes of quadratic elements on a circle, or on a sphere.
#pragma once

#include "core/algebra/number.hpp"
#include "core/mesh/mesh.hpp"

namespace stickslip {

/// Moves a node along its ray from the centre onto the circle. pre: it is not the centre.
template <class T>
void onto_circle(const std::array<Number, 2>& center, const T& radius, const Numbers<T>& numbers, int node,
                 Points<T>& points) {
  const T x0 = numbers(center[0]), y0 = numbers(center[1]);
  const Vec<T, 2> ray(points(0, node) - x0, points(1, node) - y0);
  const T stretch = radius / norm(ray);
  points(0, node) = x0 + stretch * ray[0];
  points(1, node) = y0 + stretch * ray[1];
}

/// Puts the middles of a side's edges on the circle.
template <class T>
void bend_side(const Side& side, const std::array<Number, 2>& center, const Number& radius, const Numbers<T>& numbers,
               Points<T>& points) {
  for (const auto& edge : side.quadratic) onto_circle(center, numbers(radius), numbers, edge[2], points);
}

/// Moves a node along its ray from the centre onto the sphere. pre: it is not the centre.
template <class T>
void onto_sphere(const Vec<T, 3>& center, const T& radius, int node, Points<T>& points) {
  const Vec<T, 3> ray = Vec<T, 3>(points.col(node)) - center;
  const T stretch = radius / norm(ray);
  for (int i = 0; i < 3; ++i) points(i, node) = center[i] + stretch * ray[i];
}

/// Puts the middles of a side's faces on the sphere.
template <class T>
void bend_side(const Side& side, const Vec<T, 3>& center, const T& radius, Points<T>& points) {
  for (const auto& face : side.quadratic)
    for (std::size_t k = corners_of_face(face.size()); k < face.size(); ++k)
      onto_sphere(center, radius, face[k], points);
}

}  // namespace stickslip
