/// The bodies of a picture: elements coloured by equivalent stress, springs, what has flowed, outlines.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "studies/report/drawing.hpp"
#include "studies/report/picture_frame.hpp"

namespace stickslip::report {

/// Where a point on a spring, or its anchor, has been.
struct Track {
  std::vector<Point> places;
  bool of_anchor = false;
};

struct Mesh {
  std::vector<Point> points;               ///< initial
  std::vector<Point> displacement;         ///< 0 where not recorded
  std::vector<std::vector<int>> elements;  ///< node lists with valid indices
  std::vector<double> stress;              ///< one an element, or empty
  std::vector<double> plastic;             ///< equivalent plastic strain, one an element; empty where nothing flows
  std::vector<int> body;                   ///< one an element, or empty
  std::vector<Track> tracks;               ///< of points, where one of them turns
  bool aslant = false;                     ///< its elements are faces of solid bodies, seen aslant
  bool in_space = false;                   ///< three coordinates, of which two are kept: seen along z
};

/// The extent of the nodes at the start; 0 where all bodies are points.
double extent_of(const Mesh& mesh);

/// Whether an element is the spring of a point to its anchor, which begin at the same place.
bool is_spring(const Mesh& mesh, const std::vector<int>& nodes);

/// The mesh of picture.json; no points where it is not one.
Mesh read_mesh(const nlohmann::json& picture);

/// Exaggeration: 1 where displacements show by themselves, else the round number that brings the largest to some 3 %
/// of the picture.
double scale_of(const Mesh& mesh, double extent);

/// Places of the nodes with their displacements enlarged by `scale`.
std::vector<Point> deformed(const Mesh& mesh, double scale);

/// Elements inside the frame's window, one path a colour: 20 000 elements stay a light page.
void draw_elements(const Mesh& mesh, const std::vector<Point>& at, const Frame& frame, double peak, bool mesh_lines,
                   Drawing& drawing);

/// Where points have been, and, dotted, their anchors.
void draw_tracks(const Mesh& mesh, const Frame& frame, Drawing& drawing);

/// A dot in the middle of each element that has flowed.
void draw_flowed(const Mesh& mesh, const std::vector<Point>& at, const Frame& frame, Drawing& drawing);

/// Sides that belong to one element of a body alone: the outlines of the bodies.
void draw_outlines(const Mesh& mesh, const std::vector<Point>& at, const Frame& frame, Drawing& drawing);

/// The scale of colours up to the largest stress, with its upper edge at y.
void draw_stresses(double peak, double y, Drawing& drawing);

}  // namespace stickslip::report
