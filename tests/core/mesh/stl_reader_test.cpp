/// STL files: what a cube holds by both formats, and where and what is wrong with a broken file.
#include "core/mesh/stl_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <cstring>
#include <sstream>

namespace stickslip::stl_reader_test {
namespace {

using Triangles = std::vector<std::array<std::array<float, 3>, 3>>;

/// The surface of a cube from 0 to 2, corners counter-clockwise seen from outside.
Triangles cube() {
  const auto at = [](int corner) {
    return std::array<float, 3>{corner & 1 ? 2.0F : 0.0F, corner & 2 ? 2.0F : 0.0F, corner & 4 ? 2.0F : 0.0F};
  };
  Triangles all;
  for (const auto& f : {std::array{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
    all.push_back({at(f[0]), at(f[1]), at(f[2])});
    all.push_back({at(f[0]), at(f[2]), at(f[3])});
  }
  return all;
}

std::string ascii(const Triangles& triangles, const std::string& end = "\n") {
  std::ostringstream out;
  out << "solid a cube" << end;
  for (const auto& corners : triangles) {
    out << "  facet normal 0 0 nan" << end << "    outer loop" << end;
    for (const auto& x : corners) out << "      vertex " << x[0] << " " << x[1] << " +" << x[2] << "e0" << end;
    out << "    endloop" << end << "  endfacet" << end;
  }
  out << "endsolid a cube" << end;
  return out.str();
}

/// `header`: its first words, which some programs begin with "solid".
std::string binary(const Triangles& triangles, const std::string& header) {
  std::string out = header + std::string(80 - header.size(), ' ');
  const auto append = [&](const auto& value) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    out.append(bytes, sizeof value);
  };
  append(static_cast<std::uint32_t>(triangles.size()));
  for (const auto& corners : triangles) {
    for (int i = 0; i < 3; ++i) append(0.0F);
    append(corners);
    append(std::uint16_t{0});
  }
  return out;
}

/// Volume that the triangles enclose; positive if they look outward.
double volume(const StlSurface& surface) {
  double sum = 0;
  for (const auto& f : surface.facets) {
    const Eigen::Vector3d a = surface.vertices.col(f[0]), b = surface.vertices.col(f[1]),
                          c = surface.vertices.col(f[2]);
    sum += a.dot(b.cross(c)) / 6;
  }
  return sum;
}

TEST(StlReader, JoinsTheCornersOfTheTrianglesOfEitherFormat) {
  for (const std::string& content :
       {ascii(cube()), ascii(cube(), "\r\n"), binary(cube(), "made by hand"), binary(cube(), "solid by name")}) {
    const auto surface = read_stl(content, "cube.stl");
    EXPECT_THAT(surface.errors, testing::IsEmpty());
    EXPECT_EQ(surface.vertices.cols(), 8);
    EXPECT_EQ(surface.facets.size(), 12u);
    EXPECT_DOUBLE_EQ(volume(surface), 8);
  }
}

TEST(StlReader, LeavesOutTrianglesThatAreLines) {
  auto triangles = cube();
  triangles.push_back({triangles[0][0], triangles[0][1], triangles[0][1]});
  const auto surface = read_stl(binary(triangles, ""), "cube.stl");
  EXPECT_THAT(surface.errors, testing::IsEmpty());
  EXPECT_EQ(surface.facets.size(), 12u);
}

TEST(StlReader, TakesMinusZeroForZero) {
  auto triangles = cube();
  for (auto& corners : triangles)
    if (&corners != &triangles[0])
      for (auto& x : corners)
        for (float& each : x) each = each == 0 ? -0.0F : each;
  EXPECT_EQ(read_stl(binary(triangles, ""), "cube.stl").vertices.cols(), 8);
}

TEST(StlReader, SaysWhereAndWhatIsWrong) {
  const std::string good = ascii(cube());
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  auto flat = cube();
  flat[1][2] = {1, 1, 0};  // on the diagonal of the first face
  const std::string cut = binary(cube(), "made by hand").substr(0, 500);
  for (const auto& [content, words] : std::vector<std::pair<std::string, std::string>>{
           {with("vertex 0", "vertex 0x"), "f.stl:4:14: a number should stand here; found \"0x\""},
           {with("vertex 0", "vertex inf"), "f.stl:4:14: the number \"inf\" is not finite"},
           {with("outer", "inner"), "f.stl:3:5: \"outer\" should stand here; found \"inner\""},
           {good.substr(0, good.find("endfacet")), "found the end of the file"},
           {good.substr(0, good.rfind("endsolid")), "\"facet\" or \"endsolid\" should stand here; found the end"},
           {good + "solid", "found the end of the file"},
           {good + "more", "\"solid\" should stand here; found \"more\""},
           {cut,
            "f.stl: neither text that begins with \"solid\" nor a binary file of 12 triangles, which has 684 bytes"},
           {ascii(flat), "f.stl:9:3: triangle 2: its corners are on one line"},
           {binary(flat, ""), "f.stl: triangle 2: its corners are on one line"},
           {"solid nothing\nendsolid\n", "f.stl: has no triangle"},
           {"", "f.stl: has no triangle"}}) {
    const auto surface = read_stl(content, "f.stl");
    ASSERT_EQ(surface.errors.size(), 1u) << words;
    EXPECT_THAT(surface.errors[0], testing::HasSubstr(words));
  }
}

/// Every prefix of a file, and every file with one byte changed, is read or refused.
TEST(StlReader, SurvivesBrokenFiles) {
  for (const std::string& good : {ascii({cube()[0], cube()[1]}), binary({cube()[0], cube()[1]}, "")})
    for (std::size_t k = 0; k < good.size(); ++k) {
      read_stl(good.substr(0, k), "f.stl");
      std::string changed = good;
      for (const char byte : {'\0', ' ', 'x', '\xff'}) {
        changed[k] = byte;
        const auto surface = read_stl(changed, "f.stl");
        EXPECT_EQ(surface.errors.empty(), !surface.facets.empty() && surface.errors.empty());
        EXPECT_TRUE(surface.vertices.allFinite());
      }
    }
}

}  // namespace
}  // namespace stickslip::stl_reader_test
