/// Body of an imported mesh: topology and coordinates as read.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "core/algebra/number.hpp"
#include "core/mesh/mesh.hpp"

namespace stickslip {

struct ImportedMesh {
  static constexpr Filling filling = Filling::continuum;
  std::string file, body;
  Mesh mesh;
  Points<double> points;
  std::map<std::string, std::vector<std::array<int, 2>>> curves = {};  ///< in space: edges of the sides that are curves
};

/// What is wrong with the description, or "".
std::string fault(const ImportedMesh&, const std::string& element, int dimension);
Mesh topology(const ImportedMesh&, const std::string& element, int dimension);

/// Coordinates as read: constants.
template <class T>
Points<T> coordinates(const ImportedMesh& imported, const Numbers<T>&, int) {
  return imported.points.unaryExpr([](double x) { return T(x); });
}

}  // namespace stickslip
