/// Faults of scene files: each is one, at its place, with its pointer, in words that say what is allowed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/studies/scene_texts.hpp"

namespace stickslip {
namespace {

using namespace scene_texts;
using testing::HasSubstr;

/// A scene with one edit: `from` becomes `to`, in which @ marks the place that the fault must name.
struct Broken {
  const char* name;
  const char* scene;
  std::string from, to;
  std::string pointer, message;
};
void PrintTo(const Broken& broken, std::ostream* out) { *out << broken.to; }

class BrokenScene : public testing::TestWithParam<Broken> {};

TEST_P(BrokenScene, IsRefusedWithPlacePointerAndReason) {
  const Broken& broken = GetParam();
  std::string text = edited(broken.scene, broken.from, broken.to);
  const auto mark = text.find('@');
  ASSERT_NE(mark, std::string::npos);
  text.erase(mark, 1);
  const int line = 1 + static_cast<int>(std::count(text.begin(), text.begin() + mark, '\n'));
  const int column = static_cast<int>(mark - (text.rfind('\n', mark - 1) + 1)) + 1;
  Diagnostics diagnostics;
  EXPECT_FALSE(read_text(text, diagnostics).has_value());
  ASSERT_EQ(diagnostics.error_count(), 1u) << diagnostics.text();
  const Diagnostic fault = diagnostics.errors()[0];
  EXPECT_EQ(fault.place.line, line) << fault.text();
  EXPECT_EQ(fault.place.column, column) << fault.text();
  EXPECT_EQ(fault.pointer, broken.pointer);
  EXPECT_THAT(fault.message, HasSubstr(broken.message));
}

const char* const title = R"("title": "block pushed over a floor")";
const char* const box = R"({"box": {"min": [0, 0], "max": [4, 2], "cells": [4, 2]}})";
const char* const elastic = R"("linear_elastic": {"E": 1000, "nu": 0.25})";
const char* const floor_plane = R"({"plane": {"point": [0, -1], "normal": [0, 2]}})";
const char* const sole = R"("sole": {"slave": "block.bottom", "master": "floor", "friction": 0.3})";
const char* const support = R"({"on": "block.left", "move": {"x": [[0, 0], [1, 0.2]]}})";
const char* const load = R"({"on": "block.top", "traction": [0, -5], "history": [[0, 0], [1, 1]]})";
const char* const times = R"({"end": 2, "steps": 10})";
const char* const pull = R"({"reaction": {"on": "block.left", "component": "x"}})";
const char* const tip = R"({"displacement": {"on": "block.right", "component": "y", "take": "max"}})";
const char* const mu = R"("mu": "/contacts/sole/friction")";
const char* const method = R"({"monolithic_al": {"scale": 2}})";
const char* const spring = "[[3, 1], [1, 2]]";

const char* const finite_scene = R"({
  "strain": "finite",
  "bodies": {"block": {"mesh": {"box": {"min": [0, 0], "max": [4, 2], "cells": [4, 2]}},
                       "material": {"neo_hookean": {"E": 1000, "nu": 0.25}}}},
  "obstacles": {"floor": {"plane": {"point": [0, 0], "normal": [0, 1]}}},
  "contacts": {"sole": {"slave": "block.bottom", "master": "floor"}},
  "supports": [{"on": "block.top", "move": {"x": 0, "y": -0.1}}],
  "loads": [{"on": "block.left", "traction": [1, 0]}],
  "time": {"end": 1, "steps": 2},
  "method": {"monolithic_al": {}}
})";

const char* const solid_scene = R"({
  "space": "solid", "strain": "finite",
  "bodies": {"block": {"mesh": {"box": {"min": [0, 0, 0], "max": [4, 2, 2], "cells": [4, 2, 2]}},
                       "element": "H8", "material": {"neo_hookean": {"E": 1000, "nu": 0.25}}}},
  "obstacles": {"floor": {"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}}},
  "contacts": {"sole": {"slave": "block.bottom", "master": "floor", "discretization": "node"}},
  "supports": [{"on": "block.top", "move": {"x": 0, "y": 0, "z": -0.1}}],
  "time": {"end": 1, "steps": 2},
  "method": {"monolithic_al": {}}
})";

/// What solid bodies in space do not know yet, and what is of the plane alone.
std::vector<Broken> broken_solid() {
  const char* s = solid_scene;
  return {
      {"solid_segments", s, R"("discretization": "node")", R"("discretization": @"segment")",
       "/contacts/sole/discretization", R"(needs small strain; allowed at finite strain: "node")"},
      {"solid_element_of_the_plane", s, R"("H8")", R"(@"Q4")", "/bodies/block/element",
       "H8, H8_mean_dilatation, H20, H27, T4 or T10"},
      {"solid_mesh_of_the_plane", s, R"({"box": {"min": [0, 0, 0], "max": [4, 2, 2], "cells": [4, 2, 2]}})",
       R"({@"half_disk": {"center": [0, 0], "radius": 1, "cells": [4, 4]}})", "/bodies/block/mesh/half_disk",
       "allowed: box, half_ball, ball, extruded, point, line, arc, gmsh"},
      {"solid_moment_about_a_point", s, R"("time": {)",
       R"("responses": {"M": {"reaction": @{"on": "block.top", "component": "moment", "about": [0, 0, 0]}}}, "time": {)",
       "/responses/M/reaction", R"("axis" is missing)"},
      {"solid_moment_without_a_direction", s, R"("time": {)",
       R"("responses": {"M": {"reaction": {"on": "block.top", "component": "moment", "about": [0, 0, 0], "axis": @[0, 0, 0]}}}, "time": {)",
       "/responses/M/reaction/axis", "a vector that is not zero"},
      {"solid_axis_of_a_force", s, R"("time": {)",
       R"("responses": {"F": {"reaction": {"on": "block.top", "component": "x", @"axis": [0, 0, 1]}}}, "time": {)",
       "/responses/F/reaction/axis", R"(belongs to the component "moment")"},
      {"grade_towards_both_ends", s, R"("cells": [4, 2, 2])",
       R"("cells": [4, 2, 2], "grade": @{"left": 2, "right": 2})", "/bodies/block/mesh/box/grade",
       "left or right, not both"},
      {"ball_in_the_plane", finite_scene, box, R"(@{"ball": {"center": [0, 0, 1], "radius": 1, "cells": [4, 4]}})",
       "/bodies/block/mesh", "needs the space solid"},
      {"solid_cells_of_the_plane", s, R"([4, 2, 2]}})", R"(@[4, 2]}})", "/bodies/block/mesh/box/cells",
       "an array of 3 whole numbers >= 1"},
      {"half_ball_in_the_plane", finite_scene, box,
       R"(@{"half_ball": {"center": [0, 0, 1], "radius": 1, "cells": [4, 4]}})", "/bodies/block/mesh",
       "needs the space solid"},
      {"extruded_in_the_plane", finite_scene, box,
       R"(@{"extruded": {"mesh": {"box": {"min": [0, 0], "max": [1, 1], "cells": [1, 1]}}, "from": 0, "to": 1,
                        "cells": 1}})",
       "/bodies/block/mesh", "needs the space solid"},
  };
}

/// What finite strain does not know yet, and what does not go with it.
std::vector<Broken> broken_finite() {
  const char* f = finite_scene;
  return {
      {"finite_averaged_plane_stress", f, R"("strain": "finite",
  "bodies": {"block": {)",
       R"("space": "plane_stress", "strain": "finite",
  "bodies": {"block": {"element": @"Q4_mean_dilatation", )",
       "/bodies/block/element", "in plane stress the thickness gives way"},
      {"finite_linear_elastic", f, R"("neo_hookean")", R"(@"linear_elastic")", "/bodies/block/material/linear_elastic",
       "allowed: neo_hookean"},
      {"finite_volumetric", f, R"("nu": 0.25})", R"("nu": 0.25, "volumetric": @"cubic"})",
       "/bodies/block/material/neo_hookean/volumetric", "allowed: quadratic, log"},
      {"finite_pressure_on_metal", R"({
  "space": "plane_stress", "strain": "finite",
  "bodies": {"block": {"mesh": {"box": {"min": [0, 0], "max": [4, 2], "cells": [4, 2]}},
                       "material": {"j2_plastic": {"E": 1000, "nu": 0.25, "yield": 10, "hardening": 20}}}},
  "supports": [{"on": "block.top", "move": {"x": 0, "y": -0.1}}],
  "loads": [{"on": "block.left", "traction": [1, 0]}],
  "time": {"end": 1, "steps": 2},
  "method": {"monolithic_al": {}}
})",
       R"({"on": "block.left", "traction": [1, 0]})", R"({"on": @"block.left", "pressure": 1})", "/loads/0/on",
       "a pressure on what flows is not known"},
      {"finite_condensed", f, R"("time")", R"("linear_solver": {"engine": @"condensed"}, "time")",
       "/linear_solver/engine", "allowed where strains are finite or all bodies flow: auto, sparse"},
  };
}

std::vector<Broken> broken_bodies() {
  const char* b = block_scene;
  return {
      {"unknown_top_key", b, R"("title")", R"(@"titel")", "/titel", R"(did you mean "title"?)"},
      {"schema_number", b, title, R"("$schema": @7)", "/$schema", "must be a text"},
      {"title_number", b, R"("block pushed over a floor")", "@7", "/title", "is 7; must be a text"},
      {"unknown_space", b, R"("plane_strain")", R"(@"plane_strin")", "/space", R"(did you mean "plane_strain"?)"},
      {"left_of_the_axis", b, R"("space": "plane_strain",
  "bodies": {
    "block": {
      "mesh": {"box": {"min": [0, 0])",
       R"("space": "axisymmetric",
  "bodies": {
    "block": {
      "mesh": @{"box": {"min": [-1, 0])",
       "/bodies/block/mesh", "reaches to x = -1"},
      {"ring_inside_out", b, box, R"({"ring": {"center": [0, 0], "inner": 2, "outer": @1, "cells": [2, 8]}})",
       "/bodies/block/mesh/ring/outer", "is 1; must be greater than inner, which is 2"},
      {"unknown_strain", b, R"("space": "plane_strain")", R"("strain": @"large")", "/strain", "allowed: small, finite"},
      {"neo_hookean_at_small_strain", b, elastic, R"(@"neo_hookean": {"E": 1000, "nu": 0.25})",
       "/bodies/block/material/neo_hookean", "at small strain"},
      {"bodies_list", b, R"("element": "Q4")", R"("element": @4)", "/bodies/block/element",
       "must be one of Q4, Q4_mean_dilatation, Q8, T3, T6, H8, H8_mean_dilatation, H20, H27, T4, T10, bar, point"},
      {"bar_in_a_box", b, R"("element": "Q4")", R"("element": @"bar")", "/bodies/block/element",
       "a box has elements Q4, Q4_mean_dilatation, Q8, T3 or T6, not bar"},
      {"area_of_a_box", b, R"("element": "Q4")", R"(@"area": 2)", "/bodies/block/area", "only bars"},
      {"no_thickness", b, R"("element": "Q4")", R"("thickness": @0)", "/bodies/block/thickness", "a number > 0"},
      {"negative_E", b, R"("E": 1000)", R"("E": @-1000)", "/bodies/block/material/linear_elastic/E",
       "is -1000; must be a number > 0"},
      {"nu_too_large", b, R"("nu": 0.25)", R"("nu": @0.5)", "/bodies/block/material/linear_elastic/nu",
       R"(is 0.5; must be a number > -1 and < 0.5; for a body that keeps its volume take 0.499 and "element": "Q4_mean)"},
      {"nu_text", b, R"("nu": 0.25)", R"("nu": @"0.25")", "/bodies/block/material/linear_elastic/nu",
       R"(is "0.25"; must be a number)"},
      {"nu_missing", b, R"({"E": 1000, "nu": 0.25})", R"(@{"E": 1000})", "/bodies/block/material/linear_elastic",
       R"("nu" is missing)"},
      {"plasticity_without_yield", b, elastic, R"("j2_plastic": @{"E": 1000, "nu": 0.25, "hardening": 1})",
       "/bodies/block/material/j2_plastic", R"("yield" is missing)"},
      {"negative_hardening", b, elastic, R"("j2_plastic": {"E": 1000, "nu": 0.25, "yield": 1, "hardening": @-1})",
       "/bodies/block/material/j2_plastic/hardening", "is -1; must be a number >= 0"},
      {"table_without_a_start", b, elastic, R"("j2_plastic": {"E": 1000, "nu": 0.25, "hardening": @[[0.1, 12]]})",
       "/bodies/block/material/j2_plastic/hardening", R"(give a first row [0, stress], or "yield")"},
      {"table_of_nothing", b, elastic, R"("j2_plastic": {"E": 1000, "nu": 0.25, "yield": 10, "hardening": @[]})",
       "/bodies/block/material/j2_plastic/hardening", "or a table [[plastic strain, stress], ...]"},
      {"table_of_triples", b, elastic,
       R"("j2_plastic": {"E": 1000, "nu": 0.25, "yield": 10, "hardening": [@[0, 10, 1]]})",
       "/bodies/block/material/j2_plastic/hardening/0", "a pair [plastic strain, stress]"},
      {"table_that_starts_elsewhere", b, elastic,
       R"("j2_plastic": {"E": 1000, "nu": 0.25, "yield": 10, "hardening": [[0, @11]]})",
       "/bodies/block/material/j2_plastic/hardening/0/1", R"(must be 10, as "yield" is)"},
      {"table_that_turns_back", b, elastic,
       R"("j2_plastic": {"E": 1000, "nu": 0.25, "hardening": [[0, 10], [0.2, 12], [@0.1, 13]]})",
       "/bodies/block/material/j2_plastic/hardening/2/0", "more than 0.2, the plastic strain of the row before"},
      {"softening", b, elastic, R"("j2_plastic": {"E": 1000, "nu": 0.25, "hardening": [[0, 10], [0.2, @9]]})",
       "/bodies/block/material/j2_plastic/hardening/1/1", "at least 10, the stress before it"},
      {"unknown_material", b, R"("linear_elastic")", R"(@"linear_elastc")", "/bodies/block/material/linear_elastc",
       R"(did you mean "linear_elastic"?)"},
      {"spring_in_a_box", b, R"({"linear_elastic": {"E": 1000, "nu": 0.25}})",
       R"({@"grounded_spring": {"stiffness": [[1, 0], [0, 1]]}})", "/bodies/block/material/grounded_spring",
       "does not go with this mesh"},
      {"two_meshes", b, R"({"box": {)", R"({@"point": {"at": [0, 0]}, "box": {)", "/bodies/block/mesh/point",
       "only one is allowed"},
      {"no_mesh", b, box, "@{}", "/bodies/block/mesh", "one of the keys is missing: box"},
      {"sphere", b, box, R"({@"sphere": {}})", "/bodies/block/mesh/sphere",
       "is not available in this version; allowed: box, quad, ring, disk, half_disk"},
      {"ring_without_a_hole", b, box, R"({"ring": {"center": [0, 0], "inner": @0, "outer": 2, "cells": [2, 8]}})",
       "/bodies/block/mesh/ring/inner", "a number > 0"},
      {"ring_of_more_than_a_turn", b, box,
       R"({"ring": {"center": [0, 0], "inner": 1, "outer": 2, "cells": [2, 8], "to_angle": @400}})",
       "/bodies/block/mesh/ring/to_angle", "is 400; to_angle must exceed from_angle, by 360 degrees at most"},
      {"ring_graded_to_the_left", b, box,
       R"({"ring": {"center": [0, 0], "inner": 1, "outer": 2, "cells": [2, 8], "grade": {@"left": 2}}})",
       "/bodies/block/mesh/ring/grade/left", "allowed: inner, outer"},
      {"quad_of_three_corners", b, box, R"({"quad": {"corners": @[[0, 0], [1, 0], [1, 1]], "cells": [1, 1]}})",
       "/bodies/block/mesh/quad/corners", "four corners"},
      {"quad_turned_over", b, box, R"({"quad": {"corners": @[[0, 0], [0, 1], [1, 1], [1, 0]], "cells": [1, 1]}})",
       "/bodies/block/mesh/quad/corners", "counter-clockwise"},
      {"disk_without_cells", b, box, R"({"disk": @{"center": [0, 0], "radius": 1}})", "/bodies/block/mesh/disk",
       "\"cells\" is missing"},
      {"box_turned_over", b, R"("max": [4, 2])", R"("max": [4, @0])", "/bodies/block/mesh/box/max/1",
       "is 0; must be greater than min, which is 0"},
      {"box_in_one_dimension", b, R"("max": [4, 2])", R"("max": @[4])", "/bodies/block/mesh/box/max",
       "must be an array of 2 numbers"},
      {"no_cells", b, R"("cells": [4, 2])", R"("cells": [@0, 2])", "/bodies/block/mesh/box/cells/0",
       "must be a whole number from 1"},
      {"half_a_cell", b, R"("cells": [4, 2])", R"("cells": [4, @2.5])", "/bodies/block/mesh/box/cells/1",
       "is 2.5; must be a whole number"},
      {"too_many_cells", b, R"("cells": [4, 2])", R"("cells": @[1000000, 1000000])", "/bodies/block/mesh/box/cells",
       "fewer cells"},
      {"grade_of_no_side", b, R"("cells": [4, 2])", R"("cells": [4, 2], "grade": {@"botom": 3})",
       "/bodies/block/mesh/box/grade/botom", R"(did you mean "bottom"?)"},
      // the topmost cells are thinner than the rounding of their height
      {"grade_that_flattens", b, R"("cells": [4, 2])", R"("cells": [4, 2], "grade": @{"top": 1e17})",
       "/bodies/block/mesh/box/grade", "with it element 5 is inverted or flat"},
      {"grade_of_zero", b, R"("cells": [4, 2])", R"("cells": [4, 2], "grade": {"bottom": @0})",
       "/bodies/block/mesh/box/grade/bottom", "must be a number > 0"},
      {"folded_half_disk", b, box, R"({"half_disk": {"center": [0, 0], "radius": 1, "cells": @[2, 9]}})",
       "/bodies/block/mesh/half_disk/cells", "is [2,9]; cells of a half disk must not differ"},
      {"half_disk_facing_left", b, box,
       R"({"half_disk": {"center": [0, 0], "radius": 1, "cells": [4, 4], "facing": @"left"}})",
       "/bodies/block/mesh/half_disk/facing", "allowed: down, up"},
      {"body_of_a_box", b, R"({"box": {)", R"({@"body": "a", "box": {)", "/bodies/block/mesh/body", "belongs to gmsh"},
      {"no_mesh_file", b, box, R"({"gmsh": @"no_such.msh", "body": "lower"})", "/bodies/block/mesh/gmsh",
       "no_such.msh cannot be read"},
      {"no_mesh_body", b, box, R"(@{"gmsh": "../../studies/meshes/half_disk_coarse.msh"})", "/bodies/block/mesh",
       R"("body" is missing)"},
      {"dotted_name", b, R"("block": {)",
       R"(@"blo.ck": {"mesh": {"point": {"at": [0, 0]}},
           "material": {"grounded_spring": {"stiffness": [[1, 0], [0, 1]]}}}, "block": {)",
       "/bodies/blo.ck", "no space, dot or &"},
  };
}

std::vector<Broken> broken_contacts() {
  const char* b = block_scene;
  return {
      {"normal_of_zero", b, R"("normal": [0, 2])", R"("normal": @[0, 0])", "/obstacles/floor/plane/normal",
       "a vector that is not zero"},
      {"normal_in_space", b, R"("normal": [0, 2])", R"("normal": @[0, 0, 1])", "/obstacles/floor/plane/normal",
       "must be an array of 2 numbers"},
      {"sphere", b, floor_plane, R"({@"sphere": {}})", "/obstacles/floor/sphere",
       "needs the space solid; allowed in a plane space: plane, circle, polyline"},
      {"radius_of_zero", b, floor_plane, R"({"circle": {"center": [0, 0], "radius": @0}})",
       "/obstacles/floor/circle/radius", "must be a number > 0"},
      {"inside_of_one", b, floor_plane, R"({"circle": {"center": [0, 0], "radius": 1, "inside": @1}})",
       "/obstacles/floor/circle/inside", "must be true or false"},
      {"obstacle_rotating_about_nothing", b, floor_plane,
       R"({"rotate": @{"angle": 1}, "plane": {"point": [0, -1], "normal": [0, 2]}})", "/obstacles/floor/rotate",
       R"("center" is missing)"},
      {"polyline_of_one_point", b, floor_plane, R"({"polyline": {"points": @[[0, 0]]}})",
       "/obstacles/floor/polyline/points", "two points [x, y] or more"},
      {"polyline_that_stops", b, floor_plane, R"({"polyline": {"points": [[0, 0], @[0, 0], [1, 0]]}})",
       "/obstacles/floor/polyline/points/1", "must differ"},
      {"move_along_z", b, floor_plane, R"({"move": {@"z": 1}, "plane": {"point": [0, -1], "normal": [0, 2]}})",
       "/obstacles/floor/move/z", "allowed: x, y"},
      {"obstacle_named_as_a_body", b, R"("obstacles": {)",
       R"("obstacles": {@"block": {"plane": {"point": [0, -1], "normal": [0, 2]}}, )", "/obstacles/block",
       "a body has the name"},
      {"negative_friction", b, R"("friction": 0.3)", R"("friction": @-0.3)", "/contacts/sole/friction",
       "is -0.3; must be a number >= 0"},
      {"friction_of_no_law", b, R"("friction": 0.3)", R"("friction": @"rough")", "/contacts/sole/friction",
       R"("coulomb": mu)"},
      {"two_laws_of_friction", b, R"("friction": 0.3)", R"("friction": {"tresca": 5, @"coulomb": 0.3})",
       "/contacts/sole/friction/coulomb", R"(unknown key "coulomb"; allowed: tresca)"},
      {"limit_without_friction", b, R"("friction": 0.3)", R"("friction": @{"limit": 5})", "/contacts/sole/friction",
       R"("coulomb" is missing)"},
      {"negative_limit", b, R"("friction": 0.3)", R"("friction": {"coulomb": 0.3, "limit": @-5})",
       "/contacts/sole/friction/limit", ">= 0"},
      {"unknown_key", b, R"("friction": 0.3)", R"("friction": 0.3, @"ofset": 0)", "/contacts/sole/ofset",
       R"(did you mean "offset"?)"},
      {"slave_is_an_obstacle", b, R"("slave": "block.bottom")", R"("slave": @"floor")", "/contacts/sole/slave",
       "an obstacle is rigid"},
      {"unknown_slave_body", b, R"("slave": "block.bottom")", R"("slave": @"blok.bottom")", "/contacts/sole/slave",
       R"(there is no body "blok"; did you mean "block"?)"},
      {"unknown_slave_side", b, R"("slave": "block.bottom")", R"("slave": @"block.botom")", "/contacts/sole/slave",
       R"(did you mean "bottom"?)"},
      {"slave_without_a_side", b, R"("slave": "block.bottom")", R"("slave": @"block")", "/contacts/sole/slave",
       "a body; must be BODY.SIDE"},
      {"slave_without_a_body", b, R"("slave": "block.bottom")", R"("slave": @"bottom")", "/contacts/sole/slave",
       R"("bottom" is not BODY.SIDE; did you mean "block.bottom"?)"},
      {"empty_slave", b, R"("slave": "block.bottom")", R"("slave": @"block.bottom & block.top")",
       "/contacts/sole/slave", "no node belongs"},
      {"unknown_master", b, R"("master": "floor")", R"("master": @"flor")", "/contacts/sole/master",
       R"(did you mean "floor"?)"},
      {"master_without_facets", b, R"("master": "floor")", R"("master": @"block.top & block.left")",
       "/contacts/sole/master", "a master needs facets"},
      {"contact_with_part_of_itself", b, R"("master": "floor")", R"("master": @"block.boundary - block.top")",
       "/contacts/sole/master", "shares nodes with the slave"},
      {"segments_of_one_side", b, R"("master": "floor")", R"("master": "block.bottom", "discretization": @"segment")",
       "/contacts/sole/discretization", "at finite strain alone"},
      {"missing_master", b, R"({"slave": "block.bottom", "master": "floor", "friction": 0.3})",
       R"(@{"slave": "block.bottom", "friction": 0.3})", "/contacts/sole", R"("master" is missing)"},
      {"smooth_plane", b, R"("friction": 0.3)", R"("friction": 0.3, "surface": @"smooth")", "/contacts/sole/surface",
       R"(the master "floor" has none; allowed: "faceted")"},
      {"surface_of_no_kind", b, R"("master": "floor", "friction": 0.3)",
       R"("master": "block.top", "surface": @"rough")", "/contacts/sole/surface", R"(must be "faceted", "smooth")"},
      {"unknown_smoothing", b, R"("master": "floor", "friction": 0.3)",
       R"("master": "block.top", "surface": {"smooth": @"nurbs"})", "/contacts/sole/surface/smooth",
       "allowed: catmull_rom, b_spline"},
      {"corner_of_no_angle", b, R"("master": "floor", "friction": 0.3)",
       R"("master": "block.top", "surface": {"smooth": "b_spline", "corner": @0})", "/contacts/sole/surface/corner",
       "an angle > 0 and <= 180"},
      {"smooth_segments", b, R"("master": "floor", "friction": 0.3)",
       R"("master": "block.top", "surface": "smooth", "discretization": @"segment")", "/contacts/sole/discretization",
       R"(with a smooth surface: "node")"},
      {"mortar_contact", b, R"("friction": 0.3)", R"("friction": 0.3, "discretization": @"mortar")",
       "/contacts/sole/discretization", "allowed: node, segment"},
      {"self_of_a_pair", b, R"("friction": 0.3)", R"("friction": 0.3, @"self": false)", "/contacts/sole/self",
       R"(belongs to "between")"},
      {"pairs_of_one_body", b, sole, std::string(R"("all": {"between": @"all"}, )") + sole, "/contacts/all/between",
       "less than two solid bodies"},
      {"pairs_of_nothing", b, sole, std::string(R"("all": {"between": @["block"]}, )") + sole, "/contacts/all/between",
       "an array of two bodies or more: block"},
      {"pairs_of_an_unknown_body", b, sole, std::string(R"("all": {"between": ["block", @"blok"]}, )") + sole,
       "/contacts/all/between/1", R"(did you mean "block"?)"},
      {"body_against_itself", b, sole, std::string(R"("all": {"between": ["block", @"block"]}, )") + sole,
       "/contacts/all/between/1", R"(touches itself where "self" is true)"},
      {"points_against_themselves", b, sole, std::string(R"("all": {"between": @[], "self": true}, )") + sole,
       "/contacts/all/between", R"(must be "all" or an array of bodies: block)"},
  };
}

std::vector<Broken> broken_loading() {
  const char* b = block_scene;
  return {
      {"supports_object", b, std::string("[") + support + "]", R"(@{})", "/supports", "must be an array of supports"},
      {"support_without_move", b, support, R"(@{"on": "block.left"})", "/supports/0",
       "one of the keys is missing: move, rotate, along"},
      {"support_without_axis", b, R"({"x": [[0, 0], [1, 0.2]]})", "@{}", "/supports/0/move", "must name an axis"},
      {"along_beside_move", b, support, R"({"on": "block.left", @"move": {"x": 0}, "along": [1, 1], "value": 0})",
       "/supports/0/move", "a support is either inclined or not"},
      {"along_nothing", b, support, R"({"on": "block.left", "along": @[0, 0], "value": 0})", "/supports/0/along",
       "a vector that is not zero"},
      {"along_in_space", b, support, R"({"on": "block.left", "along": @[1, 0, 0], "value": 0})", "/supports/0/along",
       "must be an array of 2 numbers"},
      {"along_without_value", b, support, R"(@{"on": "block.left", "along": [1, 1]})", "/supports/0",
       R"("value" is missing)"},
      {"value_without_along", b, support, R"({"on": "block.left", @"value": 0})", "/supports/0/value",
       R"(belongs to "along")"},
      {"rotation_without_angle", b, support, R"({"on": "block.left", "rotate": @{"center": [0, 0]}})",
       "/supports/0/rotate", R"("angle" is missing)"},
      {"axis_in_the_plane", b, support,
       R"({"on": "block.left", "rotate": {"center": [0, 0], @"axis": [0, 0, 1], "angle": 1}})",
       "/supports/0/rotate/axis", "needs the space solid"},
      {"repeated_point", b, "[[0, 0], [1, 0.2]]", R"(@{"table": [[0, 0]], "repeat": 3})", "/supports/0/move/x",
       "two points at least"},
      {"repeated_jump", b, "[[0, 0], [1, 0.2]]", R"(@{"table": [[0, 0], [1, 0.2]], "repeat": 3})", "/supports/0/move/x",
       "jumps from 0.2 at its end to 0"},
      {"repeated_never", b, "[[0, 0], [1, 0.2]]", R"({"table": [[0, 0], [1, 0]], "repeat": @0})",
       "/supports/0/move/x/repeat", "must be a whole number from 1"},
      {"repeated_nothing", b, "[[0, 0], [1, 0.2]]", R"(@{"repeat": 2})", "/supports/0/move/x", R"("table" is missing)"},
      {"table_of_numbers", b, "[[0, 0], [1, 0.2]]", "[@0, [1, 0.2]]", "/supports/0/move/x/0",
       "must be a pair [t, value]"},
      {"table_empty", b, "[[0, 0], [1, 0.2]]", "@[]", "/supports/0/move/x", "must be a number, a table"},
      {"table_back_in_time", b, "[[0, 0], [1, 0.2]]", "[[0, 0], [@0, 0.2]]", "/supports/0/move/x/1/0",
       "times must increase, and the one before is 0"},
      {"two_supports_of_one_node", b, support, std::string(support) + R"(, {"on": "block.bottom", "move": {"x": @0}})",
       "/supports/1/move/x", R"(differs from /supports/0/move/x, which is on "block.left")"},
      {"two_supports_of_one_side", b, support, std::string(support) + R"(, {"on": "block.left", "move": {"x": @0.3}})",
       "/supports/1/move/x", "holds a node"},
      {"load_without_a_kind", b, load, R"(@{"on": "block.top"})", "/loads/0",
       "one of the keys is missing: traction, pressure, force, body_force"},
      {"load_of_two_kinds", b, load, R"({"on": "block.top", "force": [0, 1], @"traction": [0, 1]})",
       "/loads/0/traction", "only one is allowed"},
      {"load_nowhere", b, load, R"(@{"traction": [0, -5]})", "/loads/0", R"("on" is missing)"},
      {"pressure_of_two_numbers", b, load, R"({"on": "block.top", "pressure": @[0, 5]})", "/loads/0/pressure",
       "must be a number"},
      {"pressure_as_a_table", b, load, R"({"on": "block.top", "pressure": @[[0, 0], [1, 5]]})", "/loads/0/pressure",
       R"(must be a number, which "history" scales in time)"},
      {"force_as_a_table", b, load, R"({"on": "block.top", "force": @{"table": [[0, 0], [1, 5]]}})", "/loads/0/force",
       R"(must be an array of 2 numbers, which "history" scales in time)"},
      {"component_as_a_table", b, load, R"({"on": "block.top", "traction": @[0, [[0, 0], [1, 5]]]})",
       "/loads/0/traction", R"(which "history" scales in time)"},
      {"pressure_on_a_corner", b, load, R"({"on": @"block.top & block.left", "pressure": 5})", "/loads/0/on",
       "use force instead of pressure"},
      {"body_force_on_a_side", b, load, R"({"on": @"block.top", "body_force": [0, -1]})", "/loads/0/on",
       "a body force acts on a body: block"},
      {"body_force_nowhere", b, load, R"(@{"body_force": [0, -1]})", "/loads/0", "the body that the load acts on"},
      {"traction_on_a_corner", b, R"("block.top")", R"(@"block.top & block.left")", "/loads/0/on", "use force instead"},
      {"traction_of_one_number", b, R"("traction": [0, -5])", R"("traction": @5)", "/loads/0/traction",
       "must be an array of 2 numbers"},
      {"history_of_text", b, R"("history": [[0, 0], [1, 1]])", R"("history": @"ramp")", "/loads/0/history",
       "must be a number, a table"},
      {"no_end", b, times, R"(@{"steps": 10})", "/time", R"("end" is missing)"},
      {"end_of_zero", b, times, R"({"end": @0, "steps": 10})", "/time/end", "must be a number > 0"},
      {"no_steps", b, times, R"({"end": 1, "steps": @0})", "/time/steps", "must be a whole number from 1"},
      {"legs_back_in_time", b, times, R"({"legs": [[1, 2], [@1, 2]]})", "/time/legs/1/0",
       "later than the end of the leg before, 1"},
      {"legs_and_end", b, times, R"({"legs": [[1, 2]], @"end": 2})", "/time/end", "unknown key"},
      {"path_beside_a_motion", b, times, R"({"end": 1, "steps": 1, "control": @"arc_length"})", "/time/control",
       "/supports/0 changes in time: along a path only the load may"},
      {"path_of_legs", b, times, R"({"legs": [[1, 2]], @"control": "arc_length"})", "/time/control",
       R"(stands beside "legs")"},
      {"path_of_no_load", b, times, R"({"end": 1, "steps": 1, "control": {"arc_length": {"load": @1}}})",
       "/time/control/arc_length/load", "there are 1"},
      {"path_without_length", b, times, R"({"end": 1, "steps": 1, "control": {"arc_length": {"length": @0}}})",
       "/time/control/arc_length/length", "must be a number > 0"},
      {"path_of_another_kind", b, times, R"({"end": 1, "steps": 1, "control": @"arclength"})", "/time/control",
       "allowed: arc_length"},
  };
}

std::vector<Broken> broken_responses() {
  const char* b = block_scene;
  return {
      {"plastic_strain_of_an_elastic_body", b, pull, R"({"plastic_strain": {"on": @"block"}})",
       "/responses/pull/plastic_strain/on", "no body flows; give one the material j2_plastic"},
      {"plastic_strain_of_nothing", b, pull, R"({"plastic_strain": @{"take": "max"}})",
       "/responses/pull/plastic_strain", R"("on" is missing)"},
      {"unknown_response", b, pull, R"({@"reacton": {}})", "/responses/pull/reacton", R"(did you mean "reaction"?)"},
      {"reaction_of_nothing", b, pull, R"({"reaction": @{"component": "x"}})", "/responses/pull/reaction",
       R"("on" is missing)"},
      {"reaction_without_component", b, pull, R"({"reaction": @{"on": "block.left"}})", "/responses/pull/reaction",
       R"("component" is missing)"},
      {"component_z", b, pull, R"({"reaction": {"on": "block.left", "component": @"z"}})",
       "/responses/pull/reaction/component", "allowed: x, y"},
      {"moment_about_nothing", b, pull, R"({"reaction": @{"on": "block.left", "component": "moment"}})",
       "/responses/pull/reaction", R"("about" is missing)"},
      {"force_about_a_point", b, pull, R"({"reaction": {"on": "block.left", "component": "x", @"about": [0, 0]}})",
       "/responses/pull/reaction/about", R"(belongs to the component "moment")"},
      {"moment_about_an_axis", b, pull,
       R"({"reaction": {"on": "block.left", "component": "moment", "about": [0, 0], @"axis": [0, 0, 1]}})",
       "/responses/pull/reaction/axis", "in a plane space a moment is about a point"},
      {"unknown_contact", b, R"({"contact": "sole", "component": "normal"})",
       R"({"contact": @"soul", "component": "normal"})", "/responses/press/contact_force/contact",
       R"(did you mean "sole"?)"},
      {"side_of_a_contact_force", b, R"({"contact": "sole", "component": "normal"})",
       R"({"contact": "sole", "component": "normal", @"on": "block.left"})", "/responses/press/contact_force/on",
       "unknown key"},
      {"displacement_nowhere", b, tip, R"({"displacement": @{"component": "y"}})", "/responses/tip/displacement",
       R"("on", a side BODY.SIDE, or "at", a point)"},
      {"at_on_a_side", b, tip, R"({"displacement": {"on": @"block.top", "at": [0, 0], "component": "y"}})",
       "/responses/tip/displacement/on", "must be a body beside"},
      {"take_at_a_point", b, tip, R"({"displacement": {"at": [0, 0], "component": "y", @"take": "max"}})",
       "/responses/tip/displacement/take", R"(has no meaning beside "at")"},
      {"at_in_space", b, tip, R"({"displacement": {"at": @[0, 0, 0], "component": "y"}})",
       "/responses/tip/displacement/at", "must be an array of 2 numbers"},
      {"take_the_median", b, R"("take": "max")", R"("take": @"median")", "/responses/tip/displacement/take",
       "allowed: mean, max, min"},
      {"slip_without_friction", lumped_scene, R"("output": {"fields": "all"})",
       R"("responses": {"s": {"slip": {"contact": @"wrap"}}})", "/responses/s/slip/contact",
       "whose slip is not followed"},
  };
}

std::vector<Broken> broken_parameters() {
  const char* b = block_scene;
  auto pointing = [](const std::string& pointer) { return "@\"mu\": \"" + pointer + "\""; };
  return {
      {"pointer_to_nothing", b, mu, pointing("/contacts/sole/frictoin"), "/parameters/mu",
       R"(has no "frictoin"; did you mean "friction"?)"},
      {"pointer_without_slash", b, mu, pointing("contacts"), "/parameters/mu", "must begin with /"},
      {"pointer_to_a_count", b, mu, pointing("/bodies/block/mesh/box/cells/0"), "/parameters/mu", "is a count"},
      {"pointer_to_steps", b, mu, pointing("/time/steps"), "/parameters/mu", "is a count"},
      {"pointer_to_an_end", b, mu, pointing("/time/end"), "/parameters/mu", "is a time"},
      {"pointer_to_a_time", b, mu, pointing("/supports/0/move/x/1/0"), "/parameters/mu",
       "is a time; times are no parameters"},
      {"pointer_to_text", b, mu, pointing("/contacts/sole/slave"), "/parameters/mu", "must be a number"},
      {"pointer_to_an_array", b, mu, pointing("/loads/0/traction"), "/parameters/mu", "such as /loads/0/traction/0"},
      {"pointer_to_an_object", b, mu, pointing("/contacts/sole"), "/parameters/mu", "is an object"},
      {"pointer_to_a_tolerance", b, R"("mu": "/contacts/sole/friction"},
  "method": {"monolithic_al": {"scale": 2}})",
       R"(@"tol": "/method/monolithic_al/newton/tolerance"},
  "method": {"monolithic_al": {"newton": {"tolerance": 1e-8}}})",
       "/parameters/tol", "is a setting of the method"},
      {"pointer_to_auto", b, R"("mu": "/contacts/sole/friction"},
  "method": {"monolithic_al": {"scale": 2}})",
       R"(@"s": "/method/monolithic_al/scale"},
  "method": {"monolithic_al": {"scale": "auto"}})",
       "/parameters/s", "is \"auto\"; a parameter must be a number"},
      {"pointer_to_another_method", b, mu, pointing("/method/penalty/stiffness"), "/parameters/mu",
       "is an option of penalty, and the scene's method is monolithic_al"},
      {"parameter_of_three", b, mu, R"("mu": @3)", "/parameters/mu", "is 3; must be a JSON pointer"},
      {"weight_of_zero", b, mu, R"("mu": {"/contacts/sole/friction": @0})", "/parameters/mu/~1contacts~1sole~1friction",
       "must be a number other than 0"},
      {"shape_key", b, mu, R"("mu": {"shape": {"side": "block.top", "direction": [0, 1], @"fix": "block.left"}})",
       "/parameters/mu/shape/fix", R"(did you mean "fixed"?)"},
      {"shape_and_pointer", b, mu,
       R"("mu": {"shape": {"side": "block.top", "direction": [0, 1]}, @"/contacts/sole/friction": 1})",
       "/parameters/mu/~1contacts~1sole~1friction", "unknown key"},
      {"shape_side", b, mu, R"("mu": {"shape": {"side": @"block.tip", "direction": [0, 1]}})",
       "/parameters/mu/shape/side", R"(did you mean "top"?)"},
      {"shape_fixed_to_itself", b, mu,
       R"("mu": {"shape": {"side": "block.top", "direction": [0, 1], "fixed": @"block.top"}})",
       "/parameters/mu/shape/fixed", "holds all nodes of the side that is to move"},
      {"shape_direction", b, mu, R"("mu": {"shape": {"side": "block.top", "direction": @[0, 0]}})",
       "/parameters/mu/shape/direction", "not all zero"},
      {"shape_dimension", b, mu, R"("mu": {"shape": {"side": "block.top", "direction": @[0, 1, 0]}})",
       "/parameters/mu/shape/direction", "a direction of 2 numbers"},
      {"shape_each", b, mu, R"("mu": {"shape": {"side": "block.top", "direction": [0, 1], "each": @"facet"}})",
       "/parameters/mu/shape/each", "allowed: node"},
      {"shape_missing", b, mu, R"("mu": {"shape": @{"side": "block.top"}})", "/parameters/mu/shape",
       R"(the key "direction" is missing)"},
      {"half_of_a_symmetric_pair", lumped_scene, R"("output": {"fields": "all"})",
       R"("parameters": {"k": @"/bodies/mass/material/grounded_spring/stiffness/0/1"})", "/parameters/k",
       "must have the weight"},
  };
}

std::vector<Broken> broken_methods() {
  const char* b = block_scene;
  return {
      {"unknown_method", b, R"("monolithic_al")", R"(@"monolitic_al")", "/method/monolitic_al",
       R"(did you mean "monolithic_al"?)"},
      {"two_methods", b, method, R"({"monolithic_al": {}, @"penalty": {}})", "/method/penalty", "only one is allowed"},
      {"option_of_another", b, R"("scale": 2)", R"(@"max_augmentations": 2)", "/method/monolithic_al/max_augmentations",
       "is an option of uzawa_al, not of monolithic_al"},
      {"option_of_newton", b, R"("scale": 2)", R"(@"line_search": true)", "/method/monolithic_al/line_search",
       R"(belongs inside "newton")"},
      {"unknown_option", b, R"("scale": 2)", R"(@"scael": 2)", "/method/monolithic_al/scael",
       R"(did you mean "scale"?)"},
      {"scale_of_zero", b, R"("scale": 2)", R"("scale": @0)", "/method/monolithic_al/scale", "must be a number > 0"},
      {"scale_text", b, R"("scale": 2)", R"("scale": @"big")", "/method/monolithic_al/scale",
       R"(must be "auto", a number > 0 or {"absolute")"},
      {"scale_absolute_text", b, R"("scale": 2)", R"("scale": {"absolute": @-2})",
       "/method/monolithic_al/scale/absolute", "must be a number > 0"},
      {"unknown_cone", b, R"("scale": 2)", R"("cone": @"frozen")", "/method/monolithic_al/cone",
       "allowed: augmented, multiplier"},
      {"acceleration", b, method, R"({"uzawa_al": {"acceleration": @"atken"}})", "/method/uzawa_al/acceleration",
       R"(did you mean "aitken"? allowed: none, aitken, anderson)"},
      {"truncated_and_accelerated", b, method,
       R"({"uzawa_al": {"acceleration": "anderson", "sensitivity": @"truncated"}})", "/method/uzawa_al/sensitivity",
       "the weights of an acceleration are not differentiated; allowed with it: iterated, oversized, preconditioned"},
      {"oversize_of_iterated", b, method, R"({"uzawa_al": {"sensitivity": "iterated", @"oversize": 50}})",
       "/method/uzawa_al/oversize", R"(belongs to the sensitivity "oversized" or "preconditioned")"},
      {"frozen_and_oversized", b, method, R"({"uzawa_al": {"sensitivity": @"oversized", "cone": "frozen"}})",
       "/method/uzawa_al/sensitivity", "leaves the error of a frozen cone as it is"},
      {"frozen_and_preconditioned", b, method, R"({"uzawa_al": {"sensitivity": @"preconditioned", "cone": "frozen"}})",
       "/method/uzawa_al/sensitivity", "allowed with it: iterated, truncated"},
      {"oversize_of_one", b, method, R"({"uzawa_al": {"oversize": @1}})", "/method/uzawa_al/oversize",
       "must be a number > 1"},
      {"oversize_text", b, method, R"({"uzawa_al": {"oversize": @"large"}})", "/method/uzawa_al/oversize",
       R"(must be "auto" or a number > 1)"},
      {"tolerance_of_one", b, method, R"({"uzawa_al": {"tolerance": @1}})", "/method/uzawa_al/tolerance",
       "must be a number > 0 and < 1"},
      {"newton_of_none", b, R"("scale": 2)", R"("newton": {"max_iterations": @0})",
       "/method/monolithic_al/newton/max_iterations", "must be a whole number from 1"},
      {"newton_unknown", b, R"("scale": 2)", R"("newton": {@"tolerence": 0.1})",
       "/method/monolithic_al/newton/tolerence", R"(did you mean "tolerance"?)"},
      {"method_number", b, method, "@1", "/method", "must be an object with one of the keys penalty"},
      {"engine", b, title, R"("linear_solver": {"engine": @"dense"})", "/linear_solver/engine",
       "allowed: auto, sparse, condensed"},
      {"backend", b, title, R"("linear_solver": {"backend": @"pardiso"})", "/linear_solver/backend", "allowed: auto"},
      {"fields", b, title, R"("output": {"fields": @"first"})", "/output/fields", R"(must be "last", "all" or)"},
      {"mode", b, title, R"("sensitivity": {"mode": @"adjiont"})", "/sensitivity/mode", R"(did you mean "adjoint"?)"},
      {"memory", b, title, R"("sensitivity": {@"memory": 100})", "/sensitivity/memory",
       R"(belongs to "mode": "adjoint")"},
      {"no_memory", b, title,
       R"("objectives": {"J": {"of": "pull", "sum": true}}, "sensitivity": {"mode": "adjoint", "memory": @0})",
       "/sensitivity/memory", "must be a number > 0"},
      {"adjoint", b, title, R"("sensitivity": {"mode": @"adjoint"})", "/sensitivity/mode",
       R"(differentiates the objectives, and the scene has none; add "objectives")"},
      {"objective_array", b, title, R"("objectives": @[])", "/objectives", "must be an object, objectives by name"},
      {"adjoint_without_parameters", b, R"("parameters": {"mu": "/contacts/sole/friction"})",
       R"("objectives": {"J": {"of": "pull", "sum": true}}, "sensitivity": @{"mode": "adjoint"})", "/sensitivity",
       "the scene has none; add \"parameters\""},
      {"objective_named_as_a_response", b, title, R"("objectives": {@"pull": {"of": "pull", "sum": true}})",
       "/objectives/pull", "a response has the name"},
      {"objective_key", b, title, R"("objectives": {"J": {"of": "pull", "sum": true, @"targett": 1}})",
       "/objectives/J/targett", R"(did you mean "target"?)"},
      {"objective_of_nothing", b, title, R"("objectives": {"J": @{"sum": true}})", "/objectives/J",
       R"(the key "of" is missing)"},
      {"objective_of", b, title, R"("objectives": {"J": {"of": @"pul", "sum": true}})", "/objectives/J/of",
       R"(there is no such response; did you mean "pull"?)"},
      {"objective_when", b, title, R"("objectives": {"J": @{"of": "pull"}})", "/objectives/J",
       R"(one of the keys is missing: "sum": true, or "at": a time)"},
      {"objective_twice", b, title, R"("objectives": {"J": {"of": "pull", "sum": true, @"at": 1}})", "/objectives/J/at",
       "one of the two"},
      {"objective_sum", b, title, R"("objectives": {"J": {"of": "pull", "sum": @false}})", "/objectives/J/sum",
       "is false; must be true"},
      {"objective_late", b, title, R"("objectives": {"J": {"of": "pull", "at": @2.5}})", "/objectives/J/at",
       "after the end of the run at 2"},
      {"objective_target", b, title, R"("objectives": {"J": {"of": "pull", "sum": true, "target": @"high"}})",
       "/objectives/J/target", R"(is "high"; must be)"},
  };
}

std::vector<Broken> broken_lumped() {
  const char* l = lumped_scene;
  return {
      {"unsymmetric_spring", l, spring, "[[3, 1], [@2, 2]]", "/bodies/mass/material/grounded_spring/stiffness/1/0",
       "is 2; must be 1, so that the stiffness is symmetric"},
      {"indefinite_spring", l, spring, "@[[1, 2], [2, 1]]", "/bodies/mass/material/grounded_spring/stiffness",
       "must be positive definite"},
      {"large_spring", l, spring, "@[[3, 1, 0], [1, 2, 0], [0, 0, 1]]",
       "/bodies/mass/material/grounded_spring/stiffness", "must be a 2 x 2 matrix"},
      {"ragged_spring", l, spring, "[[3, 1], @[1]]", "/bodies/mass/material/grounded_spring/stiffness/1",
       "must be an array of 2 numbers"},
      {"point_in_space", l, R"("at": [0, 0])", R"("at": @[0, 0, 0])", "/bodies/mass/mesh/point/at",
       "must be an array of 2 numbers"},
      {"area_of_zero", l, R"("area": 0.5)", R"("area": @0)", "/bodies/belt/area", "must be a number > 0"},
      {"arc_of_a_full_turn", l,
       R"({"arc": {"center": [0, 0], "radius": 1, "from_angle": 0, "to_angle": 90, "cells": 4}})",
       R"({"arc": {"center": [0, 0], "radius": 1, "from_angle": @0, "to_angle": 360, "cells": 4}})",
       "/bodies/belt/mesh/arc/from_angle", "less than 360 degrees"},
      {"line_of_no_length", l, R"({"line": {"from": [2, 0], "to": [3, 0], "cells": 3}})",
       R"({"line": {"from": @[2, 0], "to": [2, 0], "cells": 3}})", "/bodies/rod/mesh/line/from", "the same point"},
      // thirty bars within two roundings of their coordinates
      {"line_lost_to_rounding", l, R"({"line": {"from": [2, 0], "to": [3, 0], "cells": 3}})",
       R"(@{"line": {"from": [1e16, 0], "to": [10000000000000004, 0], "cells": 30}})", "/bodies/rod/mesh",
       "element 1 is inverted or flat; its corners are (1e+16, 0) (1e+16, 0)"},
      {"slave_is_an_anchor", l, R"("belt.interior")", R"(@"mass.anchor")", "/contacts/wrap/slave", "touches nothing"},
      {"load_on_an_anchor", l, R"("mass.node")", R"(@"mass.anchor")", "/loads/0/on", "does nothing"},
      {"circle_in_space",
       R"({"space": "solid", "time": {"end": 1, "steps": 1}, "method": {"penalty": {}},
           "bodies": {"a": {"mesh": {"point": {"at": [0, 0, 0]}},
           "material": {"grounded_spring": {"stiffness": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}}}},
           "obstacles": {"o": {"plane": 0}}})",
       R"("plane": 0)", R"(@"circle": {"center": [0, 0], "radius": 1})", "/obstacles/o/circle", "needs a plane space"},
  };
}

std::string name_of_case(const testing::TestParamInfo<Broken>& info) { return info.param.name; }

INSTANTIATE_TEST_SUITE_P(Bodies, BrokenScene, testing::ValuesIn(broken_bodies()), name_of_case);
INSTANTIATE_TEST_SUITE_P(Finite, BrokenScene, testing::ValuesIn(broken_finite()), name_of_case);
INSTANTIATE_TEST_SUITE_P(Solid, BrokenScene, testing::ValuesIn(broken_solid()), name_of_case);
INSTANTIATE_TEST_SUITE_P(Contacts, BrokenScene, testing::ValuesIn(broken_contacts()), name_of_case);
INSTANTIATE_TEST_SUITE_P(Loading, BrokenScene, testing::ValuesIn(broken_loading()), name_of_case);
INSTANTIATE_TEST_SUITE_P(Responses, BrokenScene, testing::ValuesIn(broken_responses()), name_of_case);
INSTANTIATE_TEST_SUITE_P(Parameters, BrokenScene, testing::ValuesIn(broken_parameters()), name_of_case);
INSTANTIATE_TEST_SUITE_P(Methods, BrokenScene, testing::ValuesIn(broken_methods()), name_of_case);
INSTANTIATE_TEST_SUITE_P(Lumped, BrokenScene, testing::ValuesIn(broken_lumped()), name_of_case);

TEST(SceneFaults, ReportsFaultsOfAMeshFileWithTheirOwnPlace) {
  const auto path = std::filesystem::path(testing::TempDir()) / "broken.msh";
  std::ofstream(path) << "$MeshFormat\n9.9 0 8\n$EndMeshFormat\n";
  const auto text = edited(block_scene, box, "{\"gmsh\": \"" + path.string() + "\", \"body\": \"a\"}");
  Diagnostics diagnostics;
  EXPECT_FALSE(read_text(text, diagnostics).has_value());
  ASSERT_EQ(diagnostics.error_count(), 1u) << diagnostics.text();
  EXPECT_THAT(diagnostics.text(), testing::StartsWith(path.string() + ":2:1: "));
  std::filesystem::remove(path);
}

TEST(SceneFaults, RefusesAMeshFileOfTheOtherSpace) {
  const char* const block = R"({"box": {"min": [0, 0, 0], "max": [4, 2, 2], "cells": [4, 2, 2]}})";
  const std::string disk = R"({"gmsh": "../../studies/meshes/half_disk_coarse.msh", "body": "disk"})",
                    ball = R"({"gmsh": "../support/meshes/solids_22.msh", "body": "ball"})";
  for (const auto& [text, part] :
       {std::pair{edited(solid_scene, block, disk), "half_disk_coarse.msh:1:1: no element is"},
        {edited(finite_scene, box, ball), R"("space": "solid" takes this mesh)"}}) {
    Diagnostics diagnostics;
    EXPECT_FALSE(read_text(text, diagnostics).has_value());
    ASSERT_EQ(diagnostics.error_count(), 1u) << diagnostics.text();
    EXPECT_THAT(diagnostics.text(), HasSubstr(part));
  }
}

TEST(SceneFaults, RefusesAnImportedMeshWithAnInvertedElement) {
  const auto path = std::filesystem::path(testing::TempDir()) / "concave.msh";
  std::ofstream(path) << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"a\"\n$EndPhysicalNames\n"
                         "$Nodes\n4\n1 0 0 0\n2 4 0 0\n3 1 1 0\n4 0 4 0\n$EndNodes\n"
                         "$Elements\n1\n1 3 2 1 1 1 2 3 4\n$EndElements\n";
  Diagnostics diagnostics;
  EXPECT_FALSE(read_text(R"({"bodies": {"a": {"mesh": {"gmsh": ")" + path.string() + R"(", "body": "a"},
      "material": {"linear_elastic": {"E": 1, "nu": 0}}}}, "time": {"end": 1, "steps": 1}, "method": {"penalty": {}}})",
                         diagnostics));
  ASSERT_EQ(diagnostics.error_count(), 1u) << diagnostics.text();
  EXPECT_THAT(diagnostics.text(), testing::StartsWith(path.string() + ":17:1: element 1"));
  std::filesystem::remove(path);
}

TEST(SceneFaults, SurvivesWhateverTypeAValueHas) {
  // every value in turn becomes something else: a fault or not, but never a crash
  for (const char* text : {block_scene, lumped_scene}) {
    const auto scene = nlohmann::json::parse(text);
    const auto flat = scene.flatten();
    for (const auto& [pointer, unused] : flat.items())
      for (std::string at = pointer; !at.empty(); at.erase(at.rfind('/')))
        for (const char* value : {"null", "[]", "{}", "\"x\"", "true", "-1e300", "[[]]", "{\"a\": {\"b\": []}}"}) {
          auto broken = scene;
          broken[nlohmann::json::json_pointer(at)] = nlohmann::json::parse(value);
          Diagnostics diagnostics;
          const auto input = read_text(broken.dump(), diagnostics);
          EXPECT_EQ(input.has_value(), !diagnostics.has_errors()) << at << " = " << value;
        }
  }
}

}  // namespace
}  // namespace stickslip
