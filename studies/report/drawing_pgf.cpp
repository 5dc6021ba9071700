#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "studies/io/numerals.hpp"
#include "studies/report/drawing.hpp"
#include "studies/report/drawing_parts.hpp"

namespace stickslip::report {
namespace {

/// The raised letters that `text` begins with, taken off it.
std::string take_raised(std::string_view& text) {
  std::string out;
  for (bool more = true; more;) {
    more = false;
    for (std::size_t i = 0; i < lowered.size(); ++i)
      if (text.starts_with(raised[i])) {
        out += lowered[i];
        text.remove_prefix(raised[i].size());
        more = true;
      }
  }
  return out;
}

/// What LaTeX has of its own for letters that it does not know as text (pdfTeX stops at them).
constexpr std::array<std::pair<std::string_view, std::string_view>, 56> letters_of_formulas{
    {{"α", "\\alpha"},   {"β", "\\beta"},     {"γ", "\\gamma"},    {"δ", "\\delta"}, {"ε", "\\varepsilon"},
     {"ζ", "\\zeta"},    {"η", "\\eta"},      {"θ", "\\theta"},    {"ι", "\\iota"},  {"κ", "\\kappa"},
     {"λ", "\\lambda"},  {"μ", "\\mu"},       {"ν", "\\nu"},       {"ξ", "\\xi"},    {"ο", "o"},
     {"π", "\\pi"},      {"ρ", "\\rho"},      {"ς", "\\varsigma"}, {"σ", "\\sigma"}, {"τ", "\\tau"},
     {"υ", "\\upsilon"}, {"φ", "\\varphi"},   {"χ", "\\chi"},      {"ψ", "\\psi"},   {"ω", "\\omega"},
     {"ϕ", "\\phi"},     {"ϑ", "\\vartheta"}, {"Α", "A"},          {"Β", "B"},       {"Γ", "\\Gamma"},
     {"Δ", "\\Delta"},   {"Ε", "E"},          {"Ζ", "Z"},          {"Η", "H"},       {"Θ", "\\Theta"},
     {"Ι", "I"},         {"Κ", "K"},          {"Λ", "\\Lambda"},   {"Μ", "M"},       {"Ν", "N"},
     {"Ξ", "\\Xi"},      {"Ο", "O"},          {"Π", "\\Pi"},       {"Ρ", "P"},       {"Σ", "\\Sigma"},
     {"Τ", "T"},         {"Υ", "\\Upsilon"},  {"Φ", "\\Phi"},      {"Χ", "X"},       {"Ψ", "\\Psi"},
     {"Ω", "\\Omega"},   {"−", "-"},          {"≤", "\\leq"},      {"≥", "\\geq"},   {"∞", "\\infty"},
     {"∂", "\\partial"}}};

/// The letter of a formula that `text` begins with, taken off it; empty: none.
std::string_view take_letter(std::string_view& text) {
  const auto found = std::find_if(letters_of_formulas.begin(), letters_of_formulas.end(),
                                  [&](const auto& letter) { return text.starts_with(letter.first); });
  if (found == letters_of_formulas.end()) return {};
  text.remove_prefix(found->first.size());
  return found->second;
}

}  // namespace

std::string tex_text(const std::string& text) {
  std::string out;
  for (std::string_view rest = text; !rest.empty();) {
    if (const std::string power = take_raised(rest); !power.empty()) {
      out += "\\textsuperscript{" + power + "}";
      continue;
    }
    if (const std::string_view letter = take_letter(rest); !letter.empty()) {
      out += "\\(";
      out += letter;
      out += "\\)";
      continue;
    }
    const char c = rest.front();
    rest.remove_prefix(1);
    switch (c) {
      case '\\':
        out += "\\textbackslash{}";
        break;
      case '~':
        out += "\\textasciitilde{}";
        break;
      case '^':
        out += "\\textasciicircum{}";
        break;
      case '<':
        out += "\\textless{}";
        break;
      case '>':
        out += "\\textgreater{}";
        break;
      case '&':
      case '%':
      case '$':
      case '#':
      case '_':
      case '{':
      case '}':
        out += '\\';
        out += c;
        break;
      default:
        out += static_cast<unsigned char>(c) < 32 ? ' ' : c;
    }
  }
  return out;
}

/// Short names for what a drawing repeats, of PGF's basic layer: with them a figure has a third of the bytes.
constexpr std::string_view short_names = R"(\ifx\stickslipunit\undefined\newdimen\stickslipunit\fi%
\def\sP#1#2{\pgfpoint{#1\stickslipunit}{#2\stickslipunit}}%
\def\sM#1#2{\pgfpathmoveto{\sP{#1}{#2}}}%
\def\sL#1#2{\pgfpathlineto{\sP{#1}{#2}}}%
\def\sC#1#2#3#4#5#6{\pgfpathcurveto{\sP{#1}{#2}}{\sP{#3}{#4}}{\sP{#5}{#6}}}%
\def\sZ{\pgfpathclose}%
\def\sB{\begin{pgfscope}}%
\def\sE{\end{pgfscope}}%
\def\sH#1{\definecolor{stickslip}{HTML}{#1}}%
\def\sF#1{\sH{#1}\pgfsetfillcolor{stickslip}}%
\def\sS#1#2{\sH{#1}\pgfsetstrokecolor{stickslip}\pgfsetlinewidth{#2\stickslipunit}}%
\def\sT#1#2#3#4#5#6{\sB\sH{#1}\color{stickslip}\pgftext[x=#3\stickslipunit,y=#4\stickslipunit,#2base]%
{\fontsize{#5\stickslipunit}{#5\stickslipunit}\selectfont #6}\sE}%
)";

/// The items by these names, y up. A pixel is \\stickslipunit.
class Drawing::PgfWriter {
 public:
  explicit PgfWriter(double height) : height_(height) {}

  std::string operator()(const Shape& shape) const {
    const auto& style = shape.style;
    std::string out = "\\sB" + path(shape.path);
    if (!style.fill.empty()) out += "\\sF{" + color(style.fill) + "}";
    if (!style.stroke.empty()) {
      out += "\\sS{" + color(style.stroke) + "}{" + short_number(style.width) + "}";
      std::string dash;
      for (const double d : style.dash) dash += "{" + short_number(d) + "\\stickslipunit}";
      if (!dash.empty()) out += "\\pgfsetdash{" + dash + "}{0pt}";
    }
    const char* const use = style.fill.empty() ? "stroke" : style.stroke.empty() ? "fill" : "fill,stroke";
    return out + "\\pgfusepath{" + use + "}\\sE%\n";
  }

  std::string operator()(const Text& item) const {
    const auto& style = item.style;
    const char* const anchor = style.anchor == Anchor::start ? "left," : style.anchor == Anchor::end ? "right," : "";
    return fmt::format("\\sT{{{}}}{{{}{}}}{}{{{}}}{{{}{}}}%\n", color(style.color), style.upwards ? "rotate=90," : "",
                       anchor, place(item.x, item.y), short_number(style.size), style.bold ? "\\bfseries " : "",
                       tex_text(item.text));
  }

  std::string operator()(const Clip& clip) const { return "\\sB" + path(clip.path) + "\\pgfusepath{clip}%\n"; }

  std::string operator()(const Unclip&) const { return "\\sE%\n"; }

 private:
  double height_;

  static std::string color(const std::string& name) { return in_light(name).substr(1); }

  std::string place(double x, double y) const { return "{" + short_number(x) + "}{" + short_number(height_ - y) + "}"; }

  std::string path(const Path& path) const {
    std::string out;
    for (const auto& piece : path.pieces) {
      out += std::string("\\s") + piece.kind;
      for (std::size_t i = 0; i + 1 < piece.at.size(); i += 2) out += place(piece.at[i], piece.at[i + 1]);
      out += "%\n";
    }
    return out;
  }
};

std::string Drawing::pgf_picture() const {
  std::string out = fmt::format(
      "\\stickslipunit=\\linewidth\\divide\\stickslipunit by {:.0f}%\n\\begin{{pgfpicture}}%\n"
      "\\pgfpathrectangle{{\\pgfpointorigin}}{{\\sP{{{}}}{{{}}}}}\\pgfusepath{{use as bounding box}}%\n"
      "\\pgfsetroundjoin%\n",
      width_, short_number(width_), short_number(height_));
  PgfWriter write(height_);
  for (const auto& item : items_) out += std::visit(write, item);
  return out + "\\end{pgfpicture}%\n";
}

std::string Drawing::pgf(const Drawing* narrow) const {
  const std::string layouts =
      narrow ? "\\ifdim\\linewidth<120mm%\n" + narrow->pgf_picture() + "\\else%\n" + pgf_picture() + "\\fi%\n"
             : pgf_picture();
  return "% \\usepackage{pgf} and \\input this file: as wide as \\linewidth, texts in the font of the document.\n"
         "\\begingroup%\n" +
         std::string(short_names) + layouts + "\\endgroup%\n";
}

std::size_t Drawing::pieces() const {
  std::size_t count = 0;
  for (const auto& item : items_)
    if (const auto* shape = std::get_if<Shape>(&item)) count += shape->path.pieces.size();
  return count;
}

}  // namespace stickslip::report
