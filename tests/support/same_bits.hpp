/// Two trajectories held against each other to the last bit: what must not change a solution changes none of these.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <string>

#include "core/model/state.hpp"

namespace stickslip {

inline bool same_bits(const Vector<double>& a, const Vector<double>& b) {
  return a.size() == b.size() &&
         (a.size() == 0 || std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<std::size_t>(a.size())) == 0);
}

inline void expect_same_bits(const State<double>& a, const State<double>& b, const std::string& what) {
  EXPECT_TRUE(same_bits(a.displacement, b.displacement)) << what << ": displacement";
  EXPECT_TRUE(same_bits(a.multiplier, b.multiplier)) << what << ": multiplier";
  EXPECT_TRUE(same_bits(a.history.work, b.history.work)) << what << ": dissipation";
  EXPECT_EQ(a.contact.state, b.contact.state) << what;
  EXPECT_TRUE(same_bits(a.contact.gap, b.contact.gap)) << what << ": gap";
  EXPECT_TRUE(same_bits(a.history.placement, b.history.placement)) << what << ": placement";
  EXPECT_TRUE(same_bits(a.contact.slip, b.contact.slip)) << what << ": slip";
  EXPECT_TRUE(same_bits(a.contact.traction, b.contact.traction)) << what << ": traction";
}

/// The same increments, each with the same state, found by as many iterations.
inline void expect_same_bits(const Trajectory<double>& a, const Trajectory<double>& b, const std::string& what) {
  EXPECT_EQ(a.status, b.status) << what;
  ASSERT_EQ(a.increments.size(), b.increments.size()) << what;
  for (std::size_t n = 0; n < a.increments.size(); ++n) {
    const auto &one = a.increments[n], &other = b.increments[n];
    const std::string where = what + ", increment " + std::to_string(n);
    EXPECT_EQ(one.time, other.time) << where;
    EXPECT_EQ(one.requested, other.requested) << where;
    EXPECT_EQ(one.status, other.status) << where;
    EXPECT_EQ(one.newton, other.newton) << where;
    EXPECT_EQ(one.augmentations, other.augmentations) << where;
    EXPECT_EQ(one.rho_factor, other.rho_factor) << where;
    expect_same_bits(one.state, other.state, where);
  }
}

}  // namespace stickslip
