/// A line drawing, written once and given out as SVG (inside a page or as a file of its own) and as PGF.
///
/// Coordinates are pixels of SVG, y down; a pixel is 0.75 points of PGF. Colours are "#RRGGBB", "curve #RRGGBB" or
/// one of the names ink, soft, line, paper: in a page these follow its light or dark scheme, in files they are those of
/// the light one. "" draws nothing.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace stickslip::report {

/// How a shape is drawn.
struct Style {
  std::string stroke = "ink", fill;
  double width = 1;
  std::vector<double> dash;  ///< lengths of stroke and gap in turn; empty: solid
};

/// A path of straight and cubic pieces.
class Path {
 public:
  Path& move(double x, double y) { return add('M', {x, y}); }
  Path& line(double x, double y) { return add('L', {x, y}); }
  Path& curve(double x1, double y1, double x2, double y2, double x, double y) {
    return add('C', {x1, y1, x2, y2, x, y});
  }
  Path& close() { return add('Z', {}); }
  Path& rectangle(double x, double y, double width, double height) {
    return move(x, y).line(x + width, y).line(x + width, y + height).line(x, y + height).close();
  }
  Path& circle(double x, double y, double radius);
  bool empty() const { return pieces.empty(); }

  struct Piece {
    char kind;  ///< M L C Z
    std::vector<double> at;
  };
  std::vector<Piece> pieces;

 private:
  Path& add(char kind, std::vector<double> at) {
    pieces.push_back({kind, std::move(at)});
    return *this;
  }
};

enum class Anchor { start, middle, end };

/// How a text stands at its place (on its baseline).
struct TextStyle {
  Anchor anchor = Anchor::start;
  double size = 12;
  std::string color = "ink";
  bool upwards = false;  ///< turned by a quarter, reading from below
  bool bold = false;
};

class Drawing {
 public:
  /// `title` and `description` are what a screen reader says of it.
  Drawing(double width, double height, std::string title, std::string description)
      : width_(width), height_(height), title_(std::move(title)), description_(std::move(description)) {}

  /// `tooltip`: what a reader sees who points at it; not in PGF.
  void path(Path path, Style style, std::string tooltip = {});
  void line(double x1, double y1, double x2, double y2, const Style& style);
  void text(double x, double y, std::string text, const TextStyle& style = {});
  /// Only what lies inside `path` is drawn from here on, until unclip(). Clips may nest.
  void clip(Path path);
  void unclip();
  /// A rectangle that a narrow screen shows alone, as large as it can, and the next one below it.
  void part(double x, double y, double width, double height) { parts_.push_back({x, y, width, height}); }
  /// Cuts off, or adds, room at the bottom.
  void set_height(double height) { height_ = height; }
  bool empty() const { return items_.empty(); }
  const std::string& description() const { return description_; }

  std::string inline_svg() const;
  std::string svg_file() const;
  /// For LaTeX, which sets the texts in the font of the document: as wide as \linewidth, or less than 120 mm with
  /// another layout, `narrow`, if there is one.
  std::string pgf(const Drawing* narrow = nullptr) const;
  /// Moves, lines and curves of all shapes.
  std::size_t pieces() const;

 private:
  struct Shape {
    Path path;
    Style style;
    std::string tooltip;
  };
  struct Text {
    double x, y;
    std::string text;
    TextStyle style;
  };
  struct Clip {
    Path path;
  };
  struct Unclip {};
  struct Part {
    double x, y, width, height;
  };
  using Item = std::variant<Shape, Text, Clip, Unclip>;
  class SvgWriter;
  class PgfWriter;

  std::string pgf_picture() const;

  double width_, height_;
  std::string title_, description_;
  std::vector<Item> items_;
  std::vector<Part> parts_;
};

/// A marker of some 9 pixels by its name: circle, square, triangle-up (-down, -left, -right), diamond, cross (upright),
/// failed (a diagonal cross).
Path marker(std::string_view shape, double x, double y, double size = 1);

/// A text as LaTeX sets it.
std::string tex_text(const std::string& text);

/// A path in the notation of SVG.
std::string svg_path(const Path& path);

/// Width of a text in pixels, as Helvetica sets it.
double text_width(std::string_view text, double size);

}  // namespace stickslip::report
