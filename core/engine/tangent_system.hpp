/// Systems of the tangents of bodies and contact points, factorised one way or another: sparse as a whole
/// (core/engine/sparse_system.hpp), or with what is inside the bodies eliminated first
/// (core/engine/condensed_tangent.hpp). Both take the bodies' matrix on a pattern of their own.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/engine/engine_parts.hpp"

namespace stickslip {

template <class T>
class TangentSystem {
 public:
  virtual ~TangentSystem() = default;

  virtual const std::vector<int>& row_of_dof() const = 0;  ///< of the bodies' matrix; -1: none
  virtual const std::vector<int>& dofs() const = 0;        ///< of its rows
  virtual const Pattern& pattern() const = 0;              ///< has room for it
  /// `rows` and the solution: u over all dofs, in the frames of the nodes; zero where there is no row.
  virtual BlockVector<T> solve(const BlockVector<T>& rows, Solving how) = 0;
  /// Whether the determinant has another sign than where all points stick.
  virtual bool reversed() const = 0;
  virtual double condition_estimate() = 0;
  virtual const std::string& message() const = 0;  ///< why the last factorisation failed
  virtual std::string name() const = 0;
  virtual void add_holdings(EngineHoldings& held) const = 0;
};

}  // namespace stickslip
