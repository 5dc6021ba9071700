/// Definitions of the templates in slots.hpp, with those of the bodies' elements and of the loads.
#pragma once

#include "core/mesh/generators.hpp"
#include "core/model/bodies_impl.hpp"
#include "core/model/contact_geometry.hpp"
#include "core/model/element_nodes.hpp"
#include "core/model/load_vector_impl.hpp"
#include "core/model/slots.hpp"
#include "core/solids/materials.hpp"

namespace stickslip {

template <class T>
Slots<T>::Slots() = default;
template <class T>
Slots<T>::Slots(const Slots&) = default;
template <class T>
Slots<T>::Slots(Slots&&) noexcept = default;
template <class T>
Slots<T>& Slots<T>::operator=(const Slots&) = default;
template <class T>
Slots<T>& Slots<T>::operator=(Slots&&) noexcept = default;
template <class T>
Slots<T>::~Slots() = default;

template <class T>
T bar_area(const Slots<T>& slots, int b) {
  const Law<T>& law = slots.laws[b].law;
  if (const auto* plastic = std::get_if<PlasticBarLaw<T>>(&law)) return plastic->elastic.area;
  return std::get<BarLaw<T>>(law).area;
}

namespace detail {

/// Calls f(b, elements, place) for each body with its elements that touch a contact node; place[node]: its index among
/// Model::contact_nodes, or -1.
template <class F>
void for_each_touching(const Model& model, F&& f) {
  std::vector<int> place(model.node_count, -1);
  for (std::size_t i = 0; i < model.contact_nodes.size(); ++i) place[model.contact_nodes[i]] = static_cast<int>(i);
  for (int b = 0; b < static_cast<int>(model.bodies.size()); ++b) {
    std::vector<int> touching;
    for (int e = 0; e < model.bodies[b].mesh.element_count(); ++e) {
      const auto nodes = element_nodes(model.bodies[b], e);
      if (std::any_of(nodes.begin(), nodes.end(), [&](int node) { return place[node] >= 0; })) touching.push_back(e);
    }
    f(b, touching, place);
  }
}

/// Calls f(i, r, c, k) with each entry k = K(r', c') of an element's tangent that adds to entry (r, c) of the block of
/// contact node i.
template <class T, class F>
void for_each_block_entry(int dimension, const std::vector<int>& nodes, const std::vector<int>& place,
                          const Eigen::Ref<const Matrix<T>>& K, F&& f) {
  for (int a = 0; a < static_cast<int>(nodes.size()); ++a)
    if (place[nodes[a]] >= 0)
      for (int i = 0; i < dimension; ++i)
        for (int j = 0; j < dimension; ++j) f(place[nodes[a]], i, j, K(a * dimension + i, a * dimension + j));
}

}  // namespace detail

template <class T>
std::vector<Matrix<T>> nodal_stiffness(const Model& model, const Slots<T>& slots) {
  const int D = model.dimension;
  std::vector<Matrix<T>> blocks(model.contact_nodes.size(), Matrix<T>::Constant(D, D, T(0)));
  detail::for_each_touching(model, [&](int b, const std::vector<int>& touching, const std::vector<int>& place) {
    const auto add = [&](const std::vector<int>& nodes, const Eigen::Ref<const Matrix<T>>& K) {
      detail::for_each_block_entry<T>(D, nodes, place, K,
                                      [&](int block, int i, int j, const T& k) { blocks[block](i, j) += k; });
    };
    for_each_element_tangent(model, slots, b, &touching, std::ref(add));
  });
  return blocks;
}

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

/// k_i from the slave's and the master's stiffness: their harmonic mean, as of springs in series, but at least a tenth
/// of the slave's, and at most 1e3 of the mean. Why: the master's nodes leave several slave nodes on one facet a way to
/// shift their pressures among themselves, which the slave alone resists. Springs that are soft beside it would decide
/// about that share. A slave that is stiffer by more than 1e7 rounds by more than its master bears, which stiff springs
/// would carry into it: there the bound of 1e3 falls as the ratio grows, to 1. Where supports hold one side along a
/// direction of the contact, the other alone yields there, and k_i is its stiffness. Where each yields alone along
/// another direction, k_i is their sum. Supports decide, not sizes: k_i is smooth in both, but where the slave is 19 or
/// 2e4 times as stiff, or more than 1e7 times.
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
    const auto& masters = point.surface < 0 ? point.nodes : model.surfaces[point.surface].nodes;
    const bool master_held = std::all_of(point.surface < 0 ? middle : masters.begin(), masters.end(), held);
    slave_yields |= master_held && !slave_held;
    master_yields |= slave_held && !master_held;
  }
  if (slave_yields && master_yields) return slave + master;
  if (slave_yields) return slave;
  if (master_yields) return master;
  const T mean = T(2) * slave * master / (slave + master), tenth = T(0.1) * slave;
  const double rounds = std::clamp(1e10 * value(master) / value(slave), 1.0, 1e3);
  const T most = T(rounds) * mean;
  if (value(tenth) <= value(mean)) return mean;
  return value(tenth) < value(most) ? tenth : most;
}

/// `blocks`: nodal_stiffness().
template <class T>
std::vector<T> contact_stiffness(const Model& model, const Slots<T>& slots, const std::vector<Matrix<T>>& blocks) {
  const auto block_of = [&](int node) -> const Matrix<T>& {
    const auto& nodes = model.contact_nodes;
    return blocks[std::lower_bound(nodes.begin(), nodes.end(), node) - nodes.begin()];
  };
  auto along = [&](int node, const auto& n) {
    const auto& K = block_of(node);
    const int D = model.dimension;
    T k{}, mean{};
    for (int i = 0; i < D; ++i) {
      mean += K(i, i) / T(static_cast<double>(D));
      for (int j = 0; j < D; ++j) k += n[i] * K(i, j) * n[j];
    }
    return value(k) > 1e-6 * value(mean) ? k : mean;
  };
  const auto mean_over_surface = [&](const MasterSurface& curve) {  // it does not jump where a point crosses facets
    T sum{};
    for (int node : curve.nodes)
      for (int i = 0; i < model.dimension; ++i) sum += block_of(node)(i, i);
    return sum / T(static_cast<double>(model.dimension) * static_cast<double>(curve.nodes.size()));
  };
  std::vector<T> of_surface;
  for (const auto& curve : model.surfaces)
    of_surface.push_back(model.slides_on_surfaces() && curve.obstacle < 0 ? mean_over_surface(curve) : T(0));
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
    if (point.surface >= 0 && model.slides_on_surfaces()) master = of_surface[point.surface];
    stiffness.push_back(point.obstacle >= 0 ? slave : stiffness_between(model, slots, p, slave, master));
  }
  return stiffness;
}
template <class T>
std::vector<T> contact_stiffness(const Model& model, const Slots<T>& slots) {
  return contact_stiffness(model, slots, nodal_stiffness(model, slots));
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

namespace detail {

/// Law of a body: that of its material, or that of bars made of it.
template <class T>
Law<T> make_law(const Scene& scene, const Body& body, const Mesh& mesh, const Numbers<T>& numbers) {
  return std::visit(
      [&]<class M>(const M& material) -> Law<T> {
        if constexpr (HoldsPoint<M>) {
          return law_of<T>(material, numbers);
        } else {
          if constexpr (FillsBars<M>)
            if (mesh.shape == ElementShape::bar2) {
              const BarLaw<T> bar{numbers(material.E) * numbers(body.area), numbers(body.area), scene.finite_strain};
              return bar_of<T>(material, bar, numbers);
            }
          return law_of<T>(material, scene.space, strains_of(scene.finite_strain), numbers);
        }
      },
      body.material);
}

}  // namespace detail

template <class T>
Slots<T> make_slots(const Model& model, const Numbers<T>& numbers) {
  return make_slots(model, numbers, initial_points(model, numbers));
}

template <class T>
Slots<T> make_body_slots(const Model& model, const Numbers<T>& numbers, Points<T> points) {
  Slots<T> slots;
  slots.numbers = numbers;
  slots.points = std::move(points);
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const auto& body = model.bodies[b];
    slots.laws.push_back({detail::make_law(model.scene, model.scene.bodies[b], body.mesh, numbers)});
    const bool plane = is_continuum(body.mesh.shape) && model.scene.space != Space::axisymmetric;
    slots.depths.push_back(
        {model.scene.space == Space::axisymmetric, plane ? numbers(model.scene.bodies[b].thickness) : T(1)});
  }
  return slots;
}

template <class T>
Slots<T> make_slots(const Model& model, const Numbers<T>& numbers, Points<T> points,
                    const std::vector<double>* stiffness) {
  Slots<T> slots = make_body_slots(model, numbers, std::move(points));
  slots.normals_turn = model.effects.normals_turn;
  const auto& obstacles = model.scene.obstacles;
  if (std::any_of(obstacles.begin(), obstacles.end(), [](const auto& o) { return has_facets(o.shape); }))
    for (const auto& obstacle : obstacles) slots.vertices.push_back(vertices_of(obstacle.shape, numbers));
  for (const auto& contact : model.scene.contacts)
    slots.friction.push_back(contact.friction ? contact.friction->template as<T>(numbers) : FrictionLaw<T>());
  if (std::any_of(model.surfaces.begin(), model.surfaces.end(),
                  [](const auto& curve) { return curve.is_integrated(); }))
    for (const auto& curve : model.surfaces) slots.arcs.push_back(detail::arcs_of(model, curve, slots));
  for (const auto& point : model.points) {
    slots.geometry.push_back(detail::initial_geometry(model, point, slots));
    // A gap that is rounding of the coordinates would make forces of its own, where no load presses.
    T& gap = slots.geometry.back().gap;
    if (!model.scene.finite_strain && std::abs(value(gap)) <= point.tie_length) gap -= T(value(gap));
  }
  for (const auto& framed : model.framed) slots.frames.push_back(nodal_frame(model.scene, framed, numbers));
  if (stiffness)
    slots.stiffness.assign(stiffness->begin(), stiffness->end());
  else
    slots.stiffness = contact_stiffness(model, slots);
  for (int l = 0; l < static_cast<int>(model.scene.loads.size()); ++l)
    slots.loads.emplace_back(load_vector(model, l, slots));
  const bool turns =
      std::any_of(obstacles.begin(), obstacles.end(), [](const auto& o) { return o.rotate.has_value(); });
  if (turns && !model.effects.current_geometry)
    for (int p = 0; p < static_cast<int>(model.points.size()); ++p)
      slots.spins.push_back(detail::spin(model, p, slots));
  return slots;
}

}  // namespace stickslip
