/// Balls, solid and hollow: on their spheres, of sound cells over grades and counts, converging to the exact volume and
/// area, with exact derivatives.
#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "core/mesh/generators.hpp"
#include "core/mesh/quality.hpp"
#include "core/mesh/sides.hpp"
#include "tests/support/mesh_derivatives.hpp"
#include "tests/support/volumes.hpp"

namespace stickslip::ball_test {
namespace {

constexpr double pi = 3.14159265358979323846, eps = std::numeric_limits<double>::epsilon();
const Vec<double, 3> middle(0.3, -0.2, 8.1);

BallMesh ball(int along, int layers, double inner = 0, double grade = 1) {
  BallMesh mesh;
  for (int i = 0; i < 3; ++i) mesh.center[i] = middle[i];
  mesh.radius = 8.0;
  mesh.inner = inner;
  mesh.cells = {along, layers};
  mesh.grade = grade;
  return mesh;
}

Points<double> points_of(const BallMesh& mesh) { return make_points<double>(mesh, Numbers<double>{}, 3); }

TEST(Ball, HasCellsOfGoodShapeForAllCountsAndGrades) {
  for (const int along : {1, 2, 3, 4, 7, 12})
    for (const int layers : {1, 2, 5})
      for (const double grade : {0.1, 1.0, 30.0})
        for (const double inner : {0.0, 0.1, 7.0}) {
          const BallMesh of = ball(along, layers, inner, grade);
          const Mesh mesh = make_mesh(of, "H8", 3);
          const Points<double> points = points_of(of);
          EXPECT_GT(worst_corner_in_space(mesh, points), 0.55)  // as ball.hpp promises
              << along << " " << layers << " " << grade << " " << inner;
          EXPECT_FALSE(first_inverted_element(make_mesh(of, "T4", 3), points)) << along << " " << layers;
        }
}

TEST(Ball, FitsTogetherAndFacesOutward) {
  for (const char* element : {"H8", "T4"})
    for (const double inner : {0.0, 3.0})
      for (const int along : {1, 4, 5}) {
        const BallMesh of = ball(along, 3, inner);
        const Mesh mesh = make_mesh(of, element, 3);
        const Points<double> points = points_of(of);
        EXPECT_EQ(points.cols(), mesh.node_count);
        EXPECT_EQ(mesh.element_count(), of.cell_count() * (mesh.shape == ElementShape::tet4 ? 6 : 1));
        const Side boundary = boundary_of(mesh);
        std::size_t named = 0;
        for (const auto& [name, side] : mesh.sides) {
          named += side.facets.size();
          // Euler: a sphere of faces that fit together, V - E + F = 2
          std::set<std::pair<int, int>> edges;
          for (const auto& facet : side.facets)
            for (std::size_t k = 0; k < facet.size(); ++k)
              edges.insert(std::minmax(facet[k], facet[(k + 1) % facet.size()]));
          EXPECT_EQ(side.nodes.size() + side.facets.size(), edges.size() + 2) << name;
          for (const auto& facet : side.facets)
            EXPECT_GT(
                (name == "surface" ? 1 : -1) * vector_area(points, {{}, {facet}}).dot(points.col(facet[0]) - middle),
                0);
          for (const int node : side.nodes)  // a few roundings of numbers up to 16
            EXPECT_NEAR((points.col(node) - middle).norm(), name == "surface" ? 8 : inner, 8 * 8 * eps);
        }
        EXPECT_EQ(named, boundary.facets.size());
        EXPECT_EQ(mesh.sides.count("inner"), inner > 0 ? 1u : 0u);
      }
}

TEST(Ball, ConvergesToItsVolumeAndItsAreaWithTheSquareOfTheCells) {
  for (const char* element : {"H8", "T4"})
    for (const double inner : {0.0, 4.0}) {
      std::vector<double> volumes, areas;
      for (const int n : {4, 8, 16}) {
        const BallMesh of = ball(n, n / 2, inner);
        const Mesh mesh = make_mesh(of, element, 3);
        const Points<double> points = points_of(of);
        volumes.push_back(1 - volume(mesh, points) / (4 * pi / 3 * (512 - std::pow(inner, 3))));
        areas.push_back(1 - area(points, mesh.sides.at("surface")) / (4 * pi * 64));
      }
      for (const auto& error : {volumes, areas}) {
        EXPECT_LT(std::abs(error[2]), 0.02) << element;
        EXPECT_NEAR(std::log2(error[1] / error[2]), 2, 0.1) << element << inner;
      }
    }
}

TEST(Ball, HasMiddlesOnItsSpheres) {
  for (const char* element : {"T10", "H20", "H27"})
    for (const double inner : {0.0, 4.0}) {
      const BallMesh of = ball(4, 2, inner);
      const Mesh mesh = make_mesh(of, element, 3);
      const Points<double> points = make_points(of, mesh, Numbers<double>{});
      EXPECT_EQ(first_inverted_element(mesh, points).value_or(-1), -1) << element << ", " << inner;
      for (const auto& [name, side] : mesh.sides)
        for (const int node : side.nodes)
          EXPECT_NEAR((points.col(node) - middle).norm(), name == "surface" ? 8 : inner, 8 * 8 * eps) << element;
    }
}

TEST(Ball, HasExactDerivatives) {
  BallMesh of = ball(3, 4, 0, 2.5);
  of.center = {Number(0.3, 0), Number(-0.2, 1), Number(8.1, 2)};
  of.radius = Number(8, 3);
  of.grade = Number(2.5, 4);
  expect_exact_derivatives(of, "H27", 3, {0.3, -0.2, 8.1, 8, 2.5});
  of.inner = Number(3, 5);
  expect_exact_derivatives(of, "H27", 3, {0.3, -0.2, 8.1, 8, 2.5, 3});
}

TEST(Ball, ThatMakesNoMeshIsRefusedWithAReason) {
  const auto expect_fault = [](const BallMesh& of, const char* element, int dimension, const char* part) {
    EXPECT_NE(mesh_fault(of, element, dimension).find(part), std::string::npos) << mesh_fault(of, element, dimension);
  };
  expect_fault(ball(4, 4), "", 2, "needs the space solid");
  expect_fault(ball(4, 4), "Q4", 3, "not Q4");
  expect_fault(ball(0, 4), "", 3, "at least 1");
  expect_fault(ball(4, 4, 8), "", 3, "less than radius");
  expect_fault(ball(4, 4, 0, 0), "", 3, "grade must be greater than 0");
}

}  // namespace
}  // namespace stickslip::ball_test
