#include "studies/report/drawing.hpp"

#include <fmt/format.h>

#include "studies/report/colors.hpp"
#include "studies/report/drawing_parts.hpp"
#include "studies/report/html.hpp"

namespace stickslip::report {
namespace {

std::string in_page(const std::string& color) {
  if (color.empty()) return "none";
  if (is_of_curve(color)) return "light-dark(" + in_light(color) + "," + on_dark(in_light(color)) + ")";
  return is_named(color) ? "var(--" + color + ")" : color;
}

}  // namespace

std::string svg_path(const Path& path) {
  std::string out;
  for (const auto& piece : path.pieces) {
    out += piece.kind;
    for (std::size_t i = 0; i < piece.at.size(); ++i) out += (i ? " " : "") + short_number(piece.at[i]);
  }
  return out;
}

Path& Path::circle(double x, double y, double r) {
  const double k = 0.5522847498 * r;  // quarter of a circle by a cubic, off by 3e-4 of r
  return move(x - r, y)
      .curve(x - r, y - k, x - k, y - r, x, y - r)
      .curve(x + k, y - r, x + r, y - k, x + r, y)
      .curve(x + r, y + k, x + k, y + r, x, y + r)
      .curve(x - k, y + r, x - r, y + k, x - r, y)
      .close();
}

void Drawing::path(Path path, Style style, std::string tooltip) {
  if (!path.empty()) items_.push_back(Shape{std::move(path), std::move(style), std::move(tooltip)});
}

void Drawing::line(double x1, double y1, double x2, double y2, const Style& style) {
  path(Path().move(x1, y1).line(x2, y2), style);
}

void Drawing::text(double x, double y, std::string text, const TextStyle& style) {
  if (!text.empty()) items_.push_back(Text{x, y, std::move(text), style});
}

void Drawing::clip(Path path) { items_.push_back(Clip{std::move(path)}); }

void Drawing::unclip() { items_.push_back(Unclip{}); }

/// The items as SVG; `color` writes a colour out. Ids begin with `prefix`, since a page holds many drawings.
class Drawing::SvgWriter {
 public:
  SvgWriter(std::string (*color)(const std::string&), std::string prefix) : color_(color), prefix_(std::move(prefix)) {}

  std::string operator()(const Shape& shape) const {
    const auto& style = shape.style;
    std::string out = fmt::format("<path d=\"{}\" style=\"fill:{};stroke:{}", svg_path(shape.path), color_(style.fill),
                                  color_(style.stroke));
    if (!style.stroke.empty()) out += ";stroke-width:" + short_number(style.width);
    for (std::size_t i = 0; i < style.dash.size(); ++i)
      out += (i ? "," : ";stroke-dasharray:") + short_number(style.dash[i]);
    return out + (shape.tooltip.empty() ? "\"/>\n" : "\"><title>" + escape(shape.tooltip) + "</title></path>\n");
  }

  std::string operator()(const Text& item) const {
    const auto& style = item.style;
    std::string out = fmt::format("<text x=\"{}\" y=\"{}\"", short_number(item.x), short_number(item.y));
    if (style.upwards)
      out += fmt::format(" transform=\"rotate(-90 {} {})\"", short_number(item.x), short_number(item.y));
    if (style.anchor != Anchor::start)
      out += fmt::format(" text-anchor=\"{}\"", style.anchor == Anchor::middle ? "middle" : "end");
    return out + fmt::format(" style=\"font-size:{}px;fill:{}{}\">{}</text>\n", short_number(style.size),
                             color_(style.color), style.bold ? ";font-weight:bold" : "", escape(item.text));
  }

  std::string operator()(const Clip& clip) {
    const std::string id = prefix_ + std::to_string(++clips_);
    return fmt::format("<clipPath id=\"{0}\"><path d=\"{1}\"/></clipPath><g clip-path=\"url(#{0})\">\n", id,
                       svg_path(clip.path));
  }

  std::string operator()(const Unclip&) const { return "</g>\n"; }

 private:
  std::string (*color_)(const std::string&);
  std::string prefix_;
  int clips_ = 0;
};

std::string Drawing::inline_svg() const {
  constexpr double scrolls_below = 520;  // of wider drawings, on screens that do not show their parts (page.css)
  const std::string id = slug(title_) + "-all";
  std::string out = fmt::format(
      "<svg class=\"plot text{4}\" viewBox=\"0 0 {0} {1}\" style=\"max-width:{0}px\" role=\"img\"><title>{2}</title>"
      "<desc>{3}</desc>\n",
      short_number(width_), short_number(height_), escape(title_), escape(description_),
      std::string(parts_.empty() ? "" : " whole") + (width_ < scrolls_below ? " narrow" : ""));
  if (!parts_.empty()) out += "<g id=\"" + id + "\">\n";
  SvgWriter write(in_page, slug(title_) + "-clip-");
  for (const auto& item : items_) out += std::visit(write, item);
  out += parts_.empty() ? "</svg>\n" : "</g></svg>\n";
  for (const auto& part : parts_)
    out += fmt::format(
        "<svg class=\"plot text part\" viewBox=\"{} {} {} {}\" style=\"max-width:{}px\" aria-hidden=\"true\">"
        "<use href=\"#{}\"/></svg>\n",
        short_number(part.x), short_number(part.y), short_number(part.width), short_number(part.height),
        short_number(part.width), id);
  return out;
}

std::string Drawing::svg_file() const {
  std::string out = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" "
      "height=\"{1}\" viewBox=\"0 0 {0} {1}\" role=\"img\" font-family=\"Helvetica, Arial, sans-serif\">"
      "<title>{2}</title><desc>{3}</desc>\n<rect width=\"{0}\" height=\"{1}\" fill=\"#ffffff\"/>\n",
      short_number(width_), short_number(height_), escape(title_), escape(description_));
  SvgWriter write(in_light, "clip-");
  for (const auto& item : items_) out += std::visit(write, item);
  return out + "</svg>\n";
}

Path marker(std::string_view shape, double x, double y, double size) {
  Path path;
  const double r = 4 * size;
  const auto polygon = [&](std::initializer_list<std::pair<double, double>> corners) {
    for (const auto& [dx, dy] : corners) {
      const double to_x = x + size * dx, to_y = y + size * dy;
      path.empty() ? path.move(to_x, to_y) : path.line(to_x, to_y);
    }
    return path.close();
  };
  if (shape == "square") return path.rectangle(x - r, y - r, 2 * r, 2 * r);
  if (shape == "triangle-up") return polygon({{0, -5}, {5, 4}, {-5, 4}});
  if (shape == "triangle-down") return polygon({{0, 5}, {5, -4}, {-5, -4}});
  if (shape == "triangle-left") return polygon({{-5, 0}, {4, 5}, {4, -5}});
  if (shape == "triangle-right") return polygon({{5, 0}, {-4, 5}, {-4, -5}});
  if (shape == "diamond") return polygon({{0, -5}, {5, 0}, {0, 5}, {-5, 0}});
  if (shape == "cross") return path.move(x - r, y).line(x + r, y).move(x, y - r).line(x, y + r);
  if (shape == "failed") return path.move(x - r, y - r).line(x + r, y + r).move(x - r, y + r).line(x + r, y - r);
  return path.circle(x, y, r);
}

}  // namespace stickslip::report
