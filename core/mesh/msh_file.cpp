#include "core/mesh/msh_file.hpp"

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <optional>
#include <string_view>
#include <unordered_map>

#include "core/mesh/msh_tokens.hpp"

namespace stickslip {
namespace {

std::string element_type_name(long long type) {
  static constexpr const char* names[] = {"",
                                          "2-node line",
                                          "3-node triangle",
                                          "4-node quadrangle",
                                          "4-node tetrahedron",
                                          "8-node hexahedron",
                                          "6-node prism",
                                          "5-node pyramid",
                                          "3-node line",
                                          "6-node triangle",
                                          "9-node quadrangle",
                                          "10-node tetrahedron",
                                          "27-node hexahedron",
                                          "18-node prism",
                                          "14-node pyramid",
                                          "1-node point",
                                          "8-node quadrangle",
                                          "20-node hexahedron",
                                          "15-node prism",
                                          "13-node pyramid"};
  if (type >= 1 && type < static_cast<long long>(std::size(names))) return names[type];
  return "unknown or of higher order";
}

/// Shape of an element, and the nodes that Gmsh writes for it: a point of a mesh file has no anchor, a line may have a
/// middle.
struct ElementKind {
  ElementShape shape;
  int node_count;
};

std::optional<ElementKind> kind_of(long long type) {
  switch (type) {
    case 15:
      return ElementKind{ElementShape::point, 1};
    case 1:
      return ElementKind{ElementShape::bar2, 2};
    case 8:
      return ElementKind{ElementShape::bar2, 3};
    case 2:
      return ElementKind{ElementShape::tri3, 3};
    case 3:
      return ElementKind{ElementShape::quad4, 4};
    case 9:
      return ElementKind{ElementShape::tri6, 6};
    case 16:
      return ElementKind{ElementShape::quad8, 8};
    case 4:
      return ElementKind{ElementShape::tet4, 4};
    case 5:
      return ElementKind{ElementShape::hex8, 8};
    case 10:
      return ElementKind{ElementShape::quad8, 9};
    case 11:
      return ElementKind{ElementShape::tet10, 10};
    case 17:
      return ElementKind{ElementShape::hex20, 20};
    case 12:
      return ElementKind{ElementShape::hex27, 27};
    default:
      return std::nullopt;
  }
}

/// Where Gmsh's node k of an element stands in ours. It lists the middles of edges as 01 12 20 30 32 31 of a
/// tetrahedron, and of a hexahedron as 01 03 04 12 15 23 26 37 45 47 56 67, then its faces 0321 0154 0473 1265 2376
/// 4567 [Gmsh reference manual, "Node ordering"].
int own_place(ElementShape shape, int k) {
  static constexpr std::array<int, 10> tetrahedron{0, 1, 2, 3, 4, 5, 6, 7, 9, 8};
  static constexpr std::array<int, 27> hexahedron{0,  1,  2,  3,  4,  5,  6,  7,  8,  11, 16, 9,  17, 10,
                                                  18, 19, 12, 15, 13, 14, 24, 22, 20, 21, 23, 25, 26};
  if (shape == ElementShape::tet10) return tetrahedron.at(k);
  return linear_shape(shape) == ElementShape::hex8 ? hexahedron.at(k) : k;
}

int dimension_of(ElementShape shape) {
  if (is_solid(shape)) return 3;
  return shape == ElementShape::point ? 0 : shape == ElementShape::bar2 ? 1 : 2;
}

class Parser {
 public:
  Parser(const std::string& text, const std::string& file_name, MshFile& file)
      : tokens_(text), file_name_(file_name), file_(file) {}

  void parse() {
    format();
    while (!tokens_.at_end()) {
      const MshToken token = tokens_.next("a section");
      const std::string section(token.text);
      if (section.front() != '$')
        throw MshFault{token.offset, "a section should begin here; found " + MshTokens::shown(token)};
      if (section == "$PhysicalNames")
        physical_names();
      else if (section == "$Entities" && version_4_)
        entities();
      else if (section == "$Nodes")
        version_4_ ? nodes_4() : nodes_2();
      else if (section == "$Elements")
        version_4_ ? elements_4() : elements_2();
      else if (section == "$PartitionedEntities")
        throw MshFault{token.offset, "the mesh is partitioned: save it with \"gmsh -unpartition\""};
      else
        tokens_.skip_section("$End" + section.substr(1));
    }
    if (file_.nodes.empty()) throw MshFault{tokens_.offset(), "the file has no nodes"};
    if (file_.elements.empty()) throw MshFault{tokens_.offset(), "the file has no elements"};
  }

 private:
  std::string conversion() const {
    return "; \"gmsh " + file_name_ + " -save -format msh41 -setnumber Mesh.Binary 0 -o NEW.msh\" converts it";
  }

  void format() {
    const MshToken first = tokens_.next("$MeshFormat");
    // what it holds instead is not told: it may be any file of the machine
    if (first.text != "$MeshFormat") throw MshFault{first.offset, "a mesh file of Gmsh begins with $MeshFormat"};
    const MshToken version = tokens_.next("the version of the format");
    if (version.text != "2.2" && version.text != "4.1")
      throw MshFault{version.offset, "version " + MshTokens::shown(version) +
                                         " of the format is not read, only 2.2 and 4.1" + conversion()};
    version_4_ = version.text == "4.1";
    const MshToken kind = tokens_.next("0 for ASCII");
    if (kind.text == "1") throw MshFault{kind.offset, "the file is binary, only ASCII is read" + conversion()};
    if (kind.text != "0") throw MshFault{kind.offset, "0 for ASCII should stand here; found " + MshTokens::shown(kind)};
    tokens_.integer("the size of a number");
    tokens_.close("$EndMeshFormat", "the format");
  }

  void physical_names() {
    const long long count = tokens_.count("the number of physical names");
    for (long long i = 0; i < count; ++i) {
      const long long dimension = tokens_.integer("the dimension of a physical group");
      const long long tag = tokens_.integer("the number of a physical group");
      const std::string name = tokens_.quoted("the name of a physical group");
      if (dimension >= 0 && dimension <= 3) file_.names[{static_cast<int>(dimension), tag}] = name;
    }
    tokens_.close("$EndPhysicalNames", "the " + std::to_string(count) + " names");
  }

  void entities() {
    std::array<long long, 4> counts{};
    for (long long& count : counts) count = tokens_.count("the number of entities");
    for (int dimension = 0; dimension < 4; ++dimension)
      for (long long i = 0; i < counts[dimension]; ++i) {
        const long long tag = tokens_.integer("the number of an entity");
        for (int k = 0; k < (dimension == 0 ? 3 : 6); ++k) tokens_.real("a coordinate of an entity's bounds");
        auto& groups = groups_of_[{dimension, tag}];
        const long long physical = tokens_.count("the number of an entity's physical groups");
        for (long long k = 0; k < physical; ++k) {
          const long long group = group_number(tokens_.integer("a physical group"));
          if (std::find(groups.begin(), groups.end(), group) == groups.end()) groups.push_back(group);
        }
        const long long bounding = dimension == 0 ? 0 : tokens_.count("the number of an entity's bounding entities");
        for (long long k = 0; k < bounding; ++k) tokens_.integer("a bounding entity");
      }
    tokens_.close("$EndEntities", "the entities");
  }

  void add_node(long long tag, const std::array<double, 3>& at, std::size_t offset) {
    if (!position_.emplace(tag, static_cast<int>(file_.nodes.size())).second)
      throw MshFault{offset, "node " + std::to_string(tag) + " appears twice"};
    file_.nodes.push_back({tag, at});
  }

  std::array<double, 3> coordinates() {
    std::array<double, 3> at{};
    for (double& x : at) x = tokens_.real("a coordinate of a node");
    return at;
  }

  void nodes_2() {
    const long long count = tokens_.count("the number of nodes");
    for (long long i = 0; i < count; ++i) {
      const std::size_t offset = tokens_.offset();
      const long long tag = tokens_.integer("the number of a node");
      add_node(tag, coordinates(), offset);
    }
    tokens_.close("$EndNodes", "the " + std::to_string(count) + " nodes");
  }

  void nodes_4() {
    const long long blocks = tokens_.count("the number of blocks of nodes");
    const std::size_t count_offset = tokens_.offset();
    const long long count = tokens_.count("the number of nodes");
    for (int k = 0; k < 2; ++k) tokens_.integer("the smallest and the largest node number");
    for (long long block = 0; block < blocks; ++block) {
      const std::size_t offset = tokens_.offset();
      const long long dimension = tokens_.integer("the dimension of a block's entity");
      if (dimension < 0 || dimension > 3) throw MshFault{offset, "the dimension of an entity is 0 to 3"};
      tokens_.integer("the number of a block's entity");
      const bool parametric = tokens_.integer("1 for parametric nodes, else 0") == 1;
      const long long size = tokens_.count("the number of nodes of a block");
      std::vector<std::pair<long long, std::size_t>> tags;
      for (long long i = 0; i < size; ++i) {
        const std::size_t tag_offset = tokens_.offset();
        tags.push_back({tokens_.integer("the number of a node"), tag_offset});
      }
      for (const auto& [tag, tag_offset] : tags) {
        add_node(tag, coordinates(), tag_offset);
        for (long long k = 0; parametric && k < dimension; ++k) tokens_.real("a parametric coordinate of a node");
      }
    }
    check_total(count, static_cast<long long>(file_.nodes.size()), count_offset, "nodes");
    tokens_.close("$EndNodes", "the nodes");
  }

  void elements_2() {
    const long long count = tokens_.count("the number of elements");
    for (long long i = 0; i < count; ++i) {
      const std::size_t offset = tokens_.offset();
      const long long tag = tokens_.integer("the number of an element");
      const ElementKind kind = element_kind(tag);
      const long long tags = tokens_.count("the number of an element's tags");
      long long group = 0;
      for (long long k = 0; k < tags; ++k) {
        const long long value = tokens_.integer("a tag of an element");
        if (k == 0) group = group_number(value);
      }
      add_element(tag, kind, {group}, offset);
    }
    tokens_.close("$EndElements", "the " + std::to_string(count) + " elements");
  }

  void elements_4() {
    const long long blocks = tokens_.count("the number of blocks of elements");
    const std::size_t count_offset = tokens_.offset();
    const long long count = tokens_.count("the number of elements");
    for (int k = 0; k < 2; ++k) tokens_.integer("the smallest and the largest element number");
    long long total = 0;
    for (long long block = 0; block < blocks; ++block) {
      const std::size_t offset = tokens_.offset();
      const long long dimension = tokens_.integer("the dimension of a block's entity");
      const long long entity = tokens_.integer("the number of a block's entity");
      const ElementKind kind = element_kind(std::nullopt);
      if (dimension != dimension_of(kind.shape))
        throw MshFault{offset, "an entity of dimension " + std::to_string(dimension) + " holds elements of dimension " +
                                   std::to_string(dimension_of(kind.shape))};
      const auto known = groups_of_.find({static_cast<int>(dimension), entity});
      const std::vector<long long> none{0};
      const auto& groups = known == groups_of_.end() || known->second.empty() ? none : known->second;
      const long long size = tokens_.count("the number of elements of a block");
      for (long long i = 0; i < size; ++i, ++total) {
        const std::size_t element_offset = tokens_.offset();
        const long long tag = tokens_.integer("the number of an element");
        add_element(tag, kind, groups, element_offset);
      }
    }
    check_total(count, total, count_offset, "elements");
    tokens_.close("$EndElements", "the elements");
  }

  ElementKind element_kind(std::optional<long long> tag) {
    const std::size_t offset = tokens_.offset();
    const long long type = tokens_.integer("the type of an element");
    if (const auto kind = kind_of(type)) return *kind;
    throw MshFault{
        offset, (tag ? "element " + std::to_string(*tag) : "a block of elements") + " has type " +
                    std::to_string(type) + " (" + element_type_name(type) +
                    "), which is not read; plane bodies of 3- or 6-node triangles or 4- or 8-node quadrangles are, and "
                    "bodies in space of 4- or 10-node tetrahedra or 8-, 20- or 27-node hexahedra"};
  }

  void add_element(long long tag, ElementKind kind, const std::vector<long long>& groups, std::size_t offset) {
    MshElement element{tag, kind.shape, kind.node_count, {}, {dimension_of(kind.shape), 0}, offset};
    for (int k = 0; k < kind.node_count; ++k) {
      const std::size_t node_offset = tokens_.offset();
      const long long node = tokens_.integer("a node of element " + std::to_string(tag));
      const auto known = position_.find(node);
      if (known == position_.end())
        throw MshFault{node_offset, "element " + std::to_string(tag) + " has node " + std::to_string(node) +
                                        ", which is not in $Nodes above it"};
      element.nodes[own_place(kind.shape, k)] = known->second;
    }
    for (long long group : groups) {
      element.group.second = group;
      file_.elements.push_back(element);
    }
  }

  /// A physical group with a minus sign is the same group, its curve or surface turned round.
  static long long group_number(long long tag) {
    return tag == std::numeric_limits<long long>::min() ? 0 : std::abs(tag);
  }

  static void check_total(long long announced, long long found, std::size_t offset, const std::string& what) {
    if (announced != found)
      throw MshFault{offset, std::to_string(announced) + " " + what + " are announced, " + std::to_string(found) +
                                 " are in the blocks"};
  }

  MshTokens tokens_;
  const std::string& file_name_;
  MshFile& file_;
  bool version_4_ = false;
  std::map<MshGroup, std::vector<long long>> groups_of_;  // by entity: its physical groups
  std::unordered_map<long long, int> position_;           // of a node's number in file_.nodes
};

}  // namespace

std::string msh_location(const std::string& text, std::size_t offset) {
  const std::string_view before = std::string_view(text).substr(0, std::min(offset, text.size()));
  const auto line_start = before.rfind('\n');
  const std::size_t column = line_start == std::string_view::npos ? before.size() : before.size() - line_start - 1;
  return std::to_string(1 + std::count(before.begin(), before.end(), '\n')) + ":" + std::to_string(column + 1);
}

MshFile parse_msh(const std::string& text, const std::string& file_name) {
  MshFile file;
  try {
    Parser(text, file_name, file).parse();
  } catch (const MshFault& fault) {
    file.error = msh_location(text, fault.offset) + ": " + fault.message;
  }
  return file;
}

}  // namespace stickslip
