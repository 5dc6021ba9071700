/// What the elements of a body do, as a table of functions for each shape and scalar. A function visits all elements of
/// a body, so that the law and the kinematics are looked up once; the templates of core/solids/elements.hpp that it is
/// made of are compiled in one source for a shape (core/model/elements/), and in no other.
#pragma once

#include "core/algebra/reverse.hpp"
#include "core/model/slots.hpp"

namespace stickslip {

/// Elements of one body. `only`: those that are visited; nullptr: all.
template <class T>
struct BodyElements {
  const Model& model;
  const Slots<T>& slots;
  int b;
  const std::vector<int>* only = nullptr;

  const BodyMesh& body() const { return model.bodies[b]; }
  int count() const { return only ? static_cast<int>(only->size()) : body().mesh.element_count(); }
  int operator[](int k) const { return only ? (*only)[k] : k; }
};

template <class T>
struct FlowPoint;  ///< core/model/flow_points.hpp
template <class T>
using FlowPointSink = std::function<void(const FlowPoint<T>&)>;

/// The functions behind those of slots.hpp, which say what their arguments are. What they compute is added to the last
/// argument, or handed to it.
template <class T>
struct ElementKernels {
  void (*tangents)(const BodyElements<T>&, const BodyMotion<T>* at, const ElementSink<T>& sink);
  void (*energy)(const BodyElements<T>&, const Vector<T>& u, const Vector<T>& memory, T& energy);
  void (*plastic_strains)(const BodyElements<T>&, const Vector<T>& memory, const PlasticStrainSink<T>& sink);
  void (*edge_stretches)(const BodyElements<T>&, const ElementEdge& edge, const Vector<T>& u,
                         std::vector<ThicknessStretch<T>>& stretches);
  // None of these in Reverse: the work and the flow of an element are differentiated by themselves
  // (core/solids/element_work.hpp).
  void (*forces)(const BodyElements<T>&, const Vector<T>& u, const Vector<T>& memory, Vector<T>& forces) = nullptr;
  /// Sets `after`.
  void (*flow)(const BodyElements<T>&, const Vector<T>& u, const Vector<T>& before, const FlowBranches& branches,
               Vector<T>& after) = nullptr;
  void (*flow_points)(const BodyElements<T>&, const BodyMotion<T>& at, const FlowPointSink<T>& sink) = nullptr;
};

/// Stands for the shape of bars and springs.
template <int D>
struct TwoNodes {};

/// The table of a shape: core/model/element_kernels_impl.hpp, instantiated by STICKSLIP_ELEMENTS.
template <class T, class Shape>
const ElementKernels<T>& kernels_of_shape();

/// The table of body b.
template <class T>
const ElementKernels<T>& kernels_of(const Model& model, int b) {
  const ElementKernels<T>* kernels =
      with_dimension(model.dimension, []<int D>() { return &kernels_of_shape<T, TwoNodes<D>>(); });
  with_shape(model.bodies[b].mesh.shape, [&]<class Shape>(Shape) { kernels = &kernels_of_shape<T, Shape>(); });
  return *kernels;
}

/// All tables in a scalar, and those of one shape: as STICKSLIP_SLOTS. Without the declaration, a source that is joined
/// to one that defines them compiles all of them again.
#define STICKSLIP_ELEMENTS_OF(EXTERN, T, ...) \
  EXTERN template const ElementKernels<T>& kernels_of_shape<T, __VA_ARGS__>()
#define STICKSLIP_ELEMENTS(EXTERN, T)            \
  STICKSLIP_ELEMENTS_OF(EXTERN, T, TwoNodes<2>); \
  STICKSLIP_ELEMENTS_OF(EXTERN, T, TwoNodes<3>); \
  STICKSLIP_ELEMENTS_OF(EXTERN, T, Tri3);        \
  STICKSLIP_ELEMENTS_OF(EXTERN, T, Quad4);       \
  STICKSLIP_ELEMENTS_OF(EXTERN, T, Tri6);        \
  STICKSLIP_ELEMENTS_OF(EXTERN, T, Quad8);       \
  STICKSLIP_ELEMENTS_OF(EXTERN, T, Tet4);        \
  STICKSLIP_ELEMENTS_OF(EXTERN, T, Hex8);        \
  STICKSLIP_ELEMENTS_OF(EXTERN, T, Tet10);       \
  STICKSLIP_ELEMENTS_OF(EXTERN, T, Hex20);       \
  STICKSLIP_ELEMENTS_OF(EXTERN, T, Hex27)

STICKSLIP_ELEMENTS(extern, double);

}  // namespace stickslip
