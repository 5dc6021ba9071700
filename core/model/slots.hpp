/// What is made of a scene in a scalar, and what the bodies answer at displacements.
///
/// Slots are every number that a residual reads, in the scalar T: nodal coordinates, material numbers, initial contact
/// geometry, friction, loads. T is double in the solver, Dual<N> for derivatives by parameters (pseudo-loads), complex
/// in the oracle.
#pragma once

#include <functional>
#include <type_traits>
#include <vector>

#include "core/contact/contact_point.hpp"
#include "core/mesh/mesh.hpp"
#include "core/model/history.hpp"
#include "core/model/model.hpp"
#include "core/solids/edges.hpp"

namespace stickslip {

template <class T>
struct BodyLaw;  // core/solids/materials.hpp

/// Nodal forces of a load at history = 1, on the dofs on which it acts.
template <class T>
struct NodalLoad {
  std::vector<int> dofs;  ///< ascending
  std::vector<T> forces;

  explicit NodalLoad(const Vector<T>& all) {
    for (int dof = 0; dof < all.size(); ++dof)
      if (!vanishes(all[dof])) {
        dofs.push_back(dof);
        forces.push_back(all[dof]);
      }
  }
  Vector<T> all(int dof_count) const {
    Vector<T> spread = Vector<T>::Constant(dof_count, T(0));
    for (std::size_t k = 0; k < dofs.size(); ++k) spread[dofs[k]] = forces[k];
    return spread;
  }
};

template <class T>
struct Slots {
  Numbers<T> numbers;
  Points<T> points;                        ///< D x nodes
  std::vector<BodyLaw<T>> laws;            ///< per body
  std::vector<Depth<T>> depths;            ///< per body
  std::vector<Points<T>> vertices;         ///< per obstacle: where its vertices are at the start, D x vertices, length;
                                           ///< no entry: none has any
  std::vector<PointGeometry<T>> geometry;  ///< per contact point
  std::vector<T> stiffness;                ///< per contact point: local nodal stiffness k_i (force per length)
  std::vector<FrictionLaw<T>> friction;    ///< per contact; not read if frictionless
  std::vector<NodalLoad<T>> loads;         ///< per load
  std::vector<Matrix<T>> frames;           ///< per framed node: D x D, frame vectors as columns
  std::vector<Vector<T>> spins;            ///< per contact point: displacement of its obstacle per degree of rotation,
                                           ///< length; empty: no obstacle rotates
  std::vector<Vector<T>> arcs;  ///< per surface, of integrated curves: initial arc length along it to the beginning
                                ///< of each facet, and of all; empty for another; no entry: none is
  bool normals_turn = false;    ///< of the model's effects

  Slots();  // (defined in slots_impl.hpp, where the laws are known)
  Slots(const Slots&);
  Slots(Slots&&) noexcept;
  Slots& operator=(const Slots&);
  Slots& operator=(Slots&&) noexcept;
  ~Slots();
};

/// Cross-section of the bars of body b, area.
template <class T>
T bar_area(const Slots<T>& slots, int b);

/// Gap of a point, length, up to which it counts as zero. If the initial gap is not exactly zero: the rounding of the
/// coordinates. If it is: the rounding of the displacements alone, so a contact that begins closed has the same
/// branches under every load, however small. `largest_displacement`: of the point's nodes, length.
template <class T>
double tie_length(const ContactPoint& point, const PointGeometry<T>& geometry, double largest_displacement = 0) {
  constexpr double terms = 256;  // terms summed in a displacement, times some condition number
  return value(geometry.gap) == 0 ? terms * unit_roundoff * largest_displacement : point.tie_length;
}

namespace detail {

template <class T>
Vec<T, 2> point2(const Points<T>& points, int node) {
  return {points(0, node), points(1, node)};
}

}  // namespace detail

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

/// Nodal forces of the pressures that follow their sides, at displacements of all dofs.
template <class T>
Vector<T> follower_forces(const Model& model, const Slots<T>& slots, double t, const Vector<T>& u);

/// Receives the nodes of an element and its tangent, node-major. It is a function and no template parameter, so that
/// elements of all shapes and laws are compiled once per scalar, and not once per caller.
template <class T>
using ElementSink = std::function<void(const std::vector<int>& nodes, const Eigen::Ref<const Matrix<T>>& K)>;

/// Calls sink(nodes, K) for each element of body b, or for those in `only`. `at`: motion at which the tangent is taken,
/// with its plastic flow (pre: T is double); nullptr: tangent of the start, for bodies of constant tangent.
template <class T>
void for_each_element_tangent(const Model& model, const Slots<T>& slots, int b, const std::vector<int>* only,
                              const std::type_identity_t<ElementSink<T>>& sink, const BodyMotion<T>* at = nullptr);

/// Calls sink(nodes, K) for each side of an element that a pressure follows: derivatives of its forces by
/// displacements, node-major. In plane stress it calls again with the part that the stretch of the thickness adds.
/// pre: T is double or complex.
template <class T>
void for_each_follower_tangent(const Model& model, const Slots<T>& slots, const BodyMotion<T>& at,
                               const std::type_identity_t<ElementSink<T>>& sink);

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

/// Diagonal D x D blocks of the bodies' stiffness at the contact nodes, in the order of Model::contact_nodes.
template <class T>
std::vector<Matrix<T>> nodal_stiffness(const Model& model, const Slots<T>& slots);

/// k_i of each contact point, from n.K_ii n at the interpolated slave and at the interpolated master nodes (slave only
/// if the master is rigid). Where a node has next to no stiffness along n (bars along their axis), the mean over all
/// directions stands in for it.
template <class T>
std::vector<T> contact_stiffness(const Model& model, const Slots<T>& slots);

/// Whether supports hold a contact node along a direction.
template <class T>
bool is_held(const Model& model, const Slots<T>& slots, int node, const Vector<double>& direction);

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

/// Slots of the bodies alone, without contact and loads.
template <class T>
Slots<T> make_body_slots(const Model& model, const Numbers<T>& numbers, Points<T> points);

/// All of these in a scalar: STICKSLIP_SLOTS(extern, T) in a header, STICKSLIP_SLOTS(, T) in one source, which includes
/// core/model/slots_impl.hpp.
#define STICKSLIP_SLOTS(EXTERN, T)                                                                             \
  EXTERN template struct Slots<T>;                                                                             \
  EXTERN template T bar_area(const Slots<T>&, int);                                                            \
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
  EXTERN template Vector<T> follower_forces(const Model&, const Slots<T>&, double, const Vector<T>&);          \
  EXTERN template std::vector<Matrix<T>> nodal_stiffness(const Model&, const Slots<T>&);                       \
  EXTERN template std::vector<T> contact_stiffness(const Model&, const Slots<T>&);                             \
  EXTERN template bool is_held(const Model&, const Slots<T>&, int, const Vector<double>&);                     \
  EXTERN template Points<T> initial_points(const Model&, const Numbers<T>&);                                   \
  EXTERN template Slots<T> make_body_slots(const Model&, const Numbers<T>&, Points<T>);                        \
  EXTERN template Slots<T> make_slots(const Model&, const Numbers<T>&, Points<T>, const std::vector<double>*); \
  EXTERN template Slots<T> make_slots(const Model&, const Numbers<T>&)

STICKSLIP_SLOTS(extern, double);

}  // namespace stickslip
