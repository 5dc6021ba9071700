#include "studies/sweep/study_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include "tests/studies/study_texts.hpp"

namespace stickslip {
namespace {

using study_texts::edited;
using study_texts::scene_text;
using study_texts::study_text;
using study_texts::without_stiffness_parameter;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class StudyReader : public study_texts::StudyFolder {};

TEST_F(StudyReader, ReadsAllThatAStudySays) {
  const auto study = read(study_text);
  ASSERT_TRUE(study.has_value()) << diagnostics_.text();
  EXPECT_EQ(study->title, "cost");
  ASSERT_EQ(study->methods.size(), 3u);
  EXPECT_EQ(study->methods[1].method, "uzawa_al");
  ASSERT_EQ(study->methods[1].options.size(), 3u);  // by name: adapt, newton, scale
  EXPECT_EQ(study->methods[1].options[1].pointer, "/newton/tolerance");
  EXPECT_EQ(study->methods[1].options[1].values.at(1).value, 1e-10);
  EXPECT_EQ(study->vary.at(0).knobs.at(0).pointer, "/contacts/sole/friction");
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

TEST_F(StudyReader, GoesThroughLinkedListsTogether) {
  const std::string alone = R"("vary": {"/contacts/sole/friction": [0, 0.3]})";
  const std::string sizes = R"("/bodies/block/mesh/box/max/0": [4, 8], "/bodies/block/mesh/box/cells/0": [4, 4])";
  const std::string linked = R"("vary": {"/contacts/sole/friction": [0, 0.3], "sizes": {)" + sizes + "}}";
  const auto all = cells(edited(study_text, alone, linked));
  ASSERT_EQ(all.size(), 2u * 4u * 7u);  // levels, variants, methods with their options
  std::set<std::string> variants;
  for (const CellInput& cell : all) {
    variants.insert(variant_key(cell));
    EXPECT_EQ(cell.vary.size(), 3u);
    const auto& box = cell.document.root()["bodies"]["block"]["mesh"]["box"];
    EXPECT_EQ(box["max"][0], cell.vary.at("/bodies/block/mesh/box/max/0"));
    EXPECT_EQ(box["cells"][0], 4 << cell.refine) << "what is varied is refined too";
  }
  EXPECT_EQ(variants.size(), 8u);
  // a study without the link has cells of the same ids: a study that is resumed runs them no second time
  const auto before = cells(study_text);
  std::set<std::string> ids;
  for (const CellInput& cell : all) ids.insert(cell.id);
  for (const CellInput& cell : before) EXPECT_EQ(ids.count(cell.id), 1u);
}

TEST_F(StudyReader, RunsEachOfSeveralScenes) {
  write("wide.json", edited(scene_text, "\"max\": [4, 2]", "\"max\": [8, 2]"));
  const auto all = cells(edited(study_text, R"("scene": "scene.json")", R"("scenes": ["scene.json", "wide.json"])"));
  ASSERT_EQ(all.size(), 2u * 28u);
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].scene, i < 28 ? "scene.json" : "wide.json");
    EXPECT_EQ(all[i].document.root()["bodies"]["block"]["mesh"]["box"]["max"][0], i < 28 ? 4 : 8);
  }
  EXPECT_NE(variant_key(all[0]), variant_key(all[28]));
  EXPECT_EQ(cells(study_text)[0].id, all[0].id) << "the id is that of the scene's content";
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

TEST_F(StudyReader, TakesOneOverkillReferenceForAllMeshes) {
  const auto text =
      edited(study_text, R"({"analytic": "hertz_line", "map": {"press": "force"}, "inputs": {"radius": 2}})",
             R"({"overkill": {"vary": {"/bodies/block/mesh/box/cells": [6, 3]}, "refine": 2}})");
  const auto all = cells(text);
  const auto study = read(text);
  ASSERT_EQ(all.back().refine, 1);
  for (const CellInput* cell : {&all.front(), &all.back()}) {
    const CellInput fine = reference_cell(*cell, study->references[0], "1.0", mesh_files_);
    EXPECT_EQ(fine.document.root()["bodies"]["block"]["mesh"]["box"]["cells"], (nlohmann::json{6 * 4, 3 * 4}));
    EXPECT_EQ(fine.document.root()["bodies"]["rod"]["mesh"]["line"]["cells"], 3 * 4);
    EXPECT_EQ(fine.document.root()["contacts"]["sole"]["friction"], cell->vary.at("/contacts/sole/friction"));
  }
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

}  // namespace
}  // namespace stickslip
