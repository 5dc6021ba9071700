/// Fields for ParaView, VTK and meshio: VTK's XML format for unstructured grids, data inline in base64 with UInt64
/// headers (the form that VTK and meshio both read), and the .pvd that lists a run's files in time.
/// Format: VTK File Formats, "XML File Formats" (Kitware).
#pragma once

#include <string>
#include <vector>

#include "core/mesh/mesh.hpp"

namespace stickslip {

/// Kinds of cells, by VTK's own numbers.
enum class VtuCell : unsigned char {
  vertex = 1,
  line = 3,
  triangle = 5,
  quad = 9,
  tetra = 10,
  hexahedron = 12,
  triangle6 = 22,
  quad8 = 23,
  tetra10 = 24,
  hexahedron20 = 25,
  hexahedron27 = 29
};

/// One field: a column of `values` for each point or cell. 1 row is a scalar, 2 or 3 a vector (2 is padded with a zero
/// to VTK's 3), 6 a symmetric tensor in VTK's order xx yy zz xy yz xz, by which its components are named.
struct VtuField {
  std::string name;
  Matrix<double> values;
};

/// What one file holds. Lengths in the unit of the scene.
struct VtuData {
  double time = 0;                     ///< written as FieldData TimeValue, which ParaView reads
  Points<double> points;               ///< 2 or 3 rows, a column per point, in the initial configuration
  std::vector<VtuCell> cells;          ///< one a cell
  std::vector<int> connectivity;       ///< the points of each cell, cell after cell
  std::vector<VtuField> point_fields;  ///< points.cols() columns each
  std::vector<VtuField> cell_fields;   ///< cells.size() columns each
};

/// Adds the elements of a body and its coordinates (a column per node, as many rows as the points there already).
/// Throws std::invalid_argument where they do not fit. Fields are the caller's: body after body, in this order.
void append_mesh(VtuData& data, const Mesh& mesh, const Points<double>& coordinates);

/// The file of the data. Throws std::invalid_argument, naming the field, where sizes do not fit together.
std::string vtu_text(const VtuData& data);

/// A file of a collection; `file` is relative to the folder of the .pvd.
struct PvdEntry {
  double time = 0;
  std::string file;
  int part = 0;  ///< block of the data of that time
};

/// The file of the collection.
std::string pvd_text(const std::vector<PvdEntry>& entries);

}  // namespace stickslip
