/// The tree of boxes: every item in no skipped box is visited, in the plane and in space, and few boxes are asked.
#include "core/contact/box_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>

#include "tests/support/largest.hpp"

namespace stickslip::box_tree_test {
namespace {

/// Small boxes along a way that leads from the origin to n.
template <int D>
std::vector<Bounds<D>> boxes(int n, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Bounds<D>> all;
  for (int k = 0; k < n; ++k) {
    Vec<double, D> low = Vec<double, D>::Constant(k), size;
    for (int i = 0; i < D; ++i) {
      low[i] += 3 * uniform(random);
      size[i] = uniform(random);
    }
    all.push_back({low, low + size});
  }
  return all;
}

template <int D>
void expect_the_nearest(const BoxTree<D>& tree, const std::vector<Bounds<D>>& all, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(0, static_cast<double>(all.size()));
  for (int trial = 0; trial < 50; ++trial) {
    const Vec<double, D> x = Vec<double, D>::Constant(uniform(random)) + Vec<double, D>::Unit(0);
    double least = std::numeric_limits<double>::infinity(), found = least;
    for (const auto& box : all) least = smaller(least, box.distance(x));
    int asked = 0;
    const auto skips = [&](const Bounds<D>& box) {
      ++asked;
      return box.distance(x) > found;
    };
    tree.visit(x, skips, [&](int item) { found = smaller(found, all[item].distance(x)); });
    EXPECT_EQ(found, least);
    EXPECT_LE(asked, 100) << "of " << 2 * all.size();  // of 1000 items at ten depths, a few neighbours each
  }
}

template <int D>
void expect_all_found() {
  std::mt19937 random(3);
  const auto all = boxes<D>(1000, random);
  const auto bounds = [&](int item) { return all[item]; };
  expect_the_nearest(BoxTree<D>(1000, bounds), all, random);
  std::vector<int> shuffled(all.size());
  std::iota(shuffled.begin(), shuffled.end(), 0);
  std::shuffle(shuffled.begin(), shuffled.end(), random);
  const BoxTree<D> tree(shuffled, bounds);
  expect_the_nearest(tree, all, random);
  std::vector<int> visited;
  const auto nothing = [](const auto&) { return false; };
  tree.visit(Vec<double, D>::Zero(), nothing, [&](int item) { visited.push_back(item); });
  std::sort(visited.begin(), visited.end());
  std::sort(shuffled.begin(), shuffled.end());
  EXPECT_EQ(visited, shuffled);
}

TEST(BoxTree, FindsTheNearestByFewBoxesInThePlane) { expect_all_found<2>(); }
TEST(BoxTree, FindsTheNearestByFewBoxesInSpace) { expect_all_found<3>(); }

TEST(BoxTree, OfNothingVisitsNothing) {
  const auto never = [](int) { ADD_FAILURE(); };
  const auto bounds = [](int) { return Bounds<2>{}; };
  for (const auto& tree : {BoxTree<2>(), BoxTree<2>(0, bounds), BoxTree<2>(std::vector<int>(), bounds)}) {
    EXPECT_TRUE(tree.empty());
    tree.visit(
        {0, 0}, [](const auto&) { return false; }, never);
  }
}

TEST(Bounds, OfNormalsAreAnyUnlessTheyAreSet) {
  Bounds<2> up{{0, 0}, {1, 1}, {0, 1}, {0, 1}};
  EXPECT_EQ(up.normal_low, up.normal_high);
  up.take_in({{2, 0}, {3, 1}});
  EXPECT_EQ(up.normal_low, (Vec<double, 2>(-1, -1)));
  EXPECT_EQ(up.high, (Vec<double, 2>(3, 1)));
  EXPECT_EQ(up.distance({3, 3}), 2);
  EXPECT_EQ(up.distance({2, 0.5}), 0);
}

}  // namespace
}  // namespace stickslip::box_tree_test
