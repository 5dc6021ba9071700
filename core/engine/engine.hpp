/// Linear algebra of a Newton iteration, in two engines of one interface. A method sees residual, factorise and solve;
/// it does not see whether the bodies are there in full (SparseEngine) or as their Schur complement on the contact dofs
/// (CondensedEngine: small strain and linear materials; 20-200 times cheaper an iteration).
///
/// An engine owns a displacement vector layout ("engine dofs"): all dofs, or the compact contact dofs, in the frames of
/// the nodes (model/frames.hpp). Rows and increments are in that layout; entries of prescribed dofs are zero in
/// increments and ignored in rows. What `compact`, `all` and `expand` return and `residual` is given is in the axes.
#pragma once

#include <variant>

#include "core/engine/condensed_engine.hpp"
#include "core/engine/sparse_engine.hpp"

namespace stickslip {

template <class T>
using Engine = std::variant<SparseEngine<T>, CondensedEngine<T>>;

}  // namespace stickslip
