/// Points and windows of the plane, and how a picture maps them to its pixels.
#pragma once

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

namespace stickslip::report {

struct Point {
  double x = 0, y = 0;
};

inline bool is_point(const nlohmann::json& value) {
  return value.is_array() && value.size() == 2 && value[0].is_number() && value[1].is_number();
}
inline Point to_point(const nlohmann::json& value) { return {value[0].get<double>(), value[1].get<double>()}; }

struct Box {
  Point min{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  Point max{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  void add(Point p) {
    min = {std::min(min.x, p.x), std::min(min.y, p.y)};
    max = {std::max(max.x, p.x), std::max(max.y, p.y)};
  }
  double width() const { return max.x - min.x; }
  double height() const { return max.y - min.y; }
  bool overlaps(const Box& o) const {
    return min.x <= o.max.x && o.min.x <= max.x && min.y <= o.max.y && o.min.y <= max.y;
  }
};

/// Maps a window of the plane onto a picture of the given size in pixels, y up.
class Frame {
 public:
  Frame(Box window, double width, double height, double left) : window_(window) {
    scale_ = std::min(width / window.width(), height / window.height());
    shift_ = {left + (width - scale_ * window.width()) / 2, (height - scale_ * window.height()) / 2};
  }
  double x(double x) const { return shift_.x + scale_ * (x - window_.min.x); }
  double y(double y) const { return shift_.y + scale_ * (window_.max.y - y); }
  double length(double l) const { return scale_ * l; }
  const Box& window() const { return window_; }

 private:
  Box window_;
  double scale_;
  Point shift_;
};

}  // namespace stickslip::report
