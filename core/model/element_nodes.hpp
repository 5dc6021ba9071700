/// Nodes of the elements of a body, and what stands at them.
#pragma once

#include "core/model/model.hpp"

namespace stickslip::detail {

template <class T, class Shape>
Nodal<T, Shape> gather_coordinates(const Points<T>& points, const int* nodes) {
  Nodal<T, Shape> X;
  for (int a = 0; a < Shape::nodes; ++a)
    for (int i = 0; i < Shape::dimension; ++i) X(i, a) = points(i, nodes[a]);
  return X;
}

template <class T, class Shape>
Nodal<T, Shape> gather_displacements(const Vector<T>& u, const int* nodes) {
  Nodal<T, Shape> local;
  for (int a = 0; a < Shape::nodes; ++a)
    for (int i = 0; i < Shape::dimension; ++i) local(i, a) = u[nodes[a] * Shape::dimension + i];
  return local;
}

/// Nodes of element e in the numbering of the model; in place, for a loop that allocates once.
inline void set_element_nodes(const BodyMesh& body, int e, std::vector<int>& nodes) {
  const int n = nodes_of(body.mesh.shape);
  nodes.resize(n);
  for (int a = 0; a < n; ++a) nodes[a] = body.first_node + body.mesh.connectivity[e * n + a];
}
inline std::vector<int> element_nodes(const BodyMesh& body, int e) {
  std::vector<int> nodes;
  set_element_nodes(body, e, nodes);
  return nodes;
}

/// Initial places of the nodes of an element of two, and their relative displacement (none: zero).
template <class T, int D>
Mat<T, D, 2> two_places(const Points<T>& points, const std::vector<int>& nodes) {
  Mat<T, D, 2> X;
  for (int a = 0; a < 2; ++a)
    for (int i = 0; i < D; ++i) X(i, a) = points(i, nodes[a]);
  return X;
}
template <class T, int D>
Vec<T, D> two_node_stretch(const std::vector<int>& nodes, const Vector<T>* u) {
  Vec<T, D> d = Vec<T, D>::Constant(T(0));
  for (int i = 0; u && i < D; ++i) d[i] = (*u)[nodes[1] * D + i] - (*u)[nodes[0] * D + i];
  return d;
}

/// Calls f.template operator()<Shape, kinematics>() with what the elements of a continuum are.
template <class F>
void with_element(const BodyMesh& body, F&& f) {
  with_shape(body.mesh.shape, [&]<class Shape>(Shape) {
    with_kinematics<Shape>(body.kinematics,
                           [&]<Kinematics kinematics>() { f.template operator()<Shape, kinematics>(); });
  });
}

}  // namespace stickslip::detail
