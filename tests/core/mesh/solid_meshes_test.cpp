/// Meshes of space: boxes and extruded meshes of hexahedra and of tetrahedra fill their volume, have no inverted
/// element, fit together, and have sides that face outward.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "core/mesh/generators.hpp"
#include "core/mesh/quality.hpp"
#include "core/mesh/sides.hpp"
#include "tests/support/mesh_derivatives.hpp"
#include "tests/support/volumes.hpp"

namespace stickslip::solid_meshes_test {
namespace {

constexpr double pi = 3.14159265358979323846;

struct Made {
  Mesh mesh;
  Points<double> points;
};

Made make(const MeshDescription& description, const std::string& element) {
  const Mesh mesh = make_mesh(description, element, 3);
  return {mesh, make_points<double>(description, mesh, Numbers<double>{})};
}

double volume(const Made& made) { return volume(made.mesh, made.points); }

/// The vector area of a side, out of the body.
Vec<double, 3> outward(const Made& made, const Side& side) { return vector_area(made.points, side); }

/// Every face of an element is one of exactly two, turned the other way, or of the boundary; the boundary is closed.
void expect_fits_together(const Made& made) {
  EXPECT_FALSE(first_inverted_element(made.mesh, made.points));
  EXPECT_FALSE(first_thin_element(made.mesh, made.points));
  const int count = nodes_of(made.mesh.shape);
  std::map<std::set<int>, int> faces;
  for (int e = 0; e < made.mesh.element_count(); ++e)
    for (const auto& side : sides_of(made.mesh.shape)) {
      std::set<int> nodes;
      for (const int a : side) nodes.insert(made.mesh.connectivity[e * count + a]);
      ++faces[nodes];
    }
  const Side boundary = boundary_of(made.mesh);
  std::size_t single = 0;
  for (const auto& [nodes, times] : faces) {
    EXPECT_LE(times, 2);
    single += times == 1;
  }
  EXPECT_EQ(boundary.edges().size(), single);
  EXPECT_LE(outward(made, boundary).norm(), 1e-12);  // some hundred faces of size one
  std::size_t named = 0;                             // the sides of a generated block are all of its boundary
  for (const auto& [name, side] : made.mesh.sides) named += side.facets.size();
  EXPECT_EQ(named, boundary.facets.size());
}

TEST(SolidMeshes, BoxesFillTheirVolumeAndFaceOutward) {
  BoxMesh box;
  box.min = {1.0, -1.0, 2.0};
  box.max = {3.0, 2.0, 6.0};
  box.cells = {3, 2, 4};
  box.grade = {{"bottom", 3.0}};
  // nodes; edges of a grid have directions, of tetrahedra also those across faces and blocks
  const std::map<std::string, int> nodes{
      {"", 60},          {"H8", 60},         {"H8_mean_dilatation", 60},
      {"T4", 60},        {"T10", 7 * 5 * 9}, {"H20", 60 + 3 * 3 * 5 + 4 * 2 * 5 + 4 * 3 * 4},
      {"H27", 7 * 5 * 9}};
  for (const auto& [name_of_element, count] : nodes) {
    const std::string& element = name_of_element;
    const Made made = make(box, element);
    EXPECT_EQ(made.mesh.node_count, count) << element;
    EXPECT_EQ(made.mesh.element_count(), 24 * (element[0] == 'T' ? 6 : 1));
    EXPECT_NEAR(volume(made), 24, 1e-12);  // a sum of some hundred volumes
    expect_fits_together(made);
    const std::map<std::string, Vec<double, 3>> areas{{"left", {-12, 0, 0}},  {"right", {12, 0, 0}},
                                                      {"front", {0, -8, 0}},  {"back", {0, 8, 0}},
                                                      {"bottom", {0, 0, -6}}, {"top", {0, 0, 6}}};
    for (const auto& [name, area] : areas)
      EXPECT_LE((outward(made, made.mesh.sides.at(name)) - area).norm(), 1e-12) << name << element;
    const Side edge = evaluate_side(made.mesh, "front & bottom");
    EXPECT_EQ(edge.nodes.size(), is_quadratic(made.mesh.shape) ? 7u : 4u);
    EXPECT_TRUE(edge.facets.empty());
    // the cells next to the bottom are a third as high as those next to the top
    const double low = made.points(2, 12) - 2, high = 6 - made.points(2, 12 * 3);
    EXPECT_NEAR(high / low, 3, 1e-12);
  }
}

TEST(SolidMeshes, ExtrudedOnesHaveTheSidesOfThePlaneAndTwoEnds) {
  RingMesh ring;
  ring.center = {0.0, 0.0};
  ring.inner = 1.0;
  ring.outer = 2.0;
  ring.cells = {2, 48};
  const ExtrudedMesh tube{ring, -1.0, 2.0, 3};
  for (const char* element : {"H8", "T4"}) {
    const Made made = make(tube, element);
    const double polygon = 48.0 / 2 * std::sin(2 * pi / 48) * (4 - 1);
    EXPECT_NEAR(volume(made), 3 * polygon, 1e-11);
    expect_fits_together(made);
    for (const char* name : {"inner", "outer", "front", "back"}) EXPECT_EQ(made.mesh.sides.count(name), 1u) << name;
    EXPECT_LE((outward(made, made.mesh.sides.at("back")) - Vec<double, 3>(0, 0, polygon)).norm(), 1e-12);
    EXPECT_NEAR(area(made.points, made.mesh.sides.at("outer")), 3 * 48 * 2 * 2 * std::sin(pi / 48), 1e-11);
  }
}

TEST(SolidMeshes, OfQuadraticElementsHaveTheirMiddlesOnCurvedSides) {
  RingMesh ring;
  ring.center = {0.3, -0.2};
  ring.inner = 1.0;
  ring.outer = 2.0;
  ring.cells = {2, 12};
  DiskMesh disk;
  disk.center = {0.3, -0.2};
  disk.radius = 2.0;
  HalfBallMesh ball;
  ball.radius = 2.0;
  ball.cells = {4, 4};
  for (const char* element : {"T10", "H20", "H27"}) {
    const Made tube = make(ExtrudedMesh{ring, -1.0, 2.0, 2}, element),
               cylinder = make(ExtrudedMesh{disk, 0.0, 1.0, 1}, element), half = make(ball, element);
    for (const auto* made : {&tube, &cylinder, &half}) expect_fits_together(*made);
    const auto expect_on = [](const Made& made, const char* side, auto&& radius, double expected) {
      for (const int node : made.mesh.sides.at(side).nodes)
        EXPECT_NEAR(radius(made.points.col(node)), expected, 1e-14 * expected) << side;  // some roundings
    };
    const auto from_axis = [](const Vec<double, 3>& x) { return std::hypot(x[0] - 0.3, x[1] + 0.2); };
    expect_on(tube, "inner", from_axis, 1);
    expect_on(tube, "outer", from_axis, 2);
    expect_on(cylinder, "arc", from_axis, 2);
    expect_on(
        half, "surface", [](const Vec<double, 3>& x) { return x.norm(); }, 2);
    for (const int node : half.mesh.sides.at("flat").nodes) EXPECT_NEAR(half.points(2, node), 0, 1e-15);
    // parabolas leave less than the fourth power of half an arc over 20 of a sector: of 30 degrees 2e-4, of 22 in two
    // directions 2e-3
    EXPECT_NEAR(volume(tube) / (3 * pi * 3), 1, 2e-4) << element;
    EXPECT_NEAR(volume(half) / (2 * pi / 3 * 8), 1, 2e-3) << element;
  }
}

TEST(SolidMeshes, OfQuadraticElementsHaveExactDerivatives) {
  HalfBallMesh ball;
  ball.center = {Number(0.1), Number(-0.2), Number(1.0)};
  ball.radius = Number(1.5, 0);
  ball.cells = {3, 3};
  RingMesh ring;
  ring.center = {Number(0.0), Number(0.0)};
  ring.inner = Number(1.5, 0);
  ring.outer = 2.0;
  ring.cells = {2, 8};
  for (const MeshDescription& description : {MeshDescription(ball), MeshDescription(ExtrudedMesh{ring, 0.0, 1.0, 2})})
    for (const char* element : {"T10", "H20", "H27"}) expect_exact_derivatives(description, element, 3, {1.5});
}

TEST(SolidMeshes, OfAQuadraticElementTurnedInsideOutAreFound) {
  BoxMesh box;
  box.min = {0.0, 0.0, 0.0};
  box.max = {1.0, 1.0, 1.0};
  box.cells = {1, 1, 1};
  for (const char* element : {"T10", "H20", "H27"}) {
    Made made = make(box, element);
    EXPECT_FALSE(first_inverted_element(made.mesh, made.points)) << element;
    const int middle = made.mesh.connectivity[corners_of(made.mesh.shape)], end = made.mesh.connectivity[0];
    made.points.col(middle) = 0.8 * made.points.col(end) + 0.2 * made.points.col(made.mesh.connectivity[1]);
    EXPECT_EQ(first_inverted_element(made.mesh, made.points), std::optional(0)) << element;  // less than a quarter
  }
}

TEST(SolidMeshes, AreRefusedWithAReason) {
  BoxMesh flat;
  flat.max = {1.0, 1.0};
  EXPECT_NE(mesh_fault(flat, "", 3).find("one number an axis, 3"), std::string::npos) << mesh_fault(flat, "", 3);
  BoxMesh box;
  box.min = {0.0, 0.0, 0.0};
  box.max = {1.0, 1.0, 1.0};
  box.cells = {1, 1, 1};
  EXPECT_EQ(mesh_fault(box, "", 3), "");
  EXPECT_NE(mesh_fault(box, "Q4", 3).find("H8, H8_mean_dilatation, H20, H27, T4 or T10, not Q4"), std::string::npos);
  EXPECT_NE(mesh_fault(box, "", 2).find("one number an axis, 2"), std::string::npos);
  ExtrudedMesh upside_down{flat, 1.0, 0.0, 1};
  EXPECT_NE(mesh_fault(upside_down, "", 3).find("greater than from"), std::string::npos);
  upside_down.to = 2.0;
  EXPECT_EQ(mesh_fault(upside_down, "", 3), "");
  EXPECT_NE(mesh_fault(upside_down, "", 2).find("needs the space solid"), std::string::npos);
}

}  // namespace
}  // namespace stickslip::solid_meshes_test
