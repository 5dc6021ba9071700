#include "core/mesh/msh_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <map>
#include <set>
#include <sstream>

#include "core/mesh/quality.hpp"
#include "tests/support/imported.hpp"

namespace stickslip::msh_reader_test {
namespace {

std::string content(const std::string& path) {
  std::ifstream file(std::string(STICKSLIP_SOURCE_DIR) + "/" + path);
  EXPECT_TRUE(file.good()) << path;
  return {std::istreambuf_iterator<char>(file), {}};
}

ImportResult read(const std::string& text) {
  std::istringstream stream(text);
  return read_msh(stream, "mesh.msh");
}

std::string two_blocks(const char* version) {
  return content(std::string("tests/support/meshes/two_blocks_") + version + ".msh");
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

/// Area of the elements, and area the boundary's facets enclose.
std::pair<double, double> areas(const ImportedMesh& body) {
  auto cross = [&](int a, int b) {
    return (body.points(0, a) * body.points(1, b) - body.points(0, b) * body.points(1, a)) / 2;
  };
  const int count = nodes_of(body.mesh.shape);
  double solid = 0, enclosed = 0;
  for (int e = 0; e < body.mesh.element_count(); ++e)
    for (int k = 0; k < count; ++k)
      solid += cross(body.mesh.connectivity[e * count + k], body.mesh.connectivity[e * count + (k + 1) % count]);
  for (const auto& [name, side] : body.mesh.sides)
    for (const auto& facet : side.facets) enclosed += cross(facet[0], facet[1]);
  return {solid, enclosed};
}

/// Two triangles on the unit square in MSH 2.2, for edits by hand. Node 5 belongs to no element, tags are sparse.
const std::string square = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
1 7 "under side"
2 9 "plate"
$EndPhysicalNames
$Nodes
5
10 0 0 0
500 1 0 0
30 1 1 0
4 0 1 0
5 9 9 0
$EndNodes
$Elements
3
1 1 2 7 1 500 10
2 2 2 9 1 10 500 30
3 2 2 9 1 10 30 4
$EndElements
)";

TEST(MshReader, GivesBodiesAndSidesOfASmallFile) {
  const ImportResult result = read(square);
  ASSERT_TRUE(result.errors.empty()) << result.errors.front();
  ASSERT_EQ(result.bodies.size(), 1u);
  const ImportedMesh& plate = result.bodies.front();
  EXPECT_EQ(plate.body, "plate");
  EXPECT_EQ(plate.mesh.shape, ElementShape::tri3);
  EXPECT_EQ(plate.mesh.node_count, 4);  // node 5 is dropped
  EXPECT_EQ(plate.mesh.connectivity, (std::vector<int>{0, 1, 2, 0, 2, 3}));
  // the file has the line from right to left; the solid lies on the left of the other direction
  EXPECT_EQ(plate.mesh.sides.at("under side").nodes, (std::vector<int>{0, 1}));
  EXPECT_EQ(body_error(result, "plate"), "");
  EXPECT_NE(body_error(result, "plaet").find("did you mean \"plate\""), std::string::npos);
}

TEST(MshReader, ReadsQuadraticElementsWithTheMiddlesOfTheirSides) {
  for (const char* version : {"22", "41"}) {
    const ImportResult result = read(content(std::string("tests/support/meshes/quadratic_ring_") + version + ".msh"));
    ASSERT_TRUE(result.errors.empty()) << result.errors.front();
    ASSERT_EQ(result.bodies.size(), 2u);
    const ImportedMesh &quads = result.bodies[0], &triangles = result.bodies[1];
    EXPECT_EQ(quads.mesh.shape, ElementShape::quad8);
    EXPECT_EQ(triangles.mesh.shape, ElementShape::tri6);
    EXPECT_EQ(quads.mesh.element_count(), 8);
    EXPECT_EQ(triangles.mesh.element_count(), 16);
    EXPECT_EQ(quads.mesh.node_count, 15 + 22);  // corners and edges of 2 x 4 cells
    for (const ImportedMesh& body : result.bodies) {
      EXPECT_FALSE(first_inverted_element(body.mesh, body.points));
      const int count = nodes_of(body.mesh.shape), corners = corners_of(body.mesh.shape);
      for (int e = 0; e < body.mesh.element_count(); ++e)
        for (int k = 0; k < corners; ++k) {
          auto at = [&](int i) -> Vec<double, 2> { return body.points.col(body.mesh.connectivity[e * count + i]); };
          const Vec<double, 2> a = at(k), b = at((k + 1) % corners);
          EXPECT_LT((at(corners + k) - 0.5 * (a + b)).norm(), 0.1 * (b - a).norm());  // an arc of 22.5 degrees bows 5 %
        }
      for (const auto& [name, side] : body.mesh.sides) {
        EXPECT_EQ(side.nodes.size(), 9u);
        EXPECT_EQ(side.facets.size(), 8u);
        ASSERT_EQ(side.quadratic.size(), 4u);
        const double radius = name == "inside" ? 1 : name == "between" ? 2 : 3;
        for (int node : side.nodes) EXPECT_NEAR(body.points.col(node).norm(), radius, 1e-9);  // as Gmsh writes them
        const int sign = name == "outside" || (name == "between" && body.body == "quads") ? 1 : -1;
        for (const auto& facet : side.facets) {  // the solid on its left
          const Vec<double, 2> a = body.points.col(facet[0]), b = body.points.col(facet[1]);
          EXPECT_GT(sign * (a[0] * b[1] - a[1] * b[0]), 0);
        }
      }
    }
  }
}

TEST(MshReader, TurnsQuadraticElementsWithTheirMiddles) {
  const std::string six = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
6
1 0 0 0
2 2 0 0
3 0 2 0
4 1 0 0
5 1 1 0
6 0 1 0
$EndNodes
$Elements
2
1 8 2 7 1 1 2 4
2 9 2 9 1 NODES
$EndElements
)";
  const ImportResult left = read(replaced(six, "NODES", "1 2 3 4 5 6")),
                     right = read(replaced(six, "NODES", "1 3 2 6 5 4"));
  ASSERT_TRUE(left.errors.empty() && right.errors.empty());
  EXPECT_EQ(left.bodies[0].mesh.connectivity, (std::vector<int>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(right.bodies[0].mesh.connectivity, left.bodies[0].mesh.connectivity);
  EXPECT_EQ(right.bodies[0].mesh.sides.at("7").quadratic, (std::vector<std::vector<int>>{{0, 1, 3}}));
  // a side without the middle, or with another, is no side of the element
  for (const char* line : {"1 1 2 7 1 1 2", "1 8 2 7 1 1 2 5"}) {
    const ImportResult wrong = read(replaced(replaced(six, "NODES", "1 2 3 4 5 6"), "1 8 2 7 1 1 2 4", line));
    EXPECT_TRUE(wrong.bodies.empty() || wrong.bodies[0].mesh.sides.empty());
    EXPECT_FALSE(wrong.errors.empty() && wrong.notes.empty());
  }
  // middles in another order, and one that is moved along its edge: corners are sound
  const ImportResult shuffled = read(replaced(six, "NODES", "1 2 3 5 6 4")),
                     moved = read(replaced(replaced(six, "NODES", "1 2 3 4 5 6"), "4 1 0 0", "4 1.8 0 0"));
  ASSERT_EQ(shuffled.errors.size(), 1u);
  EXPECT_THAT(
      shuffled.errors[0],
      testing::HasSubstr("its corners are sound, but the node at (1, 0) is 70.7107 % of its edge's length away"));
  ASSERT_EQ(moved.errors.size(), 1u);
  EXPECT_THAT(moved.errors[0], testing::HasSubstr("the node at (1.8, 0) is 40 % of its edge's length away"));
}

TEST(MshReader, GivesTheSameFromBothVersions) {
  const ImportResult a = read(two_blocks("22")), b = read(two_blocks("41"));
  expect_same_bodies(a, b);
  EXPECT_EQ(a.bodies.size(), 2u);
}

TEST(MshReader, DirectsAndOrdersTheSidesOfEachBody) {
  const ImportResult result = read(two_blocks("41"));
  const ImportedMesh &quads = result.bodies[0], &triangles = result.bodies[1];
  EXPECT_EQ(quads.mesh.shape, ElementShape::quad4);
  EXPECT_EQ(triangles.mesh.shape, ElementShape::tri3);
  EXPECT_FALSE(first_inverted_element(quads.mesh, quads.points));
  EXPECT_EQ(quads.mesh.element_count(), 8);
  EXPECT_EQ(triangles.mesh.sides.count("bottom"), 0u);
  EXPECT_EQ(quads.mesh.sides.at("corner").nodes.size(), 1u);

  // shared: from right to left on the block below, from left to right on the one above, between x = 0 and 2
  const Side &below = quads.mesh.sides.at("shared"), &above = triangles.mesh.sides.at("shared");
  ASSERT_EQ(below.nodes.size(), 5u);
  ASSERT_EQ(above.nodes.size(), 5u);
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(quads.points.col(below.nodes[i]), triangles.points.col(above.nodes[4 - i]));
    if (i == 0) continue;
    EXPECT_LT(quads.points(0, below.nodes[i]), quads.points(0, below.nodes[i - 1]));
    EXPECT_EQ(below.facets[i - 1], (std::vector<int>{below.nodes[i - 1], below.nodes[i]}));
  }
  // a closed curve lists each node once and has a facet back to its beginning, clockwise round the hole
  const Side& hole = triangles.mesh.sides.at("hole");
  EXPECT_EQ(hole.nodes.size(), hole.facets.size());
  EXPECT_EQ(hole.facets.back()[1], hole.facets.front()[0]);
  double turned = 0;
  for (const auto& f : hole.facets)
    turned +=
        triangles.points(0, f[0]) * triangles.points(1, f[1]) - triangles.points(0, f[1]) * triangles.points(1, f[0]);
  EXPECT_LT(turned, 0);
  EXPECT_EQ(result.notes,
            std::vector<std::string>{"physical curve \"apart\" is not on a body; an obstacle may have its "
                                     "shape (mesh_side)"});
}

TEST(MshReader, ReordersACurveWhoseElementsAreShuffledAndTurned) {
  const std::string text = replaced(square, "$Elements\n3\n1 1 2 7 1 500 10",
                                    "$Elements\n5\n1 1 2 7 1 4 30\n8 1 2 7 1 500 10\n9 1 2 7 1 500 30");
  const ImportResult result = read(text);
  ASSERT_TRUE(result.errors.empty()) << result.errors.front();
  EXPECT_EQ(result.bodies[0].mesh.sides.at("under side").nodes, (std::vector<int>{0, 1, 2, 3}));
}

TEST(MshReader, TurnsABodyThatIsClockwiseAsAWhole) {
  std::string text = replaced(square, "10 500 30", "10 30 500");
  text = replaced(text, "10 30 4\n", "10 4 30\n");
  const ImportResult result = read(text);
  ASSERT_TRUE(result.errors.empty()) << result.errors.front();
  EXPECT_FALSE(first_inverted_element(result.bodies[0].mesh, result.bodies[0].points));
  EXPECT_EQ(result.bodies[0].mesh.sides.at("under side").nodes, (std::vector<int>{0, 1}));
}

TEST(MshReader, NamesAGroupWithoutANameByItsNumber) {
  const ImportResult result = read(replaced(square, "2\n1 7 \"under side\"\n2 9 \"plate\"", "0"));
  ASSERT_TRUE(result.errors.empty()) << result.errors.front();
  EXPECT_EQ(result.bodies[0].body, "9");
  EXPECT_EQ(result.bodies[0].mesh.sides.count("7"), 1u);
}

TEST(MshReader, AcceptsLineEndsOfAnySystemAndUnknownSections) {
  std::string text = "$MeshFormat\r\n2.2 0 8\r\n$EndMeshFormat\r\n$Comments\nNodes of $Nodes 12\n$EndComments\n";
  text += square.substr(square.find("$PhysicalNames"));
  EXPECT_TRUE(read(text).errors.empty());
}

struct Broken {
  std::string from, to;     // edit of the small file
  std::string line_column;  // where the fault is
  std::string part;         // of the message
};

TEST(MshReader, SaysWhereAndWhatIsWrongWithABrokenFile) {
  const std::vector<Broken> cases = {
      {"$MeshFormat\n2.2", "MeshFormat\n2.2", "1:1", "begins with $MeshFormat"},
      {"2.2 0 8", "2.1 0 8", "2:1", "version \"2.1\" of the format is not read, only 2.2 and 4.1"},
      {"2.2 0 8", "2.2 1 8", "2:5", "binary, only ASCII is read; \"gmsh mesh.msh -save"},
      {"$Nodes\n5", "$Nodes\n6", "16:1", "fewer entries than announced"},
      {"$Nodes\n5", "$Nodes\n4", "15:1", "$EndNodes should stand here, after the 4 nodes"},
      {"$Nodes\n5", "$Nodes\n-5", "10:1", "negative"},
      {"$Elements\n3", "$Elements\n4", "22:1", "fewer entries"},
      {"500 1 0 0", "500 1 0x 0", "12:7", "a number; found \"0x\""},
      {"500 1 0 0", "500 inf 0 0", "12:5", "not finite"},
      {"30 1 1 0", "500 1 1 0", "13:1", "node 500 appears twice"},
      {"10 500 30", "10 500 31", "20:18", "element 2 has node 31"},
      {"2 2 2 9 1 10 500 30", "2 10 2 9 1 10 500 30 4 10 500 30 4 10", "20:1",
       "element 2 of body \"plate\" is a 9-node quadrangle"},
      {"2 2 2 9 1 10 500 30", "2 4 2 9 1 10 500 30 4", "20:1", "element 2 is of a mesh in space"},
      {"3 2 2 9 1 10 30 4", "3 3 2 9 1 10 500 30 4", "21:1", "mixes elements of unlike kinds, from element 3"},
      {"10 30 4\n", "10 4 30\n", "21:1", "element 3 of body \"plate\" is turned against the others"},
      {"10 30 4\n", "10 30 10\n", "21:1", "element 3 of body \"plate\" is degenerate"},
      {"30 1 1 0", "30 1 1 0.5", "20:1", "plane z = constant"},
      {"\"under side\"", "under side", "6:5", "in double quotes"},
      {"\"plate\"", "\"plate", "7:5", "not closed"},
      {"$EndElements\n", "", "22:1", "truncated"},
  };
  for (const Broken& broken : cases) {
    const ImportResult result = read(replaced(square, broken.from, broken.to));
    ASSERT_FALSE(result.errors.empty()) << broken.to;
    const std::string& error = result.errors.front();
    EXPECT_EQ(error.rfind("mesh.msh:" + broken.line_column + ": ", 0), 0u) << broken.to << "\n" << error;
    EXPECT_NE(error.find(broken.part), std::string::npos) << broken.to << "\n" << error;
  }
}

TEST(MshReader, SaysWhatExistsWhenNoSurfaceIsPhysical) {
  std::string text = replaced(square, "2 2 2 9", "2 2 2 0");
  text = replaced(text, "3 2 2 9", "3 2 2 0");
  const ImportResult result = read(text);
  EXPECT_TRUE(result.errors.empty());
  EXPECT_NE(result.no_body.find("2 plane elements in no physical surface"), std::string::npos) << result.no_body;
  EXPECT_NE(result.no_body.find("curve \"under side\""), std::string::npos) << result.no_body;
  ASSERT_EQ(result.loose.size(), 1u);  // the curve, which an obstacle may have the shape of
  const Side& side = result.loose[0].mesh.sides.at("under side");
  EXPECT_EQ(result.loose[0].mesh.element_count(), 0);
  for (const auto& facet : side.facets)
    for (const int node : facet) EXPECT_EQ(result.loose[0].points(1, node), 0);
}

TEST(MshReader, RefusesTwoBodiesOfOneNameAndACurveThatIsOnlyInPartOnABody) {
  std::string text = replaced(square, "2\n1 7 \"under side\"", "3\n2 8 \"plate\"\n1 7 \"under side\"");
  EXPECT_NE(read(replaced(text, "3 2 2 9", "3 2 2 8")).errors.at(0).find("two physical surfaces"), std::string::npos);
  text = replaced(square, "$Elements\n3", "$Elements\n4\n17 1 2 7 1 500 4");
  EXPECT_NE(read(text).errors.at(0).find("mesh.msh:19:1: element 17 of physical curve \"under side\""),
            std::string::npos);
}

TEST(MshReader, SurvivesAFileCutOffAnywhere) {
  for (const char* version : {"22", "41"}) {
    const std::string whole = two_blocks(version);
    const std::string end = "$EndElements";
    for (std::size_t length = 0; length < whole.find(end) + end.size(); length += 97) {
      const ImportResult result = read(whole.substr(0, length));
      EXPECT_FALSE(result.errors.empty()) << version << " cut at " << length;
    }
  }
}

TEST(MshReader, SurvivesAnyFlippedBit) {
  for (const char* version : {"22", "41"}) {
    const std::string whole = two_blocks(version);
    int refused = 0;
    for (std::size_t at = 0; at < whole.size(); ++at) {
      std::string text = whole;
      text[at] ^= static_cast<char>(1 << at % 8);
      const ImportResult result = read(text);
      refused += !result.errors.empty();
      for (const ImportedMesh& body : result.bodies)  // whatever it understood can be used
        EXPECT_FALSE(first_inverted_element(body.mesh, body.points)) << version << " byte " << at;
    }
    EXPECT_GT(refused, static_cast<int>(whole.size()) / 4) << version;  // most bytes matter; digits of coordinates less
  }
}

TEST(MshReader, SurvivesCountsThatAreEnormous) {
  for (const char* count : {"9223372036854775807", "4000000000", "99999999999999999999"}) {
    EXPECT_FALSE(read(replaced(square, "$Nodes\n5", std::string("$Nodes\n") + count)).errors.empty());
    EXPECT_FALSE(read(replaced(square, "$Elements\n3", std::string("$Elements\n") + count)).errors.empty());
    EXPECT_FALSE(read(replaced(square, "1 1 2 7", std::string("1 1 ") + count + " 7")).errors.empty());
  }
}

TEST(HalfDisksForTheStudies, MatchNodeByNodeAndResolveTheContact) {
  const ImportResult result = read(content("studies/meshes/two_half_disks.msh"));
  ASSERT_TRUE(result.errors.empty()) << result.errors.front();
  ASSERT_EQ(result.bodies.size(), 2u);
  const ImportedMesh &upper = result.bodies[0], &lower = result.bodies[1];
  ASSERT_EQ(upper.body, "upper");
  ASSERT_EQ(lower.body, "lower");
  EXPECT_EQ(upper.points.row(0), lower.points.row(0));
  EXPECT_EQ(upper.points.row(1), -lower.points.row(1));
  std::set<std::pair<double, double>> all;
  for (Eigen::Index i = 0; i < upper.points.cols(); ++i) all.insert({upper.points(0, i), upper.points(1, i)});
  for (const auto& [x, y] : all) EXPECT_EQ(all.count({-x, y}), 1u) << x << " " << y;

  std::vector<int> contact = upper.mesh.sides.at("upper_contact").nodes;
  std::vector<int> partner = lower.mesh.sides.at("lower_contact").nodes;
  std::reverse(partner.begin(), partner.end());
  EXPECT_EQ(contact, partner);
  ASSERT_EQ(contact.size(), 77u);
  for (std::size_t i = 0; i < contact.size(); ++i) {
    const Vec<double, 2> at = upper.points.col(contact[i]);
    EXPECT_NEAR((at - Vec<double, 2>(0, 8)).norm(), 8, 64 * std::numeric_limits<double>::epsilon());  // on the circle
    if (i == 0) continue;
    EXPECT_LT((at - upper.points.col(contact[i - 1])).norm(), 0.68 / 20);  // 20 in Hertz's half width
  }
  EXPECT_EQ(upper.points.col(contact[38]), (Vec<double, 2>(0, 0)));
  for (const ImportedMesh& body : result.bodies) {
    EXPECT_FALSE(first_inverted_element(body.mesh, body.points));
    const auto [solid, enclosed] = areas(body);
    EXPECT_NEAR(solid, enclosed, 1e-12 * solid);             // rounding of some ten thousand products
    EXPECT_NEAR(solid, std::acos(-1.0) * 32, 0.01 * solid);  // a polygon with chords up to a tenth of the radius
  }
}

TEST(HalfDisksForTheStudies, HaveACoarseOneInTheOlderFormat) {
  const ImportResult result = read(content("studies/meshes/half_disk_coarse.msh"));
  ASSERT_TRUE(result.errors.empty()) << result.errors.front();
  const ImportedMesh& disk = result.bodies.at(0);
  const int pole = disk.mesh.sides.at("pole").nodes.at(0);
  EXPECT_EQ(disk.points.col(pole), (Vec<double, 2>(0, 0)));
  const std::vector<int>& arc = disk.mesh.sides.at("arc").nodes;
  EXPECT_EQ(std::count(arc.begin(), arc.end(), pole), 1);
  EXPECT_LT(disk.points(0, arc.front()), 0);  // counter-clockwise: from left to right over the pole
  EXPECT_GT(disk.points(0, arc.back()), 0);
}

}  // namespace
}  // namespace stickslip::msh_reader_test
