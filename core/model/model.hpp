/// Model: what a scene becomes once its meshes are made and its contact pairs are found. It holds everything that does
/// not depend on a number (nodes, dofs, contact points, active effects); what does is in Slots<T>. Immutable.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/contact/contact_point.hpp"
#include "core/contact/curve.hpp"
#include "core/mesh/mesh.hpp"
#include "core/model/design_velocity.hpp"
#include "core/model/scene.hpp"
#include "core/model/seconds.hpp"
#include "core/solids/continuum.hpp"

namespace stickslip {

/// A scene that cannot become a model; what() says why in the user's words, `pointer` which entry of the scene it is
/// about, as a JSON pointer ("" where it is about none).
struct ModelError : std::runtime_error {
  explicit ModelError(const std::string& message, std::string where = "")
      : std::runtime_error(message), pointer(std::move(where)) {}
  std::string pointer;
};

/// Mesh of a body with its place in the numbering of all nodes.
struct BodyMesh {
  Mesh mesh;
  int first_node = 0;
  Kinematics kinematics = Kinematics::plane;
  int memory = 0;        ///< numbers that an element remembers, point by point
  int first_memory = 0;  ///< where those of the body begin in History::bodies
};

/// A side of a body, or a rigid polyline, that points face by patches (core/contact/curve.hpp).
struct MasterCurve {
  int contact = 0;
  int obstacle = -1;        ///< index in Scene::obstacles of a polyline; -1: of nodes
  std::vector<int> nodes;   ///< of the vertices; empty for a polyline, whose vertices are its points
  std::vector<int> places;  ///< of these in Model::contact_nodes
  int vertex_count = 0;
  std::vector<Patch> patches;
  /// Segment-integrated contact: the two nodes of each patch, and the nodes at which the side ends.
  std::vector<std::vector<int>> facets = {};
  std::vector<int> ends = {};
  bool is_integrated() const { return !facets.empty(); }
};

/// One slave node and what it can touch. Fixed for small strain.
struct ContactPoint {
  /// facet and vertex of a deformable side or a polyline; curve: patches, which points slide along at finite strain
  enum class Master { obstacle, facet, vertex, segments, curve };
  Master master = Master::obstacle;
  int contact = 0;               ///< index in Scene::contacts
  int obstacle = -1;             ///< index in Scene::obstacles, -1 for a deformable master
  int curve = -1;                ///< index in Model::curves; -1: it faces none
  Facing facing = {};            ///< the place of the curve that it faces at the start
  OwnVertex own = {};            ///< of the curve, where its slave is its master
  int foot = -1;                 ///< offset of its foot's place in History::foot; -1: it has none
  std::vector<int> nodes;        ///< slave, then master nodes (facet: its two; vertex: itself, then the far ends of the
                                 ///< facets at whose very end the projection lies; curve: of the patch of the start)
  int slave_nodes = 1;           ///< how many of `nodes` are the slave's, the first; several if segment-integrated
  std::vector<int> places;       ///< of `nodes` in Model::contact_nodes
  std::vector<int> neighbours;   ///< vertex: the vertices before and after it, whose facets share the normal
  std::vector<int> of_polyline;  ///< points of the polyline: the facet's two, or the vertex between its neighbours
  std::vector<std::pair<int, int>> area_facets;   ///< facets of the slave side at the node
  std::vector<std::pair<int, int>> facet_places;  ///< the same in Model::contact_nodes, of a solid body's along a curve
  std::vector<std::vector<int>> area_edges;  ///< sides of elements there, of which a share is tributary to the node
  /// Segment-integrated contact: the segments that the multiplier of nodes[0] acts on. At finite strain: its whole
  /// slave facets, whose present segments are Facing::pieces.
  std::vector<Segment> segments;
  bool area_of_bar = false;    ///< tributary area is the bar's cross-section; with no facets either: 1
  bool shares_normal = false;  ///< deformable continua on both sides: the normal is the bisector of the two
  int slave_body = 0;
  double mesh_size = 0;   ///< local size of the slave side, 0 for a lumped point
  double tie_length = 0;  ///< an initial gap up to this may be rounding of the coordinates
  int multiplier = 0;     ///< offset of its components in the multiplier vector
  int tangents = 0;       ///< 0 (frictionless) or D - 1
  int components() const { return 1 + tangents; }
};

/// A dof whose displacement is prescribed, by supports[support] along an axis, or by its inclined direction where the
/// axis is `inclined`; zero where support < 0 (the anchor of a spring that nobody moves).
struct Constraint {
  static constexpr char inclined = 'n';
  int dof = 0, support = -1;
  char axis = 'x';
};

/// A node that a support holds in an inclined direction. Its D dofs are not the axes but the vectors of a frame
/// (Slots::frames): the prescribed directions, orthonormalised in this order, then those across them.
struct FramedNode {
  int node = 0;
  int place = -1;                      ///< in Model::contact_nodes, or -1
  std::vector<Constraint> prescribed;  ///< of dofs node D, node D + 1, ...
};

/// The physical effects that a scene calls for; what is off has no unknown, no storage and no code path.
struct Effects {
  bool contact = false;
  bool friction = false;
  bool coupled_friction = false;  ///< its bound depends on the pressure somewhere
  bool deformable_master = false;
  bool smoothing = false;   ///< of some master's facets
  bool plasticity = false;  ///< a body flows, and remembers
  bool sensitivity = false;
  /// The internal forces are linear in the displacements: the tangent of the bodies is constant.
  bool linear_bulk = true;
  bool current_geometry = false;  ///< gap, normal and slip are those of the points where they are now
};

/// Nodes and facets of a side expression, in the numbering of the model.
struct SideSet {
  int body = 0;
  std::vector<int> nodes;
  std::vector<std::vector<int>> facets;
  std::vector<std::vector<int>> edges;  ///< Side::edges
};

/// The element behind an edge, in its body, and its corner at which the edge starts.
struct ElementEdge {
  int element = 0, corner = 0;
};

/// A pressure that follows the side that it acts on, as at finite strain.
struct Follower {
  int load = 0;  ///< index in Scene::loads
  SideSet side = {};
  std::vector<ElementEdge> backing = {};  ///< per edge of the side, whose thickness changes; empty where none does
};

/// Where a response is taken that names a point: nodes and weights of the element that holds it (fixed: the point is
/// convected with the shape parameters), or the nearest contact point.
struct ResponsePlace {
  std::vector<std::pair<int, double>> nodes;
  int contact_point = -1;
  std::vector<int> bodies = {};  ///< that hold the point; the nodes are of the first
};

/// Elements of each body.
using ElementLists = std::vector<std::vector<int>>;

struct Model {
  Scene scene;
  int dimension = 2;
  int node_count = 0;
  std::vector<BodyMesh> bodies;
  std::vector<ContactPoint> points;
  std::vector<MasterCurve> curves;
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
  std::vector<ResponsePlace> response_places;  ///< per response
  ElementLists at_reactions;                   ///< with a node of a side whose reaction is asked for; empty: none is
  std::vector<double> times;                   ///< ends of the increments, breakpoints of every table included
  Effects effects;

  Model();  // (these are defined once, in model.cpp, as those of Scene are)
  Model(const Model&);
  Model(Model&&) noexcept;
  Model& operator=(const Model&);
  Model& operator=(Model&&) noexcept;
  ~Model();

  /// Steps that a run asks for, or may take along a path.
  long most_steps() const { return scene.arc_length ? scene.arc_length->max : static_cast<long>(times.size()); }
  int dof_count() const { return dimension * node_count; }
  /// Place of a contact node in `contact_nodes`.
  int place_of(int node) const {
    return static_cast<int>(std::lower_bound(contact_nodes.begin(), contact_nodes.end(), node) - contact_nodes.begin());
  }
  /// Whether points face other places of their curves as they move.
  bool slides_along_curves() const { return effects.current_geometry && !curves.empty(); }
  /// The nodes and facets of "body.side", "body.a & body.b", "body.a - body.b". Throws ModelError.
  SideSet side(const std::string& expression) const;
  int contact_index(const std::string& name) const;
  /// Whether a contact has this name, or is one of its pairs.
  bool is_of_contact(int contact, const std::string& name) const {
    return scene.contacts[contact].name == name || scene.contacts[contact].group == name;
  }
  /// Whether a node lies on the axis of revolution, to the rounding of the coordinates: it is held there.
  bool is_on_axis(const Points<double>& points, int node) const;
};

/// What is wrong with a body in this space, apart from its mesh; "" if nothing.
std::string space_fault(Space space, const Body& body);
/// What is wrong with a pressure on a body, completing "BODY ..."; "" if nothing.
std::string pressure_fault(const Scene& scene, const Body& body);
/// What is wrong with where its nodes lie in this space; "" if nothing. `points`: of the whole model.
std::string radius_fault(Space space, const Points<double>& points, const BodyMesh& body);

/// Makes meshes, finds contact pairs, numbers the dofs. Throws ModelError where the scene makes no sense as a whole
/// (what a single entry may hold was checked when it was read). `spent` gets the seconds of the contact search.
Model make_model(const Scene& scene);
Model make_model(const Scene& scene, Seconds& spent);

/// "a.b - a.c" resolved on the meshes of a scene; used by make_model and by the scene reader's checks.
SideSet resolve_side(const Scene& scene, const std::vector<BodyMesh>& bodies, const std::string& expression);

/// Index of a node in Model::framed, or -1.
inline int framed_index(const Model& model, int node) {
  const auto found = std::lower_bound(model.framed.begin(), model.framed.end(), node,
                                      [](const FramedNode& framed, int sought) { return framed.node < sought; });
  return found == model.framed.end() || found->node != node ? -1 : static_cast<int>(found - model.framed.begin());
}

/// A node of what a point faces, or may come to face; of an obstacle the slave node itself.
inline int master_node(const Model& model, const ContactPoint& point) {
  if (point.curve < 0 || point.obstacle >= 0) return point.nodes.back();
  return model.curves[point.curve].nodes.front();
}

/// Calls f with the space dimension as a compile-time constant: f.template operator()<D>().
template <class F>
decltype(auto) with_dimension(int dimension, F&& f) {
  return dimension == 3 ? f.template operator()<3>() : f.template operator()<2>();
}

}  // namespace stickslip
