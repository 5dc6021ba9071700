#include "core/engine/engine.hpp"

#include "core/engine/condensed_tangent.hpp"
#include "core/engine/engine_impl.hpp"

namespace stickslip {

template class FullBodies<double>;
template class PointElimination<double>;
template class SparseSystem<double>;
template class DenseSystem<double>;
template class CondensedTangent<double>;
STICKSLIP_ENGINES(, double);

}  // namespace stickslip
