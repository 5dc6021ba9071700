#include "core/model/response.hpp"

namespace stickslip {

template double evaluate_response(const Model&, const Slots<double>&, int, const State<double>&,
                                  const NodalForces<double>&, Ties);
template Vector<double> evaluate_responses(const Model&, const Slots<double>&, const State<double>&, double, Ties);

}  // namespace stickslip
