#include <gtest/gtest.h>

#include <sstream>

#include "core/mesh/generators.hpp"
#include "core/mesh/msh_reader.hpp"
#include "core/mesh/quality.hpp"

namespace stickslip::mesh_faults_test {
namespace {

/// Two squares side by side on (0, 0) to (2, 1) in MSH 2.2, their bottom and top lines, and a point; `more`: lines of
/// further elements, of which there are `extra`.
std::string two_squares(const std::string& more, int extra, const std::string& nodes = "") {
  std::ostringstream text;
  const auto added = std::count(nodes.begin(), nodes.end(), '\n');
  text << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n0 4 \"corner\"\n1 1 \"bottom\"\n2 3 \"block\"\n"
       << "$EndPhysicalNames\n$Nodes\n"
       << 6 + added << "\n1 0 0 0\n2 1 0 0\n3 2 0 0\n4 0 1 0\n5 1 1 0\n6 2 1 0\n"
       << nodes << "$EndNodes\n$Elements\n"
       << 5 + extra << "\n1 1 2 1 1 1 2\n2 1 2 1 1 2 3\n3 15 2 4 1 1\n5 3 2 3 3 1 2 5 4\n6 3 2 3 3 2 3 6 5\n"
       << more << "$EndElements\n";
  return text.str();
}

ImportResult read(const std::string& text) {
  std::istringstream stream(text);
  return read_msh(stream, "mesh.msh");
}

std::string only_error(const ImportResult& result) {
  EXPECT_EQ(result.errors.size(), 1u);
  return result.errors.empty() ? "" : result.errors[0];
}

TEST(MeshFaults, ASoundMeshHasNone) {
  const auto result = read(two_squares("", 0));
  EXPECT_TRUE(result.errors.empty());
  EXPECT_TRUE(result.notes.empty());
}

TEST(MeshFaults, AnElementThatIsListedTwiceIsRefusedWithBothLines) {
  const std::string found = only_error(read(two_squares("7 3 2 3 3 3 6 5 2\n", 1)));  // from another corner
  EXPECT_NE(found.find("mesh.msh:26:1: element 7 of body \"block\" has the same nodes as element 6 of line 25"),
            std::string::npos)
      << found;
}

TEST(MeshFaults, ElementsThatOverlapByTheirNodesAreRefused) {
  // a rectangle over both squares; the right side is met first
  const std::string found = only_error(read(two_squares("7 3 2 3 3 1 3 6 4\n", 1)));
  EXPECT_NE(found.find("mesh.msh:26:1: element 7 of body \"block\" overlaps element 6 of line 25"), std::string::npos)
      << found;
}

TEST(MeshFaults, ALineOrAPointThatIsListedTwiceIsRefused) {
  std::string found = only_error(read(two_squares("7 1 2 1 1 2 1\n", 1)));  // the other way round
  EXPECT_NE(
      found.find("mesh.msh:26:1: element 7 of physical curve \"bottom\" has the same nodes as element 1 of line 21"),
      std::string::npos)
      << found;
  found = only_error(read(two_squares("7 15 2 4 1 1\n", 1)));
  EXPECT_NE(found.find("element 7 of physical point \"corner\" has the same nodes as element 3 of line 23"),
            std::string::npos)
      << found;
}

TEST(MeshFaults, TheSameLineInTwoGroupsIsNone) { EXPECT_TRUE(read(two_squares("7 1 2 8 1 1 2\n", 1)).errors.empty()); }

TEST(MeshFaults, NodesAtOnePlaceAreNoted) {
  // a third square below, of two nodes of its own where the first has its bottom
  for (const std::string x : {"0", "1e-11", "-1e-11"}) {  // what a generator computes twice differs by its rounding
    const auto result = read(two_squares("7 3 2 3 3 9 10 8 7\n", 1, "7 " + x + " 0 0\n8 1 0 0\n9 0 -1 0\n10 1 -1 0\n"));
    EXPECT_TRUE(result.errors.empty());
    ASSERT_EQ(result.notes.size(), 2u);
    EXPECT_NE(result.notes[0].find("nodes 1 and 7 of body \"block\" are at one place"), std::string::npos);
    EXPECT_NE(result.notes[1].find("are 2 parts that share no node"), std::string::npos);
  }
}

TEST(MeshFaults, ASeamThatIsOpenInPartIsNoted) {
  // its third square shares one node with the first
  const auto result = read(two_squares("7 3 2 3 3 9 10 8 1\n", 1, "8 1 1e-12 0\n9 0 -1 0\n10 1 -1 0\n"));
  EXPECT_TRUE(result.errors.empty());
  ASSERT_EQ(result.notes.size(), 1u);
  EXPECT_NE(result.notes[0].find("are at one place"), std::string::npos);
}

TEST(MeshFaults, AFineMeshHasNoNodesAtOnePlace) {
  BoxMesh box{{0.0, 0.0}, {2.0, 1.0}, {40, 20}, {{"bottom", 1e6}}};
  const Mesh mesh = make_mesh(box, "", 2);
  const auto points = make_points<double>(box, mesh, Numbers<double>{});
  EXPECT_FALSE(nodes_at_one_place(mesh, points));
  EXPECT_EQ(count_of_parts(mesh), 1);
}

TEST(MeshFaults, AnElementWithoutDigitsForItsStrainIsFound) {
  BoxMesh box{{0.0, 0.0}, {2.0, 1.0}, {4, 4}, {{"bottom", 1e12}}};
  const auto thin_of = [](const BoxMesh& of) {
    const Mesh mesh = make_mesh(of, "", 2);
    return first_thin_element(mesh, make_points<double>(of, mesh, Numbers<double>{}));
  };
  const auto thin = thin_of(box);
  ASSERT_TRUE(thin);
  EXPECT_EQ(thin->element, 0);
  EXPECT_NEAR(thin->thickness, 1e-12, 1e-15);  // by the sum of all steps
  box.grade[0].ratio = 1e9;
  EXPECT_FALSE(thin_of(box));
  // a body far away has the digits of its coordinates
  BoxMesh far{{1e9, 0.0}, {1e9 + 1e-3, 1e-3}, {1, 1}};
  EXPECT_TRUE(thin_of(far));
  far = {{1e6, 0.0}, {1e6 + 1, 1.0}, {1, 1}};
  EXPECT_FALSE(thin_of(far));
}

TEST(MeshFaults, AnImportedElementWithoutDigitsIsRefused) {
  const std::string found = only_error(read(two_squares("7 3 2 3 3 7 8 2 1\n", 1, "7 0 -1e-13 0\n8 1 -1e-13 0\n")));
  EXPECT_NE(found.find("element 7 of body \"block\" is 1e-13 thick"), std::string::npos) << found;
}

}  // namespace
}  // namespace stickslip::mesh_faults_test
