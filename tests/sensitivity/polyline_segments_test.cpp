/// Segment integration against polylines: their facets are those of a master that no force moves.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sensitivity/one_sided.hpp"
#include "tests/support/blocks.hpp"
#include "tests/support/finite_strain.hpp"
#include "tests/support/tangents.hpp"

namespace stickslip::polyline_segments_test {
namespace {

using namespace scenes;
using Kind = Response::Kind;

struct Drawn {
  bool finite = true;
  double mu = 0.3, along = 0.9;
  bool obstacle_moves = false;  ///< drawn past the block, in place of the block over it
};

/// A block on a surface, pressed down, then drawn along it to the left or the surface to the right.
Scene drawn_block(RigidSurface surface, const Drawn& of = {}) {
  Scene s;
  s.finite_strain = of.finite;
  s.legs = {{1, 3}, {2, 6}};
  s.bodies = {scenes::box_body("block", {0, 0}, {2, 1}, {5, 2})};
  const Number E = parameter(s, "E", 10);
  if (of.finite)
    s.bodies[0].material = NeoHookean{E, 0.3, NeoHookean::Volumetric::log};
  else
    s.bodies[0].material = LinearElastic{E, 0.3};
  const double size = of.finite ? 1 : 1e-3;
  const Number depth = parameter(s, "depth", -0.15 * size);
  const Table down = table({{0, 0.0}, {1, depth}});
  const auto drawn = [&](double sign) { return table({{0, 0.0}, {1, 0.0}, {2, sign * of.along * size}}); };
  s.obstacles = {{"floor", std::move(surface)}};
  if (of.obstacle_moves) s.obstacles[0].move = {{'x', drawn(1)}};
  s.supports = {scenes::support("block.top", {{'x', drawn(of.obstacle_moves ? 0 : -1)}, {'y', down}})};
  s.contacts = {scenes::contact("sole", "block.bottom", "floor")};
  s.contacts[0].segment = true;
  if (of.mu > 0) s.contacts[0].friction = parameter(s, "mu", of.mu);
  s.responses = {response("x", Kind::reaction, "block.top", "x"), response("y", Kind::reaction, "block.top", "y"),
                 response("energy", Kind::strain_energy, "")};
  if (of.mu > 0) {
    s.responses.push_back(response("slid", Kind::slip, "sole"));
    s.responses.push_back(response("heat", Kind::dissipation, "sole"));
  }
  return s;
}

const Plane level{{0.0, 0.0}, {0.0, 1.0}};
/// Facets of uneven length on that plane.
const Polyline uneven{{{-2.0, 0.0}, {-0.7, 0.0}, {0.13, 0.0}, {0.5, 0.0}, {1.31, 0.0}, {1.62, 0.0}, {4.0, 0.0}}};
/// Facets that bend to either side, so that the block crosses concave and convex vertices. `size`: of the bumps.
Polyline bumpy(double size = 1, Scene* s = nullptr) {
  Polyline out;
  for (int v = 0; v <= 12; ++v) out.points.push_back({-2.0 + 0.47 * v, 0.05 * size * (std::sin(2.3 * v) - 1)});
  if (s) out.points[5] = {parameter(*s, "bump_x", out.points[5][0].value), parameter(*s, "bump", -0.005 * size)};
  return out;
}

/// `slips`: what slip and its work may differ by, in place of `allowed`.
void expect_the_same(const scenes::Solved& a, const scenes::Solved& b, double allowed, double slips) {
  ASSERT_TRUE(is_converged(a.trajectory.status)) << a.trajectory.message;
  ASSERT_TRUE(is_converged(b.trajectory.status)) << b.trajectory.message;
  const double size = std::abs(a.value("y"));
  ASSERT_GT(size, 0);
  for (const auto& of : a.model.scene.responses) {
    const bool of_slip = of.name == "slid" || of.name == "heat";
    EXPECT_NEAR(a.value(of.name), b.value(of.name), (of_slip ? slips : allowed) * size) << of.name;
  }
}

TEST(PolylineSegments, OfFacetsOnAPlaneAreThePlane) {
  // Exact integrals, whatever they are cut into: equilibria are solved to 1e-10 of the largest nodal force. Feet are
  // along the normal of the slave facet here, and of the plane there: they slide apart where it has lifted off a bit.
  // (By mu = 0.02 nothing lifts off.)
  for (const bool finite : {false, true})
    for (const double mu : {0.0, 0.02, 0.3})
      for (const auto& method : finite_methods()) {
        SCOPED_TRACE(name_of(method));
        expect_the_same(run(drawn_block(level, {finite, mu}), method), run(drawn_block(uneven, {finite, mu}), method),
                        1e-9, finite && mu == 0.3 ? 1e-4 : 1e-9);
      }
}

TEST(PolylineSegments, DoNotTellWhoIsDrawn) {
  for (const auto& method : finite_methods()) {
    SCOPED_TRACE(name_of(method));
    Drawn other;
    other.obstacle_moves = true;
    expect_the_same(run(drawn_block(bumpy()), method), run(drawn_block(bumpy(), other), method), 1e-9, 1e-9);
  }
}

/// Drawn up a hill of a radius, whose chords are facets.
Polyline hill(int facets) {
  constexpr double radius = 6;
  Polyline out;
  for (int v = 0; v <= facets; ++v) {
    const double angle = std::numbers::pi * (0.75 - 0.5 * v / facets);
    out.points.push_back({1 + radius * std::cos(angle), radius * std::sin(angle) - radius});
  }
  return out;
}

TEST(PolylineSegments, OfChordsTendToTheCircleInSecondOrder) {
  const auto circle = run(drawn_block(Circle{{1.0, -6.0}, 6.0}), MonolithicAL{});
  ASSERT_TRUE(is_converged(circle.trajectory.status)) << circle.trajectory.message;
  double last = 0;
  for (const int facets : {24, 96, 384}) {
    const auto s = run(drawn_block(hill(facets)), MonolithicAL{});
    ASSERT_TRUE(is_converged(s.trajectory.status)) << s.trajectory.message;
    double difference = 0;
    for (const char* name : {"x", "y"}) difference = larger(difference, std::abs(s.value(name) - circle.value(name)));
    difference /= std::abs(circle.value("y"));
    if (last > 0) {
      EXPECT_LE(difference, last / 8) << facets;  // (16 without the places where the block's ends are on a chord)
    }
    last = difference;
  }
  EXPECT_LE(last, 1e-3);
}

TEST(PolylineSegments, TangentsAreTheComplexStepOfForcesAndRows) {
  for (const bool moves : {false, true})
    for (const Method& method : {Method(MonolithicAL{}), Method(Penalty{scenes::relative(100)})}) {
      Drawn of;
      of.obstacle_moves = moves;
      const auto s = run(drawn_block(bumpy(), of), method);
      ASSERT_TRUE(is_converged(s.trajectory.status)) << s.trajectory.message;
      for (std::size_t n = 0; n < s.trajectory.increments.size(); ++n)
        EXPECT_LE(scenes::errors_of_tangent(s.model, s.slots, method, s.trajectory, n).largest(), 1e-10);  // rounding
    }
}

TEST(PolylineSegments, DerivativesEqualTheComplexStepAndTheAdjoint) {
  // By numbers of the polyline too, at rest, moved and turned.
  for (const bool finite : {false, true}) {
    Drawn of;
    of.finite = finite;
    Scene shaped = drawn_block(level, of);
    shaped.obstacles[0].shape = bumpy(finite ? 1 : 1e-3, &shaped);
    ASSERT_GT(std::abs(run(shaped, MonolithicAL{}).value("y")), 0) << "it touches";
    for (const Method& method : finite_schemes()) {
      SCOPED_TRACE(finite);
      scenes::expect_derivatives_in_both_modes(shaped, method);
    }
    of.obstacle_moves = true;
    Scene turned = drawn_block(level, of);
    turned.obstacles[0].shape = bumpy(finite ? 1 : 1e-3, &turned);
    const double angle = finite ? 4 : 0.01;
    turned.obstacles[0].rotate =
        Rotation{{1.0, -3.0}, {}, table({{0, 0.0}, {1, 0.0}, {2, parameter(turned, "angle", angle)}})};
    scenes::expect_derivatives_in_both_modes(turned, MonolithicAL{});
  }
}

/// Over the side of a rigid disk of a mesh, whose radius is a parameter; it turns.
Scene over_a_disk(bool finite) {
  Drawn of;
  of.finite = finite;
  of.obstacle_moves = true;
  if (!finite) of.mu = 0.005;  // it is drawn by a fiftieth of what presses it, and slips
  Scene s = drawn_block(level, of);
  DiskMesh disk;
  disk.radius = parameter(s, "radius", 6.0);
  disk.cells = {11, 1};
  // the middle of the facet on top is in the block at the start: deeper than facets beside it fall within a cell
  disk.center = {1.03, 0.05 - 6 * std::cos(std::numbers::pi / 44)};
  s.obstacles[0].shape = MeshSide(disk, make_mesh(disk, "", 2), "arc");
  s.obstacles[0].rotate =
      Rotation{{1.0, -3.0}, {}, table({{0, 0.0}, {1, 0.0}, {2, parameter(s, "angle", finite ? 4 : 0.01)}})};
  return s;
}

TEST(PolylineSegments, OfSidesOfMeshesHaveTheSameDerivatives) {
  for (const bool finite : {false, true}) {
    SCOPED_TRACE(finite);
    const auto schemes = finite_schemes();
    for (const std::size_t k : {0U, 1U, 4U})  // one a method
      scenes::expect_derivatives_in_both_modes(over_a_disk(finite), schemes[k]);
    Scene nodes = over_a_disk(finite);
    nodes.contacts[0].segment = false;
    for (const Smoothing smoothing : {Smoothing::none, Smoothing::catmull_rom, Smoothing::b_spline}) {
      nodes.contacts[0].smoothing = smoothing;
      scenes::expect_derivatives_in_both_modes(nodes, MonolithicAL{});
    }
  }
}

}  // namespace
}  // namespace stickslip::polyline_segments_test
