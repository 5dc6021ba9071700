/// Half balls: on their sphere, of sound cells over grades and counts, converging to the exact volume and area, with
/// exact derivatives.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>

#include "core/mesh/generators.hpp"
#include "core/mesh/quality.hpp"
#include "core/mesh/sides.hpp"
#include "tests/support/mesh_derivatives.hpp"
#include "tests/support/volumes.hpp"

namespace stickslip::half_ball_test {
namespace {

constexpr double pi = 3.14159265358979323846, eps = std::numeric_limits<double>::epsilon();

HalfBallMesh half_ball(int along, int inwards, double grade, HalfBallMesh::Facing facing = HalfBallMesh::Facing::down) {
  HalfBallMesh mesh;
  mesh.center = {0.3, -0.2, 8.1};
  mesh.radius = 8.0;
  mesh.cells = {along, inwards};
  mesh.grade = grade;
  mesh.facing = facing;
  return mesh;
}

Points<double> points_of(const HalfBallMesh& ball) { return make_points<double>(ball, Numbers<double>{}, 3); }

TEST(HalfBall, HasCellsOfGoodShapeForAllCountsAndGradesItAccepts) {
  for (const int along : {2, 3, 4, 5, 6, 8, 12})
    for (int inwards = 2; inwards <= 12; ++inwards)
      for (double grade : {1.0, 3.0, 10.0, 30.0, 100.0}) {
        const HalfBallMesh ball = half_ball(along, inwards, grade);
        if (!mesh_fault(ball, "", 3).empty()) continue;
        const Mesh mesh = make_mesh(ball, "H8", 3);
        const Points<double> points = points_of(ball);
        EXPECT_FALSE(first_inverted_element(mesh, points)) << along << " " << inwards << " " << grade;
        // the qualities half_ball.hpp promises
        EXPECT_GT(worst_corner_in_space(mesh, points), along == inwards ? 0.5 : 0.2)
            << along << " " << inwards << " " << grade;
        if (along > 4) continue;
        EXPECT_FALSE(first_inverted_element(make_mesh(ball, "T4", 3), points))
            << along << " " << inwards << " " << grade;
      }
}

TEST(HalfBall, FitsTogetherAndFacesOutward) {
  for (const char* element : {"H8", "T4"})
    for (const auto facing : {HalfBallMesh::Facing::down, HalfBallMesh::Facing::up}) {
      const HalfBallMesh ball = half_ball(5, 4, 3, facing);
      const Mesh mesh = make_mesh(ball, element, 3);
      const Points<double> points = points_of(ball);
      EXPECT_EQ(points.cols(), mesh.node_count);
      EXPECT_EQ(mesh.element_count(), ball.cell_count() * (mesh.shape == ElementShape::tet4 ? 6 : 1));
      EXPECT_FALSE(first_inverted_element(mesh, points));
      EXPECT_FALSE(first_thin_element(mesh, points));
      const Side boundary = boundary_of(mesh);
      const Side &surface = mesh.sides.at("surface"), &flat = mesh.sides.at("flat");
      EXPECT_EQ(surface.facets.size() + flat.facets.size(), boundary.facets.size());
      EXPECT_LE(vector_area(points, boundary).norm(), 1e3 * eps * 200);  // sums of some hundred faces, 200 in all
      // Euler: a mesh that fits together has a closed surface of faces, V - E + F = 2
      std::set<std::pair<int, int>> edges;
      for (const auto& facet : boundary.facets)
        for (std::size_t k = 0; k < facet.size(); ++k)
          edges.insert(std::minmax(facet[k], facet[(k + 1) % facet.size()]));
      EXPECT_EQ(boundary.nodes.size() + boundary.facets.size(), edges.size() + 2);
      const double up = facing == HalfBallMesh::Facing::down ? 1 : -1;
      for (const auto& facet : flat.facets) EXPECT_GT(up * vector_area(points, {{}, {facet}})[2], 0);
      for (const auto& facet : surface.facets)
        EXPECT_GT(vector_area(points, {{}, {facet}}).dot(points.col(facet[0]) - Vec<double, 3>(0.3, -0.2, 8.1)), 0);
      for (const int node : flat.nodes) EXPECT_NEAR(points(2, node), 8.1, 16 * 8 * eps);  // a few roundings
    }
}

TEST(HalfBall, HasItsNodesOnTheSphereInGeometricStepsFromThePole) {
  const HalfBallMesh ball = half_ball(9, 8, 50);
  const Mesh mesh = make_mesh(ball, "H8", 3);
  const Points<double> points = points_of(ball);
  std::vector<double> angles;  // of the nodes in a middle plane, from the pole
  for (const int node : mesh.sides.at("surface").nodes) {
    const Vec<double, 3> r = points.col(node) - Vec<double, 3>(0.3, -0.2, 8.1);
    EXPECT_NEAR(r.norm(), 8.0, 8 * 8 * eps);  // a few roundings of numbers up to 16
    if (points(1, node) == -0.2 && r[0] >= 0) angles.push_back(std::atan2(r[0], -r[2]));
  }
  std::sort(angles.begin(), angles.end());
  ASSERT_EQ(angles.size(), 10u);
  EXPECT_EQ(angles[0], 0);
  const double factor = std::pow(50.0, 1.0 / 8);
  for (int i = 0; i + 2 < 10; ++i)  // the least step has lost three digits
    EXPECT_NEAR((angles[i + 2] - angles[i + 1]) / (angles[i + 1] - angles[i]), factor, 1e4 * eps);
  EXPECT_NEAR(angles[9], pi / 2, 10 * eps);
}

TEST(HalfBall, FacingUpMirrorsTheOneFacingDownNodeByNode) {
  HalfBallMesh down = half_ball(4, 5, 10), up = half_ball(4, 5, 10, HalfBallMesh::Facing::up);
  down.center[2] = up.center[2] = 0.0;
  const Points<double> a = points_of(down), b = points_of(up);
  EXPECT_EQ(a.topRows(2), b.topRows(2));
  EXPECT_EQ(a.row(2), -b.row(2));
  for (const char* side : {"surface", "flat"})
    EXPECT_EQ(make_mesh(down, "T4", 3).sides.at(side).nodes, make_mesh(up, "T4", 3).sides.at(side).nodes);
}

TEST(HalfBall, ConvergesToItsVolumeAndItsAreaWithTheSquareOfTheCells) {
  for (const char* element : {"H8", "T4"})
    for (const double grade : {1.0, 4.0}) {
      std::vector<double> volumes, areas;
      for (const int n : {4, 8, 16}) {
        const HalfBallMesh ball = half_ball(n, n, grade);
        const Mesh mesh = make_mesh(ball, element, 3);
        const Points<double> points = points_of(ball);
        volumes.push_back(1 - volume(mesh, points) / (2 * pi / 3 * 512));
        areas.push_back(1 - area(points, mesh.sides.at("surface")) / (2 * pi * 64));
        EXPECT_LT(area(points, mesh.sides.at("flat")), pi * 64);
      }
      for (const auto& error : {volumes, areas}) {
        EXPECT_GT(error[2], 0) << element;  // it is inside of the sphere
        EXPECT_LT(error[2], 0.02) << element;
        EXPECT_NEAR(std::log2(error[1] / error[2]), 2, 0.1) << element << grade;
      }
    }
}

TEST(HalfBall, HasExactDerivatives) {
  for (const auto facing : {HalfBallMesh::Facing::down, HalfBallMesh::Facing::up})
    for (const double grade : {1.0, 40.0}) {
      HalfBallMesh ball = half_ball(6, 5, grade, facing);
      ball.center = {Number(0.3, 0), Number(-0.2, 1), Number(8.1, 2)};
      ball.radius = Number(8, 3);
      ball.grade = Number(grade, 4);
      expect_exact_derivatives(ball, "H27", 3, {0.3, -0.2, 8.1, 8, grade});
    }
}

TEST(HalfBall, ThatMakesNoMeshIsRefusedWithAReason) {
  const auto expect_fault = [](const HalfBallMesh& ball, const char* element, int dimension, const char* part) {
    EXPECT_NE(mesh_fault(ball, element, dimension).find(part), std::string::npos)
        << mesh_fault(ball, element, dimension);
  };
  expect_fault(half_ball(4, 4, 1), "", 2, "needs the space solid");
  expect_fault(half_ball(4, 4, 1), "Q4", 3, "H8, H8_mean_dilatation, H20, H27, T4 or T10, not Q4");
  expect_fault(half_ball(1, 1, 1), "", 3, "at least 2");
  expect_fault(half_ball(4, 7, 1), "", 3, "factor 1.5");
  expect_fault(half_ball(4, 4, 0), "", 3, "grade must be greater than 0");
  HalfBallMesh flat = half_ball(4, 4, 1);
  flat.radius = 0.0;
  expect_fault(flat, "", 3, "radius must be greater than 0");
}

}  // namespace
}  // namespace stickslip::half_ball_test
