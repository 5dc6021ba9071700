#include "studies/input/obstacle_kinds.hpp"

#include <stdexcept>
#include <tuple>
#include <type_traits>

#include "core/mesh/stl_reader.hpp"
#include "core/model/model.hpp"
#include "studies/input/described.hpp"
#include "studies/input/file_objects.hpp"
#include "studies/input/made_mesh.hpp"
#include "studies/input/mesh_kinds.hpp"
#include "studies/io/json_pointer.hpp"

namespace stickslip {
namespace {

using nlohmann::json;
using Schema = nlohmann::ordered_json;

Schema polyline_schema() {
  return Schema::parse(R"json({
  "description": "straight facets; not in space", "type": "object", "required": ["points"],
  "examples": [{"points": [[5, 0], [0, 0], [0, 2]]}], "additionalProperties": false, "properties": {
    "points": {
      "description": "the solid is on the right of the way along them; the first once more closes it (length)",
      "title": "two or more [x, y]", "type": "array",
      "minItems": 2, "items": {"$ref": "#/$defs/pair"}, "examples": [[[5, 0], [0, 0], [0, 2]]]}}})json");
}

std::optional<RigidSurface> read_polyline(const JsonNode& node, SceneReading& reading) {
  constexpr const char* allowed = "an array of two points [x, y] or more, the solid on the right of the way along them";
  static const Keys keys = keys_of(polyline_schema());
  if (!node.is_object(keys)) return std::nullopt;
  const auto points = node.find("points");
  if (!points) return std::nullopt;
  if (!points->value().is_array() || points->value().size() < 2) {
    points->must_be(allowed);
    return std::nullopt;
  }
  Polyline polyline;
  auto same = [](const auto& a, const auto& b) { return a[0].value == b[0].value && a[1].value == b[1].value; };
  for (const JsonNode& element : points->elements()) {
    const bool last = polyline.points.size() + 1 == points->value().size();
    const bool again = last && polyline.points.size() > 2 && element.value() == points->value().front();
    if (again) {
      polyline.closed = true;
      for (int i = 0; i < 2; ++i)
        reading.constants[child_pointer(element.pointer(), std::to_string(i))] =
            "of the point that closes the polyline; its first point is the parameter";
      break;
    }
    const auto x = reading.vector(element, 2);
    polyline.points.push_back({x[0], x[1]});
    if (const auto n = polyline.points.size(); n > 1 && same(polyline.points[n - 1], polyline.points[n - 2]))
      element.error("is the point before it once more; two points in a row must differ");
  }
  return polyline;
}

Schema stl_schema() {
  return Schema::parse(R"json({
  "description": "triangles of an STL file; in space alone", "type": "object", "required": ["file"],
  "examples": [{"file": "tool.stl"}], "additionalProperties": false, "properties": {
    "file": {
      "description": "of an STL file, ASCII or binary; its place is from the scene's folder. The solid is behind the triangles, whose corners are counter-clockwise seen from outside",
      "title": "file name", "type": "string", "examples": ["tool.stl"]},
    "scale": {
      "description": "what lengths of the file are multiplied by", "title": "number > 0", "type": "number",
      "exclusiveMinimum": 0, "default": 1, "examples": [0.001]}}})json");
}

std::optional<RigidSurface> read_stl_file(const JsonNode& node, SceneReading& reading) {
  static const Keys keys = keys_of(stl_schema());
  if (!node.is_object(keys)) return std::nullopt;
  const auto file = node.find("file");
  const auto name = file ? file->text() : std::nullopt;
  const auto scale = node.find("scale");
  if (scale) reading.constants[scale->pointer()] = "of lengths of a file, which are no parameters";
  const auto factor = scale ? scale->number(positive) : 1;
  if (!name || !factor) return std::nullopt;
  constexpr std::uintmax_t most = std::uintmax_t{1} << 28;  // some 5 million triangles
  const auto content = reading.content_of(*file, *name, "STL", most);
  if (!content) return std::nullopt;
  StlSurface surface = read_stl(*content, reading.path_of(*name));
  for (const auto& error : surface.errors) reading.diagnostics.error({{}, "", error});
  if (!surface.errors.empty()) return std::nullopt;
  reading.mesh_fingerprints[*name] = fingerprint(*content);
  RigidFacets facets{*factor * surface.vertices, {}};
  for (const auto& facet : surface.facets) facets.facets.emplace_back(facet.begin(), facet.end());
  return facets;
}

Schema mesh_side_schema() {
  return Schema::parse(R"json({
  "description": "a side of a mesh, held rigid", "type": "object", "required": ["mesh", "side"],
  "examples": [{"mesh": {"disk": {"center": [0, -1], "radius": 1, "cells": [8, 2]}}, "side": "arc"}], "additionalProperties": false,
  "properties": {
    "mesh": {
      "description": "as of a body; the solid is inside of it. Of gmsh without a body: a physical surface, in the plane a curve, that is on no body; the solid is behind faces that are counter-clockwise seen from outside, in the plane on the left", "$ref": "#/$defs/mesh",
      "examples": [{"gmsh": "tool.msh", "body": "tool"}]},
    "side": {
      "description": "of this mesh, or an expression of several, without the name of a body", "title": "SIDE",
      "type": "string", "examples": ["arc"]}}})json");
}

/// The side of a mesh that was made; none, reported, where the mesh has no such side, or one without facets.
std::optional<RigidSurface> side_of(const MeshDescription& description, const Mesh& mesh, const JsonNode& side) {
  try {
    return MeshSide(description, mesh, side.value());
  } catch (const std::invalid_argument& fault) {
    side.error("is " + shown(side.value()) + "; " + fault.what());
    return std::nullopt;
  }
}

std::optional<RigidSurface> read_mesh_side(const JsonNode& node, SceneReading& reading) {
  static const Keys keys = keys_of(mesh_side_schema());
  if (!node.is_object(keys)) return std::nullopt;
  const auto mesh_node = node.find("mesh"), side = node.find("side");
  if (mesh_node && side && mesh_node->value().is_object() && mesh_node->find("gmsh") && !mesh_node->find("body")) {
    const auto loose = read_loose_side(*mesh_node, *side, reading);
    if (!loose) return std::nullopt;
    if (const auto message = radius_fault(reading.scene.space, loose->points, {loose->mesh}); !message.empty()) {
      mesh_node->error(message);
      return std::nullopt;
    }
    return side_of(*loose, loose->mesh, *side);
  }
  const auto description = mesh_node ? read_mesh(*mesh_node, reading) : std::nullopt;
  const auto name = side ? side->text() : std::nullopt;
  if (!description || !name) return std::nullopt;
  if (filling_of(*description) != Filling::continuum) {
    mesh_node->error("is " + shown(mesh_node->value()) +
                     ", which fills no region; a rigid side needs a solid behind it");
    return std::nullopt;
  }
  auto mesh = made_mesh(node, *mesh_node, *description, "", MeshOf::obstacle, reading);
  if (!mesh) return std::nullopt;
  return side_of(*description, *mesh, *side);
}

json value_json(const Number& number) { return number.value; }
json value_json(bool flag) { return flag; }
template <class Vector>
json value_json(const Vector& numbers) {
  json out = json::array();
  for (const Number& number : numbers) out.push_back(number.value);
  return out;
}

template <Described S>
json as_drawn(const S& surface, const Numbers<double>&) {
  json values;
  std::apply([&](const auto&... of) { ((values[of.key] = value_json(surface.*of.member)), ...); }, S::keys());
  return {{S::key, values}};
}

json as_drawn(const Polyline& polyline, const Numbers<double>&) {
  json vertices = json::array();
  for (const auto& x : polyline.points) vertices.push_back(value_json(x));
  if (polyline.closed) vertices.push_back(vertices.front());
  return {{"polyline", {{"points", vertices}}}};
}

/// (Pictures of space show bodies alone.)
json as_drawn(const RigidFacets&, const Numbers<double>&) { return {{"stl", json::object()}}; }

json as_drawn(const MeshSide& side, const Numbers<double>& numbers) {
  json points = json::array();
  if (side.mesh.dimension == 2) {
    const Points<double> vertices = vertices_of(side, numbers);
    const auto add = [&](int v) { points.push_back({vertices(0, v), vertices(1, v)}); };
    for (std::size_t f = side.facets.size(); f-- > 0;) {  // backwards: a polyline has its solid on the right
      const bool is_first = f + 1 == side.facets.size(),
                 goes_on = !is_first && side.facets[f + 1][0] == side.facets[f][1];
      if (!goes_on && !is_first) points.push_back(nullptr);
      if (!goes_on) add(side.facets[f][1]);
      add(side.facets[f][0]);
    }
  }
  return {{"polyline", {{"points", points}}}};
}

ObstacleKind entry_of(std::type_identity<Polyline>) { return {"polyline", polyline_schema, read_polyline}; }
ObstacleKind entry_of(std::type_identity<RigidFacets>) { return {"stl", stl_schema, read_stl_file}; }
ObstacleKind entry_of(std::type_identity<MeshSide>) { return {"mesh_side", mesh_side_schema, read_mesh_side}; }

template <class S>
ObstacleKind obstacle_kind(std::type_identity<S>) {
  static_assert(
      Described<S> || requires { entry_of(std::type_identity<S>()); },
      "a surface of core/contact/rigid_surfaces.hpp lacks its keys()");
  ObstacleKind kind;
  if constexpr (Described<S>)
    kind = {S::key, schema_of_object<S>, read_as<RigidSurface, S>};
  else
    kind = entry_of(std::type_identity<S>());
  kind.is_in_plane = S::is_in_plane;
  kind.is_in_space = S::is_in_space;
  return kind;
}

}  // namespace

const std::vector<ObstacleKind>& obstacle_kinds() {
  static const auto kinds = list_of<RigidSurface>([](auto surface) { return obstacle_kind(surface); });
  return kinds;
}

json drawn(const RigidSurface& surface, const Numbers<double>& numbers) {
  return std::visit([&](const auto& shape) { return as_drawn(shape, numbers); }, surface);
}

}  // namespace stickslip
