/// A share of a study's cells: "i/N" is every N-th cell, from the i-th on.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace stickslip {

struct Shard {
  int index = 1, count = 1;  ///< 1 <= index <= count

  /// Whether the cell at this place of the study's order (from 0) belongs to the share.
  bool holds(std::size_t place) const {
    return place % static_cast<std::size_t>(count) == static_cast<std::size_t>(index) - 1;
  }
  std::string text() const { return std::to_string(index) + "/" + std::to_string(count); }
};

/// "3/8"; none where it is no share.
std::optional<Shard> parse_shard(const std::string& text);

}  // namespace stickslip
