#include "studies/report/drawing.hpp"

#include <fmt/format.h>

#include <array>
#include <map>

#include "studies/report/html.hpp"

namespace stickslip::report {
namespace {

/// Named colours in the light scheme, those of page.css.
const std::map<std::string, std::string, std::less<>>& light() {
  static const std::map<std::string, std::string, std::less<>> colors = {
      {"ink", "#1b1d21"}, {"soft", "#5b616b"}, {"line", "#d5d8dd"}, {"paper", "#ffffff"}};
  return colors;
}

std::string in_light(const std::string& color) {
  if (color.empty()) return "none";
  const auto named = light().find(color);
  return named == light().end() ? color : named->second;
}

std::string in_page(const std::string& color) {
  if (color.empty()) return "none";
  return light().count(color) ? "var(--" + color + ")" : color;
}

/// A number without what carries nothing: "12.5", "3".
std::string short_number(double value) {
  std::string text = fmt::format("{:.2f}", value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

std::string svg_path(const Path& path) {
  std::string out;
  for (const auto& piece : path.pieces) {
    out += piece.kind;
    for (std::size_t i = 0; i < piece.at.size(); ++i) out += (i ? " " : "") + short_number(piece.at[i]);
  }
  return out;
}

// --- PDF -----------------------------------------------------------------------------------------------------------

/// Widths of Helvetica's characters 32 to 126, thousandths of the size. [Adobe font metrics of Helvetica]
constexpr std::array<int, 95> helvetica = {
    278, 278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333,  278, 278, 556, 556, 556,
    556, 556, 556, 556, 556, 556, 556, 278, 278, 584, 584, 584, 556, 1015, 667, 667, 722, 722, 667,
    611, 778, 722, 278, 500, 667, 556, 833, 722, 778, 667, 778, 722, 667,  611, 722, 667, 944, 667,
    667, 611, 278, 278, 278, 469, 556, 333, 556, 556, 500, 556, 556, 278,  556, 556, 222, 222, 500,
    222, 833, 556, 556, 556, 556, 333, 500, 278, 556, 500, 722, 500, 500,  500, 334, 260, 334, 584};

/// Characters of a text in UTF-8, those beyond ASCII as '?' but for a few that the font has.
std::string in_font(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const std::size_t length = byte < 0x80 ? 1 : byte < 0xE0 ? 2 : byte < 0xF0 ? 3 : 4;
    if (length == 1) {
      out += byte < 32 || byte == 127 ? ' ' : static_cast<char>(byte);
    } else if (length == 2 && (byte == 0xC2 || byte == 0xC3) && i + 1 < text.size()) {
      out += static_cast<char>((byte & 0x03) << 6 | (static_cast<unsigned char>(text[i + 1]) & 0x3F));  // Latin-1
    } else {
      out += '?';
    }
    i += length;
  }
  return out;
}

std::string pdf_string(std::string_view text) {
  std::string out = "(";
  for (const char c : in_font(text)) {
    if (c == '(' || c == ')' || c == '\\') out += '\\';
    out += c;
  }
  return out + ")";
}

/// "r g b" of "#RRGGBB".
std::string pdf_color(const std::string& color) {
  const std::string hex = in_light(color);
  std::string out;
  for (std::size_t i = 1; i + 1 < hex.size(); i += 2)
    out += fmt::format("{:.3f} ", std::stoi(hex.substr(i, 2), nullptr, 16) / 255.0);
  return out;
}

std::string pdf_pieces(const Path& path) {
  std::string out;
  for (const auto& piece : path.pieces) {
    for (const double v : piece.at) out += short_number(v) + " ";
    out += piece.kind == 'M' ? "m " : piece.kind == 'L' ? "l " : piece.kind == 'C' ? "c " : "h ";
  }
  return out;
}

std::string pdf_path(const Path& path, const Style& style) {
  std::string out;
  if (!style.fill.empty()) out += pdf_color(style.fill) + "rg ";
  if (!style.stroke.empty()) {
    out += pdf_color(style.stroke) + "RG " + short_number(style.width) + " w [";
    for (const double d : style.dash) out += short_number(d) + " ";
    out += "] 0 d ";
  }
  out += pdf_pieces(path);
  return out + (style.fill.empty() ? "S" : style.stroke.empty() ? "f" : "B") + "\n";
}

std::string pdf_text(double x, double y, const std::string& text, const TextStyle& style) {
  const double shift = text_width(text, style.size) * (style.anchor == Anchor::start    ? 0
                                                       : style.anchor == Anchor::middle ? 0.5
                                                                                        : 1);
  // The page is flipped, so that y runs down; the letters are flipped back.
  const std::string matrix = style.upwards ? fmt::format("0 -1 -1 0 {} {}", short_number(x), short_number(y + shift))
                                           : fmt::format("1 0 0 -1 {} {}", short_number(x - shift), short_number(y));
  return fmt::format("BT /{} {} Tf {}rg {} Tm {} Tj ET\n", style.bold ? "B" : "F", short_number(style.size),
                     pdf_color(style.color), matrix, pdf_string(text));
}

/// Objects 1 ... n of a PDF file, in order, with the table of their places.
std::string pdf_file(const std::vector<std::string>& objects) {
  std::string out = "%PDF-1.4\n%\xE2\xE3\xCF\xD3\n";
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    places.push_back(out.size());
    out += fmt::format("{} 0 obj\n{}\nendobj\n", i + 1, objects[i]);
  }
  const std::size_t table = out.size();
  out += fmt::format("xref\n0 {}\n0000000000 65535 f \n", objects.size() + 1);
  for (const std::size_t place : places) out += fmt::format("{:010} 00000 n \n", place);
  return out + fmt::format("trailer\n<< /Size {} /Root 1 0 R /Info {} 0 R >>\nstartxref\n{}\n%%EOF\n",
                           objects.size() + 1, objects.size(), table);
}

}  // namespace

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

/// The items as the content of a PDF page.
class Drawing::PdfWriter {
 public:
  std::string operator()(const Shape& shape) const { return pdf_path(shape.path, shape.style); }
  std::string operator()(const Text& item) const { return pdf_text(item.x, item.y, item.text, item.style); }
  std::string operator()(const Clip& clip) const { return "q " + pdf_pieces(clip.path) + "W n\n"; }
  std::string operator()(const Unclip&) const { return "Q\n"; }
};

std::string Drawing::inline_svg() const {
  std::string out = fmt::format(
      "<svg class=\"plot text\" viewBox=\"0 0 {0} {1}\" style=\"max-width:{0}px\" role=\"img\"><title>{2}</title>"
      "<desc>{3}</desc>\n",
      short_number(width_), short_number(height_), escape(title_), escape(description_));
  SvgWriter write(in_page, slug(title_) + "-clip-");
  for (const auto& item : items_) out += std::visit(write, item);
  return out + "</svg>\n";
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

std::string Drawing::pdf() const {
  constexpr double points = 0.75;  // a pixel of CSS is 1/96 inch, a point 1/72
  std::string content = fmt::format("{} 0 0 {} 0 {} cm 1 j\n", points, -points, short_number(points * height_));
  for (const auto& item : items_) content += std::visit(PdfWriter(), item);
  const auto font = [](const char* name) {
    return fmt::format("<< /Type /Font /Subtype /Type1 /BaseFont /{} /Encoding /WinAnsiEncoding >>", name);
  };
  return pdf_file({"<< /Type /Catalog /Pages 2 0 R >>", "<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
                   fmt::format("<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {} {}] /Contents 4 0 R "
                               "/Resources << /Font << /F 5 0 R /B 6 0 R >> >> >>",
                               short_number(points * width_), short_number(points * height_)),
                   fmt::format("<< /Length {} >>\nstream\n{}endstream", content.size(), content), font("Helvetica"),
                   font("Helvetica-Bold"),
                   fmt::format("<< /Title {} /Subject {} >>", pdf_string(title_), pdf_string(description_))});
}

Path marker(std::string_view shape, double x, double y) {
  Path path;
  const auto polygon = [&](std::initializer_list<std::pair<double, double>> corners) {
    for (const auto& [dx, dy] : corners) path.empty() ? path.move(x + dx, y + dy) : path.line(x + dx, y + dy);
    return path.close();
  };
  if (shape == "square") return path.rectangle(x - 4, y - 4, 8, 8);
  if (shape == "triangle-up") return polygon({{0, -5}, {5, 4}, {-5, 4}});
  if (shape == "triangle-down") return polygon({{0, 5}, {5, -4}, {-5, -4}});
  if (shape == "triangle-left") return polygon({{-5, 0}, {4, 5}, {4, -5}});
  if (shape == "triangle-right") return polygon({{5, 0}, {-4, 5}, {-4, -5}});
  if (shape == "diamond") return polygon({{0, -5}, {5, 0}, {0, 5}, {-5, 0}});
  if (shape == "cross") return path.move(x - 4, y).line(x + 4, y).move(x, y - 4).line(x, y + 4);
  if (shape == "failed") return path.move(x - 4, y - 4).line(x + 4, y + 4).move(x - 4, y + 4).line(x + 4, y - 4);
  return path.circle(x, y, 4);
}

double text_width(std::string_view text, double size) {
  double width = 0;
  for (const char c : in_font(text)) {
    const int place = static_cast<unsigned char>(c) - 32;
    width +=
        place >= 0 && place < static_cast<int>(helvetica.size()) ? helvetica[static_cast<std::size_t>(place)] : 556;
  }
  return width * size / 1000;
}

}  // namespace stickslip::report
