/// A run's result as Python takes it: a dict of numpy arrays that look into the memory of the C++ result.
#pragma once

#include <pybind11/pybind11.h>

namespace stickslip {

/// What stickslip.Result is made of, but for its document; `owner` is the RunResult, which lives as long as any of the
/// arrays. None of them is a copy or can be written to.
pybind11::dict arrays_of(const pybind11::object& owner);

}  // namespace stickslip
