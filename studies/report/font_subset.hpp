/// A TrueType font cut down to the characters of a drawing, as a PDF embeds it. [Apple, TrueType Reference Manual;
/// ISO 32000-1, 9.6.3 and 9.9]
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace stickslip::report {

/// Lengths are thousandths of the font's size, y up.
struct FontSubset {
  std::string file;                       ///< a TrueType font: outlines of `characters`, and those they are made of
  std::map<unsigned char, int> advances;  ///< width of each character
  int left, bottom, right, top;           ///< box around all characters of the whole font
  int ascent, descent, cap_height;
};

/// `characters` by their codes in Latin-1; those that the font lacks become its sign for that. pre: `font` is a
/// TrueType file with outlines (glyf), such as Liberation Sans.
FontSubset subset_of(std::string_view font, const std::set<unsigned char>& characters);

}  // namespace stickslip::report
