/// The surface of a master in space as `verify` makes it, and its search for feet, by properties that need no solver.
#include <gmock/gmock.h>

#include "core/contact/foot_in_space.hpp"
#include "studies/verify/faces.hpp"
#include "studies/verify/solids.hpp"
#include "tests/support/largest.hpp"

namespace stickslip::verify_surface_tests {
namespace {

using namespace verify;

constexpr double rounding = 1e-14;  ///< of sums of some tens of terms of size 1

/// Nodes and faces, counter-clockwise from outside.
struct Mesh {
  Field nodes;
  std::vector<Nodes> faces;
};

/// A grid of the plane, some quadrilaterals cut along one diagonal or the other; `bulge`: height over it.
Mesh grid(int cells, bool cut, double bulge) {
  Mesh mesh{Field(3, (cells + 1) * (cells + 1)), {}};
  for (int n = 0; n < mesh.nodes.cols(); ++n) {
    const double x = n % (cells + 1), y = n / (cells + 1);
    mesh.nodes.col(n) = Vec3(x + 0.15 * std::sin(3 * n), y + 0.15 * std::cos(5 * n), bulge * std::sin(2 * x + y));
  }
  for (int k = 0; k < cells * cells; ++k) {
    const int a = k / cells * (cells + 1) + k % cells;
    const Nodes f{a, a + 1, a + cells + 2, a + cells + 1};
    if (!cut || k % 3 == 0) mesh.faces.push_back(f);
    if (cut && k % 3 == 1) mesh.faces.insert(mesh.faces.end(), {{f[0], f[1], f[2]}, {f[0], f[2], f[3]}});
    if (cut && k % 3 == 2) mesh.faces.insert(mesh.faces.end(), {{f[0], f[1], f[3]}, {f[1], f[2], f[3]}});
  }
  return mesh;
}

/// A cube of 6 cells^2 quadrilaterals, of which each third is cut: nodes have 3 to 6 faces. `roundness`: 0 cube, 1
/// sphere.
Mesh ball(int cells, double roundness) {
  std::map<std::array<int, 3>, int> number;
  std::vector<Vec3> nodes;
  std::vector<Nodes> faces;
  const auto node = [&](const std::array<int, 3>& at) {
    const auto [found, is_new] = number.emplace(at, std::ssize(nodes));
    if (!is_new) return found->second;
    const Vec3 x = Vec3(at[0], at[1], at[2]) * 2 / cells - Vec3(1, 1, 1);
    nodes.emplace_back(x * (1 - roundness + roundness / x.norm()));
    return found->second;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const int end : {0, cells})
      for (int k = 0; k < cells * cells; ++k) {
        Nodes f;
        for (const auto& [i, j] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
          std::array<int, 3> at{};
          at[axis] = end;
          at[(axis + 1) % 3] = k % cells + i;
          at[(axis + 2) % 3] = k / cells + j;
          f.push_back(node(at));
        }
        if (end == 0) std::ranges::reverse(f);
        if (k % 3 == 1)
          faces.insert(faces.end(), {{f[0], f[1], f[2]}, {f[0], f[2], f[3]}});
        else
          faces.push_back(f);
      }
  Mesh mesh{Field(3, nodes.size()), faces};
  for (std::size_t n = 0; n < nodes.size(); ++n) mesh.nodes.col(n) = nodes[n];
  return mesh;
}

/// Moves nodes by up to a tenth of a face, in no order.
void shake(Mesh& mesh) {
  for (Eigen::Index k = 0; k < mesh.nodes.size(); ++k) mesh.nodes(k % 3, k / 3) += 0.04 * std::sin(11.0 * k * k + k);
}

/// y, y_s, y_t of nodes at x.
Mat3 jet(const FacePatch& patch, const Field& x, const Vec2& at) {
  return x(Eigen::all, patch.nodes) * patch.weigh * blend(patch, at);
}
Vec3 normal(const Mat3& y) { return y.col(1).cross(y.col(2)).normalized(); }

const std::vector<Vec2> places{{0.2, 0.3}, {0.45, 0.5}, {0.05, 0.9}, {1e-9, 2e-9}, {0, 0}, {1, 0}, {0.5, 0}};

/// The largest distance, and turn of normals, of two patches along the edges that they share.
struct Seam {
  double apart = 0, sine = 0, cosine = 1;
  int edges = 0;
};
Seam seam(const std::vector<FacePatch>& patches, const Field& x) {
  Seam worst;
  for (const auto& patch : patches)
    for (const auto& other : patches)
      for (int j = 0; j < patch.sides(); ++j)
        for (int k = 0; k < other.sides(); ++k) {
          if (patch.face[j] != other.face[(k + 1) % other.sides()] ||
              patch.face[(j + 1) % patch.sides()] != other.face[k])
            continue;
          ++worst.edges;
          for (const double u : {0.0, 0.1, 0.5, 0.77, 1.0}) {
            const auto on = [&](const FacePatch& p, int edge, double at) {
              return jet(p, x, corner_at(p.sides(), edge) + at * edge_along(p.sides(), edge));
            };
            const Mat3 here = on(patch, j, u), there = on(other, k, 1 - u);
            worst.apart = larger(worst.apart, (here.col(0) - there.col(0)).norm());
            worst.sine = larger(worst.sine, normal(here).cross(normal(there)).norm());
            worst.cosine = smaller(worst.cosine, normal(here).dot(normal(there)));
          }
        }
  return worst;
}

TEST(VerifySurface, HasWeightsOfSumOneAtEachValence) {
  const Mesh mesh = ball(4, 1);
  std::map<int, int> valence;
  for (const auto& face : mesh.faces)
    for (const int node : face) ++valence[node];
  std::set<int> valences;
  for (const auto& [node, count] : valence) valences.insert(count);
  EXPECT_THAT(valences, testing::IsSupersetOf({3, 4, 5, 6}));
  for (const int smooth : {0, 1, 2})
    for (const auto& patch : Patchwork(mesh.nodes, mesh.faces, smooth, 60).patches) {
      EXPECT_LE(largest_entry((patch.weigh.colwise().sum().array() - 1).matrix()), rounding);
      for (const Vec2& at : places)
        EXPECT_LE((blend(patch, at).colwise().sum() - Eigen::RowVector3d(1, 0, 0)).norm(), rounding);
    }
}

/// A triangle and a quadrilateral all around which the surface goes on.
std::array<FacePatch, 2> inner_patches() {
  const auto patch = [](int sides) {
    return FacePatch{Nodes(sides), {}, {}, std::vector<int>(sides, FacePatch::smooth), {}};
  };
  return {patch(3), patch(4)};
}

TEST(VerifySurface, HasDerivativesThatAreThoseOfItsValues) {
  constexpr double h = 1e-5;  // errors of differences: h^2, and rounding over h
  for (const auto& patch : inner_patches())
    for (const Vec2& at : {Vec2(0.2, 0.3), Vec2(0.6, 0.1), Vec2(0.05, 0.4)})
      for (int i = 0; i < 2; ++i) {
        const Vec2 step = h * Vec2::Unit(i);
        const Eigen::VectorXd difference = (blend(patch, at + step) - blend(patch, at - step)).col(0) / (2 * h);
        EXPECT_LE(largest_entry(difference - blend(patch, at).col(1 + i)), 1e-8);
      }
}

// At a corner, and past it along an edge, distances to edges are zero but for rounding. (Beyond two edges slopes are
// others.)
TEST(VerifySurface, HasTheSlopesOfItsCornersBesideThemToo) {
  for (const auto& patch : inner_patches())
    for (int j = 0; j < patch.sides(); ++j) {
      const Vec2 next = edge_along(patch.sides(), j), back = -edge_along(patch.sides(), j + patch.sides() - 1);
      for (const auto& [along, across] : {std::pair(next, back), std::pair(back, next)})
        for (const double past : {0.0, 1e-3, 0.068})
          for (const double off : {-1e-16, -5.7e-18, 5.7e-18, 1e-16}) {
            if (past > 0 && off < 0) continue;
            const Vec2 at = corner_at(patch.sides(), j) - past * along;
            EXPECT_LE(largest_entry(blend(patch, at + off * across) - blend(patch, at)), rounding)
                << patch.sides() << " sides, corner " << j << ": " << past << ", " << off;
          }
    }
}

/// The judge shares no formula with the program, and has the same surfaces, beyond their edges too.
TEST(VerifySurface, IsThatOfTheProgram) {
  for (Mesh mesh : {ball(4, 1), grid(5, true, 0.1)}) {
    shake(mesh);
    for (const int smooth : {1, 2}) {
      const auto kind = smooth == 1 ? Smoothing::catmull_rom : Smoothing::b_spline;
      const auto theirs = make_surface<3>(mesh.faces, kind, 60, mesh.nodes);
      const auto patches = Patchwork(mesh.nodes, mesh.faces, smooth, 60).patches;
      for (std::size_t p = 0; p < patches.size(); ++p)
        for (const double s : {-0.4, -0.01, 0.3, 0.8, 1.37})
          for (const double t : {-0.3, -0.02, 0.1, 0.6, 1.2}) {
            const auto weights = place_weights(theirs[p], {s, t}).leftCols<3>().eval();
            const Mat3 place = mesh.nodes(Eigen::all, theirs[p].vertices) * weights;
            EXPECT_LE(largest_entry(place - jet(patches[p], mesh.nodes, {s, t})), 1e-13)  // rounding, times some ten
                << "patch " << p << " at " << s << ", " << t;
          }
    }
  }
}

/// Normals agree whatever nodes do after weights are made.
TEST(VerifySurface, HasNoKinksInside) {
  for (Mesh mesh : {ball(4, 1), grid(5, true, 0.1)}) {
    for (const int smooth : {1, 2}) {
      const auto patches = Patchwork(mesh.nodes, mesh.faces, smooth, 60).patches;
      Mesh moved = mesh;
      shake(moved);
      for (const Field& x : {mesh.nodes, moved.nodes}) {
        const Seam worst = seam(patches, x);
        EXPECT_GT(worst.edges, 0);
        EXPECT_LE(worst.apart, rounding);
        EXPECT_LE(worst.sine, 1e-12);
        EXPECT_GT(worst.cosine, 0);
      }
    }
  }
}

TEST(VerifySurface, IsPlaneOfNodesInAPlane) {
  const Mesh mesh = grid(5, true, 0);
  for (const int smooth : {0, 1, 2})
    for (const auto& patch : Patchwork(mesh.nodes, mesh.faces, smooth, 30).patches)
      for (const Vec2& at : places) {
        if (patch.sides() == 3 && at.sum() > 1) continue;
        const Mat3 y = jet(patch, mesh.nodes, at);
        EXPECT_LE(y.row(2).norm(), 0);
        EXPECT_EQ(normal(y), Vec3(0, 0, 1));
      }
}

TEST(VerifySurface, IsASplineOfTwoDirectionsOnARegularGrid) {
  const Mesh mesh = grid(5, false, 0.3);
  const auto weights = [](int smooth, double s) -> Eigen::Vector4d {
    const double r = 1 - s;
    if (smooth == 1)
      return Eigen::Vector4d(-s * r * r, 2 - 5 * s * s + 3 * s * s * s, s + 4 * s * s - 3 * s * s * s, -s * s * r) / 2;
    return Eigen::Vector4d(r * r * r, 4 - 6 * s * s + 3 * s * s * s, 4 - 6 * r * r + 3 * r * r * r, s * s * s) / 6;
  };
  for (const int smooth : {1, 2}) {
    const auto patch = Patchwork(mesh.nodes, mesh.faces, smooth, 170).patches[2 * 5 + 2];
    for (const Vec2& at : places) {
      Vec3 y = Vec3::Zero();
      for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j)
          y += weights(smooth, at[0])[i] * weights(smooth, at[1])[j] * mesh.nodes.col((j + 1) * 6 + i + 1);
      EXPECT_LE((jet(patch, mesh.nodes, at).col(0) - y).norm(), rounding);
    }
  }
}

TEST(VerifySurface, OfFacetsIsTheirTrianglesAndBilinearQuadrilaterals) {
  Mesh mesh = ball(3, 0.5);
  shake(mesh);
  for (const auto& patch : Patchwork(mesh.nodes, mesh.faces, 0, 30).patches)
    for (const Vec2& at : places) {
      const Vec3 place(at[0], at[1], 0);
      const Vec3 y = mesh.nodes(Eigen::all, patch.face) * shape(patch.sides() == 3 ? "T3" : "Q4", place).value;
      EXPECT_LE((jet(patch, mesh.nodes, at).col(0) - y).norm(), rounding);
    }
}

/// Edges and corners of a cube, which is cut there into six planes, stay where they are; as they move, both sides of a
/// crease keep one curve of its nodes alone.
TEST(VerifySurface, KeepsCreases) {
  const Mesh mesh = ball(4, 0);
  for (const int smooth : {1, 2}) {
    const auto patches = Patchwork(mesh.nodes, mesh.faces, smooth, 30).patches;
    for (const auto& patch : patches)
      for (const Vec2& at : places) {
        if (patch.sides() == 3 && at.sum() > 1) continue;
        const Vec3 y = jet(patch, mesh.nodes, at).col(0);
        EXPECT_NEAR(largest_entry(y), 1, rounding);
      }
    Mesh moved = mesh;
    shake(moved);
    EXPECT_LE(seam(patches, moved.nodes).apart, rounding);
    EXPECT_NEAR(seam(patches, mesh.nodes).sine, 1, rounding);  // a right angle
    for (const auto& patch : patches)
      for (int j = 0; j < patch.sides(); ++j) {
        const Vec3 from = mesh.nodes.col(patch.face[j]), to = mesh.nodes.col(patch.face[(j + 1) % patch.sides()]);
        const auto on_edge = [](const Vec3& x) { return (x.cwiseAbs().array() > 1 - rounding).count() >= 2; };
        if (!on_edge(from) || !on_edge((from + to) / 2)) continue;
        const Eigen::VectorXd N =
            patch.weigh * blend(patch, corner_at(patch.sides(), j) + 0.3 * edge_along(patch.sides(), j)).col(0);
        for (Eigen::Index k = 0; k < N.size(); ++k)
          EXPECT_TRUE(on_edge(mesh.nodes.col(patch.nodes[k])) || std::abs(N[k]) <= rounding);
      }
  }
}

/// A ridge of 45 degrees that fades: where the crease ends, the surface is smooth all around the node.
TEST(VerifySurface, IsSmoothWhereACreaseEnds) {
  Mesh mesh = grid(6, false, 0);
  for (int n = 0; n < mesh.nodes.cols(); ++n)
    mesh.nodes.col(n) = Vec3(n % 7, n / 7, n % 7 == 3 ? 0.4 * std::max(0, 4 - n / 7) / 3.0 : 0);
  for (const int smooth : {1, 2}) {
    std::map<int, std::vector<Vec3>> normals;  // of the faces at each node on the ridge
    for (const auto& patch : Patchwork(mesh.nodes, mesh.faces, smooth, 30).patches)
      for (int j = 0; j < 4; ++j)
        if (patch.face[j] % 7 == 3)
          normals[patch.face[j] / 7].push_back(normal(jet(patch, mesh.nodes, corner_at(4, j))));
    const auto turn = [&](int row) {
      double most = 0;
      for (const Vec3& n : normals[row]) most = larger(most, n.cross(normals[row][0]).norm());
      return most;
    };
    EXPECT_GT(turn(1), 0.5);
    EXPECT_LE(turn(3), 1e-12);
    EXPECT_LE(turn(4), 1e-12);
  }
}

// --- feet ----------------------------------------------------------------------------------------------------------

TEST(VerifySurface, FindsTheFootThatAPointIsLiftedFrom) {
  for (const Mesh& mesh : {ball(4, 1), grid(4, true, 0.1)})
    for (const int smooth : {1, 2}) {
      const Faces faces(mesh.nodes, mesh.faces, smooth, 60, true);
      for (const auto& patch : Patchwork(mesh.nodes, mesh.faces, smooth, 60).patches)
        for (const Vec2& at : {Vec2(0.2, 0.3), Vec2(0.01, 0.02), Vec2(1e-6, 0.4)})
          for (const double height : {0.05, -0.05}) {
            const Mat3 y = jet(patch, mesh.nodes, at);
            const Vec3 x = y.col(0) + height * normal(y);
            const Foot foot = faces.foot({-1, x, -normal(y)});
            ASSERT_TRUE(foot.faces);
            EXPECT_LE((foot.y - y.col(0)).norm(), 1e-12);  // rounding over the least angle of edges
            EXPECT_LE((foot.normal - normal(y)).norm(), 1e-11);
            EXPECT_NEAR(foot.gap, height, 1e-13);
            Vec3 again = Vec3::Zero();
            for (const auto& [node, weight] : foot.weights) again -= weight * mesh.nodes.col(node);
            EXPECT_LE((again - foot.y).norm(), rounding);
            EXPECT_LE((faces.position(foot.place) - foot.y).norm(), rounding);
          }
    }
}

/// Past a convex ridge the two planes go on, and the larger gap counts; inside, the nearer plane has the larger one.
TEST(VerifySurface, GoesOnPastARidge) {
  const Mesh mesh = ball(2, 0);
  for (const int smooth : {0, 1, 2}) {
    const Faces faces(mesh.nodes, mesh.faces, smooth, 30, true);
    const auto foot = [&](const Vec3& x) { return faces.foot({-1, x, Vec3(-1, -1, -1)}); };
    EXPECT_NEAR(foot({1.1, 0.3, 1.2}).gap, 0.2, rounding);
    EXPECT_LE((foot({1.1, 0.3, 1.2}).y - Vec3(1.1, 0.3, 1)).norm(), 1e-12);
    EXPECT_NEAR(foot({1.3, 1.1, 1.2}).gap, 0.3, rounding);
    EXPECT_NEAR(foot({0.9, 0.3, 0.95}).gap, -0.05, rounding);
  }
}

TEST(VerifySurface, FacesNothingPastItsBorder) {
  const Mesh mesh = grid(4, true, 0);
  for (const int smooth : {0, 1}) {
    const Faces faces(mesh.nodes, mesh.faces, smooth, 30, true);
    EXPECT_FALSE(faces.foot({-1, {2, -0.5, 0.1}, {0, 0, -1}}).faces);
    EXPECT_TRUE(faces.foot({-1, {2, 0.5, 0.1}, {0, 0, -1}}).faces);
    EXPECT_FALSE(faces.foot({-1, {2, 0.5, 0.1}, {0, 0, 1}}).faces);  // it looks the same way
  }
}

/// A point over the top of a thin plate looks up: inside by the bottom, but outside by the nearer top.
TEST(VerifySurface, IsNotInsideByAFartherFace) {
  Mesh mesh = ball(2, 0);
  mesh.nodes.row(2) *= 0.05;
  const Faces faces(mesh.nodes, mesh.faces, 0, 30, true);
  EXPECT_FALSE(faces.foot({-1, {0.2, 0.3, 0.06}, {0, 0, 1}}).faces);
  EXPECT_TRUE(faces.foot({-1, {0.2, 0.3, -0.06}, {0, 0, 1}}).faces);
  EXPECT_TRUE(faces.foot({-1, {0.2, 0.3, 0.02}, {0, 0, 1}}).faces);  // inside of both
}

}  // namespace
}  // namespace stickslip::verify_surface_tests
