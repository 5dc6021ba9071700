/// Solid bodies in space: scenes of plane strain, drawn out by one layer and held along z, have the plane's answers and
/// derivatives.
#include "tests/support/extruded.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/finite_strain.hpp"

namespace stickslip::extruded_test {
namespace {

using Kind = Response::Kind;

/// A block that is pressed on a floor and drawn along it.
Scene drawn_block(const Material& material, bool finite, const std::string& element = "") {
  Scene s;
  s.finite_strain = finite;
  s.legs = {{1, 2}, {2, 3}};
  const Number mu = scenes::parameter(s, "mu", 0.3), width = scenes::parameter(s, "width", 2.0),
               down = scenes::parameter(s, "down", -0.08), thickness = scenes::parameter(s, "thickness", 0.7);
  BoxMesh box;
  box.max = {width, 1.0};
  box.cells = {5, 3};
  s.bodies = {{"block", box, material, element, 1.0}};
  s.bodies[0].thickness = thickness;
  s.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.02, 1.0}}, {}}};
  s.contacts = {scenes::contact("sole", "block.bottom", "floor")};
  s.contacts[0].friction = mu;
  s.supports = {scenes::support(
      "block.top", {{'x', scenes::table({{1, 0.0}, {2, 0.1}})}, {'y', scenes::table({{0, 0.0}, {1, down}})}})};
  s.loads = {{"block.left", Load::Kind::pressure, {2.0}, {}}};
  s.responses = {scenes::response("press", Kind::contact_force, "sole", "normal"),
                 scenes::response("shear", Kind::contact_force, "sole", "x"),
                 scenes::response("pull", Kind::reaction, "block.top", "x"),
                 scenes::response("heat", Kind::dissipation, "sole"),
                 scenes::response("peak", Kind::contact_pressure, "sole", "", Response::Take::max)};
  return s;
}

/// A block that sinks between a floor and a drum.
Scene under_a_drum(bool finite) {
  Scene s = drawn_block(finite ? Material(NeoHookean{1000.0, 0.3}) : Material(LinearElastic{1000.0, 0.3}), finite);
  const Number radius = scenes::parameter(s, "radius", 1.5);
  s.obstacles.push_back({"drum", Circle{{0.9, 2.5}, radius}, {{'y', scenes::table({{0, 0.0}, {1, -0.1}})}}});
  s.contacts.push_back(scenes::contact("roof", "block.top", "drum"));
  s.contacts[0].friction.reset();
  s.supports = {scenes::support("block.left", {{'x', scenes::table({{0, 0.0}})}})};
  s.loads.clear();
  s.responses = {scenes::response("press", Kind::contact_force, "roof", "normal"),
                 scenes::response("wide", Kind::displacement, "block.right", "x"),
                 scenes::response("energy", Kind::strain_energy, "")};
  return s;
}

/// The drum is rough, and turns: it pulls the block along.
Scene under_a_rough_drum() {
  Scene s = under_a_drum(true);
  s.contacts.back().friction = scenes::parameter(s, "rough", 0.4);
  s.obstacles.back().rotate =
      Rotation{{0.9, 2.5}, {}, scenes::table({{1, 0.0}, {2, scenes::parameter(s, "turn", 2.0)}})};
  s.responses.push_back(scenes::response("drawn", Kind::contact_force, "roof", "x"));
  s.responses.push_back(scenes::response("heat", Kind::dissipation, "roof"));
  return s;
}

/// The floor is a polyline that sinks and turns; its points are no parameters, as facets of space are none.
Scene over_a_ridge(Smoothing smoothing, bool finite) {
  Scene s = drawn_block(finite ? Material(NeoHookean{1000.0, 0.3}) : Material(LinearElastic{1000.0, 0.3}), finite);
  Polyline ridge;
  for (const double x : {-0.91, -0.21, 0.49, 1.19, 1.89, 2.59}) ridge.points.push_back({x, -0.03 * x * (x - 1.5)});
  s.obstacles = {{"floor", ridge, {{'y', scenes::table({{0, 0.0}, {2, scenes::parameter(s, "sinks", -0.01)}})}}}};
  s.obstacles[0].rotate = Rotation{{0.8, -0.5}, {}, scenes::table({{1, 0.0}, {2, scenes::parameter(s, "turn", 1.0)}})};
  s.contacts[0].smoothing = smoothing;
  s.supports[0].move.at('y') = scenes::table({{0, 0.0}, {1, scenes::parameter(s, "deep", -0.12)}});
  std::erase_if(s.parameters, [](const Parameter& p) { return p.name == "down"; });
  return s;
}

/// A rubber die that is pressed into a rubber slab and drawn along it, over patches of a smooth surface.
Scene drawn_die(Smoothing smoothing) {
  Scene s;
  s.finite_strain = true;
  s.legs = {{1, 2}, {2, 4}};
  const Number mu = scenes::parameter(s, "mu", 0.3), E = scenes::parameter(s, "E", 10.0),
               width = scenes::parameter(s, "width", 4.0);
  BoxMesh slab;
  slab.max = {width, 1.0};
  slab.cells = {12, 3};
  QuadMesh die;
  die.corners = {{{0.9, 1.05}, {1.7, 1.0}, {1.8, 1.6}, {0.8, 1.6}}};
  die.cells = {4, 2};
  s.bodies = {{"slab", slab, NeoHookean{E, 0.3, NeoHookean::Volumetric::log}, "", 1.0},
              {"die", die, NeoHookean{50.0, 0.3, NeoHookean::Volumetric::log}, "", 1.0}};
  s.bodies[0].thickness = s.bodies[1].thickness = 0.8;
  s.contacts = {scenes::contact("sole", "die.bottom", "slab.top")};
  s.contacts[0].smoothing = smoothing;
  s.contacts[0].friction = mu;
  const Table still = scenes::table({{0, 0.0}});
  s.supports = {scenes::support("slab.bottom", {{'x', still}, {'y', still}}),
                scenes::support("die.top", {{'x', scenes::table({{1, 0.0}, {2, 0.7}})},
                                            {'y', scenes::table({{0, 0.0}, {1, -0.15}})}})};
  s.responses = {scenes::response("x", Kind::reaction, "die.top", "x"),
                 scenes::response("normal", Kind::contact_force, "sole", "normal"),
                 scenes::response("energy", Kind::strain_energy, ""),
                 scenes::response("heat", Kind::dissipation, "sole")};
  return s;
}

const J2Plastic metal{1000.0, 0.3, 12.0, 50.0};

/// The same scene, integrated over segments: in space over overlaps. (Not on a circle: a gap to it is no polynomial,
/// and the points of Gauss are others in space.)
Scene segmented(Scene scene) {
  for (auto& contact : scene.contacts) contact.segment = true;
  return scene;
}

/// Half a rubber tube that two rough drums pinch until its inside touches itself, first at its ends. (Without friction
/// there: where a slip begins of a point that comes onto an end is not the same in space.)
Scene pinched_tube() {
  Scene s;
  s.finite_strain = true;
  s.legs = {{1, 12}};
  RingMesh ring;
  ring.center = {0.0, 0.0};
  ring.inner = scenes::parameter(s, "inner", 8.5);
  ring.outer = 10.0;
  ring.from_angle = 90.0;
  ring.to_angle = 270.0;
  ring.cells = {2, 16};
  s.bodies = {{"tube", ring, NeoHookean{scenes::parameter(s, "E", 100), 0.3}, "", 1.0}};
  const Number mu = scenes::parameter(s, "mu", 0.2);
  for (const auto& [name, y] : {std::pair("above", 15.0), std::pair("below", -15.0)}) {
    s.obstacles.push_back({name, Circle{{0.0, y}, 5.0}, {{'y', scenes::table({{0, 0.0}, {1, y > 0 ? -9.5 : 9.5}})}}});
    s.contacts.push_back(scenes::contact(name, "tube.outer", name));
    s.contacts.back().friction = mu;
  }
  s.contacts.push_back(scenes::contact("inside", "tube.inner", "tube.inner"));
  s.contacts.back().smoothing = Smoothing::catmull_rom;
  for (const char* cut : {"tube.start", "tube.end"})
    s.supports.push_back(scenes::support(cut, {{'x', scenes::table({{0, 0.0}})}}));
  s.responses = {scenes::response("press", Kind::contact_force, "above", "normal"),
                 scenes::response("touch", Kind::contact_force, "inside", "normal"),
                 scenes::response("energy", Kind::strain_energy, "")};
  return s;
}

std::vector<Scene> plane_scenes() {
  const LinearElastic elastic{1000.0, 0.3};
  const NeoHookean rubber{1000.0, 0.3, NeoHookean::Volumetric::log};
  std::vector<Scene> all{scenes::greco_plate(6),
                         scenes::driven_block(),
                         drawn_block(elastic, false),
                         drawn_block(elastic, false, "Q4_mean_dilatation"),
                         drawn_block(metal, false),
                         drawn_block(rubber, true),
                         drawn_block(rubber, true, "Q4_mean_dilatation"),
                         drawn_block(metal, true),
                         under_a_drum(false),
                         under_a_drum(true),
                         under_a_rough_drum(),
                         over_a_ridge(Smoothing::none, false),
                         over_a_ridge(Smoothing::catmull_rom, false),
                         over_a_ridge(Smoothing::none, true),
                         over_a_ridge(Smoothing::catmull_rom, true),
                         over_a_ridge(Smoothing::b_spline, true),
                         scenes::two_boxes(5, 8),
                         scenes::two_disks(6, false),
                         drawn_die(Smoothing::catmull_rom),
                         drawn_die(Smoothing::b_spline),
                         segmented(drawn_block(elastic, false)),
                         segmented(over_a_ridge(Smoothing::none, false)),
                         segmented(scenes::two_boxes(5, 8)),
                         scenes::two_disks(6, true),
                         pinched_tube()};
  for (auto& scene : all) {  // what the plane alone can be asked
    std::erase_if(scene.responses, [](const Response& response) {
      return response.component == Response::Component::moment || response.kind == Kind::contact_half_width;
    });
  }
  return all;
}

/// Runs a scene in the plane and drawn out, and compares all responses and derivatives.
void expect_the_same_in_space(const Scene& plane, const Method& method) {
  const auto in_plane = scenes::run(plane, method), in_space = scenes::run(scenes::extruded(plane), method);
  ASSERT_TRUE(is_converged(in_plane.trajectory.status)) << in_plane.trajectory.message;
  ASSERT_TRUE(is_converged(in_space.trajectory.status)) << in_space.trajectory.message;
  const auto &expected = in_plane.trajectory.increments, &found = in_space.trajectory.increments;
  ASSERT_EQ(found.size(), expected.size());
  for (const auto* one : {&in_plane, &in_space})
    ASSERT_EQ(one->gradients.of_responses.size(), expected.size()) << one->gradients.message;
  const auto responses = [](const scenes::Solved& s, std::size_t n) {
    const auto& increment = s.trajectory.increments[n];
    return evaluate_responses(s.model, s.slots, increment.state, increment.time);
  };
  Vector<double> size = Vector<double>::Zero(plane.responses.size());
  Matrix<double> slope = Matrix<double>::Zero(plane.responses.size(), plane.parameters.size());
  for (std::size_t n = 0; n < expected.size(); ++n) {
    size = size.cwiseMax(responses(in_plane, n).cwiseAbs());
    slope = slope.cwiseMax(in_plane.gradients.of_responses[n].cwiseAbs());
  }
  for (std::size_t n = 0; n < expected.size(); ++n) {
    const auto of_plane = responses(in_plane, n), of_space = responses(in_space, n);
    for (Eigen::Index r = 0; r < size.size(); ++r) {
      const std::string what = std::string(name_of(method)) + " " + plane.responses[r].name + " " + std::to_string(n);
      EXPECT_NEAR(of_space[r], of_plane[r], 1e-9 * size[r]) << what;  // the tolerance of the runs, a hundred times
      for (Eigen::Index j = 0; j < slope.cols(); ++j) {
        const double scale = std::max(slope(r, j), size[r] / std::abs(plane.parameters[j].value));
        EXPECT_NEAR(in_space.gradients.of_responses[n](r, j), in_plane.gradients.of_responses[n](r, j), 1e-8 * scale)
            << what << " by " << plane.parameters[j].name;
      }
    }
  }
}

TEST(Extruded, ScenesOfPlaneStrainHaveTheirAnswersAndDerivativesInSpace) {
  UzawaAL uzawa;
  uzawa.tolerance = 1e-12;
  int number = 0;
  for (const Scene& plane : plane_scenes()) {
    SCOPED_TRACE(number++);
    for (const Method& method : {Method(uzawa), Method(MonolithicAL{})}) expect_the_same_in_space(plane, method);
  }
}

}  // namespace
}  // namespace stickslip::extruded_test
