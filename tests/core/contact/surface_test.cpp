/// Smooth surfaces in space: weights, continuity, the tensor products that they are on regular meshes, the search, and
/// derivatives of a foot against the complex step.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <bit>
#include <complex>
#include <numbers>
#include <random>
#include <set>

#include "core/contact/foot_in_space.hpp"
#include "core/contact/surface_search.hpp"
#include "core/model/contact_geometry.hpp"
#include "tests/support/largest.hpp"

namespace stickslip::surface_test {
namespace {

struct Net {
  Places<3> points;
  std::vector<std::vector<int>> faces;
};

/// Quadrilaterals over [0, nx] x [0, ny] at height(x, y), each cut into two triangles where `cut(i, j)`.
template <class Height, class Cut>
Net sheet(int nx, int ny, Height&& height, Cut&& cut) {
  Net net{Places<3>(3, (nx + 1) * (ny + 1)), {}};
  const auto id = [&](int i, int j) { return j * (nx + 1) + i; };
  for (int j = 0; j <= ny; ++j)
    for (int i = 0; i <= nx; ++i) net.points.col(id(i, j)) << i, j, height(i, j);
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const std::array q{id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)};
      if (!cut(i, j)) {
        net.faces.push_back({q.begin(), q.end()});
      } else if ((i + j) % 2 == 0) {
        net.faces.insert(net.faces.end(), {{q[0], q[1], q[2]}, {q[0], q[2], q[3]}});
      } else {
        net.faces.insert(net.faces.end(), {{q[0], q[1], q[3]}, {q[1], q[2], q[3]}});
      }
    }
  return net;
}

/// A mixed sheet with nodes of 3 to 8 faces, its nodes moved at random.
Net crumpled() {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> by(-0.2, 0.2);
  Net net = sheet(
      6, 5, [](int, int) { return 0.0; }, [](int i, int j) { return (i * 7 + j * 5) % 3 != 0; });
  for (Eigen::Index v = 0; v < net.points.cols(); ++v)
    for (int k = 0; k < 3; ++k) net.points(k, v) += by(random);
  return net;
}

struct At {
  Vec<double, 3> y, normal;
};
At at(const Patch<3>& patch, const Places<3>& points, const Vec<double, 2>& place) {
  const PlaceWeights n = place_weights(patch, place);
  Eigen::Matrix<double, 3, 10> y = Eigen::Matrix<double, 3, 10>::Zero();
  for (std::size_t i = 0; i < patch.vertices.size(); ++i)
    y += points.col(patch.vertices[i]) * n.row(static_cast<Eigen::Index>(i));
  return {y.col(0), cross<double>(y.col(1), y.col(2)).normalized()};
}

constexpr std::array smooth_kinds{Smoothing::catmull_rom, Smoothing::b_spline};
constexpr double no_creases = 179;

TEST(Surface, WeightsSumToOneAndKeepAffineMaps) {
  const Net net = crumpled();
  for (const Smoothing kind : smooth_kinds)
    for (const auto& patch : make_surface<3>(net.faces, kind, no_creases, net.points))
      for (const Vec<double, 2>& place : {Vec<double, 2>(0.2, 0.3), Vec<double, 2>(0, 0), Vec<double, 2>(0.6, 0)}) {
        const auto sums = place_weights(patch, place).colwise().sum().eval();
        EXPECT_NEAR(sums[0], 1, 1e-14);  // (rounding of some twenty products)
        for (int k = 1; k < 6; ++k) EXPECT_NEAR(sums[k], 0, 1e-13) << k;
      }
}

/// Beyond its edges a patch goes on in its tangent planes there, on straight lines across them. So it is smooth there,
/// and folds nowhere.
TEST(Surface, GoesOnStraightBeyondItsEdges) {
  const Net net = crumpled();
  constexpr double h = 1e-5;
  // Of which column each column is a derivative, and by which coordinate.
  constexpr std::array<int, 10> of{0, 0, 0, 1, 1, 2, 3, 3, 4, 5}, by{0, 0, 1, 0, 1, 1, 0, 1, 1, 1};
  for (const Smoothing kind : smooth_kinds)
    for (const auto& patch : make_surface<3>(net.faces, kind, no_creases, net.points)) {
      for (const Vec<double, 2>& place : {Vec<double, 2>(-0.3, 0.4), Vec<double, 2>(0.2, -0.5),
                                          Vec<double, 2>(0.7, 0.9), Vec<double, 2>(-0.2, -0.1)}) {
        const PlaceWeights n = place_weights(patch, place);
        EXPECT_LE(largest_entry(curved_weights(patch, place) - n.leftCols<6>()), 1e-14);  // rounding
        for (int k = 1; k < 10; ++k) {
          const Vec<double, 2> step = h * Vec<double, 2>::Unit(by[k]);
          const Eigen::VectorXd difference =
              (place_weights(patch, place + step).col(of[k]) - place_weights(patch, place - step).col(of[k])) / (2 * h);
          EXPECT_LE(largest_entry(difference - n.col(k)), 1e-6) << k;  // h^2 times derivatives of some 1e3
        }
      }
      for (int edge = 0; edge < patch.corners; ++edge) {
        const Vec<double, 2> from = face_corner(patch.corners, edge), to = face_corner(patch.corners, edge + 1);
        const Vec<double, 2> on_edge = from + 0.3 * (to - from);
        const Vec<double, 2> across =
            on_edge - face_corner(patch.corners, edge + 2);  // of a triangle the straight line
        const Vec<double, 2> out = patch.corners == 3 ? across : Vec<double, 2>((to - from)[1], -(to - from)[0]);
        const auto weights = [&](double share) -> PlaceWeights { return place_weights(patch, on_edge + share * out); };
        const auto beside = [&](double share) { return at(patch, net.points, on_edge + share * out); };
        EXPECT_LE((beside(1e-9).y - beside(-1e-9).y).norm(), 1e-7) << edge;  // 2e-9 times some 10
        EXPECT_LE((beside(1e-9).normal - beside(-1e-9).normal).norm(), 1e-7) << edge;
        const Eigen::VectorXd bend = weights(0.5).col(0) - 2 * weights(0.3).col(0) + weights(0.1).col(0);
        EXPECT_LE(largest_entry(bend), 1e-13) << edge;  // rounding
        const Vec<double, 2> inside = on_edge - 0.004 * out, outside = on_edge + 0.005 * out;
        const Eigen::VectorXd moved = weights(0.005).col(0) - weights(-0.004).col(0);
        EXPECT_LE(largest_entry(weights_moved(patch, inside, outside) - moved), 1e-14);  // rounding
      }
    }
}

/// Beyond a node of the border two patches go on along one line, and leave no room between them.
TEST(Surface, GoesOnAlongOneLineBeyondANodeOfItsBorder) {
  const Net net = crumpled();
  std::set<int> counts;  // of faces at such a node
  for (const Smoothing kind : smooth_kinds) {
    const auto patches = make_surface<3>(net.faces, kind, no_creases, net.points);
    const auto is_end = [&](int p, int edge) { return patches[p].across[edge] == no_patch; };
    // The place beyond edge `edge` of patch p on the line from its beginning or its end.
    const auto beyond = [&](int p, int edge, bool from_end, double by) -> Vec<double, 3> {
      const Patch<3>& patch = patches[p];
      const int corner = from_end ? edge + 1 : edge, across = from_end ? corner + 1 : corner + patch.corners - 1;
      const Vec<double, 2> here = face_corner(patch.corners, corner),
                           way = here - Vec<double, 2>(face_corner(patch.corners, across));
      return at(patch, net.points, here + by * way).y;
    };
    for (int p = 0; p < static_cast<int>(patches.size()); ++p)
      for (int edge = 0; edge < patches[p].corners; ++edge) {
        if (!is_end(p, edge)) continue;
        int other = p, before = (edge + patches[p].corners - 1) % patches[p].corners, faces = 1;
        for (; !is_end(other, before); ++faces) {  // around the node, to the end that comes before
          const int next = patches[other].across[before];
          before = (patches[other].across_edge[before] + patches[next].corners - 1) % patches[next].corners;
          other = next;
        }
        counts.insert(faces);
        if (faces == 1) continue;  // it goes on along both edges
        for (const double by : {0.1, 0.5})
          EXPECT_LE((beyond(p, edge, false, by) - beyond(other, before, true, by)).norm(), 1e-14)
              << p << " " << other << ": " << faces << " faces";  // rounding
      }
  }
  EXPECT_TRUE(counts.count(2) && counts.count(3) && counts.count(4)) << "nodes of 2 to 4 faces";
}

TEST(Surface, NormalsAgreeAcrossEdgesWhereverTheNodesAre) {
  const Net net = crumpled();
  int edges = 0;
  for (const Smoothing kind : smooth_kinds) {
    const auto patches = make_surface<3>(net.faces, kind, no_creases, net.points);
    for (const auto& patch : patches)
      for (int k = 0; k < patch.corners; ++k) {
        if (!patch.goes_on(k)) continue;
        ++edges;
        const Patch<3>& other = patches[patch.across[k]];
        for (const double share : {0.0, 0.13, 0.5, 0.81, 1.0}) {
          const auto on = [&](const Patch<3>& of, int edge, double s) -> Vec<double, 2> {
            const Vec<double, 2> a = face_corner(of.corners, edge), b = face_corner(of.corners, edge + 1);
            return a + s * (b - a);
          };
          const At here = at(patch, net.points, on(patch, k, share)),
                   there = at(other, net.points, on(other, patch.across_edge[k], 1 - share));
          EXPECT_LE((here.y - there.y).norm(), 1e-13);  // of the length of an edge: rounding
          EXPECT_LE(here.normal.cross(there.normal).norm(), 1e-12);
          EXPECT_GT(here.normal.dot(there.normal), 0);
        }
      }
  }
  EXPECT_GE(edges, 100);
}

/// Four weights of uniform cubic splines at s.
std::array<double, 4> spline(Smoothing kind, double s) {
  const double r = 1 - s;
  if (kind == Smoothing::b_spline)
    return {r * r * r / 6, (4 - 6 * s * s + 3 * s * s * s) / 6, (1 + 3 * s + 3 * s * s - 3 * s * s * s) / 6,
            s * s * s / 6};
  return {-s * r * r / 2, (2 - 5 * s * s + 3 * s * s * s) / 2, (s + 4 * s * s - 3 * s * s * s) / 2, -s * s * r / 2};
}

TEST(Surface, OfRegularQuadrilateralsIsATensorProduct) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> by(-0.3, 0.3);
  Net net = sheet(
      3, 3, [](int, int) { return 0.0; }, [](int, int) { return false; });
  for (Eigen::Index v = 0; v < net.points.cols(); ++v)
    for (int k = 0; k < 3; ++k) net.points(k, v) += by(random);
  for (const Smoothing kind : smooth_kinds) {
    const auto patch = make_surface<3>(net.faces, kind, no_creases, net.points)[4];  // the one in the middle
    for (const auto& [s, t] : {std::pair(0.3, 0.7), std::pair(0.0, 0.0), std::pair(0.9, 0.05)}) {
      Vec<double, 3> expected = Vec<double, 3>::Zero();
      const auto a = spline(kind, s), b = spline(kind, t);
      for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i) expected += a[i] * b[j] * net.points.col(4 * j + i);
      EXPECT_LE((at(patch, net.points, {s, t}).y - expected).norm(), 1e-14) << s << t;  // rounding
    }
  }
}

TEST(Surface, KeepsPlanesAndSpheres) {
  // Flat nodes: flat. On a sphere of nodes an interpolating surface errs by the second order or better.
  std::array<double, 2> errors{};
  for (int fine : {0, 1}) {
    const int n = 10 << fine;
    const auto height = [&](int i, int j) {
      const double x = (i - n / 2.0) / n, y = (j - n / 2.0) / n;
      return n * std::sqrt(1 - x * x - y * y);
    };
    const Net net = sheet(n, n, height, [](int i, int j) { return (i + 2 * j) % 3 == 0; });
    const auto patches = make_surface<3>(net.faces, Smoothing::catmull_rom, no_creases, net.points);
    for (const auto& patch : patches) {
      const At middle = at(patch, net.points, {0.3, 0.3});
      const Vec<double, 3> from = middle.y - Vec<double, 3>(n / 2.0, n / 2.0, 0);
      if (from.head<2>().norm() > 0.3 * n) continue;  // (near its border a sheet has one-sided normals)
      errors[fine] = larger(errors[fine], std::abs(from.norm() / n - 1));
    }
    Net flat = sheet(
        n, n, [](int i, int j) { return 0.3 * i - 0.2 * j; }, [](int i, int) { return i % 2 == 0; });
    for (const Smoothing kind : smooth_kinds)
      for (const auto& patch : make_surface<3>(flat.faces, kind, no_creases, flat.points)) {
        const Vec<double, 3> y = at(patch, flat.points, {0.2, 0.6}).y;
        EXPECT_NEAR(y[2], 0.3 * y[0] - 0.2 * y[1], 1e-13);  // rounding
      }
  }
  EXPECT_GE(errors[0] / errors[1], 3.5);
}

TEST(Surface, HasCreasesWhereFacesTurn) {
  const Net roof = sheet(
      4, 4, [](int i, int) { return -std::abs(i - 2.0); }, [](int, int) { return false; });
  int creases = 0;
  for (const auto& patch : make_surface<3>(roof.faces, Smoothing::catmull_rom, 30, roof.points))
    for (int k = 0; k < 4; ++k) {
      const bool is_crease = patch.across[k] != no_patch && !patch.goes_on(k);
      creases += is_crease;
      if (is_crease) {
        EXPECT_NEAR(at(patch, roof.points, {k == 3 ? 0.0 : 1.0, 0.4}).y[0], 2, 1e-13);
      }
    }
  EXPECT_EQ(creases, 2 * 4);
}

TEST(Surface, IsSmoothAroundTheEndOfACrease) {
  // A ridge that begins inside of a flat sheet and grows towards its border.
  const Net ridge = sheet(
      4, 4, [](int i, int j) { return j == 2 && i > 2 ? 0.5 * (i - 2) : 0.0; }, [](int, int) { return false; });
  const auto patches = make_surface<3>(ridge.faces, Smoothing::catmull_rom, 20, ridge.points);
  int ending = 0;
  const int end = 2 * 5 + 2;
  std::vector<Vec<double, 3>> normals;
  for (const auto& patch : patches)
    for (int k = 0; k < 4; ++k) {
      if (patch.vertices[k] == end) normals.push_back(at(patch, ridge.points, face_corner(4, k)).normal);
      const bool is_crease = patch.across[k] != no_patch && !patch.goes_on(k);
      ending += is_crease && (patch.vertices[k] == end || patch.vertices[(k + 1) % 4] == end);
    }
  EXPECT_EQ(ending, 2);  // one edge, on both of its sides
  ASSERT_EQ(normals.size(), 4U);
  for (const auto& normal : normals) EXPECT_LE(normal.cross(normals[0]).norm(), 1e-13);  // rounding
}

/// Places all over a surface, 3 x places.
Eigen::Matrix3Xd samples(const Surface<3>& patches, const Places<3>& points) {
  std::vector<Vec<double, 3>> all;
  constexpr int n = 25;
  for (const auto& patch : patches)
    for (int i = 0; i <= n; ++i)
      for (int j = 0; j <= (patch.corners == 3 ? n - i : n); ++j)
        all.push_back(at(patch, points, {i / double(n), j / double(n)}).y);
  Eigen::Matrix3Xd places(3, static_cast<Eigen::Index>(all.size()));
  for (std::size_t k = 0; k < all.size(); ++k) places.col(static_cast<Eigen::Index>(k)) = all[k];
  return places;
}

TEST(SurfaceSearch, FindsTheNearestPlaceOfSmoothSurfaces) {
  const auto wave = [](int i, int j) { return 0.3 * std::sin(0.9 * i) * std::cos(0.7 * j); };
  const Net net = sheet(6, 6, wave, [](int i, int j) { return (i + j) % 3 == 0; });
  std::mt19937 random(11);
  std::uniform_real_distribution<double> along(0.7, 5.3), up(-0.4, 0.4);
  for (const Smoothing kind : smooth_kinds) {
    const auto patches = make_surface<3>(net.faces, kind, no_creases, net.points);
    const SurfaceSearch<3> search(patches, net.points);
    const Eigen::Matrix3Xd all = samples(patches, net.points);
    for (int n = 0; n < 200; ++n) {
      const Vec<double, 3> x(along(random), along(random), up(random));
      const Facing found = search.facing({x, {0, 0, -1}});
      ASSERT_NE(found.patch, no_patch);
      const auto& patch = patches[found.patch];
      for (int k = 0; k < patch.corners; ++k) EXPECT_LE(beyond_edge(patch, k, found.at), 1e-8);
      const At foot = at(patch, net.points, found.at);
      const Vec<double, 3> off = x - foot.y;
      EXPECT_LE(off.cross(foot.normal).norm(), 1e-8);  // it is a foot: the search ends at 1e-10 of a patch
      double nearest = (all.col(0) - x).norm();
      for (Eigen::Index k = 1; k < all.cols(); ++k) nearest = smaller(nearest, (all.col(k) - x).norm());
      EXPECT_LE(off.norm(), nearest + 1e-9);
    }
  }
}

TEST(SurfaceSearch, EndsAtBordersAndPassesCreasesContinuously) {
  const Net roof = sheet(
      4, 4, [](int i, int) { return -std::abs(i - 2.0); }, [](int, int) { return false; });
  for (const Smoothing kind : {Smoothing::none, Smoothing::catmull_rom, Smoothing::b_spline}) {
    const auto patches = make_surface<3>(roof.faces, kind, 30, roof.points);
    const SurfaceSearch<3> search(patches, roof.points);
    EXPECT_EQ(search.facing({{1.0, 4.2, 0.0}, {0, 0, -1}}).patch, no_patch);
    EXPECT_NEAR(search.facing({{1.0, 4.2, -1.0}, {0, 0, -1}}).distance, 0.2, 1e-12);
    double last = 0;
    for (int n = 0; n <= 100; ++n) {  // above the ridge, across it
      const Vec<double, 3> x(1.9 + 0.002 * n, 1.3, 0.2);
      const Facing found = search.facing({x, {0, 0, -1}});
      ASSERT_NE(found.patch, no_patch);
      const At foot = at(patches[found.patch], roof.points, found.at);
      const double gap = (x - foot.y).dot(foot.normal);
      EXPECT_NEAR(gap, (0.2 + std::abs(x[0] - 2)) / std::numbers::sqrt2, 1e-9);  // of the farther of the two planes
      if (n > 0) {
        EXPECT_LE(std::abs(gap - last), 0.002);
      }
      last = gap;
    }
  }
}

TEST(SurfaceSearch, EndsAtARidgeWhoseOtherFaceDoesNotOpposeTheSlave) {
  // The top of a box, and a wall that goes down from it: a slave side that looks down faces the top alone.
  const Net box = sheet(
      3, 2, [](int i, int) { return i == 3 ? -1.0 : 0.0; }, [](int, int) { return false; });
  Net net = box;
  for (Eigen::Index v = 0; v < net.points.cols(); ++v)
    if (net.points(0, v) == 3) net.points(0, v) = 2;  // the wall is upright
  for (const Smoothing kind : {Smoothing::none, Smoothing::catmull_rom}) {
    const auto patches = make_surface<3>(net.faces, kind, 30, net.points);
    const SurfaceSearch<3> search(patches, net.points);
    EXPECT_NE(search.facing({{1.9, 1.0, -0.1}, {0, 0, -1}}).patch, no_patch);
    EXPECT_EQ(search.facing({{2.2, 1.0, -0.1}, {0, 0, -1}}).patch, no_patch);
    EXPECT_NE(search.facing({{2.2, 1.0, -0.1}, {-1, 0, -1}}).patch, no_patch);  // both oppose this one
  }
}

TEST(SurfaceSearch, RoundsOffEndsOverHalfOfASlaveFacet) {
  // Top and wall of a box, as above, whose top ends at x = 2 at an edge, and at y = 0 at a border. Faces are 1 wide.
  Net net = sheet(
      3, 2, [](int i, int) { return i == 3 ? -1.0 : 0.0; }, [](int, int) { return false; });
  for (Eigen::Index v = 0; v < net.points.cols(); ++v)
    if (net.points(0, v) == 3) net.points(0, v) = 2;
  const Vec<double, 3> down(0, 0, -1);
  for (const Smoothing kind : {Smoothing::none, Smoothing::catmull_rom}) {
    const auto patches = make_surface<3>(net.faces, kind, 30, net.points);
    const SurfaceSearch<3> search(patches, net.points);
    for (const double size : {0.04, 0.6, 5.0}) {
      const RoundedEnd<double> end(size, 1);
      EXPECT_DOUBLE_EQ(end.to, smaller(size / 2, 0.5));
      double last = 0;
      for (int n = 1; n <= 40; ++n) {
        const double by = end.to * (n - 0.5) / 40;
        const bool is_far = by > end.furthest();
        for (const double depth : {0.0, 0.01}) {
          const Facing at_edge = search.facing({{2 + by, 1.3, -depth}, down, size});
          const Facing at_border = search.facing({{0.4, -by, -depth}, down, size});
          EXPECT_EQ(at_edge.patch == no_patch, is_far) << size << " " << by;
          EXPECT_EQ(at_border.patch == no_patch, is_far);
          if (is_far) continue;
          EXPECT_EQ(at_edge.ends != 0, by > end.from);
          EXPECT_EQ(at_border.ends != 0, by > end.from);
        }
        if (is_far || by <= end.from) continue;
        const double term = end_relief(end, by, size);
        EXPECT_GT(term, last);
        last = term;
      }
      EXPECT_NEAR(end_relief(end, end.furthest(), size), 3.61 * size, 1e-12 * size);  // 0.01 (0.95 / 0.05)^2
      const Facing at_corner = search.facing({{2 + end.to / 2, -end.to / 2, 0.0}, down, size});
      EXPECT_EQ(std::popcount(static_cast<unsigned>(at_corner.ends)), 2);
      EXPECT_EQ(search.facing({{2 - 1e-3, 1.3, -0.01}, down, size}).ends, 0);
      EXPECT_EQ(search.facing({{2 + end.to / 2, 1.3, -0.01}, down, size}, true).patch, no_patch);  // that comes on
    }
  }
}

/// Past a rounded end a node that presses is inside of a surface, also where its facets are warped, whose planes say
/// nothing of what is beside them.
TEST(SurfaceSearch, FacesWarpedFacetsPastTheirRoundedEnds) {
  const Net net = sheet(
      3, 3, [](int i, int j) { return 0.02 * std::sin(2.1 * i + 1.7 * j); }, [](int, int) { return false; });
  constexpr double size = 0.6;
  const RoundedEnd<double> end(size, 1);
  for (const Smoothing kind : {Smoothing::none, Smoothing::catmull_rom}) {
    const auto patches = make_surface<3>(net.faces, kind, 30, net.points);
    const SurfaceSearch<3> search(patches, net.points);
    for (int patch = 0; patch < 3; ++patch)  // along the front
      for (const double share : {0.2, 0.5, 0.9})
        for (const double along : {0.3, 0.6})
          for (const double depth : {1e-6, 1e-3}) {
            const double by = end.from + share * (end.furthest() - end.from);
            const At place = at(patches[patch], net.points, {along, -by});
            const Facing found = search.facing({place.y - depth * place.normal, {0, 0, -1}, size});
            EXPECT_EQ(found.patch, patch) << by << " " << along << " " << depth;
            EXPECT_EQ(found.ends, 1);
          }
  }
}

TEST(Surface, CarriesTangentsWhateverTheirDirections) {
  // What a surface that is sheared and turned makes of tangents e is turned by as much as e are turned.
  const Vec<double, 3> s(1.2, 0.1, 0.05), t(-0.1, 0.8, 0.2);  // slopes of the last increment
  detail::PlacedPoint<double, 3> at;
  const PatchAround<double, 3> before{Vec<double, 3>::Zero(), s, t},
      now{Vec<double, 3>::Zero(), {1.1, 0.5, -0.2}, {-0.6, 0.9, 0.3}};
  const Vec<double, 3> n0 = before.cross().normalized(),
                       n = (now.cross().normalized() + Vec<double, 3>(0.1, 0, 0)).normalized();
  const auto carried = [&](double angle) {
    at.geometry.tangents = detail::tangent_frame<double>(Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1>(n0));
    const Vec<double, 3> a = at.geometry.tangents.col(0), b = at.geometry.tangents.col(1);
    at.geometry.tangents.col(0) = std::cos(angle) * a + std::sin(angle) * b;
    at.geometry.tangents.col(1) = std::cos(angle) * b - std::sin(angle) * a;
    detail::keep_foot<double, 3>({}, before, at);
    return Vec<double, 3>(detail::carried_tangents<double>(now, at.foot.data(), n).col(0));
  };
  const Vec<double, 3> first = carried(0), across = n.cross(first);
  for (const double angle : {0.4, 1.3, 2.9})
    EXPECT_LE((carried(angle) - std::cos(angle) * first - std::sin(angle) * across).norm(), 1e-14);  // rounding
}

using Complex = std::complex<double>;

TEST(Surface, ItsFootHasTheDerivativesOfTheSearch) {
  const auto wave = [](int i, int j) { return 0.3 * std::sin(0.9 * i) * std::cos(0.7 * j); };
  const Net net = sheet(4, 4, wave, [](int i, int j) { return (i + j) % 3 == 0; });
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-1, 1);
  for (const Smoothing kind : {Smoothing::none, Smoothing::catmull_rom, Smoothing::b_spline}) {
    const auto patches = make_surface<3>(net.faces, kind, no_creases, net.points);
    Points<double> way(3, net.points.cols());
    for (Eigen::Index v = 0; v < way.cols(); ++v)
      for (int k = 0; k < 3; ++k) way(k, v) = any(random);
    const Vec<double, 3> x(1.37, 2.21, 0.35), x_way(0.3, -0.2, 0.4);
    const Facing facing = SurfaceSearch<3>(patches, net.points).facing({x, {0, 0, -1}});
    ASSERT_NE(facing.patch, no_patch);
    constexpr double h = 1e-30;
    const auto vertex = [&](int v) -> Placed<Complex, double, 3> {
      return {net.points.col(v), Vec<Complex, 3>(way.col(v) * Complex(0, h))};
    };
    const auto foot = foot_on_patch<Complex, double>(patches[facing.patch], {{0.2, 0.1}}, facing.at,
                                                     {x, Vec<Complex, 3>(x_way * Complex(0, h))}, vertex);
    const double step = 1e-5;
    const auto moved = [&](double by) {
      const Places<3> there = net.points + by * way;
      const Vec<double, 3> to = x + by * x_way;
      const Facing found = SurfaceSearch<3>(patches, there).foot_on(facing.patch, {to, Vec<double, 3>::Zero()});
      const At place = at(patches[facing.patch], there, found.at);
      return std::pair((to - place.y).dot(place.normal), place.normal);
    };
    const auto [gap_up, normal_up] = moved(step);
    const auto [gap_down, normal_down] = moved(-step);
    EXPECT_NEAR(foot.gap.real(), (gap_up + gap_down) / 2, 1e-9);
    EXPECT_NEAR(foot.gap.imag() / h, (gap_up - gap_down) / (2 * step), 1e-8);  // the difference's own error
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(foot.normal[k].imag() / h, (normal_up[k] - normal_down[k]) / (2 * step), 1e-8);
  }
}

TEST(Surface, SmallMotionsOfAFootHaveTheirDigits) {
  const auto wave = [](int i, int j) { return 0.3 * std::sin(0.9 * i) * std::cos(0.7 * j); };
  const Net net = sheet(4, 4, wave, [](int, int) { return false; });
  for (const Smoothing kind : {Smoothing::none, Smoothing::catmull_rom}) {
    const auto patches = make_surface<3>(net.faces, kind, no_creases, net.points);
    // From a node, which four patches share, in four directions: the motion along the surface is what it is.
    const Vec<double, 3> node = net.points.col(12);
    const SurfaceSearch<3> search(patches, net.points);
    const auto starts = patches_at(patches, search.facing({node, {0, 0, -1}}));
    ASSERT_EQ(starts.size(), 4U);
    const auto reference = [&](int patch) -> FootReference {
      for (const auto& start : starts)
        if (start.patch == patch) return {start.at, true};
      return {};
    };
    const auto vertex = [&](int v) -> Placed<double, double, 3> { return {net.points.col(v), Vec<double, 3>::Zero()}; };
    for (const double size : {1e-3, 1e-9, 1e-15})
      for (const auto& [a, b] :
           {std::pair(1.0, 0.6), std::pair(-1.0, 0.3), std::pair(-0.2, -1.0), std::pair(1.0, -0.4)}) {
        const Vec<double, 3> by = size * Vec<double, 3>(a, b, 0);
        const Facing found = search.facing({node + by, {0, 0, -1}});
        const auto foot =
            foot_on_patch<double, double>(patches[found.patch], reference(found.patch), found.at, {node, by}, vertex);
        const auto start =
            SurfacePlace<double, 3>::behind(patches[starts[0].patch], reference(starts[0].patch), {0, 0});
        const Vec<double, 3> motion = foot_motion<double, double>(start, foot, vertex);
        const Vec<double, 3> normal = foot.normal, expected = by - by.dot(normal) * normal;
        // the surface turns along the way, by the second order; and rounding of the way
        EXPECT_LE((motion - expected).norm(), (2 * size + 1e-12) * size) << size;
      }
  }
}

}  // namespace
}  // namespace stickslip::surface_test
