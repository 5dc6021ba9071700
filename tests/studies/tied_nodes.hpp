/// A scene whose largest and smallest values two nodes share.
#pragma once

#include <nlohmann/json.hpp>

namespace stickslip::cases {

/// A block pressed on a round obstacle between its two middle nodes: moved to either side one of them leads.
inline nlohmann::json tied_nodes() {
  return {{"bodies",
           {{"b",
             {{"mesh", {{"box", {{"min", {-1, 0}}, {"max", {1, 1}}, {"cells", {7, 4}}}}}},
              {"material", {{"linear_elastic", {{"E", 1000}, {"nu", 0.3}}}}}}}}},
          {"obstacles", {{"f", {{"circle", {{"center", {0.0, -5}}, {"radius", 5}}}}}}},
          {"contacts", {{"c", {{"slave", "b.bottom"}, {"master", "f"}}}}},
          {"supports", {{{"on", "b.top"}, {"move", {{"x", 0}, {"y", -0.02}}}}}},
          {"time", {{"end", 1}, {"steps", 1}}},
          {"responses",
           {{"most", {{"contact_pressure", {{"contact", "c"}, {"take", "max"}}}}},
            {"least", {{"gap", {{"contact", "c"}, {"take", "min"}}}}},
            {"farthest", {{"gap", {{"contact", "c"}, {"take", "max"}}}}}}},
          {"parameters", {{"shift", "/obstacles/f/circle/center/0"}}}};
}

}  // namespace stickslip::cases
