#include "core/model/point_tangent.hpp"

namespace stickslip {

template PointTangent<double> point_tangent(const ContactInput<double>&, int, const Vector<double>&,
                                            const Vector<double>&, ContactState, const std::vector<Facing>&);

}  // namespace stickslip
