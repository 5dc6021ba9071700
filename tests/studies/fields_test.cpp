/// Fields and pictures against values of their own: states made by hand, stresses and tractions by hand from them.
#include "studies/run/fields.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "core/model/contact_assembly.hpp"
#include "studies/io/atomic_file.hpp"
#include "studies/report/picture.hpp"
#include "studies/run/film.hpp"
#include "studies/run/picture_json.hpp"
#include "studies/run/run_files.hpp"
#include "tests/studies/cases.hpp"
#include "tests/studies/temporary_folder.hpp"
#include "tests/studies/vtu_reader.hpp"
#include "tests/support/scenes.hpp"

namespace stickslip {
namespace {

using nlohmann::json;
using scenes::contact;
using testing::DoubleNear;
using testing::ElementsAre;
using testing::Pointwise;

constexpr double rounding_of_fields = 1e-13;  // a few roundings of numbers of size ten

/// A result of one step whose state the test writes.
struct WrittenFields {
  CaseResult result;

  explicit WrittenFields(const Scene& scene) {
    result.problem = std::make_shared<const Problem>(scene);
    result.trajectory.increments.resize(1);
    state() = initial_state<double>(model(), result.problem->slots);
    result.trajectory.increments[0].time = 0.5;
    result.steps.resize(1);
    result.steps[0].increment = &result.trajectory.increments[0];
  }
  WrittenFields(const WrittenFields&) = delete;
  const Model& model() const { return result.problem->model; }
  State<double>& state() { return result.trajectory.increments[0].state; }
  /// The .vtu of the step.
  std::string file() const {
    const TemporaryFolder own;
    write_fields(own.path, result, 0);
    return read_file(own.path / "fields_0001.vtu");
  }
  std::vector<double> array(const std::string& name) const { return vtu::array_named(file(), name).values<double>(); }
};

/// A block of one element, 2 x 1, its corner at (1, 0); lame = 400 and shear modulus 400 in plane strain.
Scene block(Space space) {
  Scene s;
  s.space = space;
  s.legs = {{1, 1}};
  s.bodies = {{"block", BoxMesh{{1.0, 0.0}, {3.0, 1.0}, {1, 1}}, LinearElastic{1000, 0.25}, "", 1.0}};
  s.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}, {}}};
  s.contacts = {contact("sole", "block.bottom", "floor")};
  s.contacts[0].friction = 0.5;
  return s;
}

/// u = (0.01 x + 0.03 y, -0.02 y): strains 0.01, -0.02, shear 0.03.
void strain(WrittenFields& made) {
  const auto& points = made.result.problem->slots.points;
  for (Eigen::Index n = 0; n < points.cols(); ++n) {
    made.state().displacement[2 * n] = 0.01 * points(0, n) + 0.03 * points(1, n);
    made.state().displacement[2 * n + 1] = -0.02 * points(1, n);
  }
}

TEST(Fields, StressOfALinearDisplacementIsHookesLaw) {
  WrittenFields made(block(Space::plane_strain));
  strain(made);
  // trace -0.01: 400 * -0.01 + 800 * strain, and out of the plane the first part alone
  EXPECT_THAT(made.array("stress"), Pointwise(DoubleNear(rounding_of_fields), {4.0, -20.0, -4.0, 12.0, 0.0, 0.0}));
  const double mises = std::sqrt((24 * 24 + 16 * 16 + 8 * 8) / 2.0 + 3 * 12 * 12);
  EXPECT_THAT(made.array("von_mises"), Pointwise(DoubleNear(rounding_of_fields), {mises}));
  EXPECT_THAT(made.array("body"), ElementsAre(0));
  EXPECT_THAT(made.array("TimeValue"), ElementsAre(0.5));
  EXPECT_NEAR(picture_json(made.result)["von_mises"][0], mises, rounding_of_fields);
}

TEST(Fields, StressInPlaneStressHasNothingOutOfThePlane) {
  WrittenFields made(block(Space::plane_stress));
  strain(made);
  // E / (1 - nu^2) = 1066.67: times (0.01 - 0.25 * 0.02), (-0.02 + 0.25 * 0.01)
  const double modulus = 1000 / (1 - 0.0625);
  EXPECT_THAT(made.array("stress"),
              Pointwise(DoubleNear(rounding_of_fields), {modulus * 0.005, -modulus * 0.0175, 0.0, 12.0, 0.0, 0.0}));
}

TEST(Fields, StressOfRevolutionHasTheHoopStressOutOfThePlane) {
  WrittenFields made(block(Space::axisymmetric));
  for (int n = 0; n < 4; ++n) made.state().displacement[2 * n] = 0.01 * made.result.problem->slots.points(0, n);
  // u_r = 0.01 r: hoop strain 0.01 too, trace 0.02
  EXPECT_THAT(made.array("stress"), Pointwise(DoubleNear(rounding_of_fields), {16.0, 8.0, 16.0, 0.0, 0.0, 0.0}));
}

TEST(Fields, VonMisesOfHugeStressesIsFinite) {
  WrittenFields made(block(Space::plane_strain));
  made.state().displacement.setConstant(0);
  for (int n = 0; n < 4; ++n) made.state().displacement[2 * n] = 1e200 * made.result.problem->slots.points(0, n);
  // 1200, 400, 400 times 1e200
  EXPECT_NEAR(made.array("von_mises")[0], 8e202, 8e202 * rounding_of_fields);
}

TEST(Fields, OfContactAreOfPresentAreasTooAtFiniteStrain) {
  Scene scene = block(Space::plane_strain);
  scene.finite_strain = true;
  scene.bodies[0].material = NeoHookean{1000, 0.25};
  WrittenFields made(scene);
  auto& state = made.state();
  // half as wide again; areas of the start are 1 a node, 1.5 now
  for (int n = 0; n < 4; ++n) state.displacement[2 * n] = 0.5 * made.result.problem->slots.points(0, n);
  state.contact.state = {ContactState::slip, ContactState::open};
  state.contact.traction << -6, 3, 0, 0;
  const int node = made.model().side("block.bottom").nodes[0];
  EXPECT_DOUBLE_EQ(made.array("contact_pressure")[node], 6);
  EXPECT_DOUBLE_EQ(made.array("contact_pressure_current")[node], 4);
  const auto nominal = made.array("contact_traction"), current = made.array("contact_traction_current");
  for (int i = 0; i < 2; ++i) EXPECT_DOUBLE_EQ(current[3 * node + i], nominal[3 * node + i] / 1.5);
}

TEST(Fields, OfPlaneStressAtFiniteStrainAreOfThePresentThickness) {
  for (const bool metal : {false, true}) {
    Scene scene = block(Space::plane_stress);
    scene.finite_strain = true;
    scene.bodies[0].material = NeoHookean{1000, 0.25, NeoHookean::Volumetric::log};
    if (metal) scene.bodies[0].material = J2Plastic{1000, 0.25, 1e6, 0.0};
    WrittenFields made(scene);
    auto& state = made.state();
    // half as wide again: of metal that does not flow ln h = -nu / (1 - nu) ln 1.5, of rubber 400 (h^2 - 1) + 400
    // ln(1.5 h) = 0
    for (int n = 0; n < 4; ++n) state.displacement[2 * n] = 0.5 * made.result.problem->slots.points(0, n);
    double low = 0.5, high = 1;
    for (int i = 0; i < 60; ++i) {
      const double h = (low + high) / 2;
      (h * h - 1 + std::log(1.5 * h) > 0 ? high : low) = h;
    }
    const double h = metal ? std::pow(1.5, -1.0 / 3) : low;
    EXPECT_NEAR(made.array("thickness_stretch")[0], h, rounding_of_fields) << metal;
    // Cauchy's along x: rubber 400 (1.5^2 - h^2) over the volume 1.5 h, metal E / (1 - nu^2) ln 1.5 over it
    const double along = (metal ? 1000 / (1 - 0.0625) * std::log(1.5) : 400 * (2.25 - h * h)) / (1.5 * h);
    const auto stress = made.array("stress");
    EXPECT_NEAR(stress[0], along, 1e-12 * along) << metal;
    EXPECT_EQ(stress[2], 0) << metal;
    state.contact.state = {ContactState::slip, ContactState::open};
    state.contact.traction << -6, 3, 0, 0;
    const int node = made.model().side("block.bottom").nodes[0];
    EXPECT_NEAR(made.array("contact_pressure_current")[node], 6 / (1.5 * h), rounding_of_fields) << metal;
  }
  for (const bool finite : {false, true}) {  // where the thickness stays there is no such field
    Scene scene = block(finite ? Space::plane_strain : Space::plane_stress);
    scene.finite_strain = finite;
    if (finite) scene.bodies[0].material = NeoHookean{1000, 0.25};
    WrittenFields made(scene);
    EXPECT_THROW(made.array("thickness_stretch"), std::runtime_error);
  }
}

TEST(Fields, OfContactAreThoseOfTheSlaveNodes) {
  WrittenFields made(block(Space::plane_strain));
  auto& state = made.state();
  state.displacement << 1, 2, 3, 4, 5, 6, 7, 8;
  state.contact.state = {ContactState::slip, ContactState::open};
  state.contact.traction << -6, 2, 0, 0;
  state.contact.gap << -0.5, 0.25;
  const auto nodes = made.model().side("block.bottom").nodes;
  ASSERT_EQ(nodes.size(), 2u);
  const auto code = made.array("contact_state"), pressure = made.array("contact_pressure"), gap = made.array("gap"),
             traction = made.array("contact_traction"), displacement = made.array("displacement");
  int others = 0;
  for (int n = 0; n < 4; ++n) {
    EXPECT_EQ(displacement[3 * n], 2 * n + 1);
    EXPECT_EQ(displacement[3 * n + 1], 2 * n + 2);
    if (n == nodes[0] || n == nodes[1]) continue;
    ++others;
    EXPECT_EQ(code[n], -1);
    EXPECT_EQ(pressure[n], 0);
    EXPECT_TRUE(std::isnan(gap[n])) << "no slave node";
  }
  EXPECT_EQ(others, 2);
  EXPECT_EQ(code[nodes[0]], 2);
  EXPECT_EQ(code[nodes[1]], 0);
  EXPECT_EQ(pressure[nodes[0]], 6);
  EXPECT_EQ(gap[nodes[0]], -0.5);
  EXPECT_EQ(gap[nodes[1]], 0.25);
  // on the slave: pushed off the floor, and against the tangent (-1, 0)
  EXPECT_THAT(std::vector<double>(traction.begin() + 3 * nodes[0], traction.begin() + 3 * nodes[0] + 3),
              Pointwise(DoubleNear(rounding_of_fields), {2.0, 6.0, 0.0}));
  EXPECT_EQ(made.file().find("contact_state_sole"), std::string::npos) << "one contact alone needs no name";
}

TEST(Fields, OfContactWithABodyAreNotThoseOfItsMaster) {
  Scene scene = block(Space::plane_strain);
  scene.bodies.push_back({"base", BoxMesh{{0.0, -1.0}, {4.0, 0.0}, {1, 1}}, LinearElastic{1000, 0.25}, "", 1.0});
  scene.obstacles.clear();
  scene.contacts[0].master = "base.top";
  WrittenFields made(scene);
  auto& state = made.state();
  state.contact.state = {ContactState::slip, ContactState::stick};
  state.contact.traction << -6, 2, -5, 1;
  const auto nodes = made.model().side("block.bottom").nodes;
  const auto code = made.array("contact_state"), pressure = made.array("contact_pressure");
  for (int n = 0; n < 8; ++n) {
    const auto of = [&](double first, double second, double other) {
      return n == nodes[0] ? first : n == nodes[1] ? second : other;
    };
    EXPECT_EQ(code[n], of(2, 1, -1)) << n;
    EXPECT_EQ(pressure[n], of(6, 5, 0)) << n;
  }
}

/// A point between a floor and a wall to its left; its contacts in this order.
Scene corner() {
  Scene s;
  s.legs = {{1, 1}};
  s.bodies = {{"a", PointMesh{{0.0, 0.0}}, GroundedSpring{{{1.0, 0.0}, {0.0, 1.0}}}, "", 1.0}};
  s.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}, {}}, {"wall", Plane{{0.0, 0.0}, {1.0, 0.0}}, {}}};
  s.contacts = {contact("down", "a.node", "floor"), contact("left", "a.node", "wall")};
  s.contacts[0].friction = 0.5;
  s.contacts[1].friction = 0.5;
  return s;
}

TEST(Fields, ANodeInTwoContactsKeepsBoth) {
  const ContactState states[] = {ContactState::open, ContactState::stick, ContactState::slip};
  const int hold[] = {0, 2, 1};
  for (const int first : {0, 1, 2})
    for (const int second : {0, 1, 2}) {
      WrittenFields made(corner());
      auto& state = made.state();
      state.contact.state = {states[first], states[second]};
      state.contact.traction << -6, 2, -4, 1;
      state.contact.gap << 0.5, -0.25;
      const int node = made.model().points[0].nodes[0];
      EXPECT_EQ(made.array("contact_state")[node], hold[first] > hold[second] ? first : second);
      EXPECT_EQ(made.array("contact_state_down")[node], first);
      EXPECT_EQ(made.array("contact_state_left")[node], second);
      EXPECT_EQ(made.array("contact_pressure")[node], 10);
      EXPECT_EQ(made.array("contact_pressure_down")[node], 6);
      EXPECT_EQ(made.array("contact_pressure_left")[node], 4);
      EXPECT_EQ(made.array("gap")[node], -0.25);
      EXPECT_EQ(made.array("gap_down")[node], 0.5);
      const auto traction = made.array("contact_traction");
      // floor: (2, 6); wall, whose tangent is (0, 1): (4, -1)
      EXPECT_THAT(std::vector<double>(traction.begin() + 3 * node, traction.begin() + 3 * node + 3),
                  Pointwise(DoubleNear(rounding_of_fields), {6.0, 5.0, 0.0}));
    }
}

/// A disk pressed and rolled between two plates: every node of its rim is a slave of both.
json disk_between_plates() {
  const auto table = [](double last) { return json{{0, 0}, {1, last}}; };
  return {{"bodies",
           {{"disk",
             {{"mesh", {{"disk", {{"center", {0, 0}}, {"radius", 1}, {"cells", {4, 3}}}}}},
              {"material", {{"linear_elastic", {{"E", 1000}, {"nu", 0.3}}}}}}}}},
          {"obstacles",
           {{"low", {{"plane", {{"point", {0, -1}}, {"normal", {0, 1}}}}}},
            {"top", {{"plane", {{"point", {0, 1}}, {"normal", {0, -1}}}}, {"move", {{"y", table(-0.05)}}}}}}},
          {"contacts",
           {{"under", {{"slave", "disk.arc"}, {"master", "low"}, {"friction", 0.5}}},
            {"over", {{"slave", "disk.arc"}, {"master", "top"}, {"friction", 0.5}}}}},
          {"time", {{"end", 1}, {"steps", 2}}}};
}

TEST(Fields, ADiskBetweenTwoPlatesTouchesBoth) {
  const auto result = cases::run(disk_between_plates(), {{"monolithic_al", json::object()}}, "disk.json");
  ASSERT_TRUE(is_converged(result.status())) << result.message();
  const auto& model = result.problem->model;
  const auto& field = result.steps.back().increment->state.contact;
  int closed = 0;
  double force = 0;
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    closed += field.state[p] != ContactState::open;
    force -= result.problem->slots.geometry[p].area * field.traction[model.points[p].multiplier];
  }
  ASSERT_GE(closed, 2);
  const TemporaryFolder own;
  write_fields(own.path, result, 0);
  const std::string file = read_file(own.path / "fields_0002.vtu");
  const auto state = vtu::array_named(file, "contact_state").values<double>(),
             pressure = vtu::array_named(file, "contact_pressure").values<double>();
  EXPECT_EQ(std::count_if(state.begin(), state.end(), [](double code) { return code > 0; }), closed);
  double shown = 0;
  for (std::size_t p = 0; p < model.points.size() / 2; ++p)
    shown += result.problem->slots.geometry[p].area * pressure[model.points[p].nodes[0]];
  EXPECT_NEAR(shown, force, 1e-12 * force);

  // the picture has a symbol a node, and as many that touch as there are; its rows and the film keep each contact
  const auto plate = report::draw_picture(picture_json(result));
  ASSERT_TRUE(plate);
  const std::string svg = plate->drawing.svg_file();
  int touching = 0;
  for (const char* fill : {"#0072B2", "#E69F00"})
    for (std::size_t at = svg.find(fill); at != std::string::npos; at = svg.find(fill, at + 1)) ++touching;
  EXPECT_EQ(touching, closed + 1) << "one of the legend";
  const auto film = film_json(result);
  int filmed = 0;
  for (const char* name : {"under", "over"}) {
    const std::string letters = film["contacts"][name].back();
    EXPECT_EQ(letters.size(), model.points.size() / 2);
    filmed += static_cast<int>(letters.size() - std::count(letters.begin(), letters.end(), 'o'));
  }
  EXPECT_EQ(filmed, closed);
}

TEST(Fields, APictureHasPlacesStatesAndTractionsOfEachContact) {
  WrittenFields made(corner());
  auto& state = made.state();
  state.displacement << 0.25, 0.5, 0, 0;
  state.contact.state = {ContactState::stick, ContactState::open};
  state.contact.traction << -6, 2, 0, 0;
  const auto picture = picture_json(made.result);
  EXPECT_EQ(picture["contact"][0], (json{{"name", "down"},
                                         {"x", 0.25},
                                         {"y", 0.5},
                                         {"node", made.model().points[0].nodes[0]},
                                         {"state", "stick"},
                                         {"normal", -6.0},
                                         {"tangential", 2.0}}));
  EXPECT_EQ(picture["contact"][1]["name"], "left");
  EXPECT_EQ(picture["contact"][1]["state"], "open");
  EXPECT_EQ(film_json(made.result)["contacts"], (json{{"down", {"k"}}, {"left", {"o"}}}));
}

TEST(Fields, AFrictionlessPointTouchesAndDoesNotSlip) {
  json scene = disk_between_plates();
  scene["contacts"]["under"].erase("friction");
  const auto result = cases::run(scene, {{"monolithic_al", json::object()}}, "disk.json");
  ASSERT_TRUE(is_converged(result.status())) << result.message();
  std::set<std::string> under, over;
  const json picture = picture_json(result), interface = interface_json(result);
  for (const auto& point : picture["contact"])
    (point["name"] == "under" ? under : over).insert(point["state"].get<std::string>());
  EXPECT_TRUE(under.count("closed"));
  EXPECT_FALSE(under.count("slip") || under.count("stick"));
  EXPECT_FALSE(over.count("closed"));
  EXPECT_NE(film_json(result)["contacts"]["under"].back().get<std::string>().find('c'), std::string::npos);
  for (const auto& state : interface["under"]["state"]) EXPECT_NE(state, "slip");
}

/// Of several steps there is the start, and the obstacles in a block of their own that moves with its displacement.
TEST(Fields, OfSeveralStepsHaveTheStartAndTheObstacles) {
  json scene = disk_between_plates();
  scene["obstacles"]["low"]["rotate"] = {{"center", {0, -1}}, {"angle", {{0, 0}, {1, 0.1}}}};
  const auto result = cases::run(scene, {{"monolithic_al", json::object()}}, "disk.json");
  std::map<std::string, std::string> files;
  for_each_field(result, 1, [&](const std::string& name, const std::string& text) { files[name] = text; });
  const std::size_t steps = result.steps.size();
  ASSERT_EQ(files.size(), 2 * (steps + 1) + 1);
  EXPECT_EQ(field_files(result, 1).size(), files.size());
  EXPECT_EQ(vtu::array_named(files["fields_0000.vtu"], "TimeValue").values<double>(), std::vector<double>{0});
  for (const double u : vtu::array_named(files["fields_0000.vtu"], "displacement").values<double>()) EXPECT_EQ(u, 0);
  const std::string last = files["obstacles_000" + std::to_string(steps) + ".vtu"];
  const auto points = vtu::array_named(last, "Points").values<double>();
  const auto moved = vtu::array_named(last, "displacement").values<double>();
  const auto owner = vtu::array_named(last, "obstacle").values<double>();
  ASSERT_EQ(owner, (std::vector<double>{0, 1}));  // a line each
  const double turn = 0.1 * std::acos(-1.0) / 180;
  for (std::size_t i = 0; i < 2; ++i) {  // the low plate, y = -1, turns about (0, -1)
    EXPECT_EQ(points[3 * i + 1], -1);
    EXPECT_NEAR(moved[3 * i + 1], turn * points[3 * i], 1e-15);
    EXPECT_EQ(moved[6 + 3 * i + 1], -0.05);
  }
  EXPECT_NE(files["fields.pvd"].find("part=\"1\" file=\"obstacles_0000.vtu\""), std::string::npos);
  EXPECT_EQ(field_files(result, 0).size(), 2u);  // of the last step alone as ever
}

/// What differs from step to step is in the picture where the steps' fields are kept.
TEST(Fields, APictureHasTheStepsThatWereKept) {
  const auto result = cases::run(disk_between_plates(), {{"monolithic_al", json::object()}}, "disk.json");
  EXPECT_FALSE(picture_json(result).contains("frames"));
  const json picture = picture_json(result, 1);
  ASSERT_EQ(picture["frames"].size(), result.steps.size() + 1);
  EXPECT_EQ(picture["frames"][0]["time"], 0);
  for (const char* part : {"displacement", "von_mises", "contact", "obstacles"})
    EXPECT_EQ(picture["frames"].back()[part], picture[part]) << part;
}

TEST(Fields, APictureSaysWhatItsObstaclesMovedBy) {
  json scene = disk_between_plates();
  scene["obstacles"]["low"]["rotate"] = {{"center", {0, -1}}, {"angle", {{0, 0}, {1, 0.1}}}};
  scene["responses"] = {{"u", {{"displacement", {{"at", {0, 0}}, {"component", "x"}}}}}};
  const auto result = cases::run(scene, {{"monolithic_al", json::object()}}, "disk.json");
  const json picture = picture_json(result);
  const json &low = picture["obstacles"][0]["plane"], &top = picture["obstacles"][1]["plane"];
  EXPECT_EQ(top["point"], (json{0.0, 1.0}));  // where it began
  EXPECT_EQ(top["moved"]["by"], (json{0.0, -0.05}));
  EXPECT_EQ(low["moved"]["degrees"], 0.1);
  EXPECT_EQ(low["moved"]["center"], (json{0.0, -1.0}));
  EXPECT_EQ(picture["responses"], (json{{"u", "displacement"}}));
}

}  // namespace
}  // namespace stickslip
