#include "methods/penalty.hpp"

namespace stickslip {

template Increment<double> Penalty::solve_increment(Run<double>&, const State<double>&, const std::vector<double>&,
                                                    double, const Start<double>&) const;

}  // namespace stickslip
