#include "core/mesh/generators.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>
#include <stdexcept>

#include "core/mesh/quality.hpp"
#include "tests/support/largest.hpp"
#include "tests/support/mesh_derivatives.hpp"

namespace stickslip::generators_test {
namespace {

constexpr double eps = std::numeric_limits<double>::epsilon();

/// Area of all elements of a plane mesh.
double area(const Mesh& mesh, const Points<double>& points) {
  const int count = nodes_of(mesh.shape);
  double sum = 0;
  for (int e = 0; e < mesh.element_count(); ++e)
    for (int k = 0; k < count; ++k) {
      const int a = mesh.connectivity[e * count + k], b = mesh.connectivity[e * count + (k + 1) % count];
      sum += (points(0, a) * points(1, b) - points(0, b) * points(1, a)) / 2;
    }
  return sum;
}

/// Area the facets of these sides enclose, by the divergence theorem: positive if the solid lies on their left.
double enclosed(const Mesh& mesh, const Points<double>& points) {
  double sum = 0;
  for (const auto& [name, side] : mesh.sides)
    for (const auto& facet : side.facets)
      sum += (points(0, facet[0]) * points(1, facet[1]) - points(0, facet[1]) * points(1, facet[0])) / 2;
  return sum;
}

/// Least sine over the corners of all elements.
double worst_corner(const Mesh& mesh, const Points<double>& points) {
  const int count = nodes_of(mesh.shape);
  double worst = 1;
  for (int e = 0; e < mesh.element_count(); ++e)
    for (int k = 0; k < count; ++k) {
      auto at = [&](int i) -> Vec<double, 2> { return points.col(mesh.connectivity[e * count + (k + i) % count]); };
      const Vec<double, 2> out = (at(1) - at(0)).normalized(), back = (at(count - 1) - at(0)).normalized();
      worst = smaller(worst, out[0] * back[1] - out[1] * back[0]);
    }
  return worst;
}

Points<double> points_of(const MeshDescription& description, int dimension = 2) {
  return make_points(description, Numbers<double>{}, dimension);
}

BoxMesh box() {
  BoxMesh mesh;
  mesh.min = {1.0, -0.5};
  mesh.max = {4.3, 1.7};
  mesh.cells = {5, 4};
  return mesh;
}

HalfDiskMesh half_disk(int along, int inwards, double grade, HalfDiskMesh::Facing facing = HalfDiskMesh::Facing::down) {
  HalfDiskMesh mesh;
  mesh.center = {0.3, 8.1};
  mesh.radius = 8.0;
  mesh.cells = {along, inwards};
  mesh.grade = grade;
  mesh.facing = facing;
  return mesh;
}

/// Every edge of an element that no other element has is a facet of exactly one side.
void expect_sides_cover_boundary(const Mesh& mesh) {
  std::multiset<std::pair<int, int>> edges, facets;
  const int count = nodes_of(mesh.shape);
  for (int e = 0; e < mesh.element_count(); ++e)
    for (int k = 0; k < count; ++k)
      edges.insert({mesh.connectivity[e * count + k], mesh.connectivity[e * count + (k + 1) % count]});
  std::multiset<std::pair<int, int>> boundary;
  for (const auto& [a, b] : edges)
    if (!edges.count({b, a})) boundary.insert({a, b});
  for (const auto& [name, side] : mesh.sides)
    for (const auto& facet : side.facets) facets.insert({facet[0], facet[1]});
  EXPECT_EQ(facets, boundary);
}

TEST(Box, HasItsAreaItsBoundaryAndItsCornersForBothElements) {
  for (const char* element : {"Q4", "T3", ""}) {
    const Mesh mesh = make_mesh(box(), element, 2);
    const Points<double> points = points_of(box());
    EXPECT_EQ(mesh.node_count, 30);
    EXPECT_EQ(mesh.element_count(), mesh.shape == ElementShape::tri3 ? 40 : 20);
    EXPECT_EQ(points.cols(), mesh.node_count);
    // sums of some hundred products of coordinates below 5
    EXPECT_NEAR(area(mesh, points), 3.3 * 2.2, 1000 * eps);
    EXPECT_NEAR(enclosed(mesh, points), 3.3 * 2.2, 1000 * eps);
    EXPECT_FALSE(first_inverted_element(mesh, points));
    expect_sides_cover_boundary(mesh);
    const Vec<double, 2> low(1.0, -0.5), high(4.3, 1.7);  // exactly as given
    for (int i = 0; i < 2; ++i) {
      EXPECT_EQ(points.row(i).minCoeff<Eigen::PropagateNaN>(), low[i]);
      EXPECT_EQ(points.row(i).maxCoeff<Eigen::PropagateNaN>(), high[i]);
    }
  }
}

TEST(Box, GrowsGeometricallyAwayFromTheNamedSideByTheGivenRatio) {
  for (const char* towards : {"left", "right", "bottom", "top"}) {
    BoxMesh mesh = box();
    mesh.grade = {{towards, 8.0}};
    mesh.cells = {4, 4};
    const Points<double> points = points_of(mesh);
    const bool along_x = std::string(towards) == "left" || std::string(towards) == "right";
    std::vector<double> steps;
    for (int i = 0; i < 4; ++i)
      steps.push_back(along_x ? points(0, i + 1) - points(0, i) : points(1, 5 * (i + 1)) - points(1, 5 * i));
    if (std::string(towards) == "right" || std::string(towards) == "top") std::reverse(steps.begin(), steps.end());
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(steps[i + 1] / steps[i], 2.0, 100 * eps);  // cube root of 8
    EXPECT_NEAR(points(along_x ? 1 : 0, along_x ? 5 : 1) - points(along_x ? 1 : 0, 0), (along_x ? 2.2 : 3.3) / 4,
                10 * eps);
  }
}

TEST(Box, OfTrianglesHasNoTriangleWithTwoEdgesOnTheBoundary) {
  for (int nx : {2, 3, 4, 5})
    for (int ny : {2, 3, 6}) {
      BoxMesh description = box();
      description.cells = {nx, ny};
      const Mesh mesh = make_mesh(description, "T3", 2);
      std::map<int, int> boundary_edges;
      std::set<std::vector<int>> facets;
      for (const auto& [name, side] : mesh.sides) facets.insert(side.facets.begin(), side.facets.end());
      for (int e = 0; e < mesh.element_count(); ++e)
        for (int k = 0; k < 3; ++k)
          boundary_edges[e] += facets.count({mesh.connectivity[3 * e + k], mesh.connectivity[3 * e + (k + 1) % 3]});
      for (const auto& [element, edges] : boundary_edges) EXPECT_LT(edges, 2) << nx << " x " << ny;
    }
}

TEST(HalfDisk, HasUsableElementsForAnyCountsAndGradesItAccepts) {
  for (int along = 2; along <= 24; along += along < 8 ? 1 : 8)
    for (int inwards = (along + 1) / 2; inwards <= 2 * along; ++inwards)
      for (double grade : {1.0, 3.0, 10.0, 30.0, 100.0}) {
        if (inwards < 2) continue;
        const HalfDiskMesh disk = half_disk(along, inwards, grade);
        for (const char* element : {"Q4", "T3"}) {
          const Mesh mesh = make_mesh(disk, element, 2);
          EXPECT_FALSE(first_inverted_element(mesh, points_of(disk))) << along << " " << inwards << " " << grade;
        }
        const double worst = worst_corner(make_mesh(disk, "Q4", 2), points_of(disk));
        // the qualities half_disk.hpp promises
        const double promised = along == inwards ? 0.6 : std::min(along, inwards) > 2 ? 0.3 : 0.08;
        EXPECT_GT(worst, promised) << along << " " << inwards << " " << grade;
      }
}

TEST(HalfDisk, HasTheAreaOfThePolygonOfItsArc) {
  const HalfDiskMesh disk = half_disk(9, 8, 20);
  const Mesh mesh = make_mesh(disk, "Q4", 2);
  const Points<double> points = points_of(disk);
  const std::vector<int>& arc = mesh.sides.at("arc").nodes;
  double polygon = 0;  // triangles from the centre
  for (std::size_t i = 1; i < arc.size(); ++i) {
    const Vec<double, 2> center(0.3, 8.1), a = points.col(arc[i - 1]) - center, b = points.col(arc[i]) - center;
    polygon += (a[0] * b[1] - a[1] * b[0]) / 2;
  }
  EXPECT_NEAR(area(mesh, points), polygon, 1e4 * eps * polygon);  // sums of some thousand products
  EXPECT_NEAR(enclosed(mesh, points), polygon, 1e4 * eps * polygon);
  EXPECT_GT(polygon, 0.97 * std::acos(-1.0) * 64 / 2);
  expect_sides_cover_boundary(mesh);
}

TEST(HalfDisk, HasItsArcOnTheCircleInGeometricStepsFromThePole) {
  const HalfDiskMesh disk = half_disk(12, 10, 50);
  const Mesh mesh = make_mesh(disk, "Q4", 2);
  const Points<double> points = points_of(disk);
  const std::vector<int>& arc = mesh.sides.at("arc").nodes;
  ASSERT_EQ(arc.size(), 25u);
  const Vec<double, 2> center(0.3, 8.1);
  std::vector<double> angle;  // from the pole
  for (int node : arc) {
    const Vec<double, 2> r = points.col(node) - center;
    EXPECT_NEAR(r.norm(), 8.0, 8 * 8 * eps);  // a few roundings of numbers up to 16
    angle.push_back(std::atan2(r[0], -r[1]));
  }
  EXPECT_EQ(points(0, arc[12]), 0.3);
  const double factor = std::pow(50.0, 1.0 / 11);
  for (int i = 12; i + 2 < 25; ++i)  // the least step, 0.007 of the radius, has lost three digits
    EXPECT_NEAR((angle[i + 2] - angle[i + 1]) / (angle[i + 1] - angle[i]), factor, 1e4 * eps);
  EXPECT_NEAR((angle[24] - angle[23]) / (angle[13] - angle[12]), 50, 50 * 1e4 * eps);
}

TEST(HalfDisk, FacingUpMirrorsTheOneFacingDownNodeByNode) {
  HalfDiskMesh down = half_disk(8, 7, 10), up = half_disk(8, 7, 10, HalfDiskMesh::Facing::up);
  down.center = {0.0, 8.0};
  up.center = {0.0, -8.0};
  const Points<double> a = points_of(down), b = points_of(up);
  EXPECT_EQ(a.row(0), b.row(0));
  EXPECT_EQ(a.row(1), -b.row(1));
  for (const char* element : {"Q4", "T3"}) {
    const Mesh upper = make_mesh(down, element, 2), lower = make_mesh(up, element, 2);
    EXPECT_FALSE(first_inverted_element(lower, b));
    EXPECT_GT(enclosed(lower, b), 0);
    std::vector<int> arc = lower.sides.at("arc").nodes;
    std::reverse(arc.begin(), arc.end());
    EXPECT_EQ(upper.sides.at("arc").nodes, arc);
    EXPECT_EQ(upper.connectivity.size(), lower.connectivity.size());
  }
}

TEST(Chain, HasItsSidesAndItsNodesInTwoAndThreeDimensions) {
  LineMesh line;
  line.from = {0.0, 1.0, 2.0};
  line.to = {3.0, 1.0, -1.0};
  line.cells = 3;
  const Mesh mesh = make_mesh(line, "bar", 3);
  EXPECT_EQ(mesh.dimension, 3);
  EXPECT_EQ(mesh.connectivity, (std::vector<int>{0, 1, 1, 2, 2, 3}));
  EXPECT_EQ(mesh.sides.at("start").nodes, std::vector<int>{0});
  EXPECT_EQ(mesh.sides.at("end").nodes, std::vector<int>{3});
  EXPECT_EQ(mesh.sides.at("interior").nodes, (std::vector<int>{1, 2}));
  EXPECT_EQ(mesh.sides.at("interior").facets.size(), 3u);  // each interior node keeps both its bars
  EXPECT_EQ(mesh.sides.at("nodes").nodes.size(), 4u);
  const Points<double> points = points_of(line, 3);
  EXPECT_EQ(points.col(3), (Vec<double, 3>(3, 1, -1)));
  EXPECT_NEAR(points(0, 1), 1.0, 4 * eps);  // a product and a sum of numbers near 1
}

TEST(Chain, OnAnArcLiesAtEqualAnglesInDegrees) {
  ArcMesh arc;
  arc.center = {1.0, 2.0};
  arc.radius = 2.0;
  arc.from_angle = 0.0;
  arc.to_angle = 90.0;
  arc.cells = 3;
  for (int dimension : {2, 3}) {
    const Points<double> points = points_of(arc, dimension);
    EXPECT_NEAR(points(0, 1), 1 + 2 * std::cos(std::acos(-1.0) / 6), 16 * eps);  // a few roundings of numbers near 4
    EXPECT_NEAR(points(1, 3), 4, 16 * eps);
    if (dimension == 3) {
      EXPECT_EQ(points(2, 2), 0);
    }
  }
}

TEST(Point, IsANodeAndItsAnchorAtTheSamePlace) {
  PointMesh point;
  point.at = {0.5, -1.0};
  const Mesh mesh = make_mesh(point, "", 2);
  EXPECT_EQ(mesh.node_count, 2);
  EXPECT_EQ(mesh.element_count(), 1);
  EXPECT_EQ(mesh.sides.at("node").nodes, std::vector<int>{0});
  EXPECT_EQ(mesh.sides.at("anchor").nodes, std::vector<int>{1});
  const Points<double> points = points_of(point);
  EXPECT_EQ(points.col(0), (Vec<double, 2>(0.5, -1.0)));
  EXPECT_EQ(points.col(1), points.col(0));
}

/// With middles, which move too, where there are any.
void expect_exact_derivatives(const MeshDescription& description, const std::vector<double>& numbers) {
  const bool fills = filling_of(description) == Filling::continuum;
  stickslip::expect_exact_derivatives(description, fills ? "Q8" : "", 2, numbers);
}

TEST(Coordinates, OfABoxHaveExactDerivatives) {
  BoxMesh mesh;
  mesh.min = {Number(1, 0), Number(2, 1)};
  mesh.max = {Number(3, 2), Number(5, 3)};
  mesh.cells = {3, 4};
  for (const char* towards : {"right", "bottom"})
    for (double grade : {1.0, 5.0}) {  // 1: where a formula with (ratio - 1) below the line would fail
      mesh.grade = {{towards, Number(grade, 4)}};
      expect_exact_derivatives(mesh, {1, 2, 3, 5, grade});
    }
  mesh.grade = {{"top", Number(3, 5)}, {"left", Number(4, 4)}};
  expect_exact_derivatives(mesh, {1, 2, 3, 5, 4, 3});
}

TEST(Coordinates, OfAHalfDiskHaveExactDerivatives) {
  for (const auto facing : {HalfDiskMesh::Facing::down, HalfDiskMesh::Facing::up})
    for (double grade : {1.0, 40.0}) {
      HalfDiskMesh mesh = half_disk(6, 5, grade, facing);
      mesh.center = {Number(0.3, 0), Number(8.1, 1)};
      mesh.radius = Number(8, 2);
      mesh.grade = Number(grade, 3);
      expect_exact_derivatives(mesh, {0.3, 8.1, 8, grade});
    }
}

TEST(Coordinates, OfChainsAndPointsHaveExactDerivatives) {
  LineMesh line;
  line.from = {Number(0, 0), Number(1, 1)};
  line.to = {Number(4, 2), Number(3, 3)};
  line.cells = 3;
  expect_exact_derivatives(line, {0, 1, 4, 3});
  ArcMesh arc;
  arc.center = {Number(1, 0), Number(2, 1)};
  arc.radius = Number(3, 2);
  arc.from_angle = Number(-20, 3);
  arc.to_angle = Number(130, 4);
  arc.cells = 5;
  expect_exact_derivatives(arc, {1, 2, 3, -20, 130});
  PointMesh point;
  point.at = {Number(1, 0), Number(2, 1)};
  expect_exact_derivatives(point, {1, 2});
}

QuadMesh quad(int along, int up) {
  QuadMesh mesh;
  mesh.corners = {{{0.1, -0.2}, {3.0, 0.3}, {2.5, 2.0}, {-0.4, 1.5}}};
  mesh.cells = {along, up};
  return mesh;
}

RingMesh ring(int radial, int around, double from = 0, double to = 360) {
  RingMesh mesh;
  mesh.center = {0.3, -0.7};
  mesh.inner = 1.0;
  mesh.outer = 2.5;
  mesh.cells = {radial, around};
  mesh.from_angle = from;
  mesh.to_angle = to;
  return mesh;
}

DiskMesh disk(int along, int rings, double grade = 1) {
  DiskMesh mesh;
  mesh.center = {0.3, -0.7};
  mesh.radius = 2.5;
  mesh.cells = {along, rings};
  mesh.grade = grade;
  return mesh;
}

TEST(Quad, IsABoxWhereItsCornersAre) {
  QuadMesh same = quad(5, 4);
  same.corners = {{{1.0, -0.5}, {4.3, -0.5}, {4.3, 1.7}, {1.0, 1.7}}};
  for (const char* towards : {"", "left", "top"}) {
    BoxMesh reference = box();
    if (*towards) reference.grade = same.grade = {{towards, 3.0}};
    // the two weigh the corners by products of different order
    EXPECT_LE(largest_entry(points_of(same) - points_of(reference)), 8 * eps * 4.3);
  }
  const Mesh mesh = make_mesh(same, "Q4", 2), reference = make_mesh(box(), "Q4", 2);
  EXPECT_EQ(mesh.connectivity, reference.connectivity);
  for (const auto& [name, side] : reference.sides) EXPECT_EQ(mesh.sides.at(name).facets, side.facets);
}

TEST(Quad, HasItsAreaItsCornersAndStraightSides) {
  const QuadMesh description = quad(4, 3);
  const Mesh mesh = make_mesh(description, "Q4", 2);
  const Points<double> points = points_of(description);
  double polygon = 0;
  for (int k = 0; k < 4; ++k) {
    const auto &a = description.corners[k], &b = description.corners[(k + 1) % 4];
    polygon += (a[0].value * b[1].value - b[0].value * a[1].value) / 2;
  }
  EXPECT_NEAR(area(mesh, points), polygon, 1000 * eps);
  EXPECT_NEAR(enclosed(mesh, points), polygon, 1000 * eps);
  expect_sides_cover_boundary(mesh);
  const char* from[] = {"bottom", "right", "top", "left"};
  for (int k = 0; k < 4; ++k) {
    const int node = mesh.sides.at(from[k]).nodes.front();
    EXPECT_EQ(points(0, node), description.corners[k][0].value);
    EXPECT_EQ(points(1, node), description.corners[k][1].value);
  }
}

TEST(Ring, IsClosedWithoutDuplicateNodesWhereItSpansAFullTurn) {
  const Mesh mesh = make_mesh(ring(3, 10), "Q4", 2);
  const Points<double> points = points_of(ring(3, 10));
  EXPECT_EQ(mesh.node_count, 40);
  EXPECT_EQ(points.cols(), 40);
  EXPECT_EQ(mesh.element_count(), 30);
  EXPECT_EQ(mesh.sides.size(), 2u);
  for (const char* name : {"inner", "outer"}) {
    const Side& side = mesh.sides.at(name);
    EXPECT_EQ(std::set<int>(side.nodes.begin(), side.nodes.end()).size(), 10u);
    EXPECT_EQ(side.nodes.size(), 10u);
    EXPECT_EQ(side.facets.size(), 10u);
  }
  for (int a = 0; a < 40; ++a)
    for (int b = 0; b < a; ++b) EXPECT_GT((points.col(a) - points.col(b)).norm(), 0.1);
}

TEST(Ring, HasItsSidesOnItsCirclesAndTheAreaOfItsPolygonsOpenAndClosed) {
  for (double to : {360.0, 120.0})
    for (const char* element : {"Q4", "T3"}) {
      const RingMesh description = ring(3, 12, 0, to);
      const Mesh mesh = make_mesh(description, element, 2);
      const Points<double> points = points_of(description);
      const double step = to / 12 * std::acos(-1.0) / 180;
      const double polygons = 0.5 * 12 * std::sin(step) * (2.5 * 2.5 - 1);
      EXPECT_NEAR(area(mesh, points), polygons, 1000 * eps * polygons);
      EXPECT_NEAR(enclosed(mesh, points), polygons, 1000 * eps * polygons);
      expect_sides_cover_boundary(mesh);
      EXPECT_FALSE(first_inverted_element(mesh, points));
      for (const auto& [name, radius] : {std::pair{"inner", 1.0}, std::pair{"outer", 2.5}})
        for (int node : mesh.sides.at(name).nodes)
          EXPECT_NEAR((points.col(node) - Vec<double, 2>(0.3, -0.7)).norm(), radius, 8 * eps);
      if (to < 360) {
        for (int node : mesh.sides.at("start").nodes) EXPECT_EQ(points(1, node), -0.7);
        EXPECT_EQ(mesh.sides.at("end").nodes.size(), 4u);
      }
    }
}

TEST(Disk, HasItsArcOnTheCircleItsAreaAndCellsOfGoodShape) {
  for (int along = 1; along <= 8; ++along)
    for (int rings = 1; rings <= 8; ++rings)
      for (double grade : {1.0, 10.0})
        for (const char* element : {"Q4", "T3"}) {
          const DiskMesh description = disk(along, rings, grade);
          const Mesh mesh = make_mesh(description, element, 2);
          const Points<double> points = points_of(description);
          const double polygon = 0.5 * 4 * along * std::sin(std::acos(0.0) / along) * 2.5 * 2.5;
          EXPECT_NEAR(area(mesh, points), polygon, 1000 * eps * polygon) << along << " " << rings;
          EXPECT_NEAR(enclosed(mesh, points), polygon, 1000 * eps * polygon);
          expect_sides_cover_boundary(mesh);
          EXPECT_FALSE(first_inverted_element(mesh, points));
          EXPECT_EQ(mesh.sides.at("arc").nodes.size(), 4u * along);
          for (int node : mesh.sides.at("arc").nodes)
            EXPECT_NEAR((points.col(node) - Vec<double, 2>(0.3, -0.7)).norm(), 2.5, 8 * eps);
          if (mesh.shape == ElementShape::quad4) {
            EXPECT_GT(worst_corner(mesh, points), 0.5) << along << " " << rings << " " << grade;  // 30 degrees
          }
        }
}

/// Area of quadratic elements by Green's theorem over their curved edges (Simpson's rule is exact for a parabola).
double quadratic_area(const Mesh& mesh, const Points<double>& points) {
  const int count = nodes_of(mesh.shape), corners = corners_of(mesh.shape);
  double sum = 0;
  for (int e = 0; e < mesh.element_count(); ++e)
    for (int k = 0; k < corners; ++k) {
      const int* n = mesh.connectivity.data() + e * count;
      const Vec<double, 2> a = points.col(n[k]), b = points.col(n[(k + 1) % corners]), m = points.col(n[corners + k]);
      const Vec<double, 2> bow = m - 0.5 * (a + b), chord = b - a;
      sum += 0.5 * (a[0] * b[1] - b[0] * a[1]) - (chord[0] * bow[1] - chord[1] * bow[0]) * 2 / 3;
    }
  return sum;
}

TEST(QuadraticMeshes, HaveOneNodeInTheMiddleOfEachEdgeAndItsHalvesForFacets) {
  const std::vector<MeshDescription> all = {box(),      quad(3, 2),        ring(2, 8), ring(2, 8, 10, 100),
                                            disk(3, 2), half_disk(4, 5, 3)};
  for (const auto& description : all)
    for (const char* element : {"Q8", "T6"}) {
      const Mesh mesh = make_mesh(description, element, 2),
                 linear = make_mesh(description, element[0] == 'Q' ? "Q4" : "T3", 2);
      const Points<double> points = make_points(description, mesh, Numbers<double>{});
      EXPECT_EQ(points.cols(), mesh.node_count);
      EXPECT_EQ(mesh.element_count(), linear.element_count());
      EXPECT_FALSE(first_inverted_element(mesh, points));
      const int corners = corners_of(mesh.shape);
      std::set<int> used(mesh.connectivity.begin(), mesh.connectivity.end());
      EXPECT_EQ(static_cast<int>(used.size()), mesh.node_count);
      // Euler: nodes of a linear mesh, and one more for each edge
      const int holes = std::holds_alternative<RingMesh>(description) && !linear.sides.count("start") ? 1 : 0;
      EXPECT_EQ(mesh.node_count - linear.node_count, linear.node_count + linear.element_count() - 1 + holes);
      for (int e = 0; e < mesh.element_count(); ++e)
        for (int k = 0; k < corners; ++k) {
          const int* n = mesh.connectivity.data() + e * nodes_of(mesh.shape);
          const Vec<double, 2> a = points.col(n[k]), b = points.col(n[(k + 1) % corners]),
                               m = points.col(n[corners + k]);
          EXPECT_LT((m - 0.5 * (a + b)).norm(), 0.25 * (b - a).norm());
        }
      for (const auto& [name, side] : mesh.sides) {
        const Side& coarse = linear.sides.at(name);
        ASSERT_EQ(side.facets.size(), 2 * coarse.facets.size());
        ASSERT_EQ(side.quadratic.size(), coarse.facets.size());
        EXPECT_EQ(side.nodes.size(), coarse.nodes.size() + coarse.facets.size());
        for (std::size_t f = 0; f < coarse.facets.size(); ++f) {
          const int a = coarse.facets[f][0], b = coarse.facets[f][1], m = side.quadratic[f][2];
          EXPECT_EQ(side.quadratic[f], (std::vector<int>{a, b, m}));
          EXPECT_EQ(side.facets[2 * f], (std::vector<int>{a, m}));
          EXPECT_EQ(side.facets[2 * f + 1], (std::vector<int>{m, b}));
        }
      }
    }
}

TEST(QuadraticMeshes, FollowTheirCirclesToFourthOrder) {
  const double pi = std::acos(-1.0);
  auto order = [](auto&& relative_error) { return std::log2(relative_error(1) / relative_error(2)); };
  auto error = [&](const MeshDescription& description, const char* element, double exact) {
    const Mesh mesh = make_mesh(description, element, 2);
    return std::abs(quadratic_area(mesh, make_points(description, mesh, Numbers<double>{})) / exact - 1);
  };
  for (const char* element : {"Q8", "T6"}) {
    EXPECT_NEAR(order([&](int k) { return error(disk(2 * k, k), element, pi * 2.5 * 2.5); }), 4, 0.2);
    EXPECT_NEAR(order([&](int k) { return error(ring(k, 8 * k), element, pi * (2.5 * 2.5 - 1)); }), 4, 0.2);
    EXPECT_NEAR(order([&](int k) { return error(half_disk(2 * k, 2 * k, 1), element, pi * 64 / 2); }), 4, 0.2);
  }
}

TEST(QuadraticMeshes, OfARingHaveTheMiddlesOfItsArcsOnTheirOwnCircles) {
  const RingMesh description = ring(3, 8, 10, 100);
  const Mesh mesh = make_mesh(description, "Q8", 2);
  const Points<double> points = make_points<double>(description, mesh, Numbers<double>{});
  int around = 0;
  for (std::size_t k = 0; k < mesh.middles.size(); ++k) {
    auto radius = [&](int node) { return (points.col(node) - Vec<double, 2>(0.3, -0.7)).norm(); };
    const auto [a, b] = mesh.middles[k];
    const int middle = mesh.node_count - static_cast<int>(mesh.middles.size() - k);
    EXPECT_NEAR(radius(middle), 0.5 * (radius(a) + radius(b)), 16 * eps);  // along a ray, or on the circle
    around += std::abs(radius(a) - radius(b)) < 0.1;
  }
  EXPECT_EQ(around, 8 * 4);
}

TEST(Coordinates, OfQuadsRingsAndDisksHaveExactDerivatives) {
  QuadMesh q = quad(3, 4);
  std::vector<double> numbers;
  for (auto& corner : q.corners)
    for (auto& x : corner) {
      x.slot = static_cast<int>(numbers.size());
      numbers.push_back(x.value);
    }
  q.grade = {{"top", Number(2.5, 8)}};
  numbers.push_back(2.5);
  expect_exact_derivatives(q, numbers);
  for (const char* towards : {"inner", "outer"}) {
    RingMesh open = ring(3, 7, 20, 130);
    open.center = {Number(0.3, 0), Number(-0.7, 1)};
    open.inner = Number(1, 2);
    open.outer = Number(2.5, 3);
    open.from_angle = Number(20, 4);
    open.to_angle = Number(130, 5);
    open.grade = {{towards, Number(3, 6)}};
    expect_exact_derivatives(open, {0.3, -0.7, 1, 2.5, 20, 130, 3});
    RingMesh closed = open;
    closed.from_angle = Number(20, 4);
    closed.to_angle = 380.0;
    closed.grade[0].ratio.slot = 5;
    expect_exact_derivatives(closed, {0.3, -0.7, 1, 2.5, 20, 3});
  }
  DiskMesh d = disk(3, 2);
  d.center = {Number(0.3, 0), Number(-0.7, 1)};
  d.radius = Number(2.5, 2);
  d.grade = Number(1, 3);
  expect_exact_derivatives(d, {0.3, -0.7, 2.5, 1});
}

TEST(Descriptions, ThatMakeNoMeshAreRefusedWithAReason) {
  auto expect_fault = [](const MeshDescription& description, const char* element, int dimension, const char* part) {
    EXPECT_NE(mesh_fault(description, element, dimension).find(part), std::string::npos)
        << mesh_fault(description, element, dimension);
    EXPECT_THROW(make_mesh(description, element, dimension), std::invalid_argument);
  };
  expect_fault(box(), "bar", 2, "T3 or T6, not bar");
  expect_fault(box(), "Q4", 3, "one number an axis, 3");
  BoxMesh bad = box();
  bad.max[1] = -0.5;
  expect_fault(bad, "Q4", 2, "greater than min");
  bad = box();
  bad.cells = {0, 1};
  expect_fault(bad, "Q4", 2, "at least 1");
  bad = box();
  bad.grade = {{"north", 2.0}};
  expect_fault(bad, "Q4", 2, "not north");
  bad.grade = {{"left", 2.0}, {"top", 2.0}, {"right", 2.0}};
  expect_fault(bad, "Q4", 2, "left or right, not both");
  expect_fault(half_disk(4, 9, 1), "Q4", 2, "factor 2");
  expect_fault(half_disk(4, 4, 0), "Q4", 2, "grade");
  expect_fault(ring(2, 8, 0, 400), "Q4", 2, "360 degrees at most");
  expect_fault(ring(2, 8, 90, 10), "Q4", 2, "exceed");
  expect_fault(ring(2, 2), "Q4", 2, "less than 180");
  expect_fault(ring(0, 8), "Q4", 2, "at least 1");
  RingMesh thin = ring(2, 8);
  thin.outer = 1.0;
  expect_fault(thin, "Q4", 2, "greater than inner");
  thin = ring(2, 8);
  thin.grade = {{"left", 2.0}};
  expect_fault(thin, "Q4", 2, "inner or outer, not left");
  expect_fault(disk(0, 1), "Q4", 2, "at least 1");
  expect_fault(disk(2, 2, -1), "Q4", 2, "grade");
  QuadMesh turned = quad(2, 2);
  std::swap(turned.corners[1], turned.corners[3]);
  expect_fault(turned, "Q4", 2, "counter-clockwise");
  LineMesh line;
  line.from = line.to = {1.0, 1.0};
  expect_fault(line, "bar", 2, "same point");
  expect_fault(line, "bar", 3, "2 coordinates");
  PointMesh point;
  point.at = {1.0};
  expect_fault(point, "", 2, "1 coordinates");
}

TEST(InvertedElements, AreFoundWhetherFlatTurnedOrOfNoLength) {
  const Mesh mesh = make_mesh(box(), "Q4", 2);
  Points<double> points = points_of(box());
  points.col(7) = points.col(9);  // beyond node 8: element 0 is only stretched, element 1 folds
  EXPECT_EQ(first_inverted_element(mesh, points), 1);
  Points<double> far = points_of(box()).array() + 1e17;  // all coordinates round to the same number
  EXPECT_EQ(first_inverted_element(mesh, far), 0);
  points = points_of(box()).rowwise().reverse();
  points.row(0).swap(points.row(1));
  EXPECT_EQ(first_inverted_element(mesh, points), 0);
  points = points_of(box());
  points(0, 29) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(first_inverted_element(mesh, points), 19);
  LineMesh line;
  line.from = {0.0, 0.0};
  line.to = {1.0, 0.0};
  line.cells = 2;
  Points<double> chain = points_of(line);
  EXPECT_FALSE(first_inverted_element(make_mesh(line, "bar", 2), chain));
  chain.col(2) = chain.col(1);
  EXPECT_EQ(first_inverted_element(make_mesh(line, "bar", 2), chain), 1);
}

}  // namespace
}  // namespace stickslip::generators_test
