#include "studies/sweep/study_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include "studies/sweep/cell_inputs.hpp"

namespace stickslip {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* scene_text = R"({
  "title": "block",
  "bodies": {
    "block": {
      "mesh": {"box": {"min": [0, 0], "max": [4, 2], "cells": [4, 2]}},
      "material": {"linear_elastic": {"E": 1000, "nu": 0.25}}
    },
    "rod": {
      "mesh": {"line": {"from": [5, 0], "to": [6, 0], "cells": 3}},
      "material": {"linear_elastic": {"E": 1000, "nu": 0}}
    },
    "mass": {
      "mesh": {"point": {"at": [9, 0]}},
      "material": {"grounded_spring": {"stiffness": [[1, 0], [0, 1]]}}
    }
  },
  "obstacles": {"floor": {"plane": {"point": [0, 0], "normal": [0, 1]}}},
  "contacts": {"sole": {"slave": "block.bottom", "master": "floor", "friction": 0.3}},
  "time": {"end": 1, "steps": 2},
  "responses": {"press": {"contact_force": {"contact": "sole", "component": "normal"}}},
  "parameters": {"mu": "/contacts/sole/friction", "eps": "/method/penalty/stiffness"},
  "method": {"monolithic_al": {}}
})";

constexpr const char* study_text = R"({
  "title": "cost",
  "scene": "scene.json",
  "methods": [{"penalty": {"stiffness": [10, 1000]}},
              {"uzawa_al": {"scale": [1, 10], "newton": {"tolerance": [1e-8, 1e-10]}, "adapt": false}},
              {"monolithic_al": {}}],
  "vary": {"/contacts/sole/friction": [0, 0.3]},
  "refine": [0, 1],
  "reference": [{"analytic": "hertz_line", "map": {"press": "force"}, "inputs": {"radius": 2}},
                {"values": {"press": 1.5, "press/mu": 0}},
                {"method": {"monolithic_al": {"scale": 5}}}],
  "errors": ["response:*", "kkt"],
  "accuracy": [0.05, 1e-3],
  "timing": {"repeat": 4}
})";

/// A folder with a scene and a study, gone with the test.
class StudyReader : public testing::Test {
 protected:
  StudyReader() { std::filesystem::create_directories(folder_); }
  ~StudyReader() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  std::optional<Study> read(const std::string& text, const std::string& scene = scene_text) {
    write("scene.json", scene);
    return read_study(write("cost.study.json", text), diagnostics_);
  }
  std::vector<CellInput> cells(const std::string& text, const std::string& scene = scene_text) {
    const auto study = read(text, scene);
    EXPECT_TRUE(study.has_value()) << diagnostics_.text();
    return study ? expand(*study, "1.0", diagnostics_, mesh_files_) : std::vector<CellInput>{};
  }

  static std::filesystem::path own_folder() {
    std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
    std::replace(name.begin(), name.end(), '/', '_');  // of a case of a parametrised test
    return std::filesystem::path(testing::TempDir()) / ("stickslip_study_" + name);
  }

  const std::filesystem::path folder_ = own_folder();
  Diagnostics diagnostics_;
  MeshFiles mesh_files_;
};

std::string edited(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

/// The scene without the parameter on penalty's stiffness, which has to be a number there.
std::string without_stiffness_parameter() { return edited(scene_text, R"(, "eps": "/method/penalty/stiffness")", ""); }

TEST_F(StudyReader, ReadsAllThatAStudySays) {
  const auto study = read(study_text);
  ASSERT_TRUE(study.has_value()) << diagnostics_.text();
  EXPECT_EQ(study->title, "cost");
  ASSERT_EQ(study->methods.size(), 3u);
  EXPECT_EQ(study->methods[1].method, "uzawa_al");
  ASSERT_EQ(study->methods[1].options.size(), 3u);  // by name: adapt, newton, scale
  EXPECT_EQ(study->methods[1].options[1].pointer, "/newton/tolerance");
  EXPECT_EQ(study->methods[1].options[1].values.at(1).value, 1e-10);
  EXPECT_EQ(study->vary.at(0).pointer, "/contacts/sole/friction");
  EXPECT_EQ(study->refine.size(), 2u);
  ASSERT_EQ(study->references.size(), 3u);
  EXPECT_EQ(study->references[0].kind, Reference::Kind::analytic);
  EXPECT_EQ(study->references[0].entry["map"]["press"], "force");
  EXPECT_EQ(study->references[1].kind, Reference::Kind::values);
  EXPECT_EQ(study->references[2].kind, Reference::Kind::method);
  EXPECT_EQ(study->references[2].method.method, "monolithic_al");
  EXPECT_THAT(study->errors, ElementsAre("response:*", "kkt"));
  EXPECT_EQ(study->repeat, 4);
}

TEST_F(StudyReader, MakesACellOfEveryCombination) {
  const auto all = cells(study_text);
  EXPECT_EQ(diagnostics_.text(), "");
  ASSERT_EQ(all.size(), 2u * 2u * (2u + 4u + 1u));  // levels, frictions, methods with their options
  std::set<std::string> ids;
  for (const CellInput& cell : all) ids.insert(cell.id);
  EXPECT_EQ(ids.size(), all.size());
  EXPECT_EQ(all[0].label, "penalty stiffness=10");
  EXPECT_EQ(all[0].knobs, nlohmann::json::parse(R"({"stiffness": 10})"));
  EXPECT_EQ(all[3].label, "uzawa_al adapt=false newton.tolerance=1e-08 scale=10");
  EXPECT_EQ(all[3].knobs, nlohmann::json::parse(R"({"newton.tolerance": 1e-8, "scale": 10})"));
  EXPECT_EQ(all[6].label, "monolithic_al");
  EXPECT_EQ(all[6].vary.at("/contacts/sole/friction"), 0);
  EXPECT_EQ(all[7].vary.at("/contacts/sole/friction"), 0.3);
  EXPECT_EQ(all[13].refine, 0);
  EXPECT_EQ(all[14].refine, 1);
  const auto& uzawa = std::get<UzawaAL>(all[3].method);
  EXPECT_EQ(uzawa.scale.value.value, 10);
  EXPECT_EQ(uzawa.newton.tolerance, 1e-8);
  EXPECT_FALSE(uzawa.adapt);
}

TEST_F(StudyReader, GivesCellsThatReadAsCompleteScenes) {
  for (const CellInput& cell : cells(study_text)) {
    Diagnostics diagnostics;
    const auto input = read_scene(cell.document, std::string(name_of(cell.method)), diagnostics, mesh_files_);
    ASSERT_TRUE(input.has_value()) << diagnostics.text();
    EXPECT_EQ(canonical_text(*input), cell.canonical);
    EXPECT_EQ(input->scene.contacts[0].friction->first_number().value, cell.vary.at("/contacts/sole/friction"));
    // the parameter on penalty's stiffness is there where penalty runs
    EXPECT_EQ(input->scene.parameters.size(), std::holds_alternative<Penalty>(cell.method) ? 2u : 1u);
  }
}

TEST_F(StudyReader, RefinesTheMeshesOfGenerators) {
  const auto all = cells(study_text);
  const auto& bodies = all.at(14).document.root()["bodies"];
  EXPECT_EQ(bodies["block"]["mesh"]["box"]["cells"], nlohmann::json::parse("[8, 4]"));
  EXPECT_EQ(bodies["rod"]["mesh"]["line"]["cells"], 6);
  EXPECT_EQ(bodies["mass"], nlohmann::json::parse(scene_text)["bodies"]["mass"]);
}

TEST_F(StudyReader, NamesACellByItsInputAndTheProgramAlone) {
  const auto first = cells(study_text);
  const auto same = cells(edited(edited(study_text, "\"repeat\": 4", "\"repeat\": 9"), "\"cost\"", "\"price\""));
  ASSERT_EQ(same.size(), first.size());
  for (std::size_t i = 0; i < first.size(); ++i) EXPECT_EQ(same[i].id, first[i].id);
  const auto other = cells(study_text, edited(scene_text, "\"nu\": 0.25", "\"nu\": 0.2"));
  EXPECT_NE(other.at(0).id, first[0].id);
  EXPECT_NE(cell_id(first[0].canonical, "1.1"), first[0].id);
  EXPECT_EQ(cell_id(first[0].canonical, "1.0"), first[0].id);
}

TEST_F(StudyReader, MakesEachDifferentInputOnce) {
  // auto and no option are the same
  const auto study =
      R"({"scene": "scene.json", "methods": [{"penalty": {}}, {"penalty": {"stiffness": ["auto", 10]}}]})";
  EXPECT_EQ(cells(study, without_stiffness_parameter()).size(), 2u);
}

TEST_F(StudyReader, TakesTheMethodOfTheSceneWhereItNamesNone) {
  const auto all = cells(R"({"scene": "scene.json"})",
                         edited(scene_text, R"({"monolithic_al": {}})", R"({"monolithic_al": {"scale": 3}})"));
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].label, "monolithic_al scale=3");
}

TEST_F(StudyReader, SweepsWithinAnOption) {
  const auto all = cells(R"({"scene": "scene.json", "methods": [{"penalty": {"stiffness": {"absolute": [5, 6]}}}]})",
                         without_stiffness_parameter());
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[1].label, "penalty stiffness.absolute=6");
  EXPECT_EQ(std::get<Penalty>(all[1].method).stiffness.kind, Regularisation::Kind::absolute);
  EXPECT_EQ(std::get<Penalty>(all[1].method).stiffness.value.value, 6);
}

TEST_F(StudyReader, MakesTheCellOfAReferenceFromAnyCell) {
  const auto study = read(study_text);
  ASSERT_TRUE(study.has_value()) << diagnostics_.text();
  const auto all = expand(*study, "1.0", diagnostics_, mesh_files_);
  const CellInput reference = reference_cell(all.at(15), study->references[2], "1.0", mesh_files_);
  EXPECT_EQ(reference.vary, all[15].vary);
  EXPECT_EQ(reference.refine, 1);
  EXPECT_EQ(std::get<MonolithicAL>(reference.method).scale.value.value, 5);
  EXPECT_EQ(reference.document.root()["bodies"], all[15].document.root()["bodies"]);
  EXPECT_NE(reference.id, all[15].id);
}

TEST_F(StudyReader, ReadsTheStudiesThatAreShipped) {
  int read = 0;
  for (const auto& entry : std::filesystem::directory_iterator(STICKSLIP_SOURCE_DIR "/studies/scenes")) {
    if (entry.path().filename().string().find(".study.json") == std::string::npos) continue;
    Diagnostics diagnostics;
    const auto study = read_study(entry.path().string(), diagnostics);
    ASSERT_TRUE(study.has_value()) << diagnostics.text();
    EXPECT_FALSE(expand(*study, "1.0", diagnostics, mesh_files_).empty());
    EXPECT_EQ(diagnostics.text(), "");
    ++read;
  }
  EXPECT_GT(read, 0);
}

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

class BrokenStudies : public StudyReader, public testing::WithParamInterface<BrokenStudy> {};

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
    StudyReader, BrokenStudies,
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

TEST_F(StudyReader, ListsAllFaultsOfAStudyWhoseSceneCannotBeRead) {
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

TEST_F(StudyReader, TakesAnOverkillReferenceFromAFinerMeshOfTheSameCell) {
  const auto text =
      edited(study_text, R"({"analytic": "hertz_line", "map": {"press": "force"}, "inputs": {"radius": 2}})",
             R"({"overkill": {"refine": 2}})");
  const auto all = cells(text);
  const auto study = read(text);
  ASSERT_EQ(study->references[0].kind, Reference::Kind::overkill);
  const CellInput fine = reference_cell(all.back(), study->references[0], "1.0", mesh_files_);  // of level 1
  EXPECT_EQ(name_of(fine.method), "monolithic_al");
  EXPECT_EQ(fine.document.root()["bodies"]["block"]["mesh"]["box"]["cells"], (nlohmann::json{4 * 8, 2 * 8}));
  EXPECT_EQ(fine.document.root()["bodies"]["rod"]["mesh"]["line"]["cells"], 3 * 8);
  EXPECT_EQ(fine.vary, all.back().vary);
}

TEST_F(StudyReader, SaysHowManyCellsAreLeftOutBecauseTheyEqualOthers) {
  const auto once = R"({"scene": "scene.json", "methods": [{"monolithic_al": {}}, {"penalty": {}}]})";
  EXPECT_EQ(cells(once, without_stiffness_parameter()).size(), 2u);
  EXPECT_THAT(diagnostics_.notes(), IsEmpty());
  const auto twice = R"({"scene": "scene.json", "methods": [{"monolithic_al": {}}, {"penalty": {}}, {"penalty": {}}]})";
  EXPECT_EQ(cells(twice, without_stiffness_parameter()).size(), 2u);
  ASSERT_EQ(diagnostics_.notes().size(), 1u);
  EXPECT_THAT(diagnostics_.notes()[0].text(), HasSubstr("1 of the 3 cells that its lists make equals another"));
  EXPECT_EQ(diagnostics_.text(), "");
}

TEST_F(StudyReader, SaysThatPointsHaveNoMeshLevels) {
  const auto scene = R"({"bodies": {"mass": {"mesh": {"point": {"at": [0, 0]}},
      "material": {"grounded_spring": {"stiffness": [[1, 0], [0, 1]]}}}}, "time": {"end": 1, "steps": 1}})";
  EXPECT_EQ(cells(R"({"scene": "scene.json", "refine": [0, 1, 2], "methods": [{"penalty": {}}]})", scene).size(), 1u);
  ASSERT_EQ(diagnostics_.notes().size(), 1u);
  EXPECT_THAT(diagnostics_.notes()[0].text(), HasSubstr("2 of the 3 cells that its lists make equal another"));
}

TEST_F(StudyReader, CannotTakeAnOverkillReferenceOfAnImportedMesh) {
  std::filesystem::copy_file(STICKSLIP_SOURCE_DIR "/studies/meshes/half_disk_coarse.msh", folder_ / "disk.msh");
  const auto scene = R"({"bodies": {"disk": {"mesh": {"gmsh": "disk.msh", "body": "disk"},
      "material": {"linear_elastic": {"E": 1, "nu": 0}}}}, "time": {"end": 1, "steps": 1}})";
  EXPECT_THAT(cells("{\"scene\": \"scene.json\", \"methods\": [{\"penalty\": {}}],\n"
                    " \"reference\": [{\"overkill\": {\"refine\": 1}}]}",
                    scene),
              IsEmpty());
  EXPECT_THAT(diagnostics_.text(),
              HasSubstr("cost.study.json:2:16: /reference/0: refines /bodies/disk/mesh, an imported mesh"));
}

TEST_F(StudyReader, CannotRefineAnImportedMesh) {
  std::filesystem::copy_file(STICKSLIP_SOURCE_DIR "/studies/meshes/half_disk_coarse.msh", folder_ / "disk.msh");
  const auto scene = R"({"bodies": {"disk": {"mesh": {"gmsh": "disk.msh", "body": "disk"},
      "material": {"linear_elastic": {"E": 1, "nu": 0}}}}, "time": {"end": 1, "steps": 1}})";
  EXPECT_EQ(cells(R"({"scene": "scene.json", "refine": [0], "methods": [{"penalty": {}}]})", scene).size(), 1u);
  EXPECT_THAT(cells("{\"scene\": \"scene.json\", \"methods\": [{\"penalty\": {}}],\n \"refine\": [0, 1]}", scene),
              IsEmpty());
  EXPECT_THAT(
      diagnostics_.text(),
      HasSubstr("cost.study.json:2:16: /refine/1: refines /bodies/disk/mesh, an imported mesh, which cannot be"));
}

TEST_F(StudyReader, KnowsACellByTheContentOfItsMeshFile) {
  const auto scene = R"({"bodies": {"disk": {"mesh": {"gmsh": "disk.msh", "body": "disk"},
      "material": {"linear_elastic": {"E": 1, "nu": 0}}}}, "time": {"end": 1, "steps": 1}})";
  const auto study = R"({"scene": "scene.json", "methods": [{"penalty": {}}]})";
  std::filesystem::copy_file(STICKSLIP_SOURCE_DIR "/studies/meshes/half_disk_coarse.msh", folder_ / "disk.msh");
  const std::string id = cells(study, scene).at(0).id;
  std::ofstream(folder_ / "disk.msh", std::ios::app) << "\n";
  mesh_files_.clear();
  EXPECT_NE(cells(study, scene).at(0).id, id);
}

TEST_F(StudyReader, ReportsFaultsOfTheSceneInTheSceneOnce) {
  const auto study = read(study_text, edited(scene_text, "\"nu\": 0.25", "\"nu\": 0.75"));
  ASSERT_TRUE(study.has_value());
  EXPECT_THAT(expand(*study, "1.0", diagnostics_, mesh_files_), IsEmpty());
  EXPECT_EQ(diagnostics_.text(), (folder_ / "scene.json").string() +
                                     ":6:56: /bodies/block/material/linear_elastic/nu: is 0.75; must be a number > -1 "
                                     "and < 0.5\n");
}

}  // namespace
}  // namespace stickslip
