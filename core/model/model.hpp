/// Model: a scene with its meshes made and its contact pairs found. It holds what does not depend on a number (nodes,
/// dofs, contact points, active effects). What depends on numbers is in Slots<T>. Immutable.
#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "core/contact/contact_point.hpp"
#include "core/contact/face.hpp"
#include "core/contact/overlap.hpp"
#include "core/contact/own_vertex.hpp"
#include "core/contact/surface.hpp"
#include "core/mesh/mesh.hpp"
#include "core/model/design_velocity.hpp"
#include "core/model/scene.hpp"
#include "core/model/seconds.hpp"
#include "core/solids/continuum.hpp"

namespace stickslip {

template <int D>
struct StillSurface;  // core/contact/surface_search.hpp

/// Error of a scene that cannot become a model. what(): the reason in the user's words; `pointer`: JSON pointer of the
/// entry of the scene, "" if it concerns none.
struct ModelError : std::runtime_error {
  explicit ModelError(const std::string& message, std::string where = "")
      : std::runtime_error(message), pointer(std::move(where)) {}
  std::string pointer;
};

/// Mesh of a body and its range in the numbering of all nodes.
struct BodyMesh {
  Mesh mesh;
  int first_node = 0;
  Kinematics kinematics = Kinematics::plane;
  int memory = 0;        ///< size of the memory of an element, over all of its quadrature points
  int first_memory = 0;  ///< first entry of the body in History::bodies
};

/// A side of a body, or an obstacle that has facets, as a surface along which points slide.
struct MasterSurface {
  int contact = 0;
  int obstacle = -1;        ///< index in Scene::obstacles; -1: a side of a body
  std::vector<int> nodes;   ///< per vertex: node; empty for an obstacle
  std::vector<int> places;  ///< index of these nodes in Model::contact_nodes
  int vertex_count = 0;
  std::variant<std::shared_ptr<const Surface<2>>, std::shared_ptr<const Surface<3>>> surface;
  /// Of an obstacle along which points slide: where it is at the start, and the search along it there.
  std::variant<std::shared_ptr<const StillSurface<2>>, std::shared_ptr<const StillSurface<3>>> still = {};
  /// Segment-integrated contact: the two nodes of each patch, and the nodes at which the side ends. Vertices of
  /// an obstacle count as nodes behind those of the model (core/contact/segment.hpp).
  std::vector<std::vector<int>> facets = {};
  std::vector<int> ends = {};
  std::vector<std::array<int, 3>> edges = {};  ///< per facet: the side of a quadratic element that it is half of
  std::map<int, OwnVertex> own = {};           ///< of a side that is integrated against itself: per node
  Places<3> start = {};                        ///< of a side in space that touches itself: its vertices at the start
  bool is_rigid() const { return obstacle >= 0; }
  bool is_integrated() const { return !facets.empty(); }
  /// Its patches. pre: the model has D dimensions.
  template <int D>
  const Surface<D>& patches() const {
    return *std::get<std::shared_ptr<const Surface<D>>>(surface);
  }
  /// Whether a patch joins all of its neighbours without a corner or a crease.
  bool goes_on_around(int patch) const {
    return std::visit([patch](const auto& patches) { return (*patches)[patch].goes_on_around(); }, surface);
  }
  /// The vertices of a patch; no_vertex for one that it lacks.
  std::span<const int> vertices(int patch) const {
    return std::visit([&](const auto& patches) { return std::span<const int>((*patches)[patch].vertices); }, surface);
  }
  /// Whether it has patches that are not smooth.
  bool has_facets() const {
    const auto is_facet = [](const auto& patch) { return !patch.is_smooth(); };
    return std::visit([&](const auto& all) { return std::any_of(all->begin(), all->end(), is_facet); }, surface);
  }
  /// Whether the last patch of a curve ends where the first begins.
  bool is_loop() const { return patches<2>().back().across[1] == 0; }
};

/// One slave node and its master. At small strain it does not change.
struct ContactPoint {
  /// Kind of master. facet, vertex: of a curve, a body or an obstacle; faces: of a deformable side in space; surface:
  /// patches of a MasterSurface; segments: of any kind, by integrals over mortar segments, in space over overlaps.
  enum class Master { obstacle, facet, vertex, faces, segments, surface };
  Master master = Master::obstacle;
  int contact = 0;                  ///< index in Scene::contacts
  int obstacle = -1;                ///< index in Scene::obstacles; -1: deformable master
  int surface = -1;                 ///< index in Model::surfaces; -1: its master is none of these
  Facing facing = {};               ///< what it faces of the surface at the start
  std::vector<Facing> starts = {};  ///< in space: this place on each patch of the surface that has it
  OwnVertex own = {};               ///< set if the slave side is its own master
  int foot = -1;                    ///< offset of its foot in History::foot; -1: it has none
  std::vector<int> nodes;   ///< slave nodes, then master nodes. facet: its two; vertex: itself, then the far ends
                            ///< of the facets whose end the projection is; faces: of all; surface: of the initial patch
  int slave_nodes = 1;      ///< number of slave nodes in `nodes`; more than 1 if segment-integrated
  std::vector<int> places;  ///< index of `nodes` in Model::contact_nodes
  /// facet: its two ends; vertex: itself between its neighbours, whose facets share the normal. Vertices of an obstacle
  /// count as nodes behind those of the model (core/contact/segment.hpp).
  std::vector<int> corners;
  std::vector<FacePlace> faces;               ///< faces: the place that it faces, on each face that has it
  std::vector<std::vector<int>> area_facets;  ///< facets of the slave side at the node
  /// The same as indices in Model::contact_nodes; for solid bodies on a surface.
  std::vector<std::vector<int>> facet_places;
  /// Sides of elements at the node, or facets of these, a share of which is its tributary area.
  std::vector<std::vector<int>> area_edges;
  /// Segment-integrated contact: the segments that the multiplier of nodes[0] acts on. At finite strain: its whole
  /// slave facets, whose present segments are Facing::pieces.
  std::vector<Segment> segments;
  std::vector<Overlap> overlaps;  ///< the same in space, at small strain
  bool area_of_bar = false;       ///< tributary area is the cross-section of the bar; else, without facets, 1
  bool shares_normal = false;     ///< deformable continua on both sides: the normal is the bisector of the two
  bool turns_frame = false;       ///< in space, with friction: its normal turns as it slides over an obstacle, and its
                                  ///< tangents with it
  int slave_body = 0;
  double mesh_size = 0;   ///< mean length of the slave facets at the node, or of their edges; 0: none
  double tie_length = 0;  ///< length up to which an initial gap may be rounding of the coordinates
  int multiplier = 0;     ///< offset of its components in the multiplier vector
  int tangents = 0;       ///< 0 (frictionless) or D - 1
  int components() const { return 1 + tangents; }
  bool is_integrated() const { return master == Master::segments; }
  /// Number of its entries in History::foot, in D dimensions. pre: it has a foot.
  int feet(int D) const {
    if (surface >= 0) return D == 2 ? 1 : 6;
    return turns_frame ? 3 * D : D;
  }
};

/// A prescribed dof. supports[support] prescribes it along an axis, or along its inclined direction if axis ==
/// inclined. support < 0: prescribed as zero (the anchor of a spring that no support moves).
struct Constraint {
  static constexpr char inclined = 'n';
  int dof = 0, support = -1;
  char axis = 'x';
};

/// A node with an inclined support. Its D dofs are components along a frame (Slots::frames) and not along the axes. The
/// frame consists of the prescribed directions, orthonormalised in this order, and of those perpendicular to them.
struct FramedNode {
  int node = 0;
  int place = -1;                      ///< index in Model::contact_nodes, or -1
  std::vector<Constraint> prescribed;  ///< of dofs node D, node D + 1, ...
};

/// The physical effects of a scene. An effect that is off has no unknown, no storage and no code path.
struct Effects {
  bool contact = false;
  bool friction = false;
  bool coupled_friction = false;  ///< the bound of some contact depends on the pressure
  bool deformable_master = false;
  bool smoothing = false;   ///< some master has smooth patches
  bool plasticity = false;  ///< some body has memory
  bool sensitivity = false;
  /// The internal forces are linear in the displacements: the tangent of the bodies is constant.
  bool linear_bulk = true;
  bool current_geometry = false;  ///< gap, normal and slip have present geometry (finite strain)
  bool normals_turn = false;      ///< with the motion, of present geometry: some master is no plane
};

/// Nodes and facets of a side expression, in the numbering of the model.
struct SideSet {
  int body = 0;
  std::vector<int> nodes = {};
  std::vector<std::vector<int>> facets = {};
  std::vector<std::vector<int>> edges = {};  ///< Side::edges
};

/// The element of an edge, by its number in its body, and the corner at which the edge starts.
struct ElementEdge {
  int element = 0, corner = 0;
};

/// A pressure that follows its side at finite strain: the side of its load.
struct Follower {
  int load = 0;                           ///< index in Scene::loads
  std::vector<ElementEdge> backing = {};  ///< per edge: its element; empty if the thickness is constant
};

/// The two sides of a contact, as it names them.
struct ContactSides {
  SideSet slave, master = {};  ///< master: empty if it is an obstacle
  int obstacle = -1;           ///< index in Scene::obstacles; -1: deformable master
};

/// Where a response is taken, as far as its kind asks. A point that it names moves with the shape parameters, so nodes
/// and weights are constant.
struct ResponsePlace {
  std::vector<int> nodes;       ///< of its side; beside `at` of the element that holds the point
  std::vector<double> weights;  ///< of these at the point; empty for a side
  std::vector<int> bodies;      ///< that it names; beside `at` those that hold the point, `nodes` are of the first
  std::vector<int> contacts;    ///< indices in Scene::contacts
  std::vector<int> points;      ///< indices in Model::points: of its contacts; beside `at` the nearest one alone
};

/// Elements of each body.
using ElementLists = std::vector<std::vector<int>>;

struct Model {
  Scene scene;
  int dimension = 2;
  int node_count = 0;
  std::vector<BodyMesh> bodies;
  std::vector<ContactPoint> points;
  std::vector<MasterSurface> surfaces;
  std::vector<Follower> followers;
  int multiplier_count = 0;
  int foot_count = 0;                   ///< entries of History::foot
  int memory_count = 0;                 ///< entries of History::bodies
  std::vector<Constraint> constraints;  ///< ascending dof; those of framed nodes included
  std::vector<FramedNode> framed;       ///< ascending; empty where no support is inclined
  std::vector<int> free_index;          ///< per dof: index among the free ones, or -1
  std::vector<int> free_dofs;
  std::vector<int> contact_nodes;              ///< ascending; all nodes of all contact points
  std::vector<DesignVelocity> velocities;      ///< one per shape motion
  std::vector<SideSet> support_sides;          ///< per support
  std::vector<SideSet> load_sides;             ///< per load; of a body force the body alone
  std::vector<ContactSides> contact_sides;     ///< per contact
  std::vector<ResponsePlace> response_places;  ///< per response
  ElementLists at_reactions;  ///< elements at sides whose reactions are responses; empty: no reaction is
  std::vector<double> times;  ///< ends of the increments, including the breakpoints of all tables
  Effects effects;

  Model();  // (defined in model.cpp, so that they are compiled once)
  Model(const Model&);
  Model(Model&&) noexcept;
  Model& operator=(const Model&);
  Model& operator=(Model&&) noexcept;
  ~Model();

  /// Number of steps of a run; along a path the largest number.
  long most_steps() const { return scene.arc_length ? scene.arc_length->max : static_cast<long>(times.size()); }
  int dof_count() const { return dimension * node_count; }
  /// Index of a node in `contact_nodes`. pre: it is a contact node.
  int place_of(int node) const {
    return static_cast<int>(std::lower_bound(contact_nodes.begin(), contact_nodes.end(), node) - contact_nodes.begin());
  }
  /// Whether points slide along surfaces.
  bool slides_on_surfaces() const { return effects.current_geometry && !surfaces.empty(); }
  /// The nodes and facets of "body.side", "body.a & body.b", "body.a - body.b". Throws ModelError. Those that the scene
  /// names are resolved above, once: nothing that is evaluated asks for a name.
  SideSet side(const std::string& expression) const;
  int contact_index(const std::string& name) const;
  /// Whether a node lies on the axis of revolution, to the rounding of the coordinates. Such a node is held on the
  /// axis.
  bool is_on_axis(const Points<double>& points, int node) const;
};

/// Fault of a body in this space, apart from its mesh; "": none.
std::string space_fault(Space space, const Body& body);
/// Fault of a pressure on a body, in words that complete "BODY ..."; "": none.
std::string pressure_fault(const Scene& scene, const Body& body);
/// Fault of the positions of the nodes of a body in this space; "": none. `points`: of the whole model.
std::string radius_fault(Space space, const Points<double>& points, const BodyMesh& body);

/// Makes meshes, finds contact pairs and numbers dofs. Throws ModelError if entries of the scene contradict each other;
/// each entry by itself was checked when it was read. `spent`: result, seconds of the contact search.
Model make_model(const Scene& scene);
Model make_model(const Scene& scene, Seconds& spent);

/// Index of a node in Model::framed, or -1.
inline int framed_index(const Model& model, int node) {
  const auto found = std::lower_bound(model.framed.begin(), model.framed.end(), node,
                                      [](const FramedNode& framed, int sought) { return framed.node < sought; });
  return found == model.framed.end() || found->node != node ? -1 : static_cast<int>(found - model.framed.begin());
}

/// A node of the master that a point faces or may come to face; against an obstacle the slave node.
inline int master_node(const Model& model, const ContactPoint& point) {
  if (point.surface < 0 || point.obstacle >= 0) return point.nodes.back();
  return model.surfaces[point.surface].nodes.front();
}

/// Result of f.template operator()<D>() with the space dimension D.
template <class F>
decltype(auto) with_dimension(int dimension, F&& f) {
  return dimension == 3 ? f.template operator()<3>() : f.template operator()<2>();
}

}  // namespace stickslip
