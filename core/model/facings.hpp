/// Search for what contact points face of their surfaces, where displacements have moved them.
#pragma once

#include "core/model/contact_input.hpp"

namespace stickslip::detail {

/// What each contact point faces of its surface. `compact`: displacements of the contact nodes; `kept`: per point, the
/// patch on which its foot is to be found, or no_patch to search the surface; empty: search for all points.
template <class T>
std::vector<Facing> facings(const ContactInput<T>& input, const Vector<T>& compact, const std::vector<int>& kept = {});

/// Places the vertices of curves in contact with themselves that face nothing beside their nearest patches, from which
/// they slide if they come onto one. An equilibrium needs it, and no iterate on the way: the search looks far.
template <class T>
void place_open_vertices(const ContactInput<T>& input, const Vector<T>& compact, ContactField<T>& field);

/// Both in a scalar, as STICKSLIP_SLOTS; the source includes core/model/facings_impl.hpp.
#define STICKSLIP_FACINGS(EXTERN, T)                                                                              \
  EXTERN template std::vector<Facing> facings(const ContactInput<T>&, const Vector<T>&, const std::vector<int>&); \
  EXTERN template void place_open_vertices(const ContactInput<T>&, const Vector<T>&, ContactField<T>&)

STICKSLIP_FACINGS(extern, double);

}  // namespace stickslip::detail
