#include <fmt/format.h>

#include <set>

#include "studies/report/drawing.hpp"
#include "studies/report/drawing_parts.hpp"
#include "studies/report/embedded.hpp"
#include "studies/report/font_subset.hpp"

namespace stickslip::report {
namespace {

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

std::string stream(const std::string& entries, const std::string& content) {
  return fmt::format("<< {}/Length {} >>\nstream\n{}\nendstream", entries, content.size(), content);
}

/// The objects of a font, the first of which is number `first`: embedded with what `characters` need of it, or, where
/// the program was built without it, Helvetica, which every reader of PDF has.
std::vector<std::string> font_objects(std::string_view font, const std::set<unsigned char>& characters, bool bold,
                                      std::size_t first) {
  if (font.empty())
    return {fmt::format("<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica{} /Encoding /WinAnsiEncoding >>",
                        bold ? "-Bold" : "")};
  const FontSubset subset = subset_of(font, characters);
  const char* const name = bold ? "STICKB+LiberationSans-Bold" : "STICKS+LiberationSans";
  std::string widths;
  for (unsigned code = *characters.begin(); code <= *characters.rbegin(); ++code) {
    const auto advance = subset.advances.find(static_cast<unsigned char>(code));
    widths += std::to_string(advance == subset.advances.end() ? 0 : advance->second) + " ";
  }
  constexpr int not_symbolic = 32, stem = 80;
  return {fmt::format("<< /Type /Font /Subtype /TrueType /BaseFont /{} /Encoding /WinAnsiEncoding /FirstChar {} "
                      "/LastChar {} /Widths [ {}] /FontDescriptor {} 0 R >>",
                      name, *characters.begin(), *characters.rbegin(), widths, first + 1),
          fmt::format("<< /Type /FontDescriptor /FontName /{} /Flags {} /FontBBox [{} {} {} {}] /ItalicAngle 0 "
                      "/Ascent {} /Descent {} /CapHeight {} /StemV {} /FontFile2 {} 0 R >>",
                      name, not_symbolic, subset.left, subset.bottom, subset.right, subset.top, subset.ascent,
                      subset.descent, subset.cap_height, stem, first + 2),
          stream(fmt::format("/Length1 {} ", subset.file.size()), subset.file)};
}

}  // namespace

/// The items as the content of a PDF page, and the characters they show in each font.
class Drawing::PdfWriter {
 public:
  std::string operator()(const Shape& shape) { return pdf_path(shape.path, shape.style); }
  std::string operator()(const Text& item) {
    for (const char c : in_font(item.text)) characters[item.style.bold].insert(static_cast<unsigned char>(c));
    return pdf_text(item.x, item.y, item.text, item.style);
  }
  std::string operator()(const Clip& clip) { return "q " + pdf_pieces(clip.path) + "W n\n"; }
  std::string operator()(const Unclip&) { return "Q\n"; }

  std::set<unsigned char> characters[2];  ///< of the upright font, of the bold one
};

std::string Drawing::pdf() const {
  constexpr double points = 0.75;  // a pixel of CSS is 1/96 inch, a point 1/72
  std::string content = fmt::format("{} 0 0 {} 0 {} cm 1 j\n", points, -points, short_number(points * height_));
  PdfWriter write;
  for (const auto& item : items_) content += std::visit(write, item);
  std::vector<std::string> objects = {"<< /Type /Catalog /Pages 2 0 R >>", "<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
                                      "", stream("", content)};
  std::string fonts;
  for (const bool bold : {false, true}) {
    if (write.characters[bold].empty()) continue;
    fonts += fmt::format("/{} {} 0 R ", bold ? "B" : "F", objects.size() + 1);
    const auto font = bold ? embedded::bold_font() : embedded::upright_font();
    for (auto& object : font_objects(font, write.characters[bold], bold, objects.size() + 1))
      objects.push_back(std::move(object));
  }
  objects[2] = fmt::format(
      "<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {} {}] /Contents 4 0 R /Resources << /Font << {}>> >> >>",
      short_number(points * width_), short_number(points * height_), fonts);
  objects.push_back(fmt::format("<< /Title {} /Subject {} >>", pdf_string(title_), pdf_string(description_)));
  return pdf_file(objects);
}

}  // namespace stickslip::report
