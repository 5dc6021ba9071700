/// Uniform splitting of imported meshes.
#include "core/mesh/split.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <set>

#include "core/mesh/generators.hpp"
#include "core/mesh/middles.hpp"
#include "core/mesh/msh_reader.hpp"

namespace stickslip::split_test {
namespace {

ImportedMesh imported_box(const BoxMesh& box, const std::string& element) {
  const Mesh mesh = make_mesh(box, element, 2);
  return {"", "box", mesh, with_middles(mesh, make_points<double>(box, {}, 2))};
}

/// A sector of a ring of an element, as an imported mesh. Its sides are curved where elements are quadratic: their
/// middles are moved onto the circles.
ImportedMesh sector(const std::string& element) {
  BoxMesh box;
  box.min = {1.0, 0.0};
  box.max = {2.0, 1.0};
  box.cells = {2, 3};
  ImportedMesh imported = imported_box(box, element);
  for (Eigen::Index k = 0; k < imported.points.cols(); ++k) {
    const double r = imported.points(0, k), angle = imported.points(1, k);
    imported.points.col(k) << 100 + r * std::cos(angle), r * std::sin(angle);
  }
  return imported;
}

/// Area by the shape functions, exact for elements of the second order: the boundary integral of x dy over the edges,
/// each a parabola, of all sides of the body.
double area(const ImportedMesh& body) {
  double sum = 0;
  for (const auto& [name, side] : body.mesh.sides)
    for (const auto& edge : side.edges()) {
      const Vec<double, 2> a = body.points.col(edge[0]), b = body.points.col(edge[1]);
      const Vec<double, 2> m = edge.size() > 2 ? Vec<double, 2>(body.points.col(edge[2])) : Vec<double, 2>((a + b) / 2);
      const auto x = [&](double t) {
        return Vec<double, 2>((1 - t) * (1 - 2 * t) * a + t * (2 * t - 1) * b + 4 * t * (1 - t) * m);
      };
      for (const double t : {0.5 - std::sqrt(0.15), 0.5, 0.5 + std::sqrt(0.15)}) {  // exact up to the fifth order
        const Vec<double, 2> slope = (4 * t - 3) * a + (4 * t - 1) * b + (4 - 8 * t) * m;
        sum += (t == 0.5 ? 8.0 / 18 : 5.0 / 18) * (x(t)[0] - 100) * slope[1];
      }
    }
  return sum;
}

TEST(Split, KeepsTheRegionAndItsNodesAndHalvesEveryEdge) {
  for (const auto* element : {"T3", "Q4", "T6", "Q8"}) {
    const ImportedMesh coarse = sector(element), fine = split(coarse);
    ASSERT_EQ(coarse.points.cols(), coarse.mesh.node_count) << element;
    EXPECT_NEAR(area(coarse), 1.5 * 1, 0.05) << element;  // (4 - 1) / 2 times the angle of 1
    ASSERT_EQ(fine.mesh.element_count(), 4 * coarse.mesh.element_count()) << element;
    ASSERT_EQ(fine.points.cols(), fine.mesh.node_count) << element;
    EXPECT_EQ(fine.points.leftCols(coarse.mesh.node_count), coarse.points) << element;
    EXPECT_NEAR(area(fine), area(coarse), 1e-13) << element;  // of about 1.2, with x near 100
    // as many nodes as Euler's formula asks for: no node stands twice
    std::set<std::pair<int, int>> edges;
    std::set<int> corners;
    const int n = corners_of(fine.mesh.shape);
    for (int e = 0; e < fine.mesh.element_count(); ++e)
      for (int k = 0; k < n; ++k) {
        const int* node = fine.mesh.connectivity.data() + e * nodes_of(fine.mesh.shape);
        edges.insert(std::minmax(node[k], node[(k + 1) % n]));
        corners.insert(node[k]);
      }
    const auto count = static_cast<int>(corners.size() + (is_quadratic(fine.mesh.shape) ? edges.size() : 0));
    EXPECT_EQ(fine.mesh.node_count, count) << element;
    EXPECT_EQ(static_cast<int>(corners.size()) - static_cast<int>(edges.size()) + fine.mesh.element_count(), 1)
        << element;
    for (const auto& [name, side] : coarse.mesh.sides) {
      const Side& halved = fine.mesh.sides.at(name);
      EXPECT_EQ(halved.edges().size(), 2 * side.edges().size()) << element << name;
      EXPECT_EQ(halved.facets.size(), 2 * side.facets.size()) << element << name;
      EXPECT_EQ(halved.nodes.size(), 2 * side.nodes.size() - 1) << element << name;
    }
  }
}

/// The new nodes of quadratic elements lie where the shape functions of the old ones put them: a field of the second
/// order in the parameters is met, so a mesh whose nodes are on a map of the second order stays on it.
TEST(Split, OfQuadraticElementsFollowsAMapOfTheSecondOrder) {
  const auto map = [](double x, double y) { return Vec<double, 2>(x + 0.1 * y * y - 0.05 * x * y, y + 0.07 * x * x); };
  for (const auto* element : {"T6", "Q8"}) {
    BoxMesh box;
    box.min = {0.0, 0.0};
    box.max = {1.0, 1.0};
    box.cells = {1, 1};
    ImportedMesh flat = imported_box(box, element), curved = flat;
    for (Eigen::Index k = 0; k < flat.points.cols(); ++k)
      curved.points.col(k) = map(flat.points(0, k), flat.points(1, k));
    const auto fine_flat = split(split(flat)), fine = split(split(curved));
    for (Eigen::Index k = 0; k < fine.points.cols(); ++k)
      EXPECT_LT((fine.points.col(k) - map(fine_flat.points(0, k), fine_flat.points(1, k))).norm(), 1e-14)
          << element << k;
  }
}

TEST(Split, KeepsSidesOfAFileClosedAndInOrder) {
  std::ifstream file(STICKSLIP_SOURCE_DIR "/studies/meshes/half_disk_coarse.msh");
  const auto read = read_msh(file, "half_disk_coarse.msh");
  ASSERT_TRUE(read.errors.empty());
  const ImportedMesh fine = split(read.bodies.front());
  for (const auto& [name, side] : fine.mesh.sides)
    for (std::size_t k = 1; k < side.facets.size(); ++k) EXPECT_EQ(side.facets[k][0], side.facets[k - 1][1]) << name;
}

}  // namespace
}  // namespace stickslip::split_test
