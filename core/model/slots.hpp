/// What is made of a scene in a scalar: its slots, and what the bodies answer at displacements.
#pragma once

#include <functional>
#include <type_traits>
#include <vector>

#include "core/mesh/generators.hpp"
#include "core/model/element_nodes.hpp"
#include "core/model/history.hpp"
#include "core/model/slot_values.hpp"

namespace stickslip {

/// Motion of the bodies in an increment: displacements at its end, and the bodies' memory at its start
/// (History::bodies).
template <class T>
struct BodyMotion {
  const Vector<T>& displacement;  ///< all dofs, along the axes
  const Vector<T>& last_memory;
  double time = 0;  ///< at its end, for pressures that follow the sides
  const FlowBranches* branches = nullptr;
};

/// Memory of the bodies (History::bodies) at displacements of all dofs; empty if there is none. `before`: at the start
/// of the increment.
template <class T>
Vector<T> bulk_flow(const Model& model, const Slots<T>& slots, const Vector<T>& u, const Vector<T>& before,
                    const FlowBranches& branches = {});

/// Internal nodal forces of all bodies, all dofs. `u`: all dofs; `memory`: at u; `only`: elements to visit, per body;
/// nullptr: all.
template <class T>
Vector<T> bulk_forces(const Model& model, const Slots<T>& slots, const Vector<T>& u, const Vector<T>& memory,
                      const ElementLists* only = nullptr);

/// Nodal forces of Scene::loads[load] at history = 1, all dofs; zero for a pressure that follows its side.
template <class T>
Vector<T> load_vector(const Model& model, int load, const Slots<T>& slots);

/// Receives the nodes of an element and its tangent, node-major. It is a function and no template parameter, so that
/// elements of all shapes and laws are compiled once per scalar, and not once per caller.
template <class T>
using ElementSink = std::function<void(const std::vector<int>& nodes, const Eigen::Ref<const Matrix<T>>& K)>;

/// Calls sink(nodes, K) for each element of body b, or for those in `only`. `at`: motion at which the tangent is taken,
/// with its plastic flow (pre: T is double or complex); nullptr: tangent of the start, for bodies of constant tangent.
template <class T>
void for_each_element_tangent(const Model& model, const Slots<T>& slots, int b, const std::vector<int>* only,
                              const std::type_identity_t<ElementSink<T>>& sink, const BodyMotion<T>* at = nullptr);

/// The bodies' tangent at a motion times a vector, all dofs. `only`: as in bulk_forces().
template <class T>
Vector<T> bulk_tangent_times(const Model& model, const Slots<T>& slots, const BodyMotion<T>& at,
                             const Vector<T>& vector, const ElementLists* only = nullptr);

/// Strain energy of all bodies at displacements of all dofs with the memory there.
template <class T>
T bulk_energy(const Model& model, const Slots<T>& slots, const Vector<T>& u, const Vector<T>& memory);

/// Least FlowTrial::margin of a motion: distance of the nearest material point from the change between elastic and
/// plastic. Infinity if no body is plastic.
double yield_margin(const Model& model, const Slots<double>& slots, const BodyMotion<double>& at);

/// Whether each point of the bodies that remember flows at a motion, in the order of their memory.
std::vector<char> flowing_points(const Model& model, const Slots<double>& slots, const BodyMotion<double>& at);

/// Stretch of the thickness of plane stress at finite strain, and its derivatives by the displacements of the nodes of
/// an element, node-major.
template <class T>
struct ThicknessStretch {
  T value;
  Vector<T> by_motion;
};

/// The stretches at the points of the quadrature of an edge of body b. pre: its law remembers nothing.
template <class T>
std::vector<ThicknessStretch<T>> edge_stretches(const Model& model, const Slots<T>& slots, int b,
                                                const ElementEdge& edge, const Vector<T>& u);

template <class T>
using PlasticStrainSink = std::function<void(const T& a, const T& volume)>;

/// Calls sink(a, volume) at each point of body b with its equivalent plastic strain and volume (of a bar, length times
/// cross-section); nothing where it does not flow. `memory`: what bodies remember.
template <class T>
void for_each_plastic_strain(const Model& model, const Slots<T>& slots, int b, const Vector<T>& memory,
                             const std::type_identity_t<PlasticStrainSink<T>>& sink);

/// Elements that displacements invert, body by body; none where the bodies' strains are small.
ElementLists inverted_elements(const Model& model, const Slots<double>& slots, const Vector<double>& u);

/// Nodal coordinates, D x nodes: of the generators, moved by the shape parameters.
template <class T>
Points<T> initial_points(const Model& model, const Numbers<T>& numbers);

/// All slots of a model in the scalar of `numbers`; `points`: initial_points, or variables in their place. `stiffness`:
/// k_i without derivatives, for what does not depend on rho; none: functions of the slots, like all else.
template <class T>
Slots<T> make_slots(const Model& model, const Numbers<T>& numbers, Points<T> points,
                    const std::vector<double>* stiffness = nullptr);
template <class T>
Slots<T> make_slots(const Model& model, const Numbers<T>& numbers);

}  // namespace stickslip

#include "core/model/bodies_impl.hpp"
#include "core/model/slots_impl.hpp"

namespace stickslip {

/// The templates that take most time to compile, in a scalar: STICKSLIP_SLOTS(extern, T) in a header,
/// STICKSLIP_SLOTS(, T) in one source.
#define STICKSLIP_SLOTS(EXTERN, T)                                                                             \
  EXTERN template Vector<T> bulk_forces(const Model&, const Slots<T>&, const Vector<T>&, const Vector<T>&,     \
                                        const ElementLists*);                                                  \
  EXTERN template Vector<T> bulk_flow(const Model&, const Slots<T>&, const Vector<T>&, const Vector<T>&,       \
                                      const FlowBranches&);                                                    \
  EXTERN template T bulk_energy(const Model&, const Slots<T>&, const Vector<T>&, const Vector<T>&);            \
  EXTERN template void for_each_plastic_strain(const Model&, const Slots<T>&, int, const Vector<T>&,           \
                                               const PlasticStrainSink<T>&);                                   \
  EXTERN template void for_each_element_tangent(const Model&, const Slots<T>&, int, const std::vector<int>*,   \
                                                const ElementSink<T>&, const BodyMotion<T>*);                  \
  EXTERN template std::vector<ThicknessStretch<T>> edge_stretches(const Model&, const Slots<T>&, int,          \
                                                                  const ElementEdge&, const Vector<T>&);       \
  EXTERN template Vector<T> load_vector(const Model&, int, const Slots<T>&);                                   \
  EXTERN template Points<T> initial_points(const Model&, const Numbers<T>&);                                   \
  EXTERN template Slots<T> make_slots(const Model&, const Numbers<T>&, Points<T>, const std::vector<double>*); \
  EXTERN template Slots<T> make_slots(const Model&, const Numbers<T>&)

STICKSLIP_SLOTS(extern, double);

}  // namespace stickslip
