/// Definitions of the templates in slots.hpp.
#pragma once

#include "core/model/slots.hpp"

namespace stickslip {

namespace detail {

template <class T, class Shape>
Mat<T, 2, Shape::nodes> gather_coordinates(const Points<T>& points, const int* nodes) {
  Mat<T, 2, Shape::nodes> X;
  for (int a = 0; a < Shape::nodes; ++a)
    for (int i = 0; i < 2; ++i) X(i, a) = points(i, nodes[a]);
  return X;
}

template <class T, class Shape>
Mat<T, 2, Shape::nodes> gather_displacements(const Vector<T>& u, const int* nodes) {
  Mat<T, 2, Shape::nodes> local;
  for (int a = 0; a < Shape::nodes; ++a)
    for (int i = 0; i < 2; ++i) local(i, a) = u[nodes[a] * 2 + i];
  return local;
}

/// Nodes of element e in the numbering of the model.
inline std::vector<int> element_nodes(const BodyMesh& body, int e) {
  const int n = nodes_of(body.mesh.shape);
  std::vector<int> nodes(n);
  for (int a = 0; a < n; ++a) nodes[a] = body.first_node + body.mesh.connectivity[e * n + a];
  return nodes;
}

/// Initial places of a bar's nodes, and its relative displacement.
template <class T, int D>
Mat<T, D, 2> bar_coordinates(const Slots<T>& slots, const std::vector<int>& nodes) {
  Mat<T, D, 2> X;
  for (int a = 0; a < 2; ++a)
    for (int i = 0; i < D; ++i) X(i, a) = slots.points(i, nodes[a]);
  return X;
}
template <class T, int D>
Vec<T, D> bar_stretch(const std::vector<int>& nodes, const Vector<T>* u) {
  Vec<T, D> d = Vec<T, D>::Constant(T(0));
  for (int i = 0; u && i < D; ++i) d[i] = (*u)[nodes[1] * D + i] - (*u)[nodes[0] * D + i];
  return d;
}

/// Tangent of a two-node lumped element: [k, -k; -k, k] of a spring, or a bar. `u`: nullptr: no displacements.
template <class T>
Matrix<T> lumped_tangent(const Model& model, const Slots<T>& slots, int b, const std::vector<int>& nodes,
                         const Vector<T>* u) {
  const int D = model.dimension;
  if (const auto* spring = std::get_if<SpringLaw<T>>(&slots.laws[b])) {
    Matrix<T> K(2 * D, 2 * D);
    K << spring->stiffness, -spring->stiffness, -spring->stiffness, spring->stiffness;
    return K;
  }
  return with_dimension(D, [&]<int d>() -> Matrix<T> {
    const auto X = bar_coordinates<T, d>(slots, nodes);
    const auto& law = std::get<BarLaw<T>>(slots.laws[b]);
    if (law.green) return green_bar_tangent<T, d>(X, law.axial, bar_stretch<T, d>(nodes, u));
    return bar_tangent<T, d>(X, law.axial);
  });
}

template <class T>
bool is_green(const Law<T>& law) {
  const auto* bar = std::get_if<BarLaw<T>>(&law);
  return bar && bar->green;
}

/// Adds the forces of a bar of Green strain.
template <class T>
void add_green_bar_force(const Model& model, const Slots<T>& slots, int b, const std::vector<int>& nodes,
                         const Vector<T>& u, Vector<T>& forces) {
  with_dimension(model.dimension, [&]<int d>() {
    const auto force = green_bar_force<T, d>(bar_coordinates<T, d>(slots, nodes),
                                             std::get<BarLaw<T>>(slots.laws[b]).axial, bar_stretch<T, d>(nodes, &u));
    for (int i = 0; i < d; ++i) {
      forces[nodes[0] * d + i] -= force[i];
      forces[nodes[1] * d + i] += force[i];
    }
  });
}

/// Energy of a spring: half the work of its force.
template <class T>
T spring_energy(const SpringLaw<T>& spring, int D, const std::vector<int>& nodes, const Vector<T>& u) {
  T energy{};
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j)
      energy += T(0.5) * spring.stiffness(i, j) * (u[nodes[1] * D + i] - u[nodes[0] * D + i]) *
                (u[nodes[1] * D + j] - u[nodes[0] * D + j]);
  return energy;
}

/// Calls f.template operator()<Shape, kinematics>() with what the elements of a continuum are.
template <class F>
void with_element(const BodyMesh& body, F&& f) {
  with_shape(body.mesh.shape, [&]<class Shape>(Shape) {
    with_kinematics<Shape>(body.kinematics,
                           [&]<Kinematics kinematics>() { f.template operator()<Shape, kinematics>(); });
  });
}

/// Calls f.template operator()<Shape, kinematics>(law) with the elements of a continuum and its law. What a law is not
/// made for is left out: the neo-Hookean one knows the plane alone, where the model has it alone.
template <class T, class F>
void with_continuum(const BodyMesh& body, const Law<T>& law, F&& f) {
  if (const auto* linear = std::get_if<LinearElasticLaw<T>>(&law)) {
    with_element(body,
                 [&]<class Shape, Kinematics kinematics>() { f.template operator()<Shape, kinematics>(*linear); });
    return;
  }
  with_shape(body.mesh.shape, [&]<class Shape>(Shape) {
    f.template operator()<Shape, Kinematics::plane>(std::get<NeoHookeanLaw<T>>(law));
  });
}

/// Whether no derivative rides on any entry.
template <class A>
bool is_constant(const A& entries) {
  return std::all_of(entries.data(), entries.data() + entries.size(),
                     [](const auto& x) { return stickslip::is_constant(x); });
}

/// Forces of one element of a continuum. Derivatives are computed of what depends on them alone: most parameters touch
/// few elements, and those of a material no gradient.
template <class T, class Shape, Kinematics kinematics, template <class> class MaterialLaw>
Mat<T, 2, Shape::nodes> forces_of_element(const MaterialLaw<T>& law, const Mat<T, 2, Shape::nodes>& coordinates,
                                          const Mat<T, 2, Shape::nodes>& u, const T& thickness) {
  if constexpr (tells_constants<T>) {
    if (stickslip::is_constant(thickness) && is_constant(coordinates)) {
      const Mat<double, 2, Shape::nodes> fixed = values(coordinates);
      if (!stickslip::is_constant(law.lame) || !stickslip::is_constant(law.shear) || !is_constant(u))
        return element_forces<T, Shape, kinematics, double>(law, fixed, u, value(thickness));
      const auto plain = law.with(value(law.lame), value(law.shear));
      const Mat<double, 2, Shape::nodes> forces =
          element_forces<double, Shape, kinematics>(plain, fixed, values(u), value(thickness));
      return forces.unaryExpr([](double x) { return T(x); });
    }
  }
  return element_forces<T, Shape, kinematics>(law, coordinates, u, thickness);
}

}  // namespace detail

template <class T>
Vector<T> bulk_forces(const Model& model, const Slots<T>& slots, const Vector<T>& u, const ElementLists* only) {
  const int D = model.dimension;
  Vector<T> forces = Vector<T>::Constant(model.dof_count(), T(0));
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const auto& body = model.bodies[b];
    const int count = only ? static_cast<int>((*only)[b].size()) : body.mesh.element_count();
    const auto element = [&](int k) { return only ? (*only)[b][k] : k; };
    if (is_continuum(body.mesh.shape)) {
      const T& thickness = slots.depths[b].thickness;
      detail::with_continuum<T>(body, slots.laws[b], [&]<class Shape, Kinematics kinematics>(const auto& law) {
        std::array<int, Shape::nodes> nodes;
        for (int k = 0; k < count; ++k) {
          for (int a = 0; a < Shape::nodes; ++a)
            nodes[a] = body.first_node + body.mesh.connectivity[element(k) * Shape::nodes + a];
          const auto f = detail::forces_of_element<T, Shape, kinematics>(
              law, detail::gather_coordinates<T, Shape>(slots.points, nodes.data()),
              detail::gather_displacements<T, Shape>(u, nodes.data()), thickness);
          for (int a = 0; a < Shape::nodes; ++a)
            for (int i = 0; i < 2; ++i) forces[nodes[a] * 2 + i] += f(i, a);
        }
      });
      continue;
    }
    for (int k = 0; k < count; ++k) {
      const auto nodes = detail::element_nodes(body, element(k));
      if (detail::is_green(slots.laws[b])) {
        detail::add_green_bar_force(model, slots, static_cast<int>(b), nodes, u, forces);
        continue;
      }
      const Matrix<T> K = detail::lumped_tangent<T>(model, slots, static_cast<int>(b), nodes, nullptr);
      for (int a = 0; a < 2; ++a)
        for (int i = 0; i < D; ++i)
          for (int j = 0; j < D; ++j)  // K is [k, -k; -k, k]: forces of the relative displacement, free of cancellation
            forces[nodes[a] * D + i] += K(a * D + i, j) * (u[nodes[0] * D + j] - u[nodes[1] * D + j]);
    }
  }
  return forces;
}

template <class T, class Sink>
void for_each_element_tangent(const Model& model, const Slots<T>& slots, int b, const std::vector<int>* only,
                              Sink&& sink, const Vector<T>* u) {
  const auto& body = model.bodies[b];
  const int count = only ? static_cast<int>(only->size()) : body.mesh.element_count();
  for (int k = 0; k < count; ++k) {
    const int e = only ? (*only)[k] : k;
    const auto nodes = detail::element_nodes(body, e);
    if (!is_continuum(body.mesh.shape)) {
      sink(nodes, detail::lumped_tangent(model, slots, b, nodes, u));
      continue;
    }
    detail::with_continuum<T>(body, slots.laws[b], [&]<class Shape, Kinematics kinematics>(const auto& law) {
      Mat<T, 2, Shape::nodes> local = Mat<T, 2, Shape::nodes>::Constant(T(0));
      if (u) local = detail::gather_displacements<T, Shape>(*u, nodes.data());
      const auto X = detail::gather_coordinates<T, Shape>(slots.points, nodes.data());
      sink(nodes, element_tangent<T, Shape, kinematics>(law, X, local, slots.depths[b].thickness));
    });
  }
}

template <class T>
Vector<T> bulk_tangent_times(const Model& model, const Slots<T>& slots, const Vector<T>& u, const Vector<T>& vector) {
  if (model.effects.linear_bulk) return bulk_forces(model, slots, vector);
  const int D = model.dimension;
  Vector<T> product = Vector<T>::Constant(model.dof_count(), T(0));
  const auto add = [&](const auto& nodes, const auto& K) {
    for (Eigen::Index r = 0; r < K.rows(); ++r)
      for (Eigen::Index c = 0; c < K.cols(); ++c)
        product[nodes[r / D] * D + r % D] += K(r, c) * vector[nodes[c / D] * D + c % D];
  };
  for (int b = 0; b < static_cast<int>(model.bodies.size()); ++b)
    for_each_element_tangent(model, slots, b, nullptr, add, &u);
  return product;
}

template <class T>
T bulk_energy(const Model& model, const Slots<T>& slots, const Vector<T>& u) {
  if (model.effects.linear_bulk) return T(0.5) * dot(bulk_forces(model, slots, u), u);
  T energy{};
  for (int b = 0; b < static_cast<int>(model.bodies.size()); ++b) {
    const auto& body = model.bodies[b];
    for (int e = 0; e < body.mesh.element_count(); ++e) {
      const auto nodes = detail::element_nodes(body, e);
      if (const auto* law = std::get_if<NeoHookeanLaw<T>>(&slots.laws[b])) {
        with_shape(body.mesh.shape, [&]<class Shape>(Shape) {
          energy += stored_energy<T, Shape>(*law, detail::gather_coordinates<T, Shape>(slots.points, nodes.data()),
                                            detail::gather_displacements<T, Shape>(u, nodes.data()),
                                            slots.depths[b].thickness);
        });
        continue;
      }
      if (const auto* bar = std::get_if<BarLaw<T>>(&slots.laws[b])) {
        with_dimension(model.dimension, [&]<int d>() {
          energy += green_bar_energy<T, d>(detail::bar_coordinates<T, d>(slots, nodes), bar->axial,
                                           detail::bar_stretch<T, d>(nodes, &u));
        });
        continue;
      }
      energy += detail::spring_energy(std::get<SpringLaw<T>>(slots.laws[b]), model.dimension, nodes, u);
    }
  }
  return energy;
}

/// Diagonal D x D blocks of the bodies' stiffness at the contact nodes, in the order of Model::contact_nodes.
template <class T>
std::vector<Matrix<T>> nodal_stiffness(const Model& model, const Slots<T>& slots) {
  const int D = model.dimension;
  std::vector<int> place(model.node_count, -1);
  for (std::size_t i = 0; i < model.contact_nodes.size(); ++i) place[model.contact_nodes[i]] = static_cast<int>(i);
  std::vector<Matrix<T>> blocks(model.contact_nodes.size(), Matrix<T>::Constant(D, D, T(0)));
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    std::vector<int> touching;
    for (int e = 0; e < model.bodies[b].mesh.element_count(); ++e)
      for (int node : detail::element_nodes(model.bodies[b], e))
        if (place[node] >= 0) {
          touching.push_back(e);
          break;
        }
    for_each_element_tangent(model, slots, static_cast<int>(b), &touching, [&](const auto& nodes, const auto& K) {
      for (std::size_t a = 0; a < nodes.size(); ++a)
        if (place[nodes[a]] >= 0)
          for (int i = 0; i < D; ++i)
            for (int j = 0; j < D; ++j) blocks[place[nodes[a]]](i, j) += K(a * D + i, a * D + j);
    });
  }
  return blocks;
}

/// Whether supports hold a contact node along a direction.
template <class T>
bool is_held(const Model& model, const Slots<T>& slots, int node, const Vector<double>& direction) {
  constexpr double across = 1e-6;  // of a direction: less is none
  const int D = model.dimension, framed = framed_index(model, node);
  for (int i = 0; i < D; ++i) {
    if (model.free_index[node * D + i] < 0) continue;
    const double along = framed < 0 ? direction[i] : values(slots.frames[framed]).col(i).dot(direction);
    if (std::abs(along) > across) return false;
  }
  return true;
}

/// k_i between the slave's and the master's stiffness: their harmonic mean, as springs in series. Where supports hold
/// one side along a direction of the contact and not the other, that other alone yields there, and its stiffness is
/// k_i (their sum, where each yields alone along another direction). Supports decide, not sizes: k_i is smooth in both.
template <class T>
T stiffness_between(const Model& model, const Slots<T>& slots, int p, const T& slave, const T& master) {
  const auto& point = model.points[p];
  const auto& geometry = slots.geometry[p];
  const auto middle = point.nodes.begin() + point.slave_nodes;
  bool slave_yields = false, master_yields = false;  // alone
  for (int c = 0; c < point.components(); ++c) {
    const Vector<double> direction = c == 0 ? values(geometry.normal) : values(geometry.tangents.col(c - 1));
    const auto held = [&](int node) { return is_held(model, slots, node, direction); };
    const bool slave_held = std::all_of(point.nodes.begin(), middle, held);
    const bool master_held = std::all_of(middle, point.nodes.end(), held);
    slave_yields |= master_held && !slave_held;
    master_yields |= slave_held && !master_held;
  }
  if (slave_yields && master_yields) return slave + master;
  if (slave_yields) return slave;
  if (master_yields) return master;
  return T(2) * slave * master / (slave + master);
}

/// k_i of each contact point, from n.K_ii n at the interpolated slave and at the interpolated master nodes (slave only
/// if the master is rigid). Where a node has next to no stiffness along n (bars along their axis), the mean over all
/// directions stands in for it.
template <class T>
std::vector<T> contact_stiffness(const Model& model, const Slots<T>& slots) {
  const auto blocks = nodal_stiffness(model, slots);
  auto along = [&](int node, const auto& n) {
    const auto& nodes = model.contact_nodes;
    const auto& K = blocks[std::lower_bound(nodes.begin(), nodes.end(), node) - nodes.begin()];
    const int D = model.dimension;
    T k{}, mean{};
    for (int i = 0; i < D; ++i) {
      mean += K(i, i) / T(static_cast<double>(D));
      for (int j = 0; j < D; ++j) k += n[i] * K(i, j) * n[j];
    }
    return value(k) > 1e-6 * value(mean) ? k : mean;
  };
  std::vector<T> stiffness;
  for (int p = 0; p < static_cast<int>(model.points.size()); ++p) {
    const auto& point = model.points[p];
    const auto& geometry = slots.geometry[p];
    T slave{}, master{};
    for (int i = 0; i < static_cast<int>(point.nodes.size()); ++i) {
      const T k = along(point.nodes[i], geometry.normal);
      if (i < point.slave_nodes)
        slave += geometry.weights[i] * k;
      else
        master += -geometry.weights[i] * k;
    }
    stiffness.push_back(point.obstacle >= 0 ? slave : stiffness_between(model, slots, p, slave, master));
  }
  return stiffness;
}

template <class T>
Points<T> initial_points(const Model& model, const Numbers<T>& numbers) {
  Points<T> points(model.dimension, model.node_count);
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const auto& body = model.bodies[b];
    points.middleCols(body.first_node, body.mesh.node_count) =
        make_points<T>(model.scene.bodies[b].mesh, body.mesh, numbers);
  }
  for (const auto& velocity : model.velocities) {
    const T& distance = numbers.at_slot[velocity.slot];
    if (vanishes(distance)) continue;
    const int first = model.bodies[velocity.body].first_node;
    const Vector<double> share = velocity.share();
    for (Eigen::Index n = 0; n < share.size(); ++n)
      for (int i = 0; i < model.dimension; ++i) points(i, first + n) += T(share[n] * velocity.direction[i]) * distance;
  }
  return points;
}

template <class T>
Slots<T> make_slots(const Model& model, const Numbers<T>& numbers) {
  return make_slots(model, numbers, initial_points(model, numbers));
}

template <class T>
Slots<T> make_slots(const Model& model, const Numbers<T>& numbers, Points<T> points) {
  Slots<T> slots;
  slots.numbers = numbers;
  slots.points = std::move(points);
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const auto& body = model.bodies[b];
    slots.laws.push_back(detail::make_law(model.scene, model.scene.bodies[b], body.mesh, numbers));
    const bool plane = is_continuum(body.mesh.shape) && model.scene.space != Space::axisymmetric;
    slots.depths.push_back(
        {model.scene.space == Space::axisymmetric, plane ? numbers(model.scene.bodies[b].thickness) : T(1)});
  }
  for (const auto& contact : model.scene.contacts)
    slots.friction.push_back(contact.friction ? contact.friction->template as<T>(numbers) : FrictionLaw<T>());
  for (const auto& point : model.points) slots.geometry.push_back(detail::initial_geometry(model, point, slots));
  for (const auto& framed : model.framed) slots.frames.push_back(nodal_frame(model.scene, framed, numbers));
  slots.stiffness = contact_stiffness(model, slots);
  for (const auto& load : model.scene.loads) slots.loads.push_back(load_vector(model, load, slots));
  const auto& obstacles = model.scene.obstacles;
  if (std::any_of(obstacles.begin(), obstacles.end(), [](const auto& o) { return o.rotate.has_value(); }))
    for (int p = 0; p < static_cast<int>(model.points.size()); ++p)
      slots.spins.push_back(detail::spin(model, p, slots));
  return slots;
}

}  // namespace stickslip

#include "core/model/load_vector.hpp"
