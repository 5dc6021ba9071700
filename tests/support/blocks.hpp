/// Blocks, and the methods they are held against closed forms by.
#pragma once

#include "tests/support/solved.hpp"

namespace stickslip::scenes {

inline std::vector<Method> all_methods() { return {Penalty{}, UzawaAL{}, MonolithicAL{}}; }
/// Those that enforce the constraint to their tolerance. Uzawa's is set to what "exact" asks for.
inline std::vector<Method> exact_methods() {
  UzawaAL uzawa;
  uzawa.tolerance = 1e-12;
  return {uzawa, MonolithicAL{}};
}
inline constexpr double exact = 1e-10;  // of a closed form: Uzawa's tolerance times a factor rho / k

/// A box of linear elastic elements, Q4 unless the body is given another.
inline Body box_body(const std::string& name, std::array<double, 2> min, std::array<double, 2> max,
                     std::array<int, 2> cells, double E = 1000, double nu = 0.3) {
  BoxMesh box;
  box.min = {min[0], min[1]};
  box.max = {max[0], max[1]};
  box.cells = {cells[0], cells[1]};
  return {name, box, LinearElastic{E, nu}, "", 1.0};
}

/// From 0 at t = 0 to a value at t = 1.
inline Table ramp(const Number& value) { return table({{0, 0.0}, {1, value}}); }

}  // namespace stickslip::scenes
