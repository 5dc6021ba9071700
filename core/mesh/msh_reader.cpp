#include "core/mesh/msh_reader.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <set>
#include <sstream>
#include <tuple>

#include "core/mesh/msh_file.hpp"
#include "core/mesh/quality.hpp"
#include "core/mesh/sides.hpp"

namespace stickslip {
namespace {

using Elements = std::vector<const MshElement*>;
/// A side of an element: its ends, and its middle, or -1.
struct Edge {
  int first, second, middle = -1;
  bool operator<(const Edge& o) const {
    return std::tie(first, second, middle) < std::tie(o.first, o.second, o.middle);
  }
};

Edge turned(const Edge& edge) { return {edge.second, edge.first, edge.middle}; }

std::string joined(const std::vector<std::string>& words) {
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "" : ", ") + word;
  return list;
}

std::string in_digits(double x) {
  std::ostringstream text;
  text << x;
  return text.str();
}

/// Twice the signed area between the corners of an element where it lies.
double twice_area(const Mesh& mesh, const Points<double>& points, int element) {
  const int count = corners_of(mesh.shape);
  const int* nodes = mesh.connectivity.data() + element * nodes_of(mesh.shape);
  double sum = 0;
  for (int k = 0; k < count; ++k) {
    // from the first node, so that a body far from the origin loses no digits
    const Vec<double, 2> a = points.col(nodes[k]) - points.col(nodes[0]);
    const Vec<double, 2> b = points.col(nodes[(k + 1) % count]) - points.col(nodes[0]);
    sum += a[0] * b[1] - a[1] * b[0];
  }
  return sum;
}

/// Segments in order: each piece from its beginning (the node no segment leads to; a closed one from the first given).
Side side_of_segments(const std::vector<Edge>& segments) {
  std::multimap<int, std::size_t> from;
  std::set<int> ends;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    from.emplace(segments[i].first, i);
    ends.insert(segments[i].second);
  }
  Side side;
  std::set<int> listed;
  auto list = [&](int node) {
    if (listed.insert(node).second) side.nodes.push_back(node);
  };
  std::vector<bool> used(segments.size(), false);
  auto follow = [&](std::size_t i) {
    for (std::optional<std::size_t> next = i; next && !used[*next];) {
      used[*next] = true;
      const auto [a, b, middle] = segments[*next];
      list(a);
      if (middle >= 0) {
        list(middle);
        side.facets.push_back({a, middle});
        side.facets.push_back({middle, b});
        side.quadratic.push_back({a, b, middle});
      } else {
        side.facets.push_back({a, b});
      }
      list(b);
      next.reset();
      for (auto [it, last] = from.equal_range(b); it != last && !next; ++it)
        if (!used[it->second]) next = it->second;
    }
  };
  for (std::size_t i = 0; i < segments.size(); ++i)
    if (!ends.count(segments[i].first)) follow(i);
  for (std::size_t i = 0; i < segments.size(); ++i) follow(i);
  return side;
}

class Import {
 public:
  Import(const std::string& text, const std::string& file_name, const MshFile& file, ImportResult& result)
      : text_(text), file_name_(file_name), file_(file), result_(result) {
    for (const MshElement& element : file.elements)
      if (element.group.second != 0) groups_[element.group].push_back(&element);
  }

  void run() {
    bool found = false;
    for (const auto& [group, elements] : groups_)
      if (group.first == 2) {
        found = true;
        if (!used_names_.insert(name_of(group)).second) {
          fault(elements.front(), "two physical surfaces have the name \"" + name_of(group) + "\"");
        } else if (const auto body = body_of(group, elements)) {
          result_.bodies.push_back(*body);
        }
      }
    if (!found) report_no_surface();
    if (result_.errors.empty()) note_unused();
  }

 private:
  void fault(const MshElement* at, const std::string& message) {
    result_.errors.push_back(file_name_ + ":" + msh_location(text_, at->offset) + ": " + message);
  }

  std::string name_of(const MshGroup& group) const {
    const auto name = file_.names.find(group);
    return name == file_.names.end() || name->second.empty() ? std::to_string(group.second) : name->second;
  }

  void report_no_surface() {
    std::vector<std::string> existing;
    for (const auto& [group, elements] : groups_)
      existing.push_back((group.first == 1 ? "curve \"" : "point \"") + name_of(group) + "\"");
    const auto is_plane = [](const MshElement& e) { return e.group.first == 2; };
    const auto plane = std::count_if(file_.elements.begin(), file_.elements.end(), is_plane);
    result_.errors.push_back(
        file_name_ + ":1:1: no element belongs to a physical surface, so there is no body; the file has " +
        std::to_string(plane) + " plane elements in no physical surface and the physical groups: " +
        (existing.empty() ? "none" : joined(existing)));
  }

  std::optional<ImportedMesh> body_of(const MshGroup& group, const Elements& elements) {
    ImportedMesh body{file_name_, name_of(group), {}, {}};
    body.mesh.shape = elements.front()->shape;
    for (const MshElement* element : elements)
      if (element->shape != body.mesh.shape) {
        fault(element, "body \"" + body.body + "\" mixes elements of unlike kinds, from element " +
                           std::to_string(element->tag) + " on");
        return std::nullopt;
      }
    const std::vector<int> node = number_nodes(elements, body);
    if (!is_plane(body.body, elements) || !turn_counter_clockwise(elements, body)) return std::nullopt;
    if (!lie_beside_each_other(elements, body)) return std::nullopt;
    note_slits(body, node);
    add_sides(body, node);
    return body;
  }

  /// Nodes of the body's elements in the order of the file; gives the body's number of each node of the file, or -1.
  std::vector<int> number_nodes(const Elements& elements, ImportedMesh& body) const {
    const int count = nodes_of(body.mesh.shape);
    std::vector<int> number(file_.nodes.size(), -1);
    for (const MshElement* element : elements)
      for (int k = 0; k < count; ++k) number[element->nodes[k]] = 0;
    for (int& n : number)
      if (n == 0) n = body.mesh.node_count++;
    body.points.resize(2, body.mesh.node_count);
    for (std::size_t i = 0; i < number.size(); ++i)
      if (number[i] >= 0) body.points.col(number[i]) << file_.nodes[i].place[0], file_.nodes[i].place[1];
    for (const MshElement* element : elements)
      for (int k = 0; k < count; ++k) body.mesh.connectivity.push_back(number[element->nodes[k]]);
    return number;
  }

  bool is_plane(const std::string& name, const Elements& elements) {
    std::array<double, 3> low, high;
    low.fill(std::numeric_limits<double>::infinity());
    high.fill(-std::numeric_limits<double>::infinity());
    for (const MshElement* element : elements)
      for (int k = 0; k < nodes_of(element->shape); ++k)
        for (int axis = 0; axis < 3; ++axis) {
          const double x = file_.nodes[element->nodes[k]].place[axis];
          low[axis] = std::min(low[axis], x);
          high[axis] = std::max(high[axis], x);
        }
    // a mesher leaves rounding in z, of the size of the coordinates
    const double size = std::max(high[0] - low[0], high[1] - low[1]);
    const double rounding =
        1e3 * std::numeric_limits<double>::epsilon() * (size + std::max(std::abs(low[2]), std::abs(high[2])));
    if (high[2] - low[2] <= rounding) return true;
    fault(elements.front(), "body \"" + name + "\" does not lie in a plane z = constant");
    return false;
  }

  /// Turns all elements if all are clockwise; false, with the fault, if an element cannot be used.
  bool turn_counter_clockwise(const Elements& elements, ImportedMesh& body) {
    Mesh& mesh = body.mesh;
    const int count = nodes_of(mesh.shape), all = mesh.element_count();
    int clockwise = 0;
    for (int e = 0; e < all; ++e) clockwise += twice_area(mesh, body.points, e) < 0;
    const bool mostly_clockwise = 2 * clockwise > all;
    for (int e = 0; e < all && mostly_clockwise; ++e) {
      const auto first = mesh.connectivity.begin() + e * count;
      std::reverse(first + 1, first + corners_of(mesh.shape));
      std::reverse(first + corners_of(mesh.shape), first + count);  // the last side is now the first
    }
    const auto bad = first_inverted_element(mesh, body.points);
    if (!bad) return is_thick_enough(elements, body);
    const MshElement* element = elements[*bad];
    const bool against = twice_area(mesh, body.points, *bad) < 0 && clockwise != 0 && clockwise != all;
    fault(element, "element " + std::to_string(element->tag) + " of body \"" + body.body + "\" " +
                       (against ? "is turned against the others (clockwise and counter-clockwise are mixed)"
                                : "is degenerate: a corner is flat or turns inwards"));
    return false;
  }

  bool is_thick_enough(const Elements& elements, const ImportedMesh& body) {
    const auto thin = first_thin_element(body.mesh, body.points);
    if (!thin) return true;
    const MshElement* element = elements[thin->element];
    fault(element, "element " + std::to_string(element->tag) + " of body \"" + body.body + "\" is " +
                       in_digits(thin->thickness) + " thick where coordinates reach " + in_digits(thin->size) +
                       ": rounding leaves its strain less than four digits");
    return false;
  }

  std::string line_of(const MshElement* element) const {
    const std::string place = msh_location(text_, element->offset);
    return "line " + place.substr(0, place.find(':'));
  }

  /// Whether no two elements overlap by their nodes. Elements are counter-clockwise, so two with a common side in the
  /// same direction lie on the same side of it; an element that is listed twice has all sides in common with itself.
  bool lie_beside_each_other(const Elements& elements, const ImportedMesh& body) {
    const Mesh& mesh = body.mesh;
    const int count = nodes_of(mesh.shape), corners = corners_of(mesh.shape);
    std::map<std::pair<int, int>, int> element_left_of;
    const auto nodes_of_element = [&](int e) {
      const auto first = mesh.connectivity.begin() + e * count;
      return std::set<int>(first, first + count);
    };
    for (int e = 0; e < mesh.element_count(); ++e)
      for (int k = 0; k < corners; ++k) {
        const int* nodes = mesh.connectivity.data() + e * count;
        const auto [other, is_new] = element_left_of.try_emplace({nodes[k], nodes[(k + 1) % corners]}, e);
        if (is_new) continue;
        const MshElement *element = elements[e], *first = elements[other->second];
        const bool twice = nodes_of_element(e) == nodes_of_element(other->second);
        fault(element, "element " + std::to_string(element->tag) + " of body \"" + body.body + "\" " +
                           (twice ? "has the same nodes as element " : "overlaps element ") +
                           std::to_string(first->tag) + " of " + line_of(first) +
                           (twice ? ": the body would be twice as stiff there; delete one of the two"
                                  : ": both lie on the same side of their common edge"));
        return false;
      }
    return true;
  }

  /// Notes nodes of a body at one place: elements do not hold together there.
  void note_slits(const ImportedMesh& body, const std::vector<int>& number) {
    std::map<std::pair<double, double>, long long> tag_at;
    for (std::size_t i = 0; i < number.size(); ++i) {
      if (number[i] < 0) continue;
      const MshNode& node = file_.nodes[i];
      const auto [first, is_new] = tag_at.try_emplace({node.place[0], node.place[1]}, node.tag);
      if (is_new) continue;
      result_.notes.push_back("nodes " + std::to_string(first->second) + " and " + std::to_string(node.tag) +
                              " of body \"" + body.body +
                              "\" are at one place, so that its elements do not hold together there; unless a slit is "
                              "meant, merge them (Gmsh: Coherence Mesh)");
      return;
    }
  }

  /// Says that an element of a curve or a point is listed twice, so that loads there would count twice.
  void fault_twice(const MshElement* element, const MshElement* first, const MshGroup& group) {
    fault(element, "element " + std::to_string(element->tag) + " of physical " +
                       (group.first == 1 ? "curve" : "point") + " \"" + name_of(group) +
                       "\" has the same nodes as element " + std::to_string(first->tag) + " of " + line_of(first) +
                       ": loads would count twice there; delete one of the two");
  }

  void add_sides(ImportedMesh& body, const std::vector<int>& node) {
    const Mesh& mesh = body.mesh;
    const int count = nodes_of(mesh.shape), corners = corners_of(mesh.shape);
    std::set<Edge> edges;  // directed as their element has them; an inner edge in both directions
    for (int e = 0; e < mesh.element_count(); ++e)
      for (int k = 0; k < corners; ++k) {
        const int* nodes = mesh.connectivity.data() + e * count;
        edges.insert({nodes[k], nodes[(k + 1) % corners], is_quadratic(mesh.shape) ? nodes[corners + k] : -1});
      }
    for (const auto& [group, elements] : groups_) {
      if (group.first == 2) continue;
      std::vector<Edge> segments;
      Side side;
      std::map<Edge, const MshElement*> listed;
      const auto is_new = [&, &group = group](const Edge& edge, const MshElement* element) {
        const auto [first, inserted] = listed.try_emplace(edge.first < edge.second ? edge : turned(edge), element);
        if (!inserted) fault_twice(element, first->second, group);
        return inserted;
      };
      for (const MshElement* element : elements) {
        const int first = node[element->nodes[0]];
        if (group.first == 0) {
          if (first < 0 || !is_new({first, first}, element)) continue;
          side.nodes.push_back(first);
        } else {
          const Edge edge{first, node[element->nodes[1]], element->node_count == 3 ? node[element->nodes[2]] : -1};
          if (!edges.count(edge) && !edges.count(turned(edge))) continue;
          if (!is_new(edge, element)) continue;
          segments.push_back(edges.count(edge) ? edge : turned(edge));
        }
        used_.insert(element);
      }
      if (group.first == 1) side = side_of_segments(segments);
      if (side.nodes.empty()) continue;
      if (!body.mesh.sides.emplace(name_of(group), side).second)
        fault(elements.front(),
              "two physical groups on body \"" + body.body + "\" have the name \"" + name_of(group) + "\"");
    }
  }

  /// Curves and points that are no part of a body: wholly, that is allowed; in part, it is a fault.
  void note_unused() {
    for (const auto& [group, elements] : groups_) {
      if (group.first == 2) continue;
      const std::string what = (group.first == 1 ? "physical curve \"" : "physical point \"") + name_of(group) + "\"";
      const auto lost = [&](const MshElement* e) { return used_.count(e) == 0; };
      const auto first = std::find_if(elements.begin(), elements.end(), lost);
      if (first == elements.end()) continue;
      if (std::all_of(elements.begin(), elements.end(), lost)) {
        result_.notes.push_back(what + " is not on a body");
      } else {
        fault(*first, "element " + std::to_string((*first)->tag) + " of " + what +
                          " is no edge or node of an element of a body");
      }
    }
  }

  const std::string& text_;
  const std::string& file_name_;
  const MshFile& file_;
  ImportResult& result_;
  std::map<MshGroup, Elements> groups_;
  std::set<std::string> used_names_;
  std::set<const MshElement*> used_;  // lines and points that became part of a side
};

}  // namespace

ImportResult read_msh(std::istream& stream, const std::string& file_name) {
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  ImportResult result;
  const MshFile file = parse_msh(text, file_name);
  if (file.error.empty()) {
    Import(text, file_name, file, result).run();
  } else {
    result.errors.push_back(file_name + ":" + file.error);
  }
  return result;
}

std::string body_error(const ImportResult& result, const std::string& body) {
  std::vector<std::string> names;
  for (const ImportedMesh& each : result.bodies) names.push_back(each.body);
  if (std::find(names.begin(), names.end(), body) != names.end()) return "";
  if (names.empty()) return "there is no body \"" + body + "\": the mesh has none";
  return "there is no body \"" + body + "\"; did you mean \"" + nearest_name(body, names) + "\"? the mesh has " +
         joined(names);
}

}  // namespace stickslip
