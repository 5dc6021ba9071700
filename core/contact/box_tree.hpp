/// Tree of bounding boxes over the facets or patches of a side. A search is a visit of the tree that skips boxes, so it
/// visits about log n of n boxes.
#pragma once

#include <algorithm>
#include <vector>

#include "core/algebra/scalar.hpp"

namespace stickslip {

/// Bounds of places, and of the unit normals there. Unless they are set, the normals are any.
template <int D>
struct Bounds {
  Vec<double, D> low, high;  ///< length
  Vec<double, D> normal_low = Vec<double, D>::Constant(-1), normal_high = Vec<double, D>::Constant(1);

  void take_in(const Bounds& other) {
    low = low.cwiseMin(other.low);
    high = high.cwiseMax(other.high);
    normal_low = normal_low.cwiseMin(other.normal_low);
    normal_high = normal_high.cwiseMax(other.normal_high);
  }
  /// Distance from x, length; 0 inside.
  double distance(const Vec<double, D>& x) const { return (low - x).cwiseMax(x - high).cwiseMax(0.0).norm(); }
};

template <int D>
class BoxTree {
 public:
  /// The left child of boxes_[k] is boxes_[k + 1]. `right`: index of the right child. `item`: of a leaf; -1: the box
  /// has children.
  struct Box : Bounds<D> {
    int right = 0, item = -1;
  };

  /// Of nothing.
  BoxTree() = default;
  /// Tree of the items 0 to count - 1, of which each is near those before and after it. `bounds(item)`: Bounds<D>.
  template <class BoundsOf>
  BoxTree(int count, const BoundsOf& bounds) {
    boxes_.reserve(2 * count);
    if (count > 0)
      add_boxes(
          0, count, bounds, [](int k) { return k; }, [](int, int, int) {});
  }
  /// Tree of items in any order: each box is halved along its longest side.
  template <class BoundsOf>
  BoxTree(std::vector<int> items, const BoundsOf& bounds) {
    const auto halve = [&](int first, int middle, int last) { split(items, first, middle, last, bounds); };
    boxes_.reserve(2 * items.size());
    if (!items.empty())
      add_boxes(
          0, static_cast<int>(items.size()), bounds, [&](int k) { return items[k]; }, halve);
  }

  bool empty() const { return boxes_.empty(); }
  /// The box of all items. pre: there are some.
  const Box& whole() const { return boxes_[0]; }

  /// Calls f(item) for each item in no box for which `skips(box)` holds. Of two boxes, the one that is nearer to `from`
  /// comes first.
  template <class Skips, class F>
  void visit(const Vec<double, D>& from, Skips&& skips, F&& f) const {
    const auto visit_box = [&](const auto& self, int at) -> void {
      const Box& box = boxes_[at];
      if (skips(box)) return;
      if (box.item >= 0) return f(box.item);
      const bool left_first = boxes_[at + 1].distance(from) <= boxes_[box.right].distance(from);
      self(self, left_first ? at + 1 : box.right);
      self(self, left_first ? box.right : at + 1);
    };
    if (!boxes_.empty()) visit_box(visit_box, 0);
  }

 private:
  /// Adds the box of the items first to last - 1, then those of its two halves.
  template <class BoundsOf, class Item, class Halve>
  void add_boxes(int first, int last, const BoundsOf& bounds, const Item& item, const Halve& halve) {
    const std::size_t at = boxes_.size();
    if (last - first == 1) return boxes_.push_back({bounds(item(first)), 0, item(first)});
    boxes_.emplace_back();
    const int middle = (first + last) / 2;
    halve(first, middle, last);
    add_boxes(first, middle, bounds, item, halve);
    const auto right = static_cast<int>(boxes_.size());
    add_boxes(middle, last, bounds, item, halve);
    boxes_[at] = {boxes_[at + 1], right, -1};
    boxes_[at].take_in(boxes_[right]);
  }

  /// Moves the lower half of the items, along the longest side of their box, in front of the others.
  template <class BoundsOf>
  static void split(std::vector<int>& items, int first, int middle, int last, const BoundsOf& bounds) {
    Bounds<D> all = bounds(items[first]);
    for (int k = first + 1; k < last; ++k) all.take_in(bounds(items[k]));
    int longest = 0;
    for (int i = 1; i < D; ++i)
      if (all.high[i] - all.low[i] > all.high[longest] - all.low[longest]) longest = i;
    const auto comes_first = [&](int f, int g) {
      const Bounds<D> a = bounds(f), b = bounds(g);
      const double x = a.low[longest] + a.high[longest], y = b.low[longest] + b.high[longest];
      return x != y ? x < y : f < g;
    };
    std::nth_element(items.begin() + first, items.begin() + middle, items.begin() + last, comes_first);
  }

  std::vector<Box> boxes_;  ///< boxes_[0]: of all items
};

}  // namespace stickslip
