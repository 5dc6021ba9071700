/// Comparison of what mesh files give.
#pragma once

#include <gtest/gtest.h>

#include "core/mesh/msh_reader.hpp"

namespace stickslip {

/// Checks that both have the same bodies, with the same sides, and no fault.
inline void expect_same_bodies(const ImportResult& a, const ImportResult& b) {
  ASSERT_TRUE(a.errors.empty()) << a.errors.front();
  ASSERT_TRUE(b.errors.empty()) << b.errors.front();
  EXPECT_EQ(a.notes, b.notes);
  ASSERT_EQ(a.bodies.size(), b.bodies.size());
  for (std::size_t i = 0; i < a.bodies.size(); ++i) {
    EXPECT_EQ(a.bodies[i].body, b.bodies[i].body);
    EXPECT_EQ(a.bodies[i].points, b.bodies[i].points);
    EXPECT_EQ(a.bodies[i].mesh.connectivity, b.bodies[i].mesh.connectivity);
    ASSERT_EQ(a.bodies[i].mesh.sides.size(), b.bodies[i].mesh.sides.size());
    for (const auto& [name, side] : a.bodies[i].mesh.sides) {
      EXPECT_EQ(side.nodes, b.bodies[i].mesh.sides.at(name).nodes) << name;
      EXPECT_EQ(side.facets, b.bodies[i].mesh.sides.at(name).facets) << name;
    }
  }
}

}  // namespace stickslip
