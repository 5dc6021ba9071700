#include "core/mesh/msh_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <utility>

#include "core/mesh/msh_elements.hpp"
#include "core/mesh/msh_file.hpp"
#include "core/mesh/quality.hpp"
#include "core/mesh/sides.hpp"

namespace stickslip {
namespace {

using Elements = std::vector<const MshElement*>;

/// What a physical group of a dimension is called.
std::string kind_of_group(int dimension) {
  static constexpr const char* kinds[] = {"point", "curve", "surface", "volume"};
  return kinds[dimension];
}

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

class Import {
 public:
  Import(const std::string& text, const std::string& file_name, const MshFile& file, int dimension,
         ImportResult& result)
      : text_(text), file_name_(file_name), file_(file), dimension_(dimension), result_(result) {
    for (const MshElement& element : file.elements)
      if (element.group.second != 0) groups_[element.group].push_back(&element);
  }

  void run() {
    if (is_of_other_space()) return;
    bool found = false;
    for (const auto& [group, elements] : groups_)
      if (group.first == dimension_) {
        found = true;
        if (!used_names_.insert(name_of(group)).second) {
          fault(elements.front(),
                "two physical " + kind_of_group(dimension_) + "s have the name \"" + name_of(group) + "\"");
        } else if (const auto body = body_of(group, elements)) {
          result_.bodies.push_back(*body);
        }
      }
    if (!found && result_.no_body.empty()) report_no_body();
    if (result_.errors.empty()) note_unused();
  }

 private:
  void fault(const MshElement* at, const std::string& message) {
    result_.errors.push_back(file_name_ + ":" + msh_location(text_, at->offset) + ": " + message);
  }

  /// Whether the file is of bodies in space and the space is plane, or the reverse; reported.
  bool is_of_other_space() {
    const auto first = std::find_if(file_.elements.begin(), file_.elements.end(),
                                    [](const MshElement& e) { return is_solid(e.shape); });
    const bool is_in_space = first != file_.elements.end();
    if (is_in_space && dimension_ == 2)
      fault(&*first, "element " + std::to_string(first->tag) +
                         " is of a mesh in space, and the space of the scene is "
                         "plane; \"space\": \"solid\" takes this mesh");
    if (!is_in_space && dimension_ == 3)
      result_.no_body = file_name_ +
                        ":1:1: no element is a tetrahedron or a hexahedron, so there is no body for "
                        "the space solid; give its volume a physical name and mesh it (gmsh -3); a plane mesh "
                        "needs a plane space, such as \"space\": \"plane_strain\"";
    return is_in_space && dimension_ == 2;
  }

  std::string name_of(const MshGroup& group) const {
    const auto name = file_.names.find(group);
    return name == file_.names.end() || name->second.empty() ? std::to_string(group.second) : name->second;
  }

  std::string shown(const MshGroup& group) const { return kind_of_group(group.first) + " \"" + name_of(group) + "\""; }

  void report_no_body() {
    std::vector<std::string> existing;
    for (const auto& [group, elements] : groups_) existing.push_back(shown(group));
    const auto fills = [&](const MshElement& e) { return e.group.first == dimension_; };
    const auto count = std::count_if(file_.elements.begin(), file_.elements.end(), fills);
    const std::string kind = kind_of_group(dimension_);
    result_.no_body = file_name_ + ":1:1: no element belongs to a physical " + kind +
                      ", so there is no body; the file has " + std::to_string(count) +
                      (dimension_ == 2 ? " plane" : " solid") + " elements in no physical " + kind +
                      " and the physical groups: " + (existing.empty() ? "none" : joined(existing));
  }

  std::optional<ImportedMesh> body_of(const MshGroup& group, const Elements& elements) {
    ImportedMesh body{file_name_, name_of(group), {}, {}, {}};
    body.mesh.dimension = dimension_;
    body.mesh.shape = elements.front()->shape;
    for (const MshElement* element : elements)
      if (element->node_count != nodes_of(element->shape)) {
        fault(element, "element " + std::to_string(element->tag) + " of body \"" + body.body +
                           "\" is a 9-node quadrangle, which is read as a face of a 27-node hexahedron alone; save "
                           "plane bodies with 8 nodes (Gmsh: Mesh.SecondOrderIncomplete = 1)");
        return std::nullopt;
      }
    for (const MshElement* element : elements)
      if (element->shape != body.mesh.shape) {
        fault(element, "body \"" + body.body + "\" mixes elements of unlike kinds, from element " +
                           std::to_string(element->tag) + " on");
        return std::nullopt;
      }
    const std::vector<int> node = number_nodes(elements, body);
    if (dimension_ == 2 && !is_plane(body.body, elements)) return std::nullopt;
    if (!turn_to_the_right_hand(elements, body)) return std::nullopt;
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
    body.points.resize(dimension_, body.mesh.node_count);
    for (std::size_t i = 0; i < number.size(); ++i)
      for (int axis = 0; number[i] >= 0 && axis < dimension_; ++axis)
        body.points(axis, number[i]) = file_.nodes[i].place[axis];
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

  /// Turns all elements over if most are clockwise, in space left-handed; false, with the fault, if an element cannot
  /// be used.
  bool turn_to_the_right_hand(const Elements& elements, ImportedMesh& body) {
    Mesh& mesh = body.mesh;
    const int all = mesh.element_count();
    int against = 0;
    for (int e = 0; e < all; ++e) against += orientation(mesh, body.points, e) < 0;
    for (int e = 0; e < all && 2 * against > all; ++e) turn_over(mesh, e);
    const auto bad = first_inverted_element(mesh, body.points);
    if (!bad) return is_thick_enough(elements, body);
    const bool is_against = orientation(mesh, body.points, *bad) < 0 && against != 0 && against != all;
    const std::string mixed = dimension_ == 2 ? "clockwise and counter-clockwise" : "left-handed and right-handed";
    fault(elements[*bad], "element " + std::to_string(elements[*bad]->tag) + " of body \"" + body.body + "\" " +
                              (is_against ? "is turned against the others (" + mixed + " are mixed)"
                                          : "is degenerate: " + reason_of_bad_element(body, *bad)));
    return false;
  }

  static std::string reason_of_bad_element(const ImportedMesh& body, int element) {
    const auto stray = stray_middle(body.mesh, body.points, element);
    if (!stray) return "a corner is flat or turns inwards";
    std::string place;
    for (const double x : body.points.col(stray->node)) place += (place.empty() ? "(" : ", ") + in_digits(x);
    return "its corners are sound, but the node at " + place + ") is " + in_digits(100 * stray->share) +
           " % of its edge's length away from the middle of that edge; Gmsh lists the corners of an element first, " +
           "then the middles of its edges";
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

  /// Whether no two elements overlap by their nodes. Elements are counter-clockwise (right-handed), so two with a
  /// common side in the same direction lie on the same side of it; an element that is listed twice has all sides in
  /// common with itself.
  bool lie_beside_each_other(const Elements& elements, const ImportedMesh& body) {
    const Mesh& mesh = body.mesh;
    const int count = nodes_of(mesh.shape);
    std::map<ElementFacet, int> element_at;
    const auto nodes_of_element = [&](int e) {
      const auto first = mesh.connectivity.begin() + static_cast<std::ptrdiff_t>(e) * count;
      return std::set<int>(first, first + count);
    };
    for (int e = 0; e < mesh.element_count(); ++e)
      for (const ElementFacet& facet : facets_of_element(mesh, e)) {
        const auto [other, is_new] = element_at.try_emplace(ends_of(facet), e);
        if (is_new) continue;
        const MshElement *element = elements[e], *first = elements[other->second];
        const bool twice = nodes_of_element(e) == nodes_of_element(other->second);
        const std::string common = dimension_ == 2 ? "edge" : "face";
        fault(element, "element " + std::to_string(element->tag) + " of body \"" + body.body + "\" " +
                           (twice ? "has the same nodes as element " : "overlaps element ") +
                           std::to_string(first->tag) + " of " + line_of(first) +
                           (twice ? ": the body would be twice as stiff there; delete one of the two"
                                  : ": both lie on the same side of their common " + common));
        return false;
      }
    return true;
  }

  /// Without middles: two sides that differ in them overlap too.
  ElementFacet ends_of(const ElementFacet& facet) const { return without_middles(facet, dimension_); }

  /// Notes nodes of a body at one place, and parts of it that share no node: elements do not hold together there.
  /// `number`: of the nodes of the file in the body, or -1.
  void note_slits(const ImportedMesh& body, const std::vector<int>& number) {
    std::vector<long long> tags;  // by the number of the node
    for (std::size_t i = 0; i < number.size(); ++i)
      if (number[i] >= 0) tags.push_back(file_.nodes[i].tag);
    const std::string of_body = " of body \"" + body.body + "\"";
    const char* const remedy = "; unless that is meant, merge nodes (Gmsh: Coherence Mesh), or give each part a name";
    if (const auto pair = nodes_at_one_place(body.mesh, body.points))
      result_.notes.push_back("nodes " + std::to_string(tags[pair->first]) + " and " +
                              std::to_string(tags[pair->second]) + of_body +
                              " are at one place, so that its elements do not hold together there" + remedy);
    if (const int parts = count_of_parts(body.mesh); parts > 1)
      result_.notes.push_back("the elements" + of_body + " are " + std::to_string(parts) +
                              " parts that share no node, so that nothing holds them together" + remedy);
  }

  /// Whether an element of a group is the first with its nodes; otherwise it is reported, as loads would count twice.
  bool is_new(const MshElement* element, const MshGroup& group, std::map<ElementFacet, const MshElement*>& listed) {
    ElementFacet nodes;
    nodes.fill(-1);
    std::copy_n(element->nodes.begin(), std::min(element->node_count, static_cast<int>(nodes.size())), nodes.begin());
    std::sort(nodes.begin(), nodes.end());
    const auto [first, inserted] = listed.try_emplace(nodes, element);
    if (!inserted)
      fault(element, "element " + std::to_string(element->tag) + " of physical " + shown(group) +
                         " has the same nodes as element " + std::to_string(first->second->tag) + " of " +
                         line_of(first->second) + ": loads would count twice there; delete one of the two");
    return inserted;
  }

  void add_sides(ImportedMesh& body, const std::vector<int>& node) {
    const auto [facets, edges] = facets_and_edges(body.mesh);
    for (const auto& [group, elements] : groups_) {
      if (group.first == dimension_) continue;
      const int of = group.first + 1;  // what bounds bodies of this dimension
      const bool is_facet = of == dimension_;
      const auto& known = is_facet ? facets : edges;
      std::vector<ElementFacet> own;
      std::map<ElementFacet, const MshElement*> listed;
      for (const MshElement* element : elements) {
        std::vector<int> at(element->nodes.begin(), element->nodes.begin() + element->node_count);
        for (int& n : at) n = node[n];
        const ElementFacet facet = element_facet(at, of), back = turned(facet, of);
        if (of > 1 ? !known.count(facet) && !known.count(back) : facet[0] < 0) continue;
        if (!is_new(element, group, listed)) continue;
        own.push_back(of == 1 || known.count(facet) ? facet : back);
        used_.insert(element);
      }
      if (own.empty()) continue;
      Side side = side_of_facets(own, of);
      if (!is_facet) side = {side.nodes, {}, {}};
      for (const ElementFacet& edge : own)
        if (of == 2 && !is_facet) body.curves[name_of(group)].push_back({edge[0], edge[1]});
      if (!body.mesh.sides.emplace(name_of(group), side).second)
        fault(elements.front(),
              "two physical groups on body \"" + body.body + "\" have the name \"" + name_of(group) + "\"");
    }
  }

  /// The sides of all elements, directed as their elements have them, so an inner one in both directions; and in space
  /// the edges of these.
  static std::pair<std::set<ElementFacet>, std::set<ElementFacet>> facets_and_edges(const Mesh& mesh) {
    std::set<ElementFacet> facets, edges;
    for (int e = 0; e < mesh.element_count(); ++e)
      for (const ElementFacet& facet : facets_of_element(mesh, e)) {
        facets.insert(facet);
        const auto nodes = nodes_of(facet);
        const int corners = corners_of_face(nodes.size());
        for (int k = 0; mesh.dimension == 3 && k < corners; ++k) {
          std::vector<int> edge{nodes[k], nodes[(k + 1) % corners]};
          if (is_quadratic(mesh.shape)) edge.push_back(nodes[corners + k]);
          edges.insert(element_facet(edge, 2));
        }
      }
    return {facets, edges};
  }

  /// Surfaces, curves and points that are no part of a body: wholly, that is allowed; in part, it is a fault.
  void note_unused() {
    for (const auto& [group, elements] : groups_) {
      if (group.first == dimension_) continue;
      const std::string what = "physical " + shown(group);
      const auto lost = [&](const MshElement* e) { return used_.count(e) == 0; };
      const auto first = std::find_if(elements.begin(), elements.end(), lost);
      if (first == elements.end()) continue;
      if (std::all_of(elements.begin(), elements.end(), lost)) {
        const bool is_loose = group.first == dimension_ - 1;
        if (is_loose) add_loose(group, elements);
        result_.notes.push_back(what + " is not on a body" +
                                (is_loose ? "; an obstacle may have its shape (mesh_side)" : ""));
      } else {
        fault(*first, "element " + std::to_string((*first)->tag) + " of " + what + " is no " +
                          (dimension_ == 2 ? "" : "face, ") + "edge or node of an element of a body");
      }
    }
  }

  void add_loose(const MshGroup& group, const Elements& elements) {
    ImportedMesh loose{file_name_, "", {}, {}, {}};
    loose.mesh.dimension = dimension_;
    std::map<int, int> number;
    std::vector<ElementFacet> own;
    std::map<ElementFacet, const MshElement*> listed;
    for (const MshElement* element : elements) {
      if (!is_new(element, group, listed)) continue;
      std::vector<int> at(element->nodes.begin(), element->nodes.begin() + element->node_count);
      for (int& n : at) n = number.emplace(n, static_cast<int>(number.size())).first->second;
      own.push_back(element_facet(at, dimension_));
    }
    loose.mesh.node_count = static_cast<int>(number.size());
    loose.points.resize(dimension_, loose.mesh.node_count);
    for (const auto& [of_file, n] : number)
      for (int axis = 0; axis < dimension_; ++axis) loose.points(axis, n) = file_.nodes[of_file].place[axis];
    loose.mesh.sides.emplace(name_of(group), side_of_facets(own, dimension_));
    result_.loose.push_back(std::move(loose));
  }

  const std::string& text_;
  const std::string& file_name_;
  const MshFile& file_;
  int dimension_;  // of the space
  ImportResult& result_;
  std::map<MshGroup, Elements> groups_;
  std::set<std::string> used_names_;
  std::set<const MshElement*> used_;  // what became part of a side
};

}  // namespace

ImportResult read_msh(std::istream& stream, const std::string& file_name, int dimension) {
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  ImportResult result;
  const MshFile file = parse_msh(text, file_name);
  if (file.error.empty()) {
    Import(text, file_name, file, dimension, result).run();
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
