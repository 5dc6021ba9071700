#include "methods/all_methods.hpp"

namespace stickslip {

template Increment<double> solve_increment(Run<double>&, const State<double>&, const std::vector<double>&, double,
                                           const Start<double>&);

}  // namespace stickslip
