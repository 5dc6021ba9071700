/// The files of the methods in this folder: one a method of the closed set (methods/options.hpp), and the one place
/// where it is asked for which. Compiled in double; who wants another scalar includes this.
#pragma once

#include "methods/monolithic.hpp"
#include "methods/penalty.hpp"
#include "methods/uzawa.hpp"

namespace stickslip {

template <class T>
Increment<T> solve_increment(Run<T>& run, const State<T>& previous, const std::vector<double>& rho_factor, double time,
                             const Start<T>& start) {
  return std::visit([&](const auto& method) { return method.solve_increment(run, previous, rho_factor, time, start); },
                    run.method);
}

}  // namespace stickslip
