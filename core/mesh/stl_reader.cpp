#include "core/mesh/stl_reader.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <string_view>

#include "core/mesh/decimal.hpp"

namespace stickslip {
namespace {

using Corners = std::array<Eigen::Vector3d, 3>;

/// Joins triangles to a surface.
class Joining {
 public:
  explicit Joining(StlSurface& surface) : surface_(surface) {}

  /// Adds a triangle. What is wrong with it; "": nothing.
  std::string add(const Corners& corners) {
    for (const auto& x : corners)
      if (!x.allFinite()) return "a coordinate is not finite";
    std::array<int, 3> facet{};
    for (int k = 0; k < 3; ++k) facet[k] = vertex(corners[k]);
    ++count_;
    if (facet[0] == facet[1] || facet[1] == facet[2] || facet[2] == facet[0]) return "";
    const Eigen::Vector3d a = corners[1] - corners[0], b = corners[2] - corners[0];
    const double size = corners[0].norm() + a.norm() + b.norm();
    // (coordinates of a binary file are known to single precision)
    if (!(a.cross(b).norm() > std::numeric_limits<float>::epsilon() * size * std::max(a.norm(), b.norm())))
      return "its corners are on one line";
    surface_.facets.push_back(facet);
    return "";
  }
  /// Triangles so far, with those that were left out.
  std::size_t count() const { return count_; }

  void finish() {
    surface_.vertices.resize(3, static_cast<Eigen::Index>(places_.size()));
    for (const auto& [place, number] : places_)
      for (int i = 0; i < 3; ++i) surface_.vertices(i, number) = place[i];
  }

 private:
  int vertex(const Eigen::Vector3d& x) {
    // (adding 0 makes -0 the same as 0)
    return places_.emplace(std::array{x[0] + 0.0, x[1] + 0.0, x[2] + 0.0}, static_cast<int>(places_.size()))
        .first->second;
  }

  StlSurface& surface_;
  std::map<std::array<double, 3>, int> places_;
  std::size_t count_ = 0;
};

constexpr std::size_t header = 84, record = 50;  // bytes of a binary file: before the triangles; of each

std::uint32_t triangles_of_binary(const std::string& content) {
  std::uint32_t count = 0;
  std::memcpy(&count, content.data() + header - 4, 4);
  return count;
}

bool is_binary(const std::string& content) {
  if (content.size() < header) return false;
  if (content.size() == header + record * static_cast<std::size_t>(triangles_of_binary(content))) return true;
  return content.compare(0, 5, "solid") != 0;
}

void read_binary(const std::string& content, const std::string& name, Joining& joining, StlSurface& surface) {
  const std::size_t count = triangles_of_binary(content);
  if (content.size() != header + record * count) {
    surface.errors.push_back(name + ": neither text that begins with \"solid\" nor a binary file of " +
                             std::to_string(count) + " triangles, which has " +
                             std::to_string(header + record * count) + " bytes and not " +
                             std::to_string(content.size()));
    return;
  }
  for (std::size_t t = 0; t < count; ++t) {
    Corners corners;
    for (int k = 0; k < 3; ++k)
      for (int i = 0; i < 3; ++i) {
        float x = 0;
        std::memcpy(&x, content.data() + header + record * t + 12 + 12 * k + 4 * i, 4);
        corners[k][i] = x;
      }
    if (const auto fault = joining.add(corners); !fault.empty()) {
      surface.errors.push_back(name + ": triangle " + std::to_string(t + 1) + ": " + fault);
      return;
    }
  }
}

/// Words of a text, with their places.
class Words {
 public:
  explicit Words(std::string_view text) : text_(text) {}

  /// The next word; "" at the end.
  std::string_view next() {
    constexpr const char* blanks = " \t\r\n";
    begin_ = std::min(text_.find_first_not_of(blanks, end_), text_.size());
    end_ = std::min(text_.find_first_of(blanks, begin_), text_.size());
    return text_.substr(begin_, end_ - begin_);
  }
  void skip_line() { end_ = std::min(text_.find('\n', begin_), text_.size()); }
  /// LINE:COL of the last word.
  std::string place() const {
    const auto before = text_.substr(0, begin_);
    const auto line = std::count(before.begin(), before.end(), '\n') + 1;
    const auto last = before.rfind('\n');
    return std::to_string(line) + ":" + std::to_string(before.size() - (last == before.npos ? 0 : last + 1) + 1);
  }

 private:
  std::string_view text_;
  std::size_t begin_ = 0, end_ = 0;
};

/// A word with a limit to its length, as a message shows it.
std::string shown(std::string_view word) {
  if (word.empty()) return "the end of the file";
  return "\"" + std::string(word.substr(0, 40)) + (word.size() > 40 ? "..." : "") + "\"";
}

class AsciiReader {
 public:
  AsciiReader(const std::string& content, Joining& joining) : words_(content), joining_(joining) {}

  /// What is wrong, with its place; "": nothing.
  std::string read() {
    for (auto word = words_.next(); !word.empty(); word = words_.next()) {
      if (word != "solid") return at("\"solid\" should stand here; found " + shown(word));
      words_.skip_line();  // (its name)
      if (const auto fault = read_solid(); !fault.empty()) return fault;
    }
    return "";
  }

 private:
  std::string at(const std::string& fault) const { return words_.place() + ": " + fault; }

  std::string read_solid() {
    for (auto word = words_.next(); word != "endsolid"; word = words_.next()) {
      if (word != "facet") return at("\"facet\" or \"endsolid\" should stand here; found " + shown(word));
      const std::string place = words_.place();
      Corners corners;
      Eigen::Vector3d normal;
      std::string fault = expect({"normal"});
      if (fault.empty()) fault = read_numbers(normal, false);
      if (fault.empty()) fault = expect({"outer", "loop"});
      for (int k = 0; k < 3 && fault.empty(); ++k) {
        fault = expect({"vertex"});
        if (fault.empty()) fault = read_numbers(corners[k], true);
      }
      if (fault.empty()) fault = expect({"endloop", "endfacet"});
      if (!fault.empty()) return fault;
      if (const auto bad = joining_.add(corners); !bad.empty())
        return place + ": triangle " + std::to_string(joining_.count()) + ": " + bad;
    }
    words_.skip_line();
    return "";
  }

  std::string expect(std::initializer_list<std::string_view> wanted) {
    for (const auto& word : wanted)
      if (const auto found = words_.next(); found != word)
        return at("\"" + std::string(word) + "\" should stand here; found " + shown(found));
    return "";
  }

  /// `finite`: numbers that are not finite are a fault. (Normals may be anything that some program writes.)
  std::string read_numbers(Eigen::Vector3d& x, bool finite) {
    for (int i = 0; i < 3; ++i) {
      auto word = words_.next();
      if (word.starts_with('+')) word.remove_prefix(1);
      const auto number = decimal(word);
      if (!number) return at("a number should stand here; found " + shown(word));
      x[i] = *number;
      if (finite && !std::isfinite(x[i])) return at("the number " + shown(word) + " is not finite");
    }
    return "";
  }

  Words words_;
  Joining& joining_;
};

}  // namespace

StlSurface read_stl(const std::string& content, const std::string& file_name) {
  StlSurface surface;
  Joining joining(surface);
  if (is_binary(content)) {
    read_binary(content, file_name, joining, surface);
  } else if (const auto fault = AsciiReader(content, joining).read(); !fault.empty()) {
    surface.errors.push_back(file_name + ":" + fault);
  }
  joining.finish();
  if (surface.errors.empty() && surface.facets.empty()) surface.errors.push_back(file_name + ": has no triangle");
  return surface;
}

}  // namespace stickslip
