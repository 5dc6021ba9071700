/// Definitions of the templates in slots.hpp that visit the elements of bodies: forces, tangents, energy.
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

/// Calls continuum.template operator()<Shape, kinematics>(law) with the law of body b and what its elements are, or,
/// where they are of two nodes, two_nodes.template operator()<D>(law).
template <class T, class Continuum, class TwoNodes>
void with_law(const Model& model, const Slots<T>& slots, int b, Continuum&& continuum, TwoNodes&& two_nodes) {
  std::visit(
      [&]<class L>(const L& law) {
        if constexpr (requires { L::is_finite; })
          with_element(model.bodies[b], [&]<class Shape, Kinematics kinematics>() {
            if constexpr (L::is_made_for(kinematics, false) || L::is_made_for(kinematics, true))
              continuum.template operator()<Shape, kinematics>(law);
          });
        else
          with_dimension(model.dimension, [&]<int D>() { two_nodes.template operator()<D>(law); });
      },
      slots.laws[b]);
}

/// What element e of a body remembers, and the branches of its flow from there; nothing of a law that does not.
template <class L, class T>
ElementMemory<T> memory_of_element(const BodyMesh& body, int e, const Vector<T>& memory,
                                   const FlowBranches* branches = nullptr) {
  if constexpr (Remembers<L>) {
    const Eigen::Index first = body.first_memory + static_cast<Eigen::Index>(e) * body.memory;
    return {memory.data() + first, branches && !branches->empty() ? branches->data() + first : nullptr};
  }
  return {};
}

/// Whether no derivative rides on any entry.
template <class A>
bool is_constant(const A& entries) {
  return std::all_of(entries.data(), entries.data() + entries.size(),
                     [](const auto& x) { return stickslip::is_constant(x); });
}

/// Forces of one element of a continuum. Derivatives are computed only of what depends on parameters: most parameters
/// touch few elements, and those of a material touch no gradient.
template <class T, class Shape, Kinematics kinematics, class L>
Mat<T, 2, Shape::nodes> forces_of_element(const L& law, const Mat<T, 2, Shape::nodes>& coordinates,
                                          const Mat<T, 2, Shape::nodes>& u, const T& thickness,
                                          const ElementMemory<T>& memory) {
  if constexpr (tells_constants<T> && !Remembers<L>) {
    if (stickslip::is_constant(thickness) && is_constant(coordinates)) {
      const Mat<double, 2, Shape::nodes> fixed = values(coordinates);
      const auto numbers = law.numbers();
      if (!is_constant(numbers) || !is_constant(u))
        return element_forces<T, Shape, kinematics, double>(law, fixed, u, value(thickness));
      std::array<double, std::tuple_size_v<std::decay_t<decltype(numbers)>>> plain;
      std::transform(numbers.begin(), numbers.end(), plain.begin(), [](const T& x) { return value(x); });
      const Mat<double, 2, Shape::nodes> forces =
          element_forces<double, Shape, kinematics>(law.with(plain), fixed, values(u), value(thickness));
      return forces.unaryExpr([](double x) { return T(x); });
    }
  }
  return element_forces<T, Shape, kinematics>(law, coordinates, u, thickness, memory);
}

/// Adds the forces of an element of two nodes. Of a linear law: of the relative displacement, free of cancellation.
template <class T, int D, class L>
void add_two_node_forces(const L& law, const Slots<T>& slots, const std::vector<int>& nodes, const Vector<T>& u,
                         ElementMemory<T> memory, Vector<T>& forces) {
  const auto X = two_places<T, D>(slots.points, nodes);
  const auto add = [&](int i, const T& force) {
    forces[nodes[0] * D + i] -= force;
    forces[nodes[1] * D + i] += force;
  };
  const Vec<T, D> d = two_node_stretch<T, D>(nodes, &u);
  if constexpr (Remembers<L>) {
    const Vec<T, D> force = law.template force<D>(X, d, memory.template take<L::memory>());
    for (int i = 0; i < D; ++i) add(i, force[i]);
  } else {
    if (!law.is_linear()) {
      const Vec<T, D> force = law.template force<D>(X, d);
      for (int i = 0; i < D; ++i) add(i, force[i]);
      return;
    }
    const Mat<T, D> k = law.template stiffness<D>(X, d);
    for (int i = 0; i < D; ++i)
      for (int j = 0; j < D; ++j) add(i, k(i, j) * d[j]);
  }
}

}  // namespace detail

template <class T>
Vector<T> bulk_forces(const Model& model, const Slots<T>& slots, const Vector<T>& u, const Vector<T>& memory,
                      const ElementLists* only) {
  Vector<T> forces = Vector<T>::Constant(model.dof_count(), T(0));
  for (int b = 0; b < static_cast<int>(model.bodies.size()); ++b) {
    const auto& body = model.bodies[b];
    const int count = only ? static_cast<int>((*only)[b].size()) : body.mesh.element_count();
    const auto element = [&](int k) { return only ? (*only)[b][k] : k; };
    const auto continuum = [&]<class Shape, Kinematics kinematics, class L>(const L& law) {
      const T& thickness = slots.depths[b].thickness;
      std::array<int, Shape::nodes> nodes;
      for (int k = 0; k < count; ++k) {
        for (int a = 0; a < Shape::nodes; ++a)
          nodes[a] = body.first_node + body.mesh.connectivity[element(k) * Shape::nodes + a];
        const auto f = detail::forces_of_element<T, Shape, kinematics>(
            law, detail::gather_coordinates<T, Shape>(slots.points, nodes.data()),
            detail::gather_displacements<T, Shape>(u, nodes.data()), thickness,
            detail::memory_of_element<L>(body, element(k), memory));
        for (int a = 0; a < Shape::nodes; ++a)
          for (int i = 0; i < 2; ++i) forces[nodes[a] * 2 + i] += f(i, a);
      }
    };
    const auto two_nodes = [&]<int D, class L>(const L& law) {
      for (int k = 0; k < count; ++k)
        detail::add_two_node_forces<T, D>(law, slots, detail::element_nodes(body, element(k)), u,
                                          detail::memory_of_element<L>(body, element(k), memory), forces);
    };
    detail::with_law<T>(model, slots, b, continuum, two_nodes);
  }
  return forces;
}

template <class T>
Vector<T> bulk_flow(const Model& model, const Slots<T>& slots, const Vector<T>& u, const Vector<T>& before,
                    const FlowBranches& branches) {
  Vector<T> after = before;
  for (int b = 0; b < static_cast<int>(model.bodies.size()); ++b) {
    const auto& body = model.bodies[b];
    if (body.memory == 0) continue;
    const auto continuum = [&]<class Shape, Kinematics kinematics, class L>(const L& law) {
      if constexpr (Remembers<L>)
        for (int e = 0; e < body.mesh.element_count(); ++e) {
          const auto nodes = detail::element_nodes(body, e);
          element_flow<T, Shape, kinematics>(law, detail::gather_coordinates<T, Shape>(slots.points, nodes.data()),
                                             detail::gather_displacements<T, Shape>(u, nodes.data()),
                                             detail::memory_of_element<L>(body, e, before, &branches),
                                             after.data() + body.first_memory + e * body.memory);
        }
    };
    const auto two_nodes = [&]<int D, class L>(const L& law) {
      if constexpr (Remembers<L>)
        for (int e = 0; e < body.mesh.element_count(); ++e) {
          const auto nodes = detail::element_nodes(body, e);
          auto memory = detail::memory_of_element<L>(body, e, before, &branches);
          const int branch = memory.branch();
          after.template segment<L::memory>(body.first_memory + e * body.memory) = law.template flow<D>(
              detail::two_places<T, D>(slots.points, nodes), detail::two_node_stretch<T, D>(nodes, &u),
              memory.template take<L::memory>(), branch);
        }
    };
    detail::with_law<T>(model, slots, b, continuum, two_nodes);
  }
  return after;
}

template <class T>
void for_each_plastic_strain(const Model& model, const Slots<T>& slots, int b, const Vector<T>& memory,
                             const std::type_identity_t<std::function<void(const T& a, const T& volume)>>& f) {
  const auto& body = model.bodies[b];
  if (body.memory == 0) return;
  const auto continuum = [&]<class Shape, Kinematics kinematics, class L>(const L&) {
    if constexpr (Remembers<L>)
      for (int e = 0; e < body.mesh.element_count(); ++e) {
        auto remembered = detail::memory_of_element<L>(body, e, memory);
        for_each_gradient<T, Shape, kinematics>(
            detail::gather_coordinates<T, Shape>(slots.points, detail::element_nodes(body, e).data()),
            slots.depths[b].thickness, [&](const auto& gradient) {
              f(L::template plastic_strain<T>(remembered.template take<L::memory>()), gradient.volume);
            });
      }
  };
  const auto two_nodes = [&]<int D, class L>(const L&) {
    if constexpr (Remembers<L>)
      for (int e = 0; e < body.mesh.element_count(); ++e) {
        const auto X = detail::two_places<T, D>(slots.points, detail::element_nodes(body, e));
        f(L::plastic_strain(detail::memory_of_element<L>(body, e, memory).template take<L::memory>()),
          norm((X.col(1) - X.col(0)).eval()) * detail::area_of(slots.laws[b]));
      }
  };
  detail::with_law<T>(model, slots, b, continuum, two_nodes);
}

template <class T>
std::vector<ThicknessStretch<T>> edge_stretches(const Model& model, const Slots<T>& slots, int b,
                                                const ElementEdge& edge, const Vector<T>& u) {
  using Probe = Dual<4, T>;
  std::vector<ThicknessStretch<T>> stretches;
  const auto continuum = [&]<class Shape, Kinematics kinematics, class L>(const L& law) {
    if constexpr (kinematics == Kinematics::plane && L::is_made_for(kinematics, true) && !Remembers<L>) {
      const auto nodes = detail::element_nodes(model.bodies[b], edge.element);
      const auto X = detail::gather_coordinates<T, Shape>(slots.points, nodes.data());
      const auto local = detail::gather_displacements<T, Shape>(u, nodes.data());
      const auto from = natural_corner<Shape>(edge.corner), to = natural_corner<Shape>(edge.corner + 1);
      for (const auto& point : detail::edge_quadrature(Shape::nodes > Shape::corners ? 3 : 2, false)) {
        const double s = point.value[1] + point.value[2] / 2;  // share of the way along the edge
        const Vec<double, 2> at = (1 - s) * from + s * to;
        const Gradient<T, Shape, kinematics> gradient(Shape::at(at[0], at[1], 0), X);
        const auto H = detail::seeded<Probe>(gradient.of(local));
        const Probe stretch = law.stretch_across(H);
        Vector<T> by_motion = Vector<T>::Constant(2 * Shape::nodes, T(0));
        for (int a = 0; a < Shape::nodes; ++a)
          for (int i = 0; i < 2; ++i)
            gradient.for_each(i, a,
                              [&](int p, int q, const T& x) { by_motion[2 * a + i] += stretch.d[H.place(p, q)] * x; });
        stretches.push_back({stretch.v, by_motion});
      }
    }
  };
  detail::with_law<T>(model, slots, b, continuum, []<int>(const auto&) {});
  return stretches;
}

template <class T>
void for_each_element_tangent(const Model& model, const Slots<T>& slots, int b, const std::vector<int>* only,
                              const std::type_identity_t<ElementSink<T>>& sink, const BodyMotion<T>* at) {
  constexpr bool solves = std::is_same_v<T, double> || std::is_same_v<T, std::complex<double>>;
  const auto& body = model.bodies[b];
  const Vector<T>* const u = at ? &at->displacement : nullptr;
  const int count = only ? static_cast<int>(only->size()) : body.mesh.element_count();
  const auto element = [&](int k) { return only ? (*only)[k] : k; };
  std::vector<int> nodes;
  const auto continuum = [&]<class Shape, Kinematics kinematics, class L>(const L& law) {
    for (int k = 0; k < count; ++k) {
      detail::set_element_nodes(body, element(k), nodes);
      Mat<T, 2, Shape::nodes> local = Mat<T, 2, Shape::nodes>::Constant(T(0));
      if (u) local = detail::gather_displacements<T, Shape>(*u, nodes.data());
      const auto X = detail::gather_coordinates<T, Shape>(slots.points, nodes.data());
      const T& thickness = slots.depths[b].thickness;
      if constexpr (requires { law.at_rest(); }) {
        if constexpr (solves)
          if (at) {
            const auto before = detail::memory_of_element<L>(body, element(k), at->last_memory, at->branches);
            sink(nodes, element_tangent<T, Shape, kinematics>(law, X, local, thickness, before));
            continue;
          }
        sink(nodes, element_tangent<T, Shape, kinematics>(law.at_rest(), X, local, thickness));
      } else {
        sink(nodes, element_tangent<T, Shape, kinematics>(law, X, local, thickness));
      }
    }
  };
  const auto two_nodes = [&]<int D, class L>(const L& law) {
    for (int k = 0; k < count; ++k) {
      detail::set_element_nodes(body, element(k), nodes);
      const auto X = detail::two_places<T, D>(slots.points, nodes);
      const auto d = detail::two_node_stretch<T, D>(nodes, u);
      Mat<T, D> block;
      if constexpr (Remembers<L>) {
        if (at) {
          auto before = detail::memory_of_element<L>(body, element(k), at->last_memory, at->branches);
          const int branch = before.branch();
          block = law.template stiffness<D>(X, d, before.template take<L::memory>(), branch);
        } else {
          block = law.at_rest().template stiffness<D>(X, d);
        }
      } else {
        block = law.template stiffness<D>(X, d);
      }
      Mat<T, 2 * D> K;
      K << block, -block, -block, block;
      sink(nodes, K);
    }
  };
  detail::with_law<T>(model, slots, b, continuum, two_nodes);
}

template <class T>
Vector<T> bulk_tangent_times(const Model& model, const Slots<T>& slots, const BodyMotion<T>& at,
                             const Vector<T>& vector, const ElementLists* only) {
  if (model.effects.linear_bulk) return bulk_forces(model, slots, vector, {}, only);
  const int D = model.dimension;
  Vector<T> product = Vector<T>::Constant(model.dof_count(), T(0));
  const auto add = [&](const auto& nodes, const auto& K) {
    for (Eigen::Index r = 0; r < K.rows(); ++r)
      for (Eigen::Index c = 0; c < K.cols(); ++c)
        product[nodes[r / D] * D + r % D] += K(r, c) * vector[nodes[c / D] * D + c % D];
  };
  for (int b = 0; b < static_cast<int>(model.bodies.size()); ++b)
    for_each_element_tangent(model, slots, b, only ? &(*only)[b] : nullptr, std::ref(add), &at);
  return product;
}

template <class T>
T bulk_energy(const Model& model, const Slots<T>& slots, const Vector<T>& u, const Vector<T>& memory) {
  T energy{};
  for (int b = 0; b < static_cast<int>(model.bodies.size()); ++b) {
    const auto& body = model.bodies[b];
    const auto continuum = [&]<class Shape, Kinematics kinematics, class L>(const L& law) {
      for (int e = 0; e < body.mesh.element_count(); ++e) {
        const auto nodes = detail::element_nodes(body, e);
        energy += element_energy<T, Shape, kinematics>(
            law, detail::gather_coordinates<T, Shape>(slots.points, nodes.data()),
            detail::gather_displacements<T, Shape>(u, nodes.data()), slots.depths[b].thickness,
            detail::memory_of_element<L>(body, e, memory));
      }
    };
    const auto two_nodes = [&]<int D, class L>(const L& law) {
      for (int e = 0; e < body.mesh.element_count(); ++e) {
        const auto nodes = detail::element_nodes(body, e);
        const auto X = detail::two_places<T, D>(slots.points, nodes);
        const auto d = detail::two_node_stretch<T, D>(nodes, &u);
        if constexpr (Remembers<L>)
          energy +=
              law.template energy<D>(X, d, detail::memory_of_element<L>(body, e, memory).template take<L::memory>());
        else
          energy += law.template energy<D>(X, d);
      }
    };
    detail::with_law<T>(model, slots, b, continuum, two_nodes);
  }
  return energy;
}

}  // namespace stickslip
