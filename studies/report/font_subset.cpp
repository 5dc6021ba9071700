#include "studies/report/font_subset.hpp"

#include <array>
#include <cmath>
#include <cstdint>

namespace stickslip::report {
namespace {

/// Big-endian numbers of a table.
class FontTable {
 public:
  explicit FontTable(std::string_view bytes) : bytes_(bytes) {}
  unsigned u8(std::size_t at) const { return static_cast<unsigned char>(bytes_.at(at)); }
  unsigned u16(std::size_t at) const { return u8(at) << 8 | u8(at + 1); }
  int i16(std::size_t at) const { return static_cast<std::int16_t>(u16(at)); }
  std::size_t u32(std::size_t at) const { return static_cast<std::size_t>(u16(at)) << 16 | u16(at + 2); }
  std::string_view bytes() const { return bytes_; }

 private:
  std::string_view bytes_;
};

void put16(std::string& out, std::size_t value) {
  out += static_cast<char>(value >> 8 & 0xFF);
  out += static_cast<char>(value & 0xFF);
}
void put32(std::string& out, std::size_t value) {
  put16(out, value >> 16);
  put16(out, value & 0xFFFF);
}
void replace16(std::string& bytes, std::size_t at, std::size_t value) {
  bytes[at] = static_cast<char>(value >> 8 & 0xFF);
  bytes[at + 1] = static_cast<char>(value & 0xFF);
}

class Font {
 public:
  explicit Font(std::string_view file) : file_(file) {}

  /// Empty where there is none of this tag.
  FontTable table(std::string_view tag) const {
    for (std::size_t i = 0; i < file_.u16(4); ++i)
      if (const std::size_t entry = 12 + 16 * i; file_.bytes().substr(entry, 4) == tag)
        return FontTable(file_.bytes().substr(file_.u32(entry + 8), file_.u32(entry + 12)));
    return FontTable({});
  }

  /// 0, the sign for what is missing, of a character that the font lacks.
  unsigned glyph(unsigned character) const {
    const FontTable cmap = table("cmap");
    for (std::size_t i = 0; i < cmap.u16(2); ++i) {
      const std::size_t entry = 4 + 8 * i, map = cmap.u32(entry + 4);
      if (cmap.u16(entry) != 3 || cmap.u16(entry + 2) != 1 || cmap.u16(map) != 4) continue;  // Unicode by segments
      const std::size_t twice = cmap.u16(map + 6), ends = map + 14, starts = ends + twice + 2, deltas = starts + twice,
                        offsets = deltas + twice;
      for (std::size_t s = 0; s < twice; s += 2) {
        if (character > cmap.u16(ends + s)) continue;
        if (character < cmap.u16(starts + s)) return 0;
        const unsigned offset = cmap.u16(offsets + s), delta = cmap.u16(deltas + s);
        if (offset == 0) return (character + delta) & 0xFFFF;
        const unsigned found = cmap.u16(offsets + s + offset + 2 * (character - cmap.u16(starts + s)));
        return found == 0 ? 0 : (found + delta) & 0xFFFF;
      }
    }
    return 0;
  }

  std::string_view outline(unsigned glyph) const {
    const FontTable loca = table("loca");
    const bool wide = table("head").i16(50) == 1;
    const auto place = [&](std::size_t i) { return wide ? loca.u32(4 * i) : 2 * loca.u16(2 * i); };
    return table("glyf").bytes().substr(place(glyph), place(glyph + 1) - place(glyph));
  }

  /// Advance and left bearing, as hmtx has them.
  std::array<unsigned, 2> metrics(unsigned glyph) const {
    const FontTable hmtx = table("hmtx");
    const unsigned full = table("hhea").u16(34);
    if (glyph < full) return {hmtx.u16(4 * glyph), hmtx.u16(4 * glyph + 2)};
    return {hmtx.u16(4 * (full - 1)), hmtx.u16(4 * full + 2 * (glyph - full))};
  }

  int thousandths(int units) const { return static_cast<int>(std::lround(1000.0 * units / table("head").u16(18))); }

 private:
  FontTable file_;
};

/// Where a composite outline names the glyphs it is made of.
std::vector<std::size_t> component_places(std::string_view outline) {
  constexpr unsigned words = 0x1, scale = 0x8, more = 0x20, two_scales = 0x40, matrix = 0x80;
  const FontTable glyph(outline);
  std::vector<std::size_t> places;
  if (outline.empty() || glyph.i16(0) >= 0) return places;
  for (std::size_t at = 10;;) {
    const unsigned flags = glyph.u16(at);
    places.push_back(at + 2);
    at += 4 + (flags & words ? 4 : 2) + (flags & scale ? 2 : flags & two_scales ? 4 : flags & matrix ? 8 : 0);
    if (!(flags & more)) return places;
  }
}

/// The glyphs of a subset, in their new order, the sign for what is missing first.
class Kept {
 public:
  explicit Kept(const Font& font) : font_(font) { add(0); }

  /// The new number of a glyph, which is added with all it is made of.
  std::size_t add(unsigned glyph) {
    if (const auto known = number_.find(glyph); known != number_.end()) return known->second;
    const std::size_t number = number_.size();
    number_[glyph] = number;
    old_.push_back(glyph);
    outlines_.emplace_back(font_.outline(glyph));
    for (const std::size_t place : component_places(outlines_[number])) {
      const unsigned component = FontTable(outlines_[number]).u16(place);
      const std::size_t renumbered = add(component);  // may move outlines_
      replace16(outlines_[number], place, renumbered);
    }
    return number;
  }
  const std::vector<unsigned>& old_numbers() const { return old_; }
  const std::vector<std::string>& outlines() const { return outlines_; }

 private:
  const Font& font_;
  std::map<unsigned, std::size_t> number_;
  std::vector<unsigned> old_;
  std::vector<std::string> outlines_;
};

/// cmap with one segment a character, by Unicode. pre: ascending.
std::string character_map(const std::map<unsigned char, std::size_t>& glyphs) {
  const std::size_t segments = glyphs.size() + 1;
  std::string ends, starts, deltas, offsets, out;
  for (const auto& [character, glyph] : glyphs) {
    put16(ends, character);
    put16(starts, character);
    put16(deltas, (glyph + 0x10000 - character) & 0xFFFF);
    put16(offsets, 0);
  }
  put16(ends, 0xFFFF);  // the last one, which every map of this format has
  put16(starts, 0xFFFF);
  put16(deltas, 1);
  put16(offsets, 0);
  std::size_t power = 1, log = 0;
  while (2 * power <= segments) power *= 2, ++log;
  for (const std::size_t value : {0, 1, 3, 1}) put16(out, value);
  put32(out, 12);
  for (const std::size_t value :
       {std::size_t(4), 16 + 8 * segments, std::size_t(0), 2 * segments, 2 * power, log, 2 * (segments - power)})
    put16(out, value);
  out += ends;
  put16(out, 0);
  return out + starts + deltas + offsets;
}

std::size_t checksum(std::string_view bytes) {
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i)
    sum += static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i])) << (24 - 8 * (i % 4));
  return sum;
}

/// A font file of these tables. The sum over the whole file (head.checkSumAdjustment) is left 0: no reader of PDF asks.
std::string font_file(const std::map<std::string, std::string>& tables) {
  std::size_t power = 1, log = 0;
  while (2 * power <= tables.size()) power *= 2, ++log;
  std::string head, body;
  put32(head, 0x00010000);
  for (const std::size_t value : {tables.size(), 16 * power, log, 16 * (tables.size() - power)}) put16(head, value);
  const std::size_t first = 12 + 16 * tables.size();
  for (const auto& [tag, content] : tables) {
    head += tag;
    put32(head, checksum(content));
    put32(head, first + body.size());
    put32(head, content.size());
    body += content;
    body.resize((body.size() + 3) / 4 * 4);
  }
  return head + body;
}

}  // namespace

FontSubset subset_of(std::string_view file, const std::set<unsigned char>& characters) {
  const Font font(file);
  Kept kept(font);
  std::map<unsigned char, std::size_t> glyphs;
  FontSubset subset{};
  for (const unsigned char character : characters) {
    const unsigned glyph = font.glyph(character);
    glyphs[character] = kept.add(glyph);
    subset.advances[character] = font.thousandths(static_cast<int>(font.metrics(glyph)[0]));
  }
  std::map<std::string, std::string> tables;
  for (const char* tag : {"cvt ", "fpgm", "prep", "head", "hhea", "maxp"})
    if (const auto bytes = font.table(tag).bytes(); !bytes.empty()) tables[tag] = bytes;
  auto &glyf = tables["glyf"], &loca = tables["loca"], &hmtx = tables["hmtx"];
  for (std::size_t i = 0; i < kept.outlines().size(); ++i) {
    put32(loca, glyf.size());
    glyf += kept.outlines()[i];
    glyf.resize((glyf.size() + 3) / 4 * 4);
    for (const unsigned metric : font.metrics(kept.old_numbers()[i])) put16(hmtx, metric);
  }
  put32(loca, glyf.size());
  tables["cmap"] = character_map(glyphs);
  replace16(tables["head"], 50, 1);  // loca in bytes, of four each
  for (const std::size_t at : {8, 10}) replace16(tables["head"], at, 0);
  replace16(tables["hhea"], 34, kept.outlines().size());
  replace16(tables["maxp"], 4, kept.outlines().size());
  subset.file = font_file(tables);
  const FontTable head = font.table("head"), hhea = font.table("hhea"), os2 = font.table("OS/2");
  const auto thousandths = [&](int units) { return font.thousandths(units); };
  subset.left = thousandths(head.i16(36));
  subset.bottom = thousandths(head.i16(38));
  subset.right = thousandths(head.i16(40));
  subset.top = thousandths(head.i16(42));
  subset.ascent = thousandths(hhea.i16(4));
  subset.descent = thousandths(hhea.i16(6));
  subset.cap_height = os2.bytes().size() >= 90 ? thousandths(os2.i16(88)) : subset.ascent;
  return subset;
}

}  // namespace stickslip::report
