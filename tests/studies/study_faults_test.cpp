/// What is at fault in a study file, where, and what else is told with it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "studies/sweep/study_reader.hpp"
#include "tests/studies/study_texts.hpp"

namespace stickslip {
namespace {

using study_texts::edited;
using study_texts::scene_text;
using study_texts::study_text;
using testing::HasSubstr;
using testing::IsEmpty;

class StudyFaults : public study_texts::StudyFolder {};

/// Two long lists; none of their combinations may be made.
std::string many_cells() {
  const auto list = [](int count) {
    std::string text = "0";
    for (int i = 1; i < count; ++i) text += ", " + std::to_string(i);
    return "[" + text + "]";
  };
  return R"(@{"scene": "scene.json", "methods": [{"penalty": {"stiffness": )" + list(6993) +
         R"(}}], "vary": {"/contacts/sole/friction": )" + list(1998) + "}}";
}

/// A study with one edit, whose fault stands in a line and column of the study file.
struct BrokenStudy {
  const char* name;
  std::string from, to;  ///< @ in `to` marks the place
  std::string pointer, message;
};
void PrintTo(const BrokenStudy& broken, std::ostream* out) { *out << broken.to; }

class BrokenStudies : public StudyFaults, public testing::WithParamInterface<BrokenStudy> {};

TEST_P(BrokenStudies, AreRefusedWithPlacePointerAndReason) {
  const BrokenStudy& broken = GetParam();
  std::string text = edited(study_text, broken.from, broken.to);
  const auto mark = text.find('@');
  ASSERT_NE(mark, std::string::npos);
  text.erase(mark, 1);
  const int line = 1 + static_cast<int>(std::count(text.begin(), text.begin() + mark, '\n'));
  const int column = static_cast<int>(mark - (text.rfind('\n', mark - 1) + 1)) + 1;
  const auto study = read(text);
  if (study) {
    EXPECT_THAT(expand(*study, "1.0", diagnostics_, mesh_files_), IsEmpty());
  }
  ASSERT_EQ(diagnostics_.error_count(), 1u) << diagnostics_.text();
  const Diagnostic fault = diagnostics_.errors()[0];
  EXPECT_EQ(fault.place.source, (folder_ / "cost.study.json").string());
  EXPECT_EQ(fault.place.line, line) << fault.text();
  EXPECT_EQ(fault.place.column, column) << fault.text();
  EXPECT_EQ(fault.pointer, broken.pointer);
  EXPECT_THAT(fault.message, HasSubstr(broken.message));
}

INSTANTIATE_TEST_SUITE_P(
    StudyFaults, BrokenStudies,
    testing::Values(
        BrokenStudy{"unknown_key", R"("errors")", R"(@"erors")", "/erors", R"(did you mean "errors"?)"},
        BrokenStudy{"no_scene_file", R"("scene.json")", R"(@"scen.json")", "/scene", "cannot be read"},
        BrokenStudy{"methods_object", R"([{"penalty": {"stiffness": [10, 1000]}},)", R"([@3,)", "/methods/0",
                    "must be an object with one of the keys penalty"},
        BrokenStudy{"unknown_method", R"({"monolithic_al": {}}])", R"({@"monolitic_al": {}}])",
                    "/methods/2/monolitic_al", R"(did you mean "monolithic_al"?)"},
        BrokenStudy{"empty_sweep", "[10, 1000]", "@[]", "/methods/0/penalty/stiffness", "must be a list of values"},
        BrokenStudy{"value_twice", "[10, 1000]", "[10, @10]", "/methods/0/penalty/stiffness/1", "has already"},
        BrokenStudy{"bad_option_value", "[10, 1000]", "[10, @-1]", "/methods/0/penalty/stiffness/1",
                    "is -1; must be a number > 0"},
        BrokenStudy{"unknown_option", R"("adapt": false)", R"(@"adpt": false)", "/methods/1/uzawa_al/adpt",
                    R"(did you mean "adapt"?)"},
        BrokenStudy{"vary_nothing", R"("/contacts/sole/friction": [0, 0.3])", R"(@"/contacts/soul/friction": [0, 0.3])",
                    "/vary/~1contacts~1soul~1friction", R"(did you mean "sole"?)"},
        BrokenStudy{"vary_a_method", R"("/contacts/sole/friction": [0, 0.3])",
                    R"(@"/method/monolithic_al/scale": [0, 0.3])", "/vary/~1method~1monolithic_al~1scale",
                    R"(in "methods")"},
        BrokenStudy{"vary_an_object", R"("/contacts/sole/friction": [0, 0.3])", R"(@"/contacts/sole": [0, 0.3])",
                    "/vary/~1contacts~1sole", "names an object"},
        BrokenStudy{"vary_a_part_of_another", R"("/contacts/sole/friction": [0, 0.3])",
                    R"("/obstacles/floor/plane/normal": [[0, 1]], @"/obstacles/floor/plane/normal/1": [1, 2])",
                    "/vary/~1obstacles~1floor~1plane~1normal~11", "overlaps /obstacles/floor/plane/normal, which"},
        BrokenStudy{"vary_one_value", R"("/contacts/sole/friction": [0, 0.3])", R"("/contacts/sole/friction": @0.3)",
                    "/vary/~1contacts~1sole~1friction", "must be a list of values"},
        BrokenStudy{"linked_lengths", "[0, 0.3]", R"([0, 0.3], "both": {"/time/end": [1, 2], "/time/steps": @[1]})",
                    "/vary/both/~1time~1steps", "has 1 value, but /time/end has 2; lists that are linked must"},
        BrokenStudy{"linked_alone", "[0, 0.3]", R"([0, 0.3], "both": @{"/time/end": [1, 2]})", "/vary/both",
                    "must be two or more lists of values by JSON pointer"},
        BrokenStudy{"linked_overlap", "[0, 0.3]",
                    R"([0, 0.3], "more": {"/time/end": [1, 2], @"/contacts/sole/friction": [1, 2]})",
                    "/vary/more/~1contacts~1sole~1friction", "overlaps /contacts/sole/friction"},
        BrokenStudy{"linked_beyond", "[0, 0.3]", R"([0, 0.3], "both": {"/time/end": [1, 2], "/time/steps": [1, @-3]})",
                    "/vary/both/~1time~1steps/1", "is -3; must be a whole number"},
        BrokenStudy{"scene_and_scenes", R"("scene": "scene.json")", R"("scene": "scene.json", @"scenes": ["a", "b"])",
                    "/scenes", "goes in place of \"scene\""},
        BrokenStudy{"one_of_scenes", R"("scene": "scene.json")", R"("scenes": @["scene.json"])", "/scenes",
                    "must be a list of two or more scene files"},
        BrokenStudy{"vary_beyond", "[0, 0.3]", "[0, @-0.3]", "/vary/~1contacts~1sole~1friction/1",
                    "is -0.3; must be a number >= 0"},
        BrokenStudy{"refine_below", R"("refine": [0, 1])", R"("refine": [@-1, 1])", "/refine/0",
                    "must be a whole number from 0 to 10"},
        BrokenStudy{"refine_far", R"("refine": [0, 1])", R"("refine": [0, @11])", "/refine/1",
                    "must be a whole number from 0 to 10"},
        BrokenStudy{"refine_twice", R"("refine": [0, 1])", R"("refine": [0, @0])", "/refine/1", "has already"},
        BrokenStudy{"schema_number", R"("title": "cost")", R"("$schema": @7)", "/$schema", "must be a text"},
        BrokenStudy{"too_many_cells", study_text, many_cells(), "", "makes 13972014 cells of all its lists"},
        BrokenStudy{"overkill", R"({"analytic": "hertz_line", "map": {"press": "force"}, "inputs": {"radius": 2}})",
                    R"({"overkill": {"refine": @0}})", "/reference/0/overkill/refine", "must be a whole number from 1"},
        BrokenStudy{"overkill_far", R"({"analytic": "hertz_line", "map": {"press": "force"}, "inputs": {"radius": 2}})",
                    R"({"overkill": {"refine": @11}})", "/reference/0/overkill/refine",
                    "must be a whole number from 1 to 10"},
        BrokenStudy{
            "overkill_of_nothing", R"({"analytic": "hertz_line", "map": {"press": "force"}, "inputs": {"radius": 2}})",
            R"({"overkill": @{}})", "/reference/0/overkill", "needs \"refine\", levels finer than the cell, or"},
        BrokenStudy{"overkill_of_no_mesh",
                    R"({"analytic": "hertz_line", "map": {"press": "force"}, "inputs": {"radius": 2}})",
                    R"({"overkill": {"vary": @{}}})", "/reference/0/overkill/vary", "is empty; must name a mesh"},
        BrokenStudy{"overkill_of_another_problem",
                    R"({"analytic": "hertz_line", "map": {"press": "force"}, "inputs": {"radius": 2}})",
                    R"({"overkill": {"vary": {@"/contacts/sole/friction": 0.1}}})",
                    "/reference/0/overkill/vary/~1contacts~1sole~1friction",
                    "must be of a mesh, /bodies/NAME/mesh/..."},
        BrokenStudy{"overkill_of_a_bad_mesh",
                    R"({"analytic": "hertz_line", "map": {"press": "force"}, "inputs": {"radius": 2}})",
                    R"({"overkill": {"vary": {"/bodies/block/mesh/box/cells": @[0, 2]}}})",
                    "/reference/0/overkill/vary/~1bodies~1block~1mesh~1box~1cells/0", "must be a whole number"},
        BrokenStudy{"no_such_input", R"("inputs": {"radius": 2})", R"("inputs": {"radius": 2, @"radios": 2})",
                    "/reference/0/inputs/radios", R"(did you mean "radius"?)"},
        BrokenStudy{"input_twice", R"("inputs": {"radius": 2})", R"("inputs": {"radius": 2, @"force": 2})",
                    "/reference/0/inputs/force", "is given by the map too"},
        BrokenStudy{"input_of_nothing", R"("inputs": {"radius": 2})", R"("inputs": {"radius": @"R"})",
                    "/reference/0/inputs/radius", "the scene has no parameter of this name"},
        BrokenStudy{"input_beyond", R"("inputs": {"radius": 2})", R"("inputs": {"radius": @0})",
                    "/reference/0/inputs/radius", "is 0; must be a number > 0"},
        BrokenStudy{"input_list", R"("inputs": {"radius": 2})", R"("inputs": {"radius": @[2]})",
                    "/reference/0/inputs/radius", "must be a number, or the name of a parameter"},
        BrokenStudy{
            "input_missing", R"({"analytic": "hertz_line", "map": {"press": "force"}, "inputs": {"radius": 2}})",
            R"(@{"analytic": "hertz_line", "map": {"press": "force"}})", "/reference/0", "hertz_line lacks radius"},
        BrokenStudy{"inputs_of_values", R"({"values": {"press": 1.5, "press/mu": 0}})",
                    R"({"values": {"press": 1.5, "press/mu": 0}, @"inputs": {}})", "/reference/1/inputs",
                    "belongs to analytic"},
        BrokenStudy{"unknown_form", R"("hertz_line")", R"(@"hertz_lin")", "/reference/0/analytic",
                    R"(did you mean "hertz_line"?)"},
        BrokenStudy{"no_map", R"({"analytic": "hertz_line", "map": {"press": "force"}, "inputs": {"radius": 2}})",
                    R"(@{"analytic": "hertz_line"})", "/reference/0", R"("map" is missing)"},
        BrokenStudy{"map_of_nothing", R"({"press": "force"})", R"({@"pres": "force"})", "/reference/0/map/pres",
                    R"(did you mean "press"?)"},
        BrokenStudy{"map_to_nothing", R"({"press": "force"})", R"({"press": @"forse"})", "/reference/0/map/press",
                    R"(did you mean "force"?)"},
        BrokenStudy{"values_of_nothing", R"("press/mu": 0)", R"(@"press/nu": 0)", "/reference/1/values/press~1nu",
                    R"(did you mean "press/mu"?)"},
        BrokenStudy{"value_text", R"("press": 1.5)", R"("press": @"1.5")", "/reference/1/values/press",
                    "must be a number"},
        BrokenStudy{"reference_sweep", R"({"monolithic_al": {"scale": 5}})", R"({"monolithic_al": {"scale": @[5, 6]}})",
                    "/reference/2/method/monolithic_al/scale", "must be one value"},
        BrokenStudy{"reference_option", R"({"monolithic_al": {"scale": 5}})", R"({"monolithic_al": {"scale": @-5}})",
                    "/reference/2/method/monolithic_al/scale", "must be a number > 0"},
        BrokenStudy{"no_values", R"({"values": {"press": 1.5, "press/mu": 0}})", R"({"values": @{}})",
                    "/reference/1/values", "is empty; must give a response its number"},
        BrokenStudy{"reference_twice", R"({"method": {"monolithic_al": {"scale": 5}}}])",
                    R"(@{"values": {"press": 1.5, "press/mu": 0}}])", "/reference/2", "that the list has already"},
        BrokenStudy{"pattern", R"(["response:*", "kkt"])", R"(["response:*", @"ktk"])", "/errors/1",
                    "must be \"kkt\", or begin with response:"},
        BrokenStudy{"pattern_of_nothing", R"("response:*")", R"(@"response:pres")", "/errors/0",
                    R"(matches nothing in the scene; did you mean "response:press"?)"},
        BrokenStudy{"pattern_of_no_field", R"("response:*")", R"(@"field:x*")", "/errors/0", "matches nothing"},
        BrokenStudy{"repeat", R"("repeat": 4)", R"("repeat": @0)", "/timing/repeat", "must be a whole number from 1"},
        BrokenStudy{"accuracy", R"([0.05, 1e-3])", R"([0.05, @2])", "/accuracy/1", "must be a number > 0 and < 1"},
        BrokenStudy{"accuracies", R"([0.05, 1e-3])", R"(@[])", "/accuracy", "must be a list of up to six"}),
    [](const auto& info) { return std::string(info.param.name); });

TEST_F(StudyFaults, ListsAllFaultsOfAStudyWhoseSceneCannotBeRead) {
  std::string text = edited(study_text, R"("scene.json")", R"("scen.json")");
  text = edited(text, R"("adapt": false)", R"("adpt": false)");
  text = edited(text, R"("refine": [0, 1])", R"("refine": [-1, 1])");
  text = edited(text, R"("hertz_line")", R"("hertz_lin")");
  text = edited(text, R"("repeat": 4)", R"("repeat": 0)");
  EXPECT_FALSE(read(text));
  EXPECT_EQ(diagnostics_.error_count(), 5u) << diagnostics_.text();  // and none of names that the scene would have
  for (const char* fault :
       {"/scene: ", "/methods/1/uzawa_al/adpt: ", "/refine/0: ", "/reference/0/analytic: ", "/timing/repeat: "})
    EXPECT_THAT(diagnostics_.text(), HasSubstr(fault));
}

/// Whatever else is at fault: values of options and of what is varied, and the scene.
TEST_F(StudyFaults, AreListedAllAtOnce) {
  std::string text = edited(study_text, "[10, 1000]", "[10, -1]");
  text = edited(text, R"("adapt": false)", R"("adapt": "no", "adpt": 3)");
  text = edited(text, "[1e-8, 1e-10]", "[1e-8, 2]");
  text = edited(text, "[0, 0.3]", "[0, -0.3]");
  text = edited(text, R"({"scale": 5})", R"({"scale": "five"})");
  text = edited(text, R"("repeat": 4)", R"("repeat": 0)");
  EXPECT_FALSE(read(text, edited(scene_text, "\"nu\": 0.25", "\"nu\": 0.75")));
  EXPECT_EQ(diagnostics_.error_count(), 8u) << diagnostics_.text();
  for (const char* fault :
       {"/methods/0/penalty/stiffness/1: is -1;", "/methods/1/uzawa_al/adapt: is \"no\";",
        "/methods/1/uzawa_al/adpt: unknown option", "/methods/1/uzawa_al/newton/tolerance/1: is 2;",
        "/vary/~1contacts~1sole~1friction/1: is -0.3;", "/reference/2/method/monolithic_al/scale: is \"five\";",
        "/timing/repeat: is 0;", "scene.json:6:56: /bodies/block/material/linear_elastic/nu: is 0.75;"})
    EXPECT_THAT(diagnostics_.text(), HasSubstr(fault));
}

TEST_F(StudyFaults, OfAReferenceAreToldThoughNoCellIsSound) {
  std::string text = edited(study_text, R"("adapt": false)", R"("adapt": 0)");
  text = edited(text, "[10, 1000]", "[-1]");
  text = edited(text, R"(,
              {"monolithic_al": {}}])",
                "]");
  text = edited(text, R"({"scale": 5})", R"({"scale": -5})");
  const auto study = read(text);
  ASSERT_TRUE(study.has_value()) << diagnostics_.text();
  EXPECT_THAT(expand(*study, "1.0", diagnostics_, mesh_files_), IsEmpty());
  EXPECT_EQ(diagnostics_.error_count(), 3u) << diagnostics_.text();
  EXPECT_THAT(diagnostics_.text(), HasSubstr("/reference/2/method/monolithic_al/scale: is -5;"));
}

TEST_F(StudyFaults, OfOneOfSeveralScenesNameIt) {
  write("bare.json",
        edited(scene_text, R"("contacts": {"sole": {"slave": "block.bottom", "master": "floor", "friction": 0.3}},)",
               R"("contacts": {"face": {"slave": "block.bottom", "master": "floor", "friction": 0.3}},)"));
  EXPECT_FALSE(
      read(edited(study_text, R"("scene": "scene.json")", R"("scenes": ["scene.json", "bare.json", "scene.json"])")));
  EXPECT_THAT(diagnostics_.text(), HasSubstr("/scenes/2: is \"scene.json\", which the list has already\n"));
  EXPECT_THAT(diagnostics_.text(), HasSubstr("/contacts has no \"sole\"; it has face (of bare.json)\n"));
  EXPECT_THAT(diagnostics_.text(), testing::Not(HasSubstr("(of scene.json)")));
}

TEST_F(StudyFaults, OfSeveralScenesWithoutMethodsAreToldOnce) {
  write("other.json", edited(scene_text, R"("title": "block")", R"("title": "blocks")"));
  EXPECT_FALSE(read(R"({"scenes": ["scene.json", "other.json"]})"));
  EXPECT_THAT(diagnostics_.text(), testing::EndsWith("a study of several scenes needs it\n"));
}

TEST_F(StudyFaults, OfAMissingSceneAreToldWhateverIsVaried) {
  // without a scene no pointer is checked, so they may be none
  EXPECT_FALSE(read(R"({"methods": [{"penalty": {}}], "vary": {"/time/steps": [1], "extra": 360, "a/b": [1]}})"));
  EXPECT_THAT(diagnostics_.text(), HasSubstr(R"(the key "scene" is missing)"));
}

TEST_F(StudyFaults, OfAnImportedMeshThatIsSplitTooOftenAreAtTheLevel) {
  std::filesystem::copy_file(STICKSLIP_SOURCE_DIR "/studies/meshes/half_disk_coarse.msh", folder_ / "disk.msh");
  const auto scene = R"({"bodies": {"disk": {"mesh": {"gmsh": "disk.msh", "body": "disk"},
      "material": {"linear_elastic": {"E": 1, "nu": 0}}}}, "time": {"end": 1, "steps": 1}})";
  const auto found = cells(R"({"scene": "scene.json", "refine": [0, 1], "methods": [{"penalty": {}}],
      "reference": [{"overkill": {"refine": 1}}]})",
                           scene);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[1].document.root()["bodies"]["disk"]["mesh"]["split"], 1);
  EXPECT_NE(found[0].canonical, found[1].canonical);
  EXPECT_THAT(cells("{\"scene\": \"scene.json\", \"methods\": [{\"penalty\": {}}],\n \"refine\": [0, 7]}", scene),
              IsEmpty());
  EXPECT_THAT(diagnostics_.text(),
              HasSubstr("cost.study.json:2:16: /refine/1: is 7; must be a whole number from 0 to 6"));
}

TEST_F(StudyFaults, ReportsFaultsOfTheSceneInTheSceneOnce) {
  const auto study = read(study_text, edited(scene_text, "\"nu\": 0.25", "\"nu\": 0.75"));
  ASSERT_TRUE(study.has_value());
  EXPECT_THAT(expand(*study, "1.0", diagnostics_, mesh_files_), IsEmpty());
  EXPECT_EQ(diagnostics_.errors().size(), 1u);
  EXPECT_THAT(diagnostics_.text(),
              testing::StartsWith((folder_ / "scene.json").string() +
                                  ":6:56: /bodies/block/material/linear_elastic/nu: is 0.75; must be "
                                  "a number > -1 and < 0.5; "));
}

}  // namespace
}  // namespace stickslip
