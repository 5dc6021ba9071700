/// Bodies in space from files of Gmsh: their elements, their sides, and every fault where it is.
#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>

#include "core/mesh/generators.hpp"
#include "core/mesh/msh_reader.hpp"
#include "core/mesh/quality.hpp"
#include "core/mesh/sides.hpp"
#include "core/mesh/split.hpp"
#include "tests/support/imported.hpp"
#include "tests/support/volumes.hpp"

namespace stickslip::msh_solids_test {
namespace {

constexpr double pi = 3.14159265358979323846;

ImportResult read(const std::string& text, int dimension = 3) {
  std::istringstream stream(text);
  return read_msh(stream, "mesh.msh", dimension);
}

std::string content(const char* version) {
  std::ifstream file(std::string(STICKSLIP_SOURCE_DIR "/tests/support/meshes/solids_") + version + ".msh");
  EXPECT_TRUE(file.good());
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(MshSolids, AreTheSameFromBothVersions) {
  const ImportResult a = read(content("22")), b = read(content("41"));
  expect_same_bodies(a, b);
  EXPECT_TRUE(a.notes.empty());
  EXPECT_EQ(a.bodies.size(), 3u);
}

TEST(MshSolids, FillTheirVolumesAndHaveSidesThatFaceOutward) {
  const ImportResult result = read(content("22"));
  const ImportedMesh &block = result.bodies.at(0), &cylinder = result.bodies.at(1), &ball = result.bodies.at(2);
  EXPECT_EQ(block.mesh.shape, ElementShape::hex8);
  EXPECT_EQ(block.mesh.element_count(), 16);
  EXPECT_EQ(block.mesh.node_count, 5 * 3 * 3);
  EXPECT_NEAR(volume(block.mesh, block.points), 2, 1e-12);  // as Gmsh writes coordinates
  EXPECT_EQ(ball.mesh.shape, ElementShape::tet4);
  for (const ImportedMesh* body : {&block, &cylinder, &ball}) {
    EXPECT_EQ(body->mesh.dimension, 3);
    EXPECT_FALSE(first_inverted_element(body->mesh, body->points));
    EXPECT_LE(vector_area(body->points, boundary_of(body->mesh)).norm(), 1e-12) << body->body;  // it is closed
  }
  // the vector area of the sides: a unit square, a polygon in a circle
  EXPECT_LE((vector_area(block.points, block.mesh.sides.at("left")) - Vec<double, 3>(-1, 0, 0)).norm(), 1e-12);
  const Vec<double, 3> foot = vector_area(cylinder.points, cylinder.mesh.sides.at("foot"));
  EXPECT_NEAR(foot[2], -pi / 4, 0.15);
  EXPECT_LE(foot.head<2>().norm(), 1e-12);
  for (const auto& facet : cylinder.mesh.sides.at("mantle").facets) {
    Vec<double, 3> middle = Vec<double, 3>(-4, 0, -0.5);
    for (const int node : facet) middle += cylinder.points.col(node) / 3;
    EXPECT_GT(vector_area(cylinder.points, {{}, {facet}}).dot(Vec<double, 3>(middle[0], middle[1], 0)), 0);
  }
  EXPECT_EQ(ball.mesh.sides.at("sphere").facets.size(), boundary_of(ball.mesh).facets.size());
  for (const auto& facet : ball.mesh.sides.at("sphere").facets)
    EXPECT_GT(vector_area(ball.points, {{}, {facet}}).dot(ball.points.col(facet[0]) - Vec<double, 3>(7, 0, 1)), 0);
}

TEST(MshSolids, HaveASideInsideAsTheFileDirectsItAndCurvesAndPointsAsNodes) {
  const ImportResult result = read(content("41"));
  const ImportedMesh& block = result.bodies.at(0);
  const Side &inside = block.mesh.sides.at("inside"), &edge = block.mesh.sides.at("edge");
  EXPECT_EQ(inside.facets.size(), 4u);
  EXPECT_EQ(inside.nodes.size(), 9u);
  EXPECT_NEAR(std::abs(vector_area(block.points, inside)[0]), 1, 1e-12);
  EXPECT_EQ(edge.nodes.size(), 3u);
  EXPECT_TRUE(edge.facets.empty());
  EXPECT_EQ(block.points.col(edge.nodes[1]), (Vec<double, 3>(0, 0.5, 0)));  // from one end to the other
  EXPECT_EQ(block.mesh.sides.at("corner").nodes.size(), 1u);
  EXPECT_EQ(block.mesh.sides.count("foot"), 0u);
}

/// Two cubes side by side along x, a face, an edge and a point, in MSH 2.2, for edits by hand.
const std::string cubes = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
4
0 4 "corner"
1 1 "edge"
2 2 "bottom"
3 3 "block"
$EndPhysicalNames
$Nodes
12
1 0 0 0
2 1 0 0
3 2 0 0
4 0 1 0
5 1 1 0
6 2 1 0
7 0 0 1
8 1 0 1
9 2 0 1
10 0 1 1
11 1 1 1
12 2 1 1
$EndNodes
$Elements
6
1 15 2 4 1 1
2 1 2 1 1 1 2
3 3 2 2 1 1 2 5 4
4 3 2 2 1 2 3 6 5
5 5 2 3 1 1 2 5 4 7 8 11 10
6 5 2 3 1 2 3 6 5 8 9 12 11
$EndElements
)";

TEST(MshSolids, TurnFacesOfAFileOutwardAndABodyThatIsLeftHanded) {
  const ImportResult right = read(cubes);
  ASSERT_TRUE(right.errors.empty()) << right.errors.front();
  const Mesh& mesh = right.bodies[0].mesh;
  const std::set<std::vector<int>> facets{{0, 3, 4, 1}, {1, 4, 5, 2}};  // in the file they look into the body
  EXPECT_EQ(std::set(mesh.sides.at("bottom").facets.begin(), mesh.sides.at("bottom").facets.end()), facets);
  std::string text = replaced(cubes, "1 1 2 5 4 7 8 11 10", "1 7 8 11 10 1 2 5 4");
  text = replaced(text, "1 2 3 6 5 8 9 12 11", "1 8 9 12 11 2 3 6 5");
  const ImportResult left = read(text);
  ASSERT_TRUE(left.errors.empty()) << left.errors.front();
  EXPECT_EQ(left.bodies[0].mesh.connectivity, mesh.connectivity);
}

TEST(MshSolids, LeaveSurfacesLooseThatAreOnNoBody) {
  const auto end = cubes.find("5 5 2 3");
  const std::string faces = replaced(cubes.substr(0, end) + cubes.substr(cubes.find("$EndElements")), "s\n6", "s\n4");
  const ImportResult result = read(faces);
  EXPECT_TRUE(result.errors.empty() && result.bodies.empty());
  ASSERT_EQ(result.loose.size(), 1u);
  const ImportedMesh& loose = result.loose[0];
  EXPECT_EQ(loose.mesh.element_count(), 0);
  EXPECT_EQ(loose.points.cols(), 6);  // those of its faces alone
  // directed as in the file: 1 2 5 4 and 2 3 6 5 are counter-clockwise seen from above
  EXPECT_LE((vector_area(loose.points, loose.mesh.sides.at("bottom")) - Vec<double, 3>(0, 0, 2)).norm(), 1e-15);
}

struct Broken {
  std::string from, to;     // edit of the small file
  std::string line_column;  // where the fault is
  std::string part;         // of the message
};

TEST(MshSolids, SayWhereAndWhatIsWrong) {
  const std::string six = "6 5 2 3 1 2 3 6 5 8 9 12 11";
  const std::vector<Broken> cases = {
      {six, "6 4 2 3 1 2 3 6 8", "33:1", "body \"block\" mixes elements of unlike kinds, from element 6"},
      {six, "6 5 2 3 1 8 9 12 11 2 3 6 5", "33:1", "element 6 of body \"block\" is turned against the others"},
      {six, "6 5 2 3 1 2 3 6 5 8 9 12 2", "33:1", "element 6 of body \"block\" is degenerate"},
      {"12 2 1 1", "12 1.2 0.2 0.2", "33:1", "element 6 of body \"block\" is degenerate: a corner is flat or turns"},
      {"9 2 0 1", "9 2 0 inf", "21:7", "not finite"},
      {six, "6 6 2 3 1 2 3 6 8 9 12", "33:3", "type 6 (6-node prism), which is not read; plane bodies of 3- or"},
      {six, "6 18 2 3 1 2 3 6 8 9 12 1 1 1 1", "33:3", "bodies in space of 4- or 10-node tetrahedra or 8-, 20- or 27-"},
      {six, "6 11 2 3 1 2 3 6 8 9 12 1 1 1 1", "33:1", "body \"block\" mixes elements of unlike kinds, from element 6"},
      {"$Elements\n6", "$Elements\n7\n7 5 2 3 1 2 5 4 1 8 11 10 7", "33:1",
       "element 5 of body \"block\" has the same nodes as element 7 of line 28"},
      {"$Elements\n6", "$Elements\n7\n7 5 2 3 1 1 3 6 4 7 9 12 10", "33:1",
       "element 5 of body \"block\" overlaps element 7 of line 28"},
      {"$Elements\n6", "$Elements\n7\n7 3 2 2 1 5 4 1 2", "31:1",
       "element 3 of physical surface \"bottom\" has the same nodes as element 7 of line 28"},
      {"$Elements\n6", "$Elements\n7\n7 1 2 1 1 2 1", "30:1",
       "element 2 of physical curve \"edge\" has the same nodes as element 7"},
      {"3 3 2 2 1 1 2 5 4", "3 3 2 2 1 1 2 5 7", "30:1", "element 3 of physical surface \"bottom\" is no face, edge"},
      {"3 3 2 2 1 1 2 5 4", "3 2 2 2 1 1 2 5", "30:1", "element 3 of physical surface \"bottom\" is no face, edge"},
      {"2 1 2 1 1 1 2", "2 1 2 2 1 1 3", "", ""},  // wholly off the body: a note
      {"1 1 \"edge\"", "1 1 \"bottom\"", "30:1", "two physical groups on body \"block\" have the name \"bottom\""},
      {"3 3 \"block\"", "3 3 \"block", "9:5", "not closed"},
  };
  for (const Broken& broken : cases) {
    const ImportResult result = read(replaced(cubes, broken.from, broken.to));
    if (broken.line_column.empty()) {
      EXPECT_TRUE(result.errors.empty()) << broken.to;
      EXPECT_EQ(result.notes, std::vector<std::string>{"physical curve \"2\" is not on a body"});
      continue;
    }
    ASSERT_FALSE(result.errors.empty()) << broken.to;
    const std::string& error = result.errors.front();
    EXPECT_EQ(error.rfind("mesh.msh:" + broken.line_column + ": ", 0), 0u) << broken.to << "\n" << error;
    EXPECT_NE(error.find(broken.part), std::string::npos) << broken.to << "\n" << error;
  }
}

TEST(MshSolids, RefuseAFileOfTheOtherSpaceAndOneWithoutABody) {
  const auto only_error = [](const ImportResult& result) {
    EXPECT_EQ(result.errors.size(), 1u);
    return result.errors.empty() ? "" : result.errors[0];
  };
  std::string error = only_error(read(cubes, 2));
  EXPECT_EQ(error.rfind("mesh.msh:32:1: element 5 is of a mesh in space", 0), 0u) << error;
  EXPECT_NE(error.find("\"space\": \"solid\" takes this mesh"), std::string::npos) << error;
  const auto end = cubes.find("5 5 2 3");
  const std::string faces = replaced(cubes.substr(0, end) + cubes.substr(cubes.find("$EndElements")), "s\n6", "s\n4");
  error = read(faces).no_body;
  EXPECT_NE(error.find("give its volume a physical name and mesh it"), std::string::npos) << error;
  EXPECT_TRUE(read(faces, 2).errors.empty() && read(faces, 2).no_body.empty());
  error = read(replaced(replaced(cubes, "5 5 2 3", "5 5 2 0"), "6 5 2 3", "6 5 2 0")).no_body;
  EXPECT_NE(
      error.find("2 solid elements in no physical volume and the physical groups: point \"corner\", curve \"edge\", "
                 "surface \"bottom\""),
      std::string::npos)
      << error;
  error = mesh_fault(read(cubes).bodies.at(0), "", 2);
  EXPECT_NE(error.find("body block fills space"), std::string::npos) << error;
}

TEST(MshSolids, NoteNodesAtOnePlaceAndRefuseElementsWithoutDigits) {
  const std::string apart =
      replaced(replaced(cubes, "$Nodes\n12", "$Nodes\n13\n13 1 0 0"), "1 2 3 6 5 8", "1 13 3 6 5 8");
  const ImportResult slit = read(replaced(apart, "4 3 2 2 1 2 3 6 5\n", "4 3 2 2 1 13 3 6 5\n"));
  ASSERT_TRUE(slit.errors.empty()) << slit.errors[0];
  ASSERT_EQ(slit.notes.size(), 1u);
  EXPECT_NE(slit.notes[0].find("nodes 13 and 2 of body \"block\" are at one place"), std::string::npos)
      << slit.notes[0];
  std::string thin = cubes;
  for (const char* node : {"3 2 0 0", "6 2 1 0", "9 2 0 1", "12 2 1 1"}) {
    const std::string to = std::string(node).replace(std::string(node).find(" 2 "), 3, " 1.00000000000004 ");
    thin = replaced(thin, std::string("\n") + node, "\n" + to);
  }
  const ImportResult result = read(thin);
  ASSERT_EQ(result.errors.size(), 1u);
  EXPECT_NE(result.errors[0].find("element 6 of body \"block\" is 3.9968e-14 thick"), std::string::npos)
      << result.errors[0];
}

TEST(MshSolids, TakeTheElementsOfTheFileAlone) {
  const ImportResult result = read(content("22"));
  for (const char* element : {"", "H8", "H8_mean_dilatation"}) EXPECT_EQ(mesh_fault(result.bodies[0], element, 3), "");
  EXPECT_EQ(mesh_fault(result.bodies[2], "T4", 3), "");
  EXPECT_EQ(mesh_fault(result.bodies[0], "T4", 3), "body block is made of H8, not T4");
  EXPECT_EQ(mesh_fault(result.bodies[2], "H8_mean_dilatation", 3), "body ball is made of T4, not H8_mean_dilatation");
}

TEST(MshSolids, SurviveAFileCutOffAnywhereAndAnyFlippedBit) {
  for (const char* version : {"22", "41"}) {
    const std::string whole = content(version);
    for (std::size_t length = 0; length < whole.find("$EndElements") + 12; length += 997)
      EXPECT_FALSE(read(whole.substr(0, length)).errors.empty()) << version << " cut at " << length;
  }
  int refused = 0;
  for (std::size_t at = 0; at < cubes.size(); ++at) {
    std::string text = cubes;
    text[at] ^= static_cast<char>(1 << at % 8);
    const ImportResult result = read(text);
    refused += !result.errors.empty();
    for (const ImportedMesh& body : result.bodies)  // whatever it understood can be used
      EXPECT_FALSE(first_inverted_element(body.mesh, body.points)) << "byte " << at;
  }
  EXPECT_GT(refused, static_cast<int>(cubes.size()) / 4);
}

// --- elements with middles -------------------------------------------------------------------------------------------

/// Corners around each node after the corners, in the order of Gmsh's manual, "Node ordering".
const std::vector<std::set<int>>& order_of_gmsh(ElementShape shape) {
  static const std::vector<std::set<int>> tetrahedron{{0, 1}, {1, 2}, {2, 0}, {3, 0}, {3, 2}, {3, 1}};
  static const std::vector<std::set<int>> edges{{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 5}, {2, 3},
                                                {2, 6}, {3, 7}, {4, 5}, {4, 7}, {5, 6}, {6, 7}};
  static const std::vector<std::set<int>> all = [] {
    auto nodes = edges;
    nodes.insert(
        nodes.end(),
        {{0, 3, 2, 1}, {0, 1, 5, 4}, {0, 4, 7, 3}, {1, 2, 6, 5}, {2, 3, 7, 6}, {4, 5, 6, 7}, {0, 1, 2, 3, 4, 5, 6, 7}});
    return nodes;
  }();
  return shape == ElementShape::tet10 ? tetrahedron : shape == ElementShape::hex20 ? edges : all;
}

/// A block of 2 x 1 x 1 cells that no plane bounds, of quadratic elements.
ImportedMesh bent_block(const std::string& element) {
  BoxMesh box;
  box.min = {0.0, 0.0, 0.0};
  box.max = {2.0, 1.0, 1.0};
  box.cells = {2, 1, 1};
  ImportedMesh block{"", "block", make_mesh(box, element, 3), {}, {}};
  block.points = make_points<double>(box, block.mesh, {});
  for (Eigen::Index n = 0; n < block.points.cols(); ++n) {
    const Vec<double, 3> x = block.points.col(n);
    block.points.col(n) += 0.0625 * Vec<double, 3>(x[1] * x[2], x[0] * x[0] - x[2], x[0] * x[1]);  // no digits are lost
  }
  return block;
}

std::string in_numbers(const std::vector<int>& nodes) {
  std::string text;
  for (const int node : nodes) text += " " + std::to_string(node + 1);
  return text;
}

/// The block as Gmsh would write it, with its bottom, the edge from (0, 0, 0) along y, and its first corner.
std::string written(const ImportedMesh& block, bool version_4) {
  const ElementShape shape = block.mesh.shape;
  const auto& around = corners_around(shape);
  const int count = nodes_of(shape), corners = corners_of(shape);
  std::ostringstream nodes, coordinates;
  for (auto* to : {&nodes, &coordinates}) to->precision(17);
  for (int n = 0; n < block.mesh.node_count; ++n) {
    nodes << n + 1 << (version_4 ? "\n" : " ");
    std::ostringstream& to = version_4 ? coordinates : nodes;
    for (int i = 0; i < 3; ++i) to << block.points(i, n) << (i < 2 ? " " : "\n");
  }
  std::vector<std::string> solids, faces;
  for (int e = 0; e < block.mesh.element_count(); ++e) {
    const int* own = block.mesh.connectivity.data() + e * count;
    std::vector<int> list(own, own + corners);
    for (const auto& of : order_of_gmsh(shape))
      for (int a = corners; a < count; ++a)
        if (std::set<int>(around[a].begin(), around[a].end()) == of) list.push_back(own[a]);
    EXPECT_EQ(static_cast<int>(list.size()), count);
    solids.push_back(in_numbers(list));
  }
  for (const auto& face : block.mesh.sides.at("bottom").quadratic) faces.push_back(in_numbers(face));
  const auto edge = evaluate_side(block.mesh, "left & bottom").nodes;  // ascending: two corners and a middle
  const int solid = shape == ElementShape::tet10   ? 11
                    : shape == ElementShape::hex20 ? 17
                                                   : 12,
            face = shape == ElementShape::tet10   ? 9
                   : shape == ElementShape::hex20 ? 16
                                                  : 10;
  std::ostringstream text;
  text << "$MeshFormat\n"
       << (version_4 ? "4.1" : "2.2") << " 0 8\n$EndMeshFormat\n$PhysicalNames\n4\n0 4 \"corner\"\n"
       << "1 3 \"edge\"\n2 2 \"bottom\"\n3 1 \"block\"\n$EndPhysicalNames\n";
  const auto total = solids.size() + faces.size() + 2;
  if (version_4) {
    text << "$Entities\n1 1 1 1\n1 0 0 0 1 4\n1 0 0 0 1 1 1 1 3 0\n1 0 0 0 1 1 1 1 2 0\n1 0 0 0 2 1 1 1 1 0\n"
         << "$EndEntities\n$Nodes\n1 " << block.mesh.node_count << " 1 " << block.mesh.node_count << "\n3 1 0 "
         << block.mesh.node_count << "\n"
         << nodes.str() << coordinates.str() << "$EndNodes\n$Elements\n4 " << total << " 1 " << total << "\n";
  } else {
    text << "$Nodes\n" << block.mesh.node_count << "\n" << nodes.str() << "$EndNodes\n$Elements\n" << total << "\n";
  }
  int number = 0;
  const auto write = [&](int dimension, int type, int group, const std::vector<std::string>& lists) {
    if (version_4) text << dimension << " 1 " << type << " " << lists.size() << "\n";
    for (const auto& list : lists) {
      text << ++number;
      if (!version_4) text << " " << type << " 2 " << group << " 1";
      text << list << "\n";
    }
  };
  write(0, 15, 4, {in_numbers({0})});
  write(1, 8, 3, {in_numbers(edge)});
  write(2, face, 2, faces);
  write(3, solid, 1, solids);
  text << "$EndElements\n";
  return text.str();
}

TEST(MshSolids, OfElementsWithMiddlesHaveTheirNodesInGmshsOrder) {
  for (const char* element : {"T10", "H20", "H27"}) {
    const ImportedMesh block = bent_block(element);
    for (bool version_4 : {false, true}) {
      const ImportResult result = read(written(block, version_4));
      ASSERT_TRUE(result.errors.empty()) << element << ": " << result.errors.front();
      ASSERT_EQ(result.bodies.size(), 1u);
      EXPECT_TRUE(result.notes.empty());
      const ImportedMesh& found = result.bodies[0];
      EXPECT_EQ(found.mesh.shape, block.mesh.shape);
      EXPECT_EQ(found.mesh.connectivity, block.mesh.connectivity);
      EXPECT_EQ(found.points, block.points);
      EXPECT_EQ(mesh_fault(found, element, 3), "");
      const Side &bottom = found.mesh.sides.at("bottom"), &expected = block.mesh.sides.at("bottom");
      EXPECT_EQ(bottom.nodes, expected.nodes);
      EXPECT_EQ(bottom.facets.size(), expected.facets.size());
      ASSERT_EQ(bottom.quadratic.size(), expected.quadratic.size());
      EXPECT_LE((vector_area(found.points, bottom) - vector_area(block.points, expected)).norm(), 1e-14);
      EXPECT_EQ(found.mesh.sides.at("edge").nodes.size(), 3u);
      EXPECT_EQ(found.mesh.sides.at("corner").nodes, std::vector<int>{0});
    }
  }
}

TEST(MshSolids, OfElementsWithMiddlesAreTurnedToTheRightHandWithTheirFaces) {
  for (const char* element : {"T10", "H20", "H27"}) {
    ImportedMesh mirrored = bent_block(element);
    mirrored.points.row(0) *= -1;
    const ImportResult result = read(written(mirrored, false));
    ASSERT_TRUE(result.errors.empty()) << element << ": " << result.errors.front();
    const ImportedMesh& found = result.bodies[0];
    EXPECT_NEAR(volume(found.mesh, found.points), volume(bent_block(element).mesh, bent_block(element).points), 1e-12);
    for (const auto& face : found.mesh.sides.at("bottom").quadratic)
      EXPECT_LT(vector_area(found.points, {{}, {face}, {}})[2], 0);
    for (const auto& facet : found.mesh.sides.at("bottom").facets)
      EXPECT_LT(vector_area(found.points, {{}, {facet}, {}})[2], 0);
  }
}

TEST(MshSolids, OfElementsWithMiddlesSplitOnTheirOwnCurves) {
  for (const char* element : {"T10", "H20", "H27"}) {
    const ImportedMesh coarse = read(written(bent_block(element), false)).bodies.at(0);
    const ImportedMesh fine = split(coarse);
    ASSERT_EQ(fine.mesh.element_count(), 8 * coarse.mesh.element_count());
    ASSERT_EQ(fine.points.cols(), fine.mesh.node_count);
    EXPECT_EQ(fine.points.leftCols(coarse.mesh.node_count), coarse.points);
    EXPECT_FALSE(first_inverted_element(fine.mesh, fine.points));
    // four points of a tetrahedron are not exact for its cubic Jacobian
    EXPECT_NEAR(volume(fine.mesh, fine.points), volume(coarse.mesh, coarse.points), element[0] == 'T' ? 1e-3 : 1e-13);
    const Side all = boundary_of(fine.mesh);
    EXPECT_EQ(all.quadratic.size(), 4 * boundary_of(coarse.mesh).quadratic.size());  // it fits together
    EXPECT_LE(vector_area(fine.points, all).norm(), 1e-13);
    const auto whole_area = [](const ImportedMesh& body) {
      return vector_area(body.points, {{}, body.mesh.sides.at("bottom").quadratic, {}});
    };
    EXPECT_EQ(fine.mesh.sides.at("bottom").quadratic.size(), 4 * coarse.mesh.sides.at("bottom").quadratic.size());
    EXPECT_LE((whole_area(fine) - whole_area(coarse)).norm(), 1e-13);  // the same surface
    EXPECT_EQ(fine.mesh.sides.at("edge").nodes.size(), 5u);
    const ImportedMesh twice = split(fine);
    EXPECT_EQ(twice.mesh.sides.at("edge").nodes.size(), 9u);
    EXPECT_LE((whole_area(twice) - whole_area(coarse)).norm(), 1e-13);
    // the middle of an edge of a part lies on the parabola of the whole: a map of the second order, of straight ones
    BoxMesh box;
    box.min = {0.0, 0.0, 0.0};
    box.max = {2.0, 1.0, 1.0};
    box.cells = {4, 2, 2};
    for (Eigen::Index n = 0; n < fine.points.cols(); ++n) {
      const Vec<double, 3> at = fine.points.col(n);
      Vec<double, 3> x = at;  // where the map takes it from
      for (int k = 0; k < 60; ++k) x = at - 0.0625 * Vec<double, 3>(x[1] * x[2], x[0] * x[0] - x[2], x[0] * x[1]);
      for (int i = 0; i < 3; ++i) EXPECT_NEAR(x[i] * 4, std::round(x[i] * 4), 1e-13) << element;  // quarters
    }
  }
}

TEST(MshSolids, OfNineNodesInThePlaneAreNoBody) {
  const ImportedMesh block = bent_block("H27");
  const std::string text =
      replaced(replaced(written(block, false), "2 2 \"bottom\"", "2 2 \"plate\""), "3 1 \"block\"", "3 9 \"x\"");
  const auto at = text.find("5 12 2 1 1");
  ASSERT_NE(at, std::string::npos);
  const std::string faces = replaced(text.substr(0, at) + "$EndElements\n", "$Elements\n6", "$Elements\n4");
  const ImportResult result = read(faces, 2);
  ASSERT_FALSE(result.errors.empty());
  EXPECT_NE(result.errors[0].find("is a 9-node quadrangle, which is read as a face of a 27-node hexahedron alone"),
            std::string::npos)
      << result.errors[0];
}

TEST(MshSolids, SplitIntoEightOfTheSameRegion) {
  const ImportResult result = read(content("22"));
  for (const ImportedMesh& coarse : result.bodies) {
    const ImportedMesh fine = split(coarse);
    ASSERT_EQ(fine.mesh.element_count(), 8 * coarse.mesh.element_count());
    ASSERT_EQ(fine.points.cols(), fine.mesh.node_count);
    EXPECT_EQ(fine.points.leftCols(coarse.mesh.node_count), coarse.points);
    EXPECT_FALSE(first_inverted_element(fine.mesh, fine.points));
    EXPECT_NEAR(volume(fine.mesh, fine.points), volume(coarse.mesh, coarse.points), 1e-12);
    EXPECT_EQ(boundary_of(fine.mesh).facets.size(), 4 * boundary_of(coarse.mesh).facets.size());  // it fits together
    EXPECT_EQ(std::set(fine.mesh.connectivity.begin(), fine.mesh.connectivity.end()).size(),
              static_cast<std::size_t>(fine.mesh.node_count));
    for (const auto& [name, side] : coarse.mesh.sides) {
      const Side& of = fine.mesh.sides.at(name);
      EXPECT_EQ(of.facets.size(), 4 * side.facets.size()) << name;
      EXPECT_LE((vector_area(fine.points, of) - vector_area(coarse.points, side)).norm(), 1e-12) << name;
      const std::set<int> nodes(of.nodes.begin(), of.nodes.end());
      for (const int node : side.nodes) EXPECT_EQ(nodes.count(node), 1u) << name;
    }
  }
  const Side edge = split(result.bodies[0]).mesh.sides.at("edge");
  EXPECT_EQ(edge.nodes.size(), 5u);
  EXPECT_EQ(split(result.bodies[0]).mesh.sides.at("corner").nodes.size(), 1u);
  // of tetrahedra, split over and over, the shape does not degrade
  ImportedMesh ball = result.bodies[2];
  const double first = worst_corner_in_space(ball.mesh, ball.points);
  for (int times = 0; times < 3; ++times) ball = split(ball);
  EXPECT_GT(worst_corner_in_space(ball.mesh, ball.points), 0.5 * first);
  EXPECT_LT(volume(ball.mesh, ball.points), 4 * pi / 3);
}

}  // namespace
}  // namespace stickslip::msh_solids_test
