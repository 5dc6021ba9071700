/// Scene: the plain description of one problem, as the user wrote it, before anything is computed from it.
/// docs/scene.md says what a file may hold; studies/scene_reader builds it from JSON.
///
/// Every physical or geometric number is a Number: its value and its slot in `Scene::numbers`. A Numbers<T> gives all
/// of them in the scalar T, so a parameter, a difference step and a complex step are the same thing: a change of some
/// slots.
#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/algebra/scalar.hpp"
#include "core/contact/friction_law.hpp"
#include "core/contact/rigid_surfaces.hpp"
#include "core/contact/surface.hpp"
#include "core/mesh/generators.hpp"
#include "core/model/table.hpp"
#include "core/solids/materials.hpp"

namespace stickslip {

// --- bodies ------------------------------------------------------------------------------------------------------

struct Body {
  std::string name;
  MeshDescription mesh;
  Material material;
  std::string element;     ///< as in generators.hpp: "Q4", "T10", ...; "": follows from mesh and material
  Number area = 1.0;       ///< of a bar's cross-section
  Number thickness = 1.0;  ///< of a continuum in a plane space
};

/// Rotation theta about a center, and in space an axis through it (need not be a unit vector); positive
/// counter-clockwise. Small strain: u = theta x (X - center), for a body turned by a finite angle is not free of
/// linear strain.
struct Rotation {
  std::vector<Number> center, axis;  ///< axis: empty in 2D
  Table angle;                       ///< degrees
};
struct Obstacle {
  std::string name;
  RigidSurface shape;
  std::map<char, Table> move = {};      ///< rigid displacement by axis
  std::optional<Rotation> rotate = {};  ///< added to it
};

struct Contact {
  std::string name;
  std::string slave;                            ///< side expression of a deformable body
  std::string master;                           ///< obstacle name, or side expression of a deformable body; the slave's
                                                ///< own: the side touches itself
  std::optional<FrictionLaw<Number>> friction;  ///< none: frictionless, no tangential unknowns or code path
  Number offset = 0.0;                          ///< added to the geometric gap
  bool segment = false;                         ///< segment-integrated gap and slip in place of node-to-segment
  Smoothing smoothing = Smoothing::none;        ///< of a master of facets
  double corner = 30;                           ///< degrees that facets turn by at most where they are smoothed
  std::string group = {};                       ///< of a pair of "between": the name that stands for all pairs
  bool is_of_itself() const { return slave == master; }
};

/// Prescribed displacement n.u along a direction, free across it.
struct Inclined {
  std::vector<Number> along;  ///< n, need not be a unit vector: its length does not matter
  Table value;
};
/// Prescribed displacement on a side (an anchor's move drives the spring): by axis, of all axes where it rotates, or
/// inclined.
struct Support {
  std::string on;
  std::map<char, Table> move = {};
  std::optional<Rotation> rotate = {};    ///< of all axes, added to `move`
  std::optional<Inclined> inclined = {};  ///< alone
};

/// Calls f(t) with the breakpoints of all that a support or an obstacle prescribes; between them it is linear in time.
template <class Moved, class F>
void for_each_breakpoint(const Moved& moved, F&& f) {
  for (const auto& [axis, table] : moved.move) for_each_breakpoint(table, f);
  if (moved.rotate) for_each_breakpoint(moved.rotate->angle, f);
  if constexpr (requires { moved.inclined; })
    if (moved.inclined) for_each_breakpoint(moved.inclined->value, f);
}

struct Load {
  enum class Kind { traction, pressure, force, body_force };
  std::string on;  ///< a side; a body for body_force
  Kind kind = Kind::traction;
  /// traction: per area (per length on a bar); pressure: one number, per area, along the inward normal of the start, at
  /// finite strain along the present one, on the present area;
  /// force: total, shared by tributary area; body_force: per volume
  std::vector<Number> vector;
  std::optional<Table> history;  ///< factor in time; none: 1 from the first step on
};

// --- what is asked -----------------------------------------------------------------------------------------------

struct Response {
  enum class Kind {
    reaction,
    contact_force,
    displacement,
    contact_pressure,
    gap,
    slip,
    dissipation,
    strain_energy,
    plastic_strain,
    contact_half_width
  };
  enum class Take { mean, max, min };
  enum class Component { own, x, y, z, normal, moment };  ///< own: of a slip in the plane, along its own tangent
  std::string name;
  Kind kind = Kind::displacement;
  std::string on;  ///< side expression, or name of a contact or body, as the kind asks
  Component component = Component::own;
  Take take = Take::mean;
  std::vector<Number> about = {};        ///< of a moment, or of a half width
  std::vector<Number> moment_axis = {};  ///< direction, of any length; in space, of a moment
  std::vector<Number> at;                ///< point of the initial configuration instead of `on`

  /// 0, 1, 2 of x, y, z. pre: the component is one of them.
  int axis() const { return static_cast<int>(component) - static_cast<int>(Component::x); }
};

/// A side of a body, or one node of it, moves along a direction: a shape parameter, whose slot holds the distance.
struct ShapeMotion {
  int body = 0;
  std::string side;   ///< side expression
  std::string fixed;  ///< side expression of what stays; empty: all other sides of the body
  std::vector<double> direction;
  int node = -1;  ///< index along the side; -1: the whole side
  int slot = 0;
};

/// A scalar over time: the sum over the requested steps, or the value at the end of one, of a response F, or of its
/// squared distance (F - target)^2 to a target.
struct Objective {
  std::string name;
  int response = 0;          ///< index in Scene::responses
  std::optional<double> at;  ///< a time; none: the sum. It becomes the end of a step, as a breakpoint of a table does
  std::optional<Table> target = {};
};

/// Derivatives of all responses, or of the objectives alone at a cost that does not grow with the parameters.
enum class SensitivityMode { direct, adjoint };

/// A parameter: weights on slots; its derivative is the sum of weight * d/d(slot).
struct Parameter {
  std::string name;
  std::vector<std::pair<int, double>> slots;
  std::string pointer;  ///< as the user named it (the first, where weighted)
  double value = 0;     ///< of the first slot
};

/// The time of a step is found, not given: steps go along the path of equilibria (methods/stepping/path.hpp), on which
/// the time of the load that it drives may fall. All else is held.
struct ArcLength {
  int load = 0;       ///< index in Scene::loads; its history goes on
  double length = 0;  ///< that the bodies move by in a step where the load stands still; 0: path_length() says
  int max = 0;        ///< steps at most
};

/// [t_end, steps] each; the first leg starts at t = 0.
struct Leg {
  double end = 1;
  int steps = 1;
};

struct Scene {
  std::string title;
  Space space = Space::plane_strain;  ///< axisymmetric: x is the radius, y the axis; all is of the full revolution
  bool finite_strain = false;         ///< everything is on the current configuration; else linear, on that of the start
  std::vector<Body> bodies;
  std::vector<Obstacle> obstacles;
  std::vector<Contact> contacts;
  std::vector<Support> supports;
  std::vector<Load> loads;
  std::vector<Leg> legs;
  std::optional<ArcLength> arc_length;  ///< of the one leg that there is then
  std::vector<Response> responses;
  std::vector<ShapeMotion> shapes;
  std::vector<Objective> objectives;
  SensitivityMode sensitivity_mode = SensitivityMode::direct;
  std::vector<Parameter> parameters;

  std::vector<double> numbers;        ///< value of each slot
  std::vector<std::string> pointers;  ///< JSON pointer of each slot

  Scene();  // (these are defined once, in scene.cpp: a scene has many parts, and many sources hold scenes)
  Scene(const Scene&);
  Scene(Scene&&) noexcept;
  Scene& operator=(const Scene&);
  Scene& operator=(Scene&&) noexcept;
  ~Scene();

  int dimension() const;  ///< 2, or 3 for Space::solid

  /// All numbers as T, unseeded.
  template <class T>
  Numbers<T> as() const {
    return {std::vector<T>(numbers.begin(), numbers.end())};
  }
};

inline int Scene::dimension() const { return space == Space::solid ? 3 : 2; }

/// Whether the stiffness of all bodies is constant: strains are small, and nothing flows.
inline bool has_constant_stiffness(const Scene& scene) {
  const auto remembers = [](const Body& body) { return flows(body.material); };
  return !scene.finite_strain && std::none_of(scene.bodies.begin(), scene.bodies.end(), remembers);
}

}  // namespace stickslip
