#include "methods/monolithic.hpp"

namespace stickslip {

template Increment<double> MonolithicAL::solve_increment(Run<double>&, const State<double>&, const std::vector<double>&,
                                                         double, const Start<double>&) const;

}  // namespace stickslip
