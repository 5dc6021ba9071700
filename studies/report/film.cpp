#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "studies/report/chart_parts.hpp"
#include "studies/report/colors.hpp"
#include "studies/report/look_up.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

/// States of one contact in one run: a text a step, a letter a point.
struct Strip {
  const Cell* cell;
  std::string contact, title;
  std::vector<std::string> steps;
  std::vector<double> times;
};

/// Those of a cell that tell something: more than one step, more than one point.
void add_strips(const Cell& cell, std::vector<Strip>& strips) {
  const json& film = object_at(cell.record, "film");
  std::vector<double> times;
  for (const auto& time : array_at(film, "times")) times.push_back(time.is_number() ? time.get<double>() : 0);
  for (const auto& [contact, states] : object_at(film, "contacts").items()) {
    Strip strip{&cell, contact, in_words(cell) + ", " + contact, {}, times};
    for (const auto& state : states)
      if (state.is_string()) strip.steps.push_back(state);
    const bool even = std::all_of(strip.steps.begin(), strip.steps.end(),
                                  [&](const auto& step) { return step.size() == strip.steps.front().size(); });
    if (strip.steps.size() > 1 && strip.steps.size() == times.size() && even && strip.steps.front().size() > 1)
      strips.push_back(std::move(strip));
  }
}

struct Look {
  char letter;
  const char *words, *name, *fill;
};
/// Dark, middle and light, so that grey print tells them apart.
constexpr std::array<Look, 4> looks = {{{'k', "sticks", "stick", stick_color},
                                        {'s', "slips", "slip", slip_color},
                                        {'c', "touches", "touches", "#7a7f87"},
                                        {'o', "open", "open", open_color}}};

/// Those that occur; stick and slip go together.
std::vector<Look> looks_of(const std::vector<Strip>& strips) {
  const auto present = [&](char letter) {
    return std::any_of(strips.begin(), strips.end(), [&](const Strip& strip) {
      return std::any_of(strip.steps.begin(), strip.steps.end(),
                         [&](const auto& step) { return step.find(letter) != std::string::npos; });
    });
  };
  std::vector<Look> out;
  for (const auto& look : looks) {
    const bool rubs = look.letter == 'k' || look.letter == 's';
    if (rubs ? present('k') || present('s') : present(look.letter)) out.push_back(look);
  }
  return out;
}

constexpr double strip_height = 170, gutter = 20, head = 20, foot = 30, small = 10, aside = 5;

/// One or two strips side by side over the whole width.
struct Layout {
  std::size_t columns;
  double canvas, indent, strip_width;
  double cell_width() const { return indent + strip_width + gutter; }
};

Layout layout_of(const std::vector<Strip>& strips) {
  const bool single = strips.size() == 1;
  Layout out{single ? 1u : 2u, single ? 500.0 : 692.0, 0, 0};
  for (const auto& strip : strips)
    for (const double time : strip.times) out.indent = std::max(out.indent, text_width(number(time), small));
  out.indent += 2 * aside;
  out.strip_width = out.canvas / static_cast<double>(out.columns) - out.indent - gutter;
  return out;
}

/// The strip as a grid, steps downwards, points to the right; one path a state.
void draw_strip(const Strip& strip, double left, double top, double strip_width, Drawing& drawing) {
  drawing.text(left, top - 6, strip.title, {Anchor::start, 11});
  const double width = strip_width / static_cast<double>(strip.steps.front().size());
  const double height = strip_height / static_cast<double>(strip.steps.size());
  for (const auto& look : looks) {
    Path path;
    for (std::size_t n = 0; n < strip.steps.size(); ++n) {
      const auto& step = strip.steps[n];
      for (std::size_t begin = step.find(look.letter); begin != std::string::npos;) {
        const std::size_t end = std::min(step.find_first_not_of(look.letter, begin), step.size());
        path.rectangle(left + width * static_cast<double>(begin), top + height * static_cast<double>(n),
                       width * static_cast<double>(end - begin), height);
        begin = step.find(look.letter, end);
      }
    }
    drawing.path(path, {"", look.fill, 1, {}});
  }
  drawing.path(Path().rectangle(left, top, strip_width, strip_height), {"ink"});
  // Times from the last step upwards, as many as have room.
  const auto stride = static_cast<std::size_t>(std::ceil(14 / height));
  for (std::size_t n = strip.steps.size(); n > 0; n -= std::min(stride, n))
    drawing.text(left - aside, top + height * (static_cast<double>(n) - 0.5) + 4, number(strip.times[n - 1]),
                 {Anchor::end, small, "soft"});
  if (height >= 8)
    for (std::size_t n = 1; n < strip.steps.size(); ++n) {
      const double y = top + height * static_cast<double>(n);
      drawing.line(left, y, left + strip_width, y, {"line", "", 0.6, {}});
    }
  drawing.text(left, top + strip_height + 14, "point 1", {Anchor::start, small, "soft"});
  drawing.text(left + strip_width, top + strip_height + 14, std::to_string(strip.steps.front().size()),
               {Anchor::end, small, "soft"});
}

void draw_legend(const std::vector<Strip>& strips, double x, double y, Drawing& drawing) {
  constexpr double of_wide_fonts = 1.15;  // over Helvetica
  for (const auto& look : looks_of(strips)) {
    drawing.path(Path().rectangle(x, y, 16, 12), {"ink", look.fill, 1, {}});
    drawing.text(x + 22, y + 10, look.words);
    x += 22 + of_wide_fonts * text_width(look.words, 12) + 16;
  }
  const std::string directions = "down: time; across: contact points";
  drawing.text(x, y + 10, directions);
  drawing.part(0, y - 4, x + of_wide_fonts * text_width(directions, 12), 24);
}

Table tabulate(const std::vector<Strip>& strips) {
  Table table;
  const auto present = looks_of(strips);
  table.header = {"method", "contact", "time"};
  for (const auto& look : present) table.header.emplace_back(look.name);
  for (const auto& strip : strips)
    for (std::size_t n = 0; n < strip.steps.size(); ++n) {
      std::vector<std::string> row = {strip.cell->label, strip.contact, number(strip.times[n], 6)};
      for (const auto& look : present)
        row.push_back(std::to_string(std::count(strip.steps[n].begin(), strip.steps[n].end(), look.letter)));
      table.rows.push_back(row);
    }
  return table;
}

json rows_of(const std::vector<Strip>& strips) {
  json rows = json::array();
  for (const auto& strip : strips)
    for (std::size_t n = 0; n < strip.steps.size(); ++n)
      rows.push_back({{"label", strip.cell->label},
                      {"contact", strip.contact},
                      {"time", strip.times[n]},
                      {"states", strip.steps[n]}});
  return rows;
}

/// Where all runs say the same of every contact, leaves those of the first run alone, and returns true.
bool keep_one_of_equals(std::vector<Strip>& strips) {
  const auto* first = strips.front().cell;
  const auto twin = [&](const Strip& strip) {
    return std::any_of(strips.begin(), strips.end(), [&](const Strip& other) {
      return other.cell == first && other.contact == strip.contact && other.steps == strip.steps;
    });
  };
  if (strips.back().cell == first || !std::all_of(strips.begin(), strips.end(), twin)) return false;
  std::erase_if(strips, [&](const Strip& strip) { return strip.cell != first; });
  for (auto& strip : strips) strip.title = "all runs, " + strip.contact;
  return true;
}

/// Leaves out the contacts at which no run ever touches, as long as there are others; true where there were such.
bool keep_what_touches(std::vector<Strip>& strips) {
  std::set<std::string> touch;
  for (const auto& strip : strips)
    if (std::any_of(strip.steps.begin(), strip.steps.end(),
                    [](const std::string& step) { return step.find_first_not_of('o') != std::string::npos; }))
      touch.insert(strip.contact);
  return !touch.empty() &&
         std::erase_if(strips, [&](const Strip& strip) { return touch.count(strip.contact) == 0; }) > 0;
}

/// Whether every strip is the same from the first step to the last.
bool nothing_changes(const std::vector<Strip>& strips) {
  return std::all_of(strips.begin(), strips.end(), [](const Strip& strip) {
    return std::all_of(strip.steps.begin(), strip.steps.end(), [&](auto& step) { return step == strip.steps.front(); });
  });
}

}  // namespace

std::optional<Plate> film_of_states(const Study& study) {
  const auto shown = telling_cells(study, Furthest::added);
  std::vector<Strip> strips;
  for (const auto& cell : study.cells)
    if (cell.variant == study.main_variant && std::find(shown.begin(), shown.end(), cell.label) != shown.end())
      add_strips(cell, strips);
  if (strips.empty()) return std::nullopt;
  const bool some_never_touch = keep_what_touches(strips), agree = keep_one_of_equals(strips);
  constexpr std::size_t most = 12;
  const std::size_t left_out = strips.size() - std::min(strips.size(), most);
  strips.resize(strips.size() - left_out);
  const std::string title = "Film of the contact: the state of each point, step by step";
  std::string text = "Time runs downwards, the contact points stand side by side in the order of their numbers";
  if (agree)
    text += "; the same in the most accurate run of each method and in the one furthest off";
  else if (study.cells.size() > 1)
    text +=
        "; the most accurate run of each method and the one furthest off. Where two pictures differ, the methods "
        "disagree on the state of a point";
  text += some_never_touch ? "; contacts that never touch are left out." : ".";
  if (left_out > 0) text += fmt::format(" {} more are left out.", left_out);
  const Layout layout = layout_of(strips);
  const double cell_height = head + strip_height + foot;
  const std::size_t lines = (strips.size() + layout.columns - 1) / layout.columns;
  const double bottom = cell_height * static_cast<double>(lines) + 6;
  Plate plate{"film", title, text, Drawing(layout.canvas, bottom + 20, title, text), tabulate(strips), rows_of(strips)};
  for (std::size_t i = 0; i < strips.size(); ++i) {
    const double left = layout.cell_width() * static_cast<double>(i % layout.columns);
    const double top = cell_height * static_cast<double>(i / layout.columns);
    draw_strip(strips[i], left + layout.indent, top + head, layout.strip_width, plate.drawing);
    plate.drawing.part(left, top, layout.cell_width(), cell_height);
  }
  draw_legend(strips, layout.indent, bottom, plate.drawing);
  if (nothing_changes(strips) && (agree || study.cells.size() == 1)) plate.folded = "no point changes its state";
  return plate;
}

}  // namespace stickslip::report
