/// The list of rigid surfaces. Each has a file of its own, with
///
///   its description    for the scene: its keys (core/algebra/described.hpp); whether it is made for the plane and for
///                      space (is_in_plane, is_in_space); whether it is flat (is_flat); what to do if its solid is on
///                      the wrong side (if_turned)
///   against()          of (X, w, surface, numbers): the geometry of the place X + w. Its gap is that of X and what the
///                      displacement w adds, so that a small displacement keeps its digits far from the origin
///   ambiguous_at()     only if it has a place from which no part of it is nearer than another
///
/// What it lacks does not compile. Those that are made of facets (rigid_facets.hpp) have no against(): which facet a
/// place faces is found by search (core/contact/facet_search.hpp, surface_search.hpp).
#pragma once

#include <concepts>
#include <string>
#include <variant>
#include <vector>

#include "core/contact/circle.hpp"
#include "core/contact/cylinder.hpp"
#include "core/contact/plane.hpp"
#include "core/contact/rigid_facets.hpp"
#include "core/contact/sphere.hpp"

namespace stickslip {

using RigidSurface = std::variant<Plane, Circle, Sphere, Cylinder, Polyline, RigidFacets, MeshSide>;

/// Whether a surface is made of facets that lie beside one another: points slide along it as along a side of a body.
inline bool has_facets(const RigidSurface& surface) {
  return std::visit(
      []<class S>(const S&) {
        return requires { S::has_facets; };
      },
      surface);
}

/// Initial positions of the vertices of a surface that is made of facets, D x vertices, length; of another none.
template <class T>
Points<T> vertices_of(const RigidSurface& surface, const Numbers<T>& numbers) {
  return std::visit(
      [&]<class S>(const S& shape) -> Points<T> {
        if constexpr (requires { S::has_facets; }) return vertices_of(shape, numbers);
        return {};
      },
      surface);
}
/// Facets of a surface that is made of them; of another none.
inline std::vector<std::vector<int>> facets_of(const RigidSurface& surface) {
  return std::visit(
      []<class S>(const S& shape) -> std::vector<std::vector<int>> {
        if constexpr (requires { S::has_facets; }) return facets_of(shape);
        return {};
      },
      surface);
}

template <class S>
concept WholeSurface = requires(const S& surface, const Vec<double, 2>& x, const Numbers<double>& numbers) {
  { S::is_in_plane } -> std::convertible_to<bool>;
  { S::is_in_space } -> std::convertible_to<bool>;
  { S::is_flat } -> std::convertible_to<bool>;
  { against<double>(x, x, surface, numbers) } -> std::same_as<PointGeometry<double>>;
};

namespace detail {

template <class S>
constexpr bool is_whole_surface() {
  if constexpr (!requires { S::has_facets; }) static_assert(WholeSurface<S>, "a rigid surface lacks something");
  return true;
}
template <class... S>
constexpr bool are_whole_surfaces(const std::variant<S...>*) {
  return (is_whole_surface<S>() && ...);
}
static_assert(are_whole_surfaces(static_cast<const RigidSurface*>(nullptr)) && !WholeSurface<Polyline>);

}  // namespace detail

inline bool is_in_space(const RigidSurface& surface) {
  return std::visit([](const auto& shape) { return shape.is_in_space; }, surface);
}
inline bool is_flat(const RigidSurface& surface) {
  return std::visit([](const auto& shape) { return shape.is_flat; }, surface);
}

/// What to do if the solid of a surface is on the wrong side.
inline std::string if_turned(const RigidSurface& surface) {
  return std::visit([](const auto& shape) -> std::string { return shape.if_turned; }, surface);
}

/// Geometry of the place X + w against a surface. pre: it has no facets.
template <class T, class Start, class Motion, class Read>
PointGeometry<T> against_rigid(const Start& X, const Motion& w, const RigidSurface& surface, const Read& numbers) {
  return std::visit(
      [&]<class S>(const S& shape) -> PointGeometry<T> {
        if constexpr (WholeSurface<S>) return against<T>(X, w, shape, numbers);
        return {};
      },
      surface);
}
/// The same of a place.
template <class T, class Place, class Read>
PointGeometry<T> against_rigid(const Place& x, const RigidSurface& surface, const Read& numbers) {
  return against_rigid<T>(x, Vector<T>(Vector<T>::Constant(x.size(), T(0))), surface, numbers);
}

/// The key of the surface that is wrong where x has no nearest place on it; nullptr where x has one.
template <class Place>
const char* ambiguity(const Place& x, const RigidSurface& surface, const Numbers<double>& numbers) {
  return std::visit(
      [&](const auto& shape) -> const char* {
        if constexpr (requires { ambiguous_at(x, shape, numbers); }) return ambiguous_at(x, shape, numbers);
        return nullptr;
      },
      surface);
}

}  // namespace stickslip
