#include "studies/report/picture_contact.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "studies/report/colors.hpp"
#include "studies/report/html.hpp"
#include "studies/report/look_up.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

/// `size`: a share of the full one.
void draw_state(const std::string& state, double x, double y, double size, const std::string& tooltip,
                Drawing& drawing) {
  const auto mark = [&](const char* shape, double share, const char* stroke, const char* fill) {
    drawing.path(marker(shape, x, y, share * size), {stroke, fill, 0.8 * size, {}}, tooltip);
  };
  if (state == "stick")
    mark("square", 0.875, "#ffffff", stick_color);
  else if (state == "slip")
    mark("triangle-up", 0.9, "#000000", slip_color);
  else
    mark("circle", 0.75, state == "closed" ? "#000000" : "#333333", state == "closed" ? closed_color : open_color);
}

/// The size of symbols of which neighbours do not cover one another: by the median way from one to the next, since they
/// come in order along their sides. Not so small that their colours are lost.
double size_of(const std::vector<Point>& places) {
  constexpr double room = 9, least = 0.45;  // pixels that a symbol of full size takes; a share
  std::vector<double> ways;
  for (std::size_t i = 1; i < places.size(); ++i)
    ways.push_back(std::hypot(places[i].x - places[i - 1].x, places[i].y - places[i - 1].y));
  if (ways.empty()) return 1;
  const auto middle = ways.begin() + static_cast<std::ptrdiff_t>(ways.size() / 2);
  std::nth_element(ways.begin(), middle, ways.end());
  return std::clamp(*middle / room, least, 1.0);
}

int hold(const std::string& state) { return state == "stick" ? 2 : state == "open" ? 0 : 1; }

std::string in_words(const ContactPoint& c) {
  if (c.state == "open") return c.name + ": open";
  const bool rubs = c.state == "stick" || c.state == "slip";
  return fmt::format("{}: {}, normal traction {}{}", c.name, c.state, plain(c.normal),
                     rubs ? ", tangential " + plain(c.tangential) : "");
}

}  // namespace

std::vector<ContactPoint> read_contact(const json& contact, const std::vector<Point>& displacement) {
  std::vector<ContactPoint> out;
  for (const auto& c : contact) {
    if (!at(c, "x").is_number() || !at(c, "y").is_number()) continue;
    const json& node = at(c, "node");
    const bool known = node.is_number_integer() && node >= 0 && node < displacement.size();
    out.push_back({{c["x"], c["y"]},
                   known ? displacement[node.get<std::size_t>()] : Point{},
                   plain(at(c, "name")),
                   plain(at(c, "state")),
                   at(c, "normal"),
                   at(c, "tangential"),
                   known ? node.get<int>() : -1});
  }
  return out;
}

void draw_contact(const std::vector<ContactPoint>& contact, double scale, const Frame& frame, Drawing& drawing) {
  struct Symbol {
    const ContactPoint* point;  ///< that holds most
    std::string tooltip;
  };
  std::vector<Symbol> symbols;
  std::map<int, std::size_t> of_node;
  for (const auto& c : contact) {
    const auto place = c.node < 0 ? of_node.end() : of_node.find(c.node);
    if (place == of_node.end()) {
      if (c.node >= 0) of_node[c.node] = symbols.size();
      symbols.push_back({&c, in_words(c)});
      continue;
    }
    Symbol& symbol = symbols[place->second];
    symbol.tooltip += "; " + in_words(c);
    if (hold(c.state) > hold(symbol.point->state)) symbol.point = &c;
  }
  const Box& w = frame.window();
  std::vector<const Symbol*> seen;
  std::vector<Point> places;
  for (const auto& symbol : symbols) {
    const Point p = symbol.point->enlarged(scale);
    if (p.x < w.min.x || p.x > w.max.x || p.y < w.min.y || p.y > w.max.y) continue;
    seen.push_back(&symbol);
    places.push_back({frame.x(p.x), frame.y(p.y)});
  }
  const double size = size_of(places);
  for (std::size_t i = 0; i < seen.size(); ++i)
    draw_state(seen[i]->point->state, places[i].x, places[i].y, size, seen[i]->tooltip, drawing);
}

void draw_states(const std::vector<ContactPoint>& contact, double y, Drawing& drawing) {
  const auto present = [&](const std::string& state) {
    return std::any_of(contact.begin(), contact.end(), [&](const ContactPoint& c) { return c.state == state; });
  };
  constexpr double left = 400;
  double x = left;
  for (const auto& [state, words] :
       {std::pair{"stick", "sticks"}, {"slip", "slips"}, {"closed", "touches"}, {"open", "open"}}) {
    if (!present(state)) continue;
    draw_state(state, x, y + 8, 1, "", drawing);
    drawing.text(x + 10, y + 12, words);
    x += 80;
  }
  if (x > left) drawing.part(left - 10, y - 4, x - left, 24);
}

}  // namespace stickslip::report
