/// Small scenes written in C++, shared by the tests: what scene files say, without the files. Every number
/// that a test differentiates has a slot.
#pragma once

#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/model/scene.hpp"

namespace stickslip::scenes {

/// A number with a slot, and a parameter of the same name.
Number parameter(Scene& scene, const std::string& name, double value);

Response response(const std::string& name, Response::Kind kind, const std::string& on,
                  const std::string& component = "", Response::Take take = Response::Take::mean);

Table table(std::vector<std::pair<double, Number>> points);

Load force(const std::string& on, std::vector<Number> vector);
Load traction(const std::string& on, std::vector<Number> vector);
Support support(const std::string& on, std::map<char, Table> move);

Contact contact(const std::string& name, const std::string& slave, const std::string& master);

/// A quarter of a ring of radii 1 and 2, with n cells along the radius and 2 n around.
RingMesh quarter_ring(int n);

/// A1: spring k pushed by F against a stop at g0, all in y.
Scene stop(double F = 15, double k = 1000, double g0 = 0.01);

/// A2: block pressed by N, dragged by a spring k whose anchor follows `drive` (t, U); amplitude U0 scales the drive.
Scene slider(const std::vector<std::pair<double, double>>& drive, int steps, double k = 100, double mu = 0.3,
             double N = 10);

/// A3: a point on a rough plane in space, dragged by an isotropic spring; mu N / k = c. Its anchor runs through
/// `path` (t, x, y), relative to the point's start.
Scene dragged_point(const std::vector<std::array<double, 3>>& path, int steps, double c);

/// B2: the GRECO plate with n x n elements.
Scene greco_plate(int n, double mu = 1);

/// Two elastic boxes, slave above with `slave` cells along the interface and master below with `master`; pressed
/// down by 0.01 and then moved sideways to and fro.
Scene two_boxes(int slave, int master, const std::string& element = "Q4", double mu = 0.3);

/// two_boxes with an elastic upper box of `cells` by `cells` on a lower one that flows: pressed until it does, then
/// moved sideways to and fro. `inclined`: the upper box is driven along an inclined direction, its top free across it
/// but for a corner, and pulled at its side.
Scene punched_metal(int cells, double mu = 0.3, bool inclined = false);

/// A4: a bar on a rough floor (EA = 1000, length 1, weight 100 per length) pulled at its start. `path`: the pull in
/// units of P = 20 at t = 0, 1, 2, ...; `steps` to each leg.
Scene pull_out(int cells, const std::vector<double>& path, int steps);

/// Adds a shape parameter. Its derivatives are measured against a body of size one.
void shape(Scene& scene, const std::string& name, ShapeMotion motion);

/// two_boxes whose sides move: the slave surface as a whole and node by node, and a side away from the contact.
Scene shaped_boxes(int slave, int master, const std::string& element, bool segment);

/// two_boxes with segment-integrated contact; `edge`, the right end of the slave, moves the segments.
Scene segment_boxes(int slave, int master, double mu = 0.3);

/// Two half disks of radii 1 and `radius`, pressed by 0.04 and then moved sideways; `cells` along a quarter.
Scene two_disks(int cells, bool segment, double mu = 0.2);

/// A block that only supports, loads and obstacles of every kind drive: inclined supports (one of them at a contact
/// point, one node with two), a rotating support, a rotating and moving obstacle, pressure and body force.
Scene driven_block(const std::string& element = "Q4");

/// A block on an inclined polyline, pressed on and pushed to and fro along it by its left side, whose corner's friction
/// the support decides. Neither tractions nor displacements depend on its thickness.
Scene pushed_block(double angle = 0.6);

/// A3's point in space, whose anchor is held in an inclined direction and turned about a skew axis.
Scene turned_point();

/// two_boxes as bodies of revolution, the lower one on the axis; or as slices of unlike thickness.
Scene two_drums(int slave, int master, const std::string& element);
Scene two_slices(int slave, int master, const std::string& element);

/// A quarter of a disk-like ring pushed with an interference into a graded quarter ring, which then turns: curved
/// sides, every number of both meshes.
Scene fitted_rings(const std::string& element);

/// A point on a spring whose tangential and normal parts are coupled, pushed along a rough floor: the further it slips,
/// the harder it is pressed, by 1/s of the tangential force, s = k / coupling.
Scene wedge(double mu, double push = 100, double press = 10, double k = 100, double coupling = 50);

/// Scenes of all kinds: open, stick and slip, one step and a path, the plane and space, conforming meshes and others.
std::vector<Scene> all();

/// With shape parameters, whose derivatives move the gap as a whole.
std::vector<Scene> shaped();

/// One for each kinematics and each kind of element.
std::vector<Scene> of_every_element();

}  // namespace stickslip::scenes
