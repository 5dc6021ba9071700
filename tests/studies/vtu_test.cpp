#include "studies/io/vtu.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "core/mesh/generators.hpp"
#include "studies/io/atomic_file.hpp"
#include "tests/studies/temporary_folder.hpp"
#include "tests/studies/vtu_reader.hpp"

namespace stickslip {
namespace {

using vtu::Array;
using vtu::array_named;

/// A triangle, a quad, a line and a vertex in the plane, with fields of every width.
VtuData sample() {
  VtuData data;
  data.time = 0.1;
  data.points.resize(2, 6);
  data.points << 0, 1, 1, 0, 2, 2,  //
      0, 0, 1, 1, 0, 1;
  data.cells = {VtuCell::quad, VtuCell::triangle, VtuCell::line, VtuCell::vertex};
  data.connectivity = {0, 1, 2, 3, 1, 4, 2, 4, 5, 5};
  Matrix<double> pressure(1, 6), displacement(2, 6), normal(3, 6), stress(6, 4);
  for (int i = 0; i < 6; ++i) {
    pressure(0, i) = std::sqrt(2.0) * i;
    displacement.col(i) << i + 0.1, -i - 0.2;
    normal.col(i) << i, 2 * i, 3 * i;
  }
  for (int i = 0; i < 24; ++i) stress(i % 6, i / 6) = 1.0 / (i + 3);
  data.point_fields = {{"pressure", pressure}, {"displacement", displacement}, {"normal", normal}};
  data.cell_fields = {{"stress", stress}};
  return data;
}

class Vtu : public InOwnFolder {
 protected:
  std::string written(const VtuData& data) {
    write_file_atomically(folder_ / "fields.vtu", vtu_text(data));
    return read_file(folder_ / "fields.vtu");
  }
};

TEST_F(Vtu, DeclaresGridHeadersAndCounts) {
  const std::string xml = written(sample());
  EXPECT_NE(xml.find("<VTKFile type=\"UnstructuredGrid\""), std::string::npos);
  EXPECT_NE(xml.find("header_type=\"UInt64\""), std::string::npos);
  EXPECT_NE(xml.find("byte_order=\"LittleEndian\""), std::string::npos);
  EXPECT_NE(xml.find("<Piece NumberOfPoints=\"6\" NumberOfCells=\"4\">"), std::string::npos);
}

TEST_F(Vtu, PointsInThePlaneGetAThirdCoordinate) {
  const Array points = array_named(written(sample()), "Points");
  EXPECT_NE(points.attributes.find("NumberOfComponents=\"3\""), std::string::npos);
  EXPECT_EQ(points.values<double>(), (std::vector<double>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 2, 0, 0, 2, 1, 0}));
}

TEST_F(Vtu, MixedCellsHaveTheirPointsEndsAndVtkTypes) {
  const std::string xml = written(sample());
  EXPECT_EQ(array_named(xml, "connectivity").values<std::int64_t>(),
            (std::vector<std::int64_t>{0, 1, 2, 3, 1, 4, 2, 4, 5, 5}));
  EXPECT_EQ(array_named(xml, "offsets").values<std::int64_t>(), (std::vector<std::int64_t>{4, 7, 9, 10}));
  // VTK_QUAD, VTK_TRIANGLE, VTK_LINE, VTK_VERTEX of vtkCellType.h
  EXPECT_EQ(array_named(xml, "types").values<std::uint8_t>(), (std::vector<std::uint8_t>{9, 5, 3, 1}));
}

TEST_F(Vtu, FieldsComeBackBitByBit) {
  const VtuData data = sample();
  const std::string xml = written(data);
  const auto flat = [](const Matrix<double>& m) { return std::vector<double>(m.data(), m.data() + m.size()); };
  EXPECT_EQ(array_named(xml, "pressure").values<double>(), flat(data.point_fields[0].values));
  EXPECT_EQ(array_named(xml, "normal").values<double>(), flat(data.point_fields[2].values));
  EXPECT_EQ(array_named(xml, "stress").values<double>(), flat(data.cell_fields[0].values));
  EXPECT_NE(array_named(xml, "stress").attributes.find("NumberOfComponents=\"6\" ComponentName0=\"xx\""),
            std::string::npos);
  EXPECT_NE(array_named(xml, "stress").attributes.find("ComponentName5=\"xz\""), std::string::npos);
}

TEST_F(Vtu, AVectorInThePlaneIsPaddedWithZero) {
  const Array displacement = array_named(written(sample()), "displacement");
  EXPECT_NE(displacement.attributes.find("NumberOfComponents=\"3\""), std::string::npos);
  const std::vector<double> values = displacement.values<double>();
  ASSERT_EQ(values.size(), 18u);
  EXPECT_EQ((std::array{values[3], values[4], values[5]}), (std::array{1.1, -1.2, 0.0}));
}

TEST_F(Vtu, TimeIsExact) {
  EXPECT_EQ(array_named(written(sample()), "TimeValue").values<double>(), std::vector<double>{0.1});
}

TEST_F(Vtu, ValuesThatAreNotFiniteSurvive) {
  VtuData data = sample();
  data.point_fields[0].values(0, 1) = std::numeric_limits<double>::infinity();
  data.point_fields[0].values(0, 2) = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> values = array_named(written(data), "pressure").values<double>();
  EXPECT_EQ(values[1], std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(values[2]));
}

TEST_F(Vtu, APayloadOfEveryRemainderByThreeIsPaddedRight) {
  // 8 bytes of header and one byte a vertex: 9, 10 and 11 bytes.
  for (int count = 1; count <= 3; ++count) {
    VtuData data;
    data.points = Matrix<double>::Zero(3, count);
    for (int i = 0; i < count; ++i) {
      data.cells.push_back(VtuCell::vertex);
      data.connectivity.push_back(i);
    }
    EXPECT_EQ(array_named(written(data), "types").values<std::uint8_t>(),
              std::vector<std::uint8_t>(static_cast<std::size_t>(count), 1));
  }
}

TEST_F(Vtu, NothingIsAFileToo) {
  const std::string xml = written(VtuData{});
  EXPECT_NE(xml.find("<Piece NumberOfPoints=\"0\" NumberOfCells=\"0\">"), std::string::npos);
  EXPECT_TRUE(array_named(xml, "connectivity").payload.empty());
  // VTK's reader refuses points of any other width, even none of them.
  EXPECT_NE(array_named(xml, "Points").attributes.find("NumberOfComponents=\"3\""), std::string::npos);
}

TEST_F(Vtu, NamesAreEscaped) {
  VtuData data = sample();
  data.point_fields[0].name = "dp/dE <\"a\" & b>";
  EXPECT_NE(written(data).find("Name=\"dp/dE &lt;&quot;a&quot; &amp; b&gt;\""), std::string::npos);
}

TEST_F(Vtu, WhatDoesNotFitIsRefusedByName) {
  const auto refused = [](const VtuData& data, const std::string& part) {
    try {
      vtu_text(data);
      ADD_FAILURE() << "accepted: " << part;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  };
  VtuData data = sample();
  data.point_fields[1].values.conservativeResize(2, 5);
  refused(data, "'displacement' has 5 values for 6 points");
  data = sample();
  data.cell_fields[0].values = Matrix<double>::Zero(4, 4);
  refused(data, "'stress' has 4 components");
  data = sample();
  data.connectivity.pop_back();
  refused(data, "the cells have 10 points, not 9");
  data = sample();
  data.connectivity.back() = 6;
  refused(data, "a cell names point 6 of 6");
}

TEST_F(Vtu, BodiesAreAppendedWithTheirNodesAfterThoseBefore) {
  Mesh quad;
  quad.node_count = 4;
  quad.connectivity = {0, 1, 2, 3};
  Mesh bar;
  bar.node_count = 2;
  bar.shape = ElementShape::bar2;
  bar.connectivity = {0, 1};
  VtuData data;
  append_mesh(data, quad, (Points<double>(2, 4) << 0, 1, 1, 0, 0, 0, 1, 1).finished());
  append_mesh(data, bar, (Points<double>(2, 2) << 5, 6, 0, 0).finished());
  EXPECT_EQ(data.cells, (std::vector<VtuCell>{VtuCell::quad, VtuCell::line}));
  EXPECT_EQ(data.connectivity, (std::vector<int>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(data.points(0, 5), 6);
  EXPECT_THROW(append_mesh(data, bar, Points<double>::Zero(3, 2)), std::invalid_argument);
  EXPECT_THROW(append_mesh(data, bar, Points<double>::Zero(2, 3)), std::invalid_argument);
}

/// The parametric coordinates that VTK documents for its quadratic cells, doubled.
TEST_F(Vtu, QuadraticCellsOfSpaceHaveTheirNodesInVtksOrder) {
  using Places = std::vector<std::array<int, 3>>;
  const Places tetrahedron{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}, {1, 0, 0},
                           {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}},
      hexahedron{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 0, 2}, {2, 0, 2}, {2, 2, 2}, {0, 2, 2}, {1, 0, 0},
                 {2, 1, 0}, {1, 2, 0}, {0, 1, 0}, {1, 0, 2}, {2, 1, 2}, {1, 2, 2}, {0, 1, 2}, {0, 0, 1}, {2, 0, 1},
                 {2, 2, 1}, {0, 2, 1}, {0, 1, 1}, {2, 1, 1}, {1, 0, 1}, {1, 2, 1}, {1, 1, 0}, {1, 1, 2}, {1, 1, 1}};
  BoxMesh box;
  box.min = {0.0, 0.0, 0.0};
  box.max = {2.0, 2.0, 2.0};
  box.cells = {1, 1, 1};
  for (const auto& [element, cell, type] : {std::tuple{"T10", VtuCell::tetra10, 24},
                                            {"H20", VtuCell::hexahedron20, 25},
                                            {"H27", VtuCell::hexahedron27, 29}}) {
    const Mesh mesh = make_mesh(box, element, 3);
    VtuData data;
    append_mesh(data, mesh, make_points<double>(box, mesh, {}));
    const std::string xml = written(data);
    const auto types = array_named(xml, "types").values<std::uint8_t>();
    const auto nodes = array_named(xml, "connectivity").values<std::int64_t>();
    const auto points = array_named(xml, "Points").values<double>();
    ASSERT_EQ(types.size(), static_cast<std::size_t>(mesh.element_count()));
    EXPECT_EQ(types[0], type);
    EXPECT_EQ(static_cast<int>(cell), type);
    const int count = nodes_of(mesh.shape);
    ASSERT_EQ(nodes.size(), static_cast<std::size_t>(count) * types.size());
    const auto at = [&](int a) { return Eigen::Map<const Eigen::Vector3d>(points.data() + 3 * nodes[a]); };
    for (int a = 0; a < count; ++a) {
      const auto& p = count == 10 ? tetrahedron[a] : hexahedron[a];
      const int third = count == 10 ? 2 : 3, up = count == 10 ? 3 : 4;  // corners along the second and third coordinate
      const Eigen::Vector3d expected =
          at(0) + (p[0] * (at(1) - at(0)) + p[1] * (at(third) - at(0)) + p[2] * (at(up) - at(0))) / 2;
      EXPECT_EQ(Eigen::Vector3d(at(a)), expected) << element << " " << a;  // halves of whole numbers
    }
  }
}

TEST_F(Vtu, ACollectionListsItsFilesWithTimesThatReadBackExactly) {
  const std::string xml = pvd_text({{0.1, "fields_1.vtu"}, {1.0 / 3, "a&b.vtu", 1}});
  EXPECT_NE(xml.find("<VTKFile type=\"Collection\""), std::string::npos);
  EXPECT_NE(xml.find("timestep=\"0.1\" group=\"\" part=\"0\" file=\"fields_1.vtu\""), std::string::npos);
  EXPECT_NE(xml.find("part=\"1\" file=\"a&amp;b.vtu\""), std::string::npos);
  const std::size_t second = xml.find("timestep=\"", xml.find("fields_1.vtu")) + std::strlen("timestep=\"");
  EXPECT_EQ(std::strtod(xml.c_str() + second, nullptr), 1.0 / 3);
}

#ifdef STICKSLIP_PYTHON_WITH_MESHIO
TEST_F(Vtu, IsReadByMeshio) {
  written(sample());
  write_file_atomically(folder_ / "check.py", R"(
import sys, meshio, numpy as np
mesh = meshio.read(sys.argv[1])
assert mesh.points.shape == (6, 3), mesh.points
assert [(c.type, c.data.tolist()) for c in mesh.cells] == [
    ("quad", [[0, 1, 2, 3]]), ("triangle", [[1, 4, 2]]), ("line", [[4, 5]]), ("vertex", [[5]])], mesh.cells
assert np.array_equal(mesh.point_data["pressure"].ravel(), np.sqrt(2.0) * np.arange(6))
assert np.array_equal(mesh.point_data["displacement"][1], [1.1, -1.2, 0.0])
assert np.array_equal(np.vstack(mesh.cell_data["stress"]).ravel(), 1.0 / (np.arange(24) + 3.0))
)");
  const std::string command = std::string(STICKSLIP_PYTHON_WITH_MESHIO) + " '" + (folder_ / "check.py").string() +
                              "' '" + (folder_ / "fields.vtu").string() + "'";
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
}
#endif

}  // namespace
}  // namespace stickslip
