/// A side that touches itself: which places may touch, the same numbers as of two sides that are named, and the
/// derivatives of every scheme.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <ctime>

#include "core/contact/foot_in_plane.hpp"
#include "core/contact/foot_in_space.hpp"
#include "core/contact/surface_search.hpp"
#include "tests/support/blocks.hpp"
#include "tests/support/extruded.hpp"
#include "tests/support/finite_strain.hpp"

namespace stickslip::self_contact_test {
namespace {

using namespace scenes;
using Kind = Response::Kind;

// --- what may be faced -----------------------------------------------------------------------------------------------

/// A wall 1 thick, folded to a U that opens to the right: arms 4 long, 1.5 apart. Corners, counter-clockwise.
const std::vector<Vec<double, 2>> folded{{4, 1}, {0, 1}, {0, 2.5}, {4, 2.5}, {4, 3.5}, {-1, 3.5}, {-1, 0}, {4, 0}};

struct Fold {
  Surface<2> patches;
  Eigen::Matrix2Xd places;
  /// `pieces`: facets of each straight part.
  Fold(int pieces, Smoothing smoothing) {
    const int corners = static_cast<int>(folded.size()), count = corners * pieces;
    places.resize(2, count);
    std::vector<std::vector<int>> facets;
    for (int c = 0; c < corners; ++c)
      for (int k = 0; k < pieces; ++k) {
        const double share = static_cast<double>(k) / pieces;
        places.col(c * pieces + k) = (1 - share) * folded[c] + share * folded[(c + 1) % corners];
        facets.push_back({c * pieces + k, (c * pieces + k + 1) % count});
      }
    patches = make_surface<2>(facets, smoothing, 30, places);
  }
};

// The nearest facets of a wall are its own, which do not count: to try them all takes eight times as long a point.
TEST(SelfContact, FindsThatWithoutTryingTheWholeWall) {
  const auto seconds_a_point = [](int pieces) {
    const Fold fold(pieces, Smoothing::none);
    const SurfaceSearch<2> search(fold.patches, fold.places);
    const Vec<double, 2> up(0, 1), down(0, -1);
    std::vector<OwnVertex> owned;
    for (const int side : {0, 6})  // one faces the other arm, one faces nothing
      for (int k = 1; k < 20; ++k)
        owned.push_back(
            own_vertex(fold.patches, fold.places, side * pieces + k * pieces / 20, side == 0 ? up : down, 0.5));
    int searched = 0, faced = 0;
    const std::clock_t start = std::clock();
    while (std::clock() - start < CLOCKS_PER_SEC / 20)
      for (const auto& own : owned) {
        const bool upper = own.vertex < pieces;
        const auto at =
            search.facing_itself({.x = fold.places.col(own.vertex), .outward = upper ? up : down, .own = &own});
        faced += at.patch != no_patch;
        ++searched;
      }
    EXPECT_EQ(2 * faced, searched);
    return static_cast<double>(std::clock() - start) / searched;
  };
  seconds_a_point(50);
  EXPECT_LT(seconds_a_point(400), 3.5 * seconds_a_point(50));  // log 3200 over log 400 is 1.3
}

TEST(SelfContact, FacesTheOtherArmAndNotThroughTheWall) {
  for (const Smoothing smoothing : {Smoothing::none, Smoothing::catmull_rom, Smoothing::b_spline}) {
    constexpr int pieces = 8;
    const Fold fold(pieces, smoothing);
    const SurfaceSearch<2> search(fold.patches, fold.places);
    const auto faced = [&](int vertex, const Vec<double, 2>& outward, const Vec<double, 2>& shift,
                           int last = no_patch) {
      const OwnVertex own = own_vertex(fold.patches, fold.places, vertex, outward, 0.5);
      return search.facing_itself(
          {.x = fold.places.col(vertex) + shift, .outward = outward, .own = &own, .last = last});
    };
    for (int k = 1; k < pieces; ++k) {
      // from the lower arm up: across the slit, however far it is and a bit inside; not once it is deep inside
      const Facing across = faced(k, {0, 1}, {0, 0});
      ASSERT_NE(across.patch, no_patch) << k;
      const auto place = [&](int vertex) -> Vec<double, 2> { return fold.places.col(vertex); };
      const Vec<double, 2> foot = curve_position<double>(fold.patches[across.patch], across.at[0], place);
      EXPECT_NEAR(foot[1], 2.5, 1e-12);
      EXPECT_NEAR(foot[0], fold.places(0, k), 1e-9);
      EXPECT_EQ(faced(k, {0, 1}, {0, 1.7}).patch, across.patch) << "0.2 inside";
      EXPECT_EQ(faced(k, {0, 1}, {0, 2.4}, across.patch).patch, across.patch) << "0.9 inside, from in front";
      EXPECT_EQ(faced(k, {0, 1}, {0, 2.4}).patch, no_patch) << "0.9 inside of what it did not face";
      EXPECT_EQ(faced(k, {0, 1}, {0, 2.6}, across.patch).patch, no_patch) << "through all of the other wall";
      // the other way round it is the slave
      EXPECT_EQ(faced(2 * pieces + k, {0, -1}, {0, 0}).patch, no_patch);
      // outer sides face nothing: what is behind them is the wall
      for (const int side : {4, 5, 6}) {
        const Vec<double, 2> along = folded[(side + 1) % 8] - folded[side];
        const Facing none = faced(side * pieces + k, {along[1], -along[0]}, {0, 0});
        EXPECT_EQ(none.patch, no_patch) << side;
        EXPECT_NEAR(none.distance, std::hypot(5, 3.5), 1e-12) << "the size of the curve";
      }
    }
  }
}

/// The same wall in space, drawn out by layers along z. Vertices are in the order of the side.
struct DrawnFold {
  static constexpr int layers = 2;
  Surface<3> patches;
  Places<3> places;
  std::vector<std::vector<int>> facets;
  std::vector<int> number;  ///< by vertex of the plane's fold + its count x layer
  DrawnFold(int pieces, Smoothing smoothing) {
    const Fold plane(pieces, smoothing);
    const int count = static_cast<int>(plane.places.cols());
    Places<3> drawn(3, (layers + 1) * count);
    for (int layer = 0; layer <= layers; ++layer)
      for (int v = 0; v < count; ++v) drawn.col(layer * count + v) << plane.places.col(v), layer;
    for (int layer = 0; layer < layers; ++layer)
      for (int v = 0; v < count; ++v) {
        const int a = layer * count + v, b = layer * count + (v + 1) % count;
        facets.push_back({a, b, b + count, a + count});  // the solid is on the left of a -> b
      }
    const auto order = order_in_space(facets, drawn);
    number.resize(order.size());
    places.resize(3, drawn.cols());
    for (std::size_t k = 0; k < order.size(); ++k) {
      number[order[k]] = static_cast<int>(k);
      places.col(static_cast<Eigen::Index>(k)) = drawn.col(order[k]);
    }
    for (auto& facet : facets)
      for (int& v : facet) v = number[v];
    patches = make_surface<3>(facets, smoothing, 30, places);
  }
};

TEST(SelfContact, InSpaceFacesTheOtherArmAndNotThroughTheWall) {
  for (const Smoothing smoothing : {Smoothing::none, Smoothing::catmull_rom, Smoothing::b_spline}) {
    constexpr int pieces = 8, count = 8 * pieces;
    const DrawnFold fold(pieces, smoothing);
    const SurfaceSearch<3> search(fold.patches, fold.places);
    const FaceSearch faces(fold.places, fold.facets);
    const auto faced = [&](int vertex, double up, double shift, int last = no_patch) {
      const int v = fold.number[count + vertex];  // of the middle layer
      const Vec<double, 3> outward(0, up, 0), at = fold.places.col(v) + Vec<double, 3>(0, shift, 0);
      const OwnVertex own = own_vertex(faces, v, outward, 0.5);
      return search.facing_itself({.x = at, .outward = outward, .own = &own, .last = last, .start = &fold.places});
    };
    for (int k = 1; k < pieces; ++k) {
      const Facing across = faced(k, 1, 0);
      ASSERT_NE(across.patch, no_patch) << k;
      const auto weights = place_weights(fold.patches[across.patch], across.at);
      Vec<double, 3> foot = Vec<double, 3>::Zero();
      for (Eigen::Index i = 0; i < weights.rows(); ++i)
        foot += weights(i, 0) * fold.places.col(fold.patches[across.patch].vertices[i]);
      EXPECT_LT((foot - Vec<double, 3>(fold.places(0, fold.number[count + k]), 2.5, 1)).norm(), 1e-9);
      EXPECT_NE(faced(k, 1, 1.7).patch, no_patch) << "0.2 inside";
      EXPECT_NE(faced(k, 1, 2.4, across.patch).patch, no_patch) << "0.9 inside, from in front";
      EXPECT_EQ(faced(k, 1, 2.4).patch, no_patch) << "0.9 inside of what it did not face";
      EXPECT_EQ(faced(k, 1, 2.6, across.patch).patch, no_patch) << "through all of the other wall";
      EXPECT_EQ(faced(2 * pieces + k, -1, 0).patch, no_patch) << "the other way round it is the slave";
      for (const auto& [side, up] : {std::pair(4, 1.0), std::pair(6, -1.0)}) {  // what is behind them is the wall
        const Facing none = faced(side * pieces + k, up, 0);
        EXPECT_EQ(none.patch, no_patch) << side;
        EXPECT_NEAR(none.distance, std::hypot(5, 3.5, DrawnFold::layers), 1e-12) << "the size of the side";
      }
    }
  }
}

// Whatever the numbers of its vertices, and turned in space: one wall comes before the other.
TEST(SelfContact, InSpaceHasAnOrderThatNumbersAndFramesDoNotChange) {
  const DrawnFold fold(4, Smoothing::none);
  const int count = static_cast<int>(fold.places.cols());
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.9, Eigen::Vector3d(1, 2, -2).normalized()).toRotationMatrix();
  Places<3> places(3, count);
  auto facets = fold.facets;
  const auto renumbered = [&](int v) { return (7 * v + 3) % count; };  // (7 and 96 have no common factor)
  for (int v = 0; v < count; ++v) places.col(renumbered(v)) = turn * fold.places.col(v);
  for (auto& facet : facets)
    for (int& v : facet) v = renumbered(v);
  const auto order = order_in_space(facets, places);
  std::vector<double> heights;  // in the frame of the fold, whose void is crossed along y
  for (const int v : order) heights.push_back((turn.transpose() * places.col(v))[1]);
  if (heights.front() > heights.back())
    std::reverse(heights.begin(), heights.end());  // (the fold is as long either way)
  for (std::size_t k = 0; k + 1 < heights.size(); ++k) EXPECT_LE(heights[k], heights[k + 1] + 1e-12);
}

// --- a ring that is open, and closes ---------------------------------------------------------------------------------

/// A rubber C: its start is held, pressure from all around closes it, with friction where the ends meet, and a force
/// shears the end along. Contact of its boundary with itself, or of two sides.
enum class Geometry { facets, b_spline, segments };
Scene clasp(bool itself, Geometry geometry = Geometry::facets, const std::string& element = "Q4") {
  Scene s;
  s.finite_strain = true;
  s.legs = {{0.1, 8}, {1, 4}, {2, 3}};  // (it closes soon)
  RingMesh ring;
  ring.center = {0.0, 0.0};
  ring.inner = parameter(s, "inner", 1);
  ring.outer = 1.5;
  ring.from_angle = 20.0;
  ring.to_angle = 340.0;
  ring.cells = {3, 16};
  s.bodies = {{"clasp", ring, NeoHookean{parameter(s, "E", 100), 0.3}, element, 1.0}};
  s.contacts = {itself ? scenes::contact("ends", "clasp.boundary", "clasp.boundary")
                       : scenes::contact("ends", "clasp.end", "clasp.start")};
  s.contacts[0].friction = parameter(s, "mu", 0.2);
  if (geometry == Geometry::b_spline) s.contacts[0].smoothing = Smoothing::b_spline;
  s.contacts[0].segment = geometry == Geometry::segments;
  // (corners of a boundary carry no multiplier)
  if (!itself && s.contacts[0].segment) s.contacts[0].slave = "clasp.end - clasp.inner - clasp.outer";
  s.supports = {scenes::support("clasp.start", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}})}})};
  Load around;
  around.on = "clasp.outer";
  around.kind = Load::Kind::pressure;
  around.vector = {parameter(s, "p", 2)};
  around.history = table({{0, 0.0}, {1, 1.0}});
  Load along = scenes::traction("clasp.end", {parameter(s, "shear", 0.6), 0.0});
  along.history = table({{0, 0.0}, {1, 0.0}, {2, 1.0}});
  s.loads = {around, along};
  s.responses = {response("press", Kind::contact_force, "ends", "normal"),
                 response("drag", Kind::contact_force, "ends", "x"),
                 response("end", Kind::displacement, "clasp.end", "x"), response("energy", Kind::strain_energy, "")};
  return s;
}

void expect_that_of_two_sides(Geometry geometry) {
  for (const Method& method : finite_methods()) {
    if (std::holds_alternative<Penalty>(method)) continue;  // (its stiffness is of other sides)
    const auto solve = [&](bool with_itself) {
      Scene scene = clasp(with_itself, geometry);
      scene.legs[0] = {0.1, 16};  // (no step is cut, so that both take the same ones)
      return run(scene, method);
    };
    const auto named = solve(false), itself = solve(true);
    ASSERT_TRUE(is_converged(named.trajectory.status)) << name_of(method) << named.trajectory.message;
    ASSERT_TRUE(is_converged(itself.trajectory.status)) << name_of(method) << itself.trajectory.message;
    ASSERT_EQ(named.trajectory.increments.size(), itself.trajectory.increments.size());
    EXPECT_GT(named.value("press"), 0.1) << "the ends meet";
    EXPECT_GT(std::abs(named.value("drag")), 0.1 * named.value("press")) << "and rub";
    for (std::size_t n = 0; n < named.trajectory.increments.size(); ++n)
      for (const auto& r : named.model.scene.responses)
        EXPECT_NEAR(itself.value(r.name, n), named.value(r.name, n), 1e-9 * std::abs(named.value(r.name)))
            << name_of(method) << r.name << n;
  }
}

TEST(SelfContact, OfABoundaryIsThatOfTheTwoSidesThatMeet) {
  for (const Geometry geometry : {Geometry::facets, Geometry::segments}) expect_that_of_two_sides(geometry);
}

TEST(SelfContact, InSpaceIsThatOfTheTwoSidesThatMeet) {
  for (const Method& method : finite_methods()) {
    if (std::holds_alternative<Penalty>(method)) continue;  // (as in the plane)
    const auto solve = [&](bool itself) {
      Scene plane = clasp(itself, Geometry::b_spline);
      plane.legs[0] = {0.1, 16};
      return run(extruded(plane), method);
    };
    const auto named = solve(false), itself = solve(true);
    ASSERT_TRUE(is_converged(named.trajectory.status)) << name_of(method) << named.trajectory.message;
    ASSERT_TRUE(is_converged(itself.trajectory.status)) << name_of(method) << itself.trajectory.message;
    ASSERT_EQ(named.trajectory.increments.size(), itself.trajectory.increments.size());
    EXPECT_GT(named.value("press"), 0.1) << "the ends meet";
    for (const auto& r : named.model.scene.responses) {
      EXPECT_NEAR(itself.value(r.name), named.value(r.name), 1e-9 * std::abs(named.value(r.name))) << r.name;
      for (const auto& p : named.model.scene.parameters) {
        const double scale =
            std::max(std::abs(named.derivative(r.name, p.name)), std::abs(named.value(r.name) / p.value));
        EXPECT_NEAR(itself.derivative(r.name, p.name), named.derivative(r.name, p.name), 1e-8 * scale)
            << name_of(method) << " " << r.name << " by " << p.name;
      }
    }
  }
}

TEST(SelfContact, InSpaceHasTheDerivativesOfTheWholeRun) {
  Scene plane = clasp(true, Geometry::b_spline);
  plane.legs = {{0.1, 8}, {1, 2}, {2, 2}};
  std::erase_if(plane.parameters, [](const Parameter& p) { return p.name == "p" || p.name == "inner"; });
  expect_derivatives_of_the_oracle(extruded(plane), MonolithicAL{});
}

/// A ring in space at small strain with a thin slit, which a traction closes.
Scene slit_ring(bool itself) {
  Scene s;
  s.space = Space::solid;
  s.legs = {{1, 2}};
  RingMesh ring;
  ring.center = {0.0, 0.0};
  ring.inner = 1.0;
  ring.outer = 1.5;
  ring.from_angle = 0.3;
  ring.to_angle = 359.7;
  ring.cells = {3, 16};
  s.bodies = {{"ring", ExtrudedMesh{ring, 0.0, 0.5, 1}, LinearElastic{parameter(s, "E", 100), 0.3}, "", 1.0}};
  s.contacts = {itself ? scenes::contact("ends", "ring.boundary", "ring.boundary")
                       : scenes::contact("ends", "ring.end", "ring.start")};
  s.contacts[0].friction = parameter(s, "mu", 0.2);
  s.supports = {scenes::support("ring.start", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}})}}),
                scenes::support("ring.front", {{'z', table({{0, 0.0}})}})};
  Load closing = scenes::traction("ring.end", {0.02, parameter(s, "p", 0.2), 0.0});
  closing.history = table({{0, 0.0}, {1, 1.0}});
  s.loads = {closing};
  s.responses = {response("press", Kind::contact_force, "ends", "normal"),
                 response("drag", Kind::contact_force, "ends", "x")};
  return s;
}

TEST(SelfContact, InSpaceAtSmallStrainHasTheForcesOfTheTwoSidesAndTheDerivativesOfTheRun) {
  for (const Method& method : finite_methods()) {
    const auto named = run(slit_ring(false), method), itself = run(slit_ring(true), method);
    ASSERT_TRUE(is_converged(named.trajectory.status)) << name_of(method) << named.trajectory.message;
    ASSERT_TRUE(is_converged(itself.trajectory.status)) << name_of(method) << itself.trajectory.message;
    EXPECT_GT(named.value("press"), 0.04) << "the ends meet";
    // Nodes at the rim of an end have the normal of all faces there that face the other end, which is another mean.
    // (Forces are those on the slave, which may be the other end.)
    for (const char* force : {"press", "drag"})
      EXPECT_NEAR(std::abs(itself.value(force)), std::abs(named.value(force)), 0.02 * std::abs(named.value(force)))
          << force;
  }
  expect_derivatives_of_the_oracle(slit_ring(true), MonolithicAL{});
}

TEST(SelfContact, HasTheDerivativesOfTheWholeRun) {
  // a thin ring: the rounding of its matrix, some 1.7e-11, is more than 1e-11
  const auto check = [](Scene scene, const Method& method) {
    scenes::expect_derivatives_of_the_oracle(scene, method);
    const double condition = run(scene, method).condition;
    scenes::ask_for_objectives(scene);
    EXPECT_LE(scenes::difference_of_modes(scene, method), 50 * unit_roundoff * condition) << name_of(method);
  };
  for (const Method& method : finite_schemes()) {
    if (std::holds_alternative<UzawaAL>(method))
      scenes::expect_derivatives_in_both_modes(clasp(true), method);
    else
      check(clasp(true), method);
  }
  for (const Geometry geometry : {Geometry::b_spline, Geometry::segments}) check(clasp(true, geometry), MonolithicAL{});
  check(clasp(true, Geometry::segments, "Q8"), MonolithicAL{});
}

}  // namespace
}  // namespace stickslip::self_contact_test
