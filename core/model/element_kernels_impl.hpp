/// Definitions of the functions in the tables of core/model/element_kernels.hpp.
#pragma once

#include "core/model/element_kernels.hpp"
#include "core/model/element_nodes.hpp"
#include "core/model/flow_points.hpp"
#include "core/model/with_law.hpp"
#include "core/solids/elements.hpp"

namespace stickslip {

namespace detail {

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

/// Forces of one element of a continuum. Derivatives are computed only of what depends on parameters: most parameters
/// touch few elements, and those of a material touch no gradient.
template <class T, class Shape, Kinematics kinematics, class L>
Nodal<T, Shape> forces_of_element(const L& law, const Nodal<T, Shape>& coordinates, const Nodal<T, Shape>& u,
                                  const T& thickness, const ElementMemory<T>& memory) {
  if constexpr (tells_constants<T> && !Remembers<L>) {
    if (is_constant(thickness) && are_constant(coordinates)) {
      const Nodal<double, Shape> fixed = values(coordinates);
      const auto numbers = law.numbers();
      if (!are_constant(numbers) || !are_constant(u))
        return element_forces<T, Shape, kinematics, double>(law, fixed, u, value(thickness));
      std::array<double, std::tuple_size_v<std::decay_t<decltype(numbers)>>> plain;
      std::transform(numbers.begin(), numbers.end(), plain.begin(), [](const T& x) { return value(x); });
      const Nodal<double, Shape> forces =
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

/// Size of an element along the longer axis.
template <class T, int D, int nodes>
double extent(const Mat<T, D, nodes>& coordinates) {
  const auto places = values(coordinates);
  return (places.rowwise().maxCoeff() - places.rowwise().minCoeff()).maxCoeff();
}

}  // namespace detail

/// Elements of a continuum.
template <class T, class Shape>
struct ContinuumKernels {
  using Elements = BodyElements<T>;
  using Places = Nodal<T, Shape>;

  /// Calls f.template operator()<kinematics>(law, e, nodes, coordinates) for each element.
  template <class F>
  static void for_each(const Elements& elements, F&& f) {
    const auto visit = [&]<Kinematics kinematics>(const auto& law) {
      for (int k = 0; k < elements.count(); ++k) {
        const int e = elements[k];
        const auto nodes = nodes_of(elements.body(), e);
        f.template operator()<kinematics>(law, e, nodes.data(),
                                          detail::gather_coordinates<T, Shape>(elements.slots.points, nodes.data()));
      }
    };
    detail::with_continuum<Shape>(elements.body(), elements.slots.laws[elements.b].law, visit);
  }
  static std::array<int, Shape::nodes> nodes_of(const BodyMesh& body, int e) {
    std::array<int, Shape::nodes> nodes;
    for (int a = 0; a < Shape::nodes; ++a) nodes[a] = body.first_node + body.mesh.connectivity[e * Shape::nodes + a];
    return nodes;
  }
  static const T& thickness(const Elements& elements) { return elements.slots.depths[elements.b].thickness; }

  static void forces(const Elements& elements, const Vector<T>& u, const Vector<T>& memory, Vector<T>& forces) {
    for_each(elements, [&]<Kinematics kinematics, class L>(const L& law, int e, const int* nodes, const Places& X) {
      const auto f = detail::forces_of_element<T, Shape, kinematics>(
          law, X, detail::gather_displacements<T, Shape>(u, nodes), thickness(elements),
          detail::memory_of_element<L>(elements.body(), e, memory));
      for (int a = 0; a < Shape::nodes; ++a)
        for (int i = 0; i < Shape::dimension; ++i) forces[nodes[a] * Shape::dimension + i] += f(i, a);
    });
  }

  static void tangents(const Elements& elements, const BodyMotion<T>* at, const ElementSink<T>& sink) {
    constexpr bool solves = std::is_same_v<T, double>;
    std::vector<int> all;
    for_each(elements, [&]<Kinematics kinematics, class L>(const L& law, int e, const int* nodes, const Places& X) {
      all.assign(nodes, nodes + Shape::nodes);
      Places u = Places::Constant(T(0));
      if (at) u = detail::gather_displacements<T, Shape>(at->displacement, nodes);
      if constexpr (requires { law.at_rest(); }) {
        if constexpr (solves)
          if (at) {
            const auto before = detail::memory_of_element<L>(elements.body(), e, at->last_memory, at->branches);
            return sink(all, element_tangent<T, Shape, kinematics>(law, X, u, thickness(elements), before));
          }
        sink(all, element_tangent<T, Shape, kinematics>(law.at_rest(), X, u, thickness(elements)));
      } else {
        sink(all, element_tangent<T, Shape, kinematics>(law, X, u, thickness(elements)));
      }
    });
  }

  static void energy(const Elements& elements, const Vector<T>& u, const Vector<T>& memory, T& energy) {
    for_each(elements, [&]<Kinematics kinematics, class L>(const L& law, int e, const int* nodes, const Places& X) {
      const Places motion = detail::gather_displacements<T, Shape>(u, nodes);
      const TapeMark<T> mark(motion);
      std::array<T, 1> of_element{element_energy<T, Shape, kinematics>(
          law, X, motion, thickness(elements), detail::memory_of_element<L>(elements.body(), e, memory))};
      mark.fold(of_element);
      energy += of_element[0];
    });
  }

  static void plastic_strains(const Elements& elements, const Vector<T>& memory, const PlasticStrainSink<T>& sink) {
    for_each(elements, [&]<Kinematics kinematics, class L>(const L&, int e, const int*, const Places& X) {
      if constexpr (Remembers<L>) {
        auto remembered = detail::memory_of_element<L>(elements.body(), e, memory);
        for_each_gradient<T, Shape, kinematics>(X, thickness(elements), [&](const auto& gradient) {
          sink(L::template plastic_strain<T>(remembered.template take<memory_at<L, kinematics>()>()), gradient.volume);
        });
      }
    });
  }

  static void edge_stretches(const Elements& elements, const ElementEdge& edge, const Vector<T>& u,
                             std::vector<ThicknessStretch<T>>& stretches) {
    if constexpr (Shape::dimension == 2) stretch_edge(elements, edge, u, stretches);
  }

  /// edge_stretches() of a plane element.
  static void stretch_edge(const Elements& elements, const ElementEdge& edge, const Vector<T>& u,
                           std::vector<ThicknessStretch<T>>& stretches) {
    const auto of_element = [&]<Kinematics kinematics, class L>(const L& law) {
      if constexpr (kinematics == Kinematics::plane && L::is_made_for(kinematics, Strains::finite) && !Remembers<L>) {
        const auto nodes = nodes_of(elements.body(), edge.element);
        const auto X = detail::gather_coordinates<T, Shape>(elements.slots.points, nodes.data());
        const auto local = detail::gather_displacements<T, Shape>(u, nodes.data());
        const auto from = natural_corner<Shape>(edge.corner), to = natural_corner<Shape>(edge.corner + 1);
        for (const auto& point : detail::edge_quadrature(Shape::nodes > Shape::corners ? 3 : 2, false)) {
          const double s = point.value[1] + point.value[2] / 2;  // share of the way along the edge
          const Vec<double, 2> at = (1 - s) * from + s * to;
          const Gradient<T, Shape, kinematics> gradient(Shape::at(at[0], at[1], 0), X);
          const auto H = detail::seeded<Dual<4, T>>(gradient.of(local));
          const Dual<4, T> stretch = law.stretch_across(H);
          Vector<T> by_motion = Vector<T>::Constant(2 * Shape::nodes, T(0));
          for (int a = 0; a < Shape::nodes; ++a)
            for (int i = 0; i < 2; ++i)
              gradient.for_each(
                  i, a, [&](int p, int q, const T& x) { by_motion[2 * a + i] += stretch.d[H.place(p, q)] * x; });
          stretches.push_back({stretch.v, by_motion});
        }
      }
    };
    detail::with_continuum<Shape>(elements.body(), elements.slots.laws[elements.b].law, of_element);
  }

  static void flow(const Elements& elements, const Vector<T>& u, const Vector<T>& before, const FlowBranches& branches,
                   Vector<T>& after) {
    const auto& body = elements.body();
    for_each(elements, [&]<Kinematics kinematics, class L>(const L& law, int e, const int* nodes, const Places& X) {
      if constexpr (Remembers<L>)
        element_flow<T, Shape, kinematics>(law, X, detail::gather_displacements<T, Shape>(u, nodes),
                                           detail::memory_of_element<L>(body, e, before, &branches),
                                           after.data() + body.first_memory + e * body.memory);
    });
  }

  static void flow_points(const Elements& elements, const BodyMotion<T>& at, const FlowPointSink<T>& sink) {
    const auto& body = elements.body();
    for_each(elements, [&]<Kinematics kinematics, class L>(const L& law, int e, const int* nodes, const Places& X) {
      if constexpr (Remembers<L>) {
        auto before = detail::memory_of_element<L>(body, e, at.last_memory, at.branches);
        Eigen::Index memory = body.first_memory + static_cast<Eigen::Index>(e) * body.memory;
        for_each_strain_in<T, Shape, kinematics>(
            law.is_finite, X, T(1), detail::gather_displacements<T, Shape>(at.displacement, nodes),
            [&](const auto& H, const T&) {
              const int branch = before.branch();
              constexpr int remembered = memory_at<L, kinematics>();
              const auto trial = law.trial(H, before.template take<remembered>(), branch);
              sink(
                  {elements.b, e, std::exchange(memory, memory + remembered), trial, law.hardening, detail::extent(X)});
            });
      }
    });
  }
};

/// Bars and springs.
template <class T, int D>
struct TwoNodeKernels {
  using Elements = BodyElements<T>;
  using Places = Mat<T, D, 2>;

  /// Calls f(law, e, nodes, coordinates) for each element.
  template <class F>
  static void for_each(const Elements& elements, F&& f) {
    std::vector<int> nodes;
    detail::with_two_nodes(elements.slots.laws[elements.b].law, [&](const auto& law) {
      for (int k = 0; k < elements.count(); ++k) {
        detail::set_element_nodes(elements.body(), elements[k], nodes);
        f(law, elements[k], nodes, detail::two_places<T, D>(elements.slots.points, nodes));
      }
    });
  }

  /// Of a linear law: of the relative displacement, free of cancellation.
  static void forces(const Elements& elements, const Vector<T>& u, const Vector<T>& memory, Vector<T>& forces) {
    for_each(elements, [&]<class L>(const L& law, int e, const std::vector<int>& nodes, const Places& X) {
      const auto add = [&](int i, const T& force) {
        forces[nodes[0] * D + i] -= force;
        forces[nodes[1] * D + i] += force;
      };
      const auto add_all = [&](const Vec<T, D>& force) {
        for (int i = 0; i < D; ++i) add(i, force[i]);
      };
      const Vec<T, D> d = detail::two_node_stretch<T, D>(nodes, &u);
      if constexpr (Remembers<L>) {
        auto remembered = detail::memory_of_element<L>(elements.body(), e, memory);
        add_all(law.template force<D>(X, d, remembered.template take<L::memory>()));
      } else {
        if (!law.is_linear()) return add_all(law.template force<D>(X, d));
        const Mat<T, D> k = law.template stiffness<D>(X, d);
        for (int i = 0; i < D; ++i)
          for (int j = 0; j < D; ++j) add(i, k(i, j) * d[j]);
      }
    });
  }

  static void tangents(const Elements& elements, const BodyMotion<T>* at, const ElementSink<T>& sink) {
    for_each(elements, [&]<class L>(const L& law, int e, const std::vector<int>& nodes, const Places& X) {
      const auto d = detail::two_node_stretch<T, D>(nodes, at ? &at->displacement : nullptr);
      Mat<T, D> block;
      if constexpr (Remembers<L>) {
        if (at) {
          auto before = detail::memory_of_element<L>(elements.body(), e, at->last_memory, at->branches);
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
    });
  }

  static void energy(const Elements& elements, const Vector<T>& u, const Vector<T>& memory, T& energy) {
    for_each(elements, [&]<class L>(const L& law, int e, const std::vector<int>& nodes, const Places& X) {
      const auto d = detail::two_node_stretch<T, D>(nodes, &u);
      if constexpr (Remembers<L>) {
        auto remembered = detail::memory_of_element<L>(elements.body(), e, memory);
        energy += law.template energy<D>(X, d, remembered.template take<L::memory>());
      } else {
        energy += law.template energy<D>(X, d);
      }
    });
  }

  static void plastic_strains(const Elements& elements, const Vector<T>& memory, const PlasticStrainSink<T>& sink) {
    for_each(elements, [&]<class L>(const L&, int e, const std::vector<int>&, const Places& X) {
      if constexpr (Remembers<L>)
        sink(L::plastic_strain(detail::memory_of_element<L>(elements.body(), e, memory).template take<L::memory>()),
             norm((X.col(1) - X.col(0)).eval()) * bar_area(elements.slots, elements.b));
    });
  }

  static void edge_stretches(const Elements&, const ElementEdge&, const Vector<T>&, std::vector<ThicknessStretch<T>>&) {
  }

  static void flow(const Elements& elements, const Vector<T>& u, const Vector<T>& before, const FlowBranches& branches,
                   Vector<T>& after) {
    const auto& body = elements.body();
    for_each(elements, [&]<class L>(const L& law, int e, const std::vector<int>& nodes, const Places& X) {
      if constexpr (Remembers<L>) {
        auto memory = detail::memory_of_element<L>(body, e, before, &branches);
        const int branch = memory.branch();
        after.template segment<L::memory>(body.first_memory + e * body.memory) = law.template flow<D>(
            X, detail::two_node_stretch<T, D>(nodes, &u), memory.template take<L::memory>(), branch);
      }
    });
  }

  static void flow_points(const Elements& elements, const BodyMotion<T>& at, const FlowPointSink<T>& sink) {
    const auto& body = elements.body();
    for_each(elements, [&]<class L>(const L& law, int e, const std::vector<int>& nodes, const Places& X) {
      if constexpr (Remembers<L>) {
        auto before = detail::memory_of_element<L>(body, e, at.last_memory, at.branches);
        const int branch = before.branch();
        const auto trial = law.template trial<D>(X, detail::two_node_stretch<T, D>(nodes, &at.displacement),
                                                 before.template take<L::memory>(), branch);
        sink({elements.b, e, body.first_memory + static_cast<Eigen::Index>(e) * body.memory, trial, law.hardening,
              detail::extent(X)});
      }
    });
  }
};

namespace detail {

template <class T, class Shape>
struct KernelsOf : ContinuumKernels<T, Shape> {};
template <class T, int D>
struct KernelsOf<T, TwoNodes<D>> : TwoNodeKernels<T, D> {};

}  // namespace detail

template <class T, class Shape>
const ElementKernels<T>& kernels_of_shape() {
  static constexpr ElementKernels<T> table = [] {
    using Of = detail::KernelsOf<T, Shape>;
    ElementKernels<T> all{Of::tangents, Of::energy, Of::plastic_strains, Of::edge_stretches};
    if constexpr (!std::is_same_v<T, Reverse>) {
      all.forces = Of::forces;
      all.flow = Of::flow;
      all.flow_points = Of::flow_points;
    }
    return all;
  }();
  return table;
}

}  // namespace stickslip
