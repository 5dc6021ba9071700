/// Solids at finite strain against solutions of ordinary differential equations, and their derivatives: a cylinder that
/// is twisted (A25), and hollow balls that are pressed into one another (A21).
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>
#include <span>

#include "core/mesh/sides.hpp"
#include "tests/support/finite_strain.hpp"

namespace stickslip::solid_closed_forms_test {
namespace {

using namespace scenes;
using Kind = Response::Kind;

const NeoHookean rubber{Number(1000), Number(0.3), NeoHookean::Volumetric::log};

/// A generated mesh whose nodes can be named one by one: side "n7" is node 7.
ImportedMesh with_named_nodes(const MeshDescription& description, const std::string& element) {
  ImportedMesh mesh{"", "", make_mesh(description, element, 3), {}};
  mesh.points = make_points<double>(description, mesh.mesh, {});
  mesh.mesh.middles.clear();  // (as read from a file: all places are given)
  mesh.mesh.centres.clear();
  for (int n = 0; n < mesh.mesh.node_count; ++n) mesh.mesh.sides["n" + std::to_string(n)] = {{n}, {}};
  return mesh;
}

// --- A25: a cylinder is twisted, its mantle free ---------------------------------------------------------------------

/// Radius 1, length 1, twisted by `twist`. At both ends nodes move along the radius that turns with them: across it
/// they are held, at the far end where the twist takes them. All of that depends on the parameter "twist".
Scene twisted_cylinder(int cells, const std::string& element, double twist) {
  DiskMesh disk;
  disk.center = {0.0, 0.0};
  disk.radius = 1;
  disk.cells = {cells, cells};
  const ImportedMesh mesh = with_named_nodes(ExtrudedMesh{disk, 0.0, 1.0, cells}, element);
  Scene s;
  s.space = Space::solid;
  s.finite_strain = true;
  s.legs = {{1, 2}};
  s.bodies = {{"bar", mesh, rubber, element, 1.0}};
  Parameter by_twist{"twist", {}, "/twist", twist};
  const auto number = [&](double value, double per_twist) {
    const int slot = static_cast<int>(s.numbers.size());
    s.numbers.push_back(value);
    s.pointers.push_back("/twist/" + std::to_string(slot));
    by_twist.slots.emplace_back(slot, per_twist);
    return Number(value, slot);
  };
  for (const char* end : {"bar.front", "bar.back"}) s.supports.push_back(support(end, {{'z', table({{0, 0.0}})}}));
  for (int n = 0; n < mesh.mesh.node_count; ++n) {
    const Vec<double, 3> X = mesh.points.col(n);
    if (X[2] != 0 && X[2] != 1) continue;
    const std::string node = "bar.n" + std::to_string(n);
    const double R = X.head<2>().norm(), turn = std::atan2(X[1], X[0]) + twist * X[2];
    if (R < 1e-12) {
      s.supports.push_back(support(node, {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}})}}));
    } else if (X[2] == 0) {
      s.supports.push_back({node, {}, {}, Inclined{{-std::sin(turn), std::cos(turn), 0.0}, table({{0, 0.0}})}});
    } else {
      const Number way = number(R * std::sin(twist), R * std::cos(twist));
      s.supports.push_back(
          {node,
           {},
           {},
           Inclined{{number(-std::sin(turn), -std::cos(turn)), number(std::cos(turn), -std::sin(turn)), 0.0},
                    table({{0, 0.0}, {1, way}})}});
    }
  }
  s.parameters = {by_twist};
  s.responses = {response("moment", Kind::reaction, "bar.back", "moment"),
                 response("pull", Kind::reaction, "bar.back", "z"), response("thinner", Kind::displacement, "")};
  s.responses[0].about = {0.0, 0.0, 0.0};
  s.responses[0].moment_axis = {0.0, 0.0, 1.0};
  s.responses[2].on = "bar";
  s.responses[2].at = {1.0, 0.0, 0.0};
  s.responses[2].component = Response::Component::x;
  return s;
}

TEST(TwistedCylinder, HasTheMomentAndThePullOfItsDifferentialEquation) {
  constexpr double twist = 0.5, M = 293.1018574, N = -44.25061745, radius = 0.9878915869;
  constexpr double dM = 551.7411636, dN = -172.9053071;
  std::vector<double> errors;  // the largest of all, relative to the value
  for (const int cells : {1, 2, 3}) {
    const auto s = run(twisted_cylinder(cells, "H27", twist), MonolithicAL{});
    ASSERT_TRUE(is_converged(s.trajectory.status)) << s.trajectory.message;
    const Vec<double, 5> error(s.value("moment") / M - 1, s.value("pull") / N - 1,
                               s.value("thinner") / (radius - 1) - 1, s.derivative("moment", "twist") / dM - 1,
                               s.derivative("pull", "twist") / dN - 1);
    errors.push_back(largest_entry(error));
  }
  // Falls as the third power of the size of elements, or faster.
  EXPECT_LT(errors[1], errors[0] / 4);
  EXPECT_LT(errors[2], errors[1] / 3);
  EXPECT_LT(errors[2], 1e-3);
}

// --- A21: hollow balls in one another --------------------------------------------------------------------------------

/// The eighth of a ball in which no coordinate is negative. Its flat sides are x, y and z.
ImportedMesh eighth(const BallMesh& ball, const std::string& element) {
  const MeshDescription description = ball;
  const Mesh whole = make_mesh(description, element, 3);
  const Points<double> points = make_points<double>(description, whole, {});
  const auto is_inside = [&](std::span<const int> nodes) {
    return std::all_of(nodes.begin(), nodes.end(), [&](int n) { return (points.col(n).array() > -1e-9).all(); });
  };
  std::map<int, int> number;
  const auto renumber = [&](int n) { return number.emplace(n, static_cast<int>(number.size())).first->second; };
  ImportedMesh mesh;
  mesh.mesh.dimension = 3;
  mesh.mesh.shape = whole.shape;
  const int per = nodes_of(whole.shape);
  for (int e = 0; e < whole.element_count(); ++e) {
    const std::span<const int> nodes(whole.connectivity.data() + static_cast<std::ptrdiff_t>(e) * per, per);
    if (!is_inside(nodes)) continue;
    for (const int n : nodes) mesh.mesh.connectivity.push_back(renumber(n));
  }
  for (const char* name : {"surface", "inner"}) {
    const Side& of = whole.sides.at(name);
    Side side;
    const auto keep = [&](const std::vector<std::vector<int>>& faces, std::vector<std::vector<int>>& kept) {
      for (auto face : faces) {
        if (!is_inside(face)) continue;
        for (int& n : face) n = renumber(n);
        kept.push_back(face);
      }
    };
    keep(of.facets, side.facets);
    keep(of.quadratic, side.quadratic);
    std::set<int> nodes;
    for (const auto& face : side.edges()) nodes.insert(face.begin(), face.end());
    side.nodes.assign(nodes.begin(), nodes.end());
    mesh.mesh.sides[name] = side;
  }
  mesh.mesh.node_count = static_cast<int>(number.size());
  mesh.points.resize(3, mesh.mesh.node_count);
  for (const auto& [from, to] : number) mesh.points.col(to) = points.col(from);
  for (int n = 0; n < mesh.mesh.node_count; ++n)
    for (int i = 0; i < 3; ++i)
      if (std::abs(mesh.points(i, n)) < 1e-9) mesh.mesh.sides[std::string(1, "xyz"[i])].nodes.push_back(n);
  return mesh;
}

Scene balls_in_one_another(int cells, const std::string& element) {
  const auto ball = [](double inner, double outer, int around, int layers) {
    BallMesh mesh;
    mesh.center = {0.0, 0.0, 0.0};
    mesh.radius = outer;
    mesh.inner = inner;
    mesh.cells = {around, layers};
    return mesh;
  };
  Scene s;
  s.space = Space::solid;
  s.finite_strain = true;
  s.legs = {{1, 1}};
  NeoHookean core = rubber, shell = rubber;
  core.E = parameter(s, "Ei", 1000);
  shell.E = parameter(s, "Eo", 1000);
  s.bodies = {{"core", eighth(ball(1, 2.1, cells, cells / 2), element), core, element, 1.0},
              {"shell", eighth(ball(2, 4, cells, cells), element), shell, element, 1.0}};
  s.contacts = {contact("fit", "core.surface", "shell.inner")};
  s.contacts[0].smoothing = Smoothing::catmull_rom;
  for (const char* body : {"core.", "shell."})
    for (const char axis : {'x', 'y', 'z'})
      s.supports.push_back(support(std::string(body) + axis, {{axis, table({{0, 0.0}})}}));
  s.responses = {response("inner", Kind::displacement, ""), response("outer", Kind::displacement, ""),
                 response("between", Kind::displacement, "")};
  const auto at = [&](int r, const char* body, double x) {
    s.responses[r].on = body;
    s.responses[r].at = {x, 0.0, 0.0};
    s.responses[r].component = Response::Component::x;
  };
  at(0, "core", 1);
  at(1, "shell", 4);
  at(2, "shell", 2);
  s.responses.push_back(response("push", Kind::contact_force, "fit", "x"));
  return s;
}

TEST(HollowBalls, PressedIntoOneAnotherHaveThePressureOfTheirDifferentialEquation) {
  constexpr double p = 36.42580825, rc = 2.0621175812, ri = 0.9601051796, ro = 4.0236587809;
  const double area = M_PI * rc * rc / 4;  // of the eighth, seen along x
  const auto errors = [&](const Solved& s) {
    Vec<double, 6> error(s.value("inner") / (ri - 1) - 1, s.value("outer") / (ro - 4) - 1,
                         s.value("between") / (rc - 2) - 1, std::abs(s.value("push")) / (p * area) - 1, 0, 0);
    int at = 4;
    const std::map<std::string, double> slopes{{"Ei", 0.0127381100}, {"Eo", 0.0236876983}};
    for (const auto& [modulus, dp] : slopes) {  // push is p pi rc^2 / 4
      const double by_area = 2 * s.derivative("between", modulus) / rc;
      error[at++] = (s.derivative("push", modulus) / s.value("push") - by_area) / (dp / p) - 1;
    }
    return error;
  };
  const auto solve = [](int cells, const Method& method) {
    const auto s = run(balls_in_one_another(cells, "H27"), method);
    EXPECT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << s.trajectory.message;
    return s;
  };
  const Vec<double, 6> coarse = errors(solve(4, MonolithicAL{})), fine = errors(solve(6, MonolithicAL{}));
  EXPECT_LT(largest_entry(coarse), 2e-2);
  EXPECT_LT(largest_entry(fine), largest_entry(coarse) / 2);  // (of second order: 2.25)
  EXPECT_LT(largest_entry(fine), 6e-3);
  for (const Method& method : finite_methods())  // of one mesh, to what the penalty of 1e5 leaves
    EXPECT_LT(largest_entry(errors(solve(4, method)) - coarse), 1e-4) << name_of(method);
}

}  // namespace
}  // namespace stickslip::solid_closed_forms_test
