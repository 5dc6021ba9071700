/// Solutions of other programs as curves of a study: here those of this one, in another order of nodes and without its
/// tractions.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>

#include "studies/io/input_fault.hpp"
#include "studies/run/certificate.hpp"
#include "studies/run/solution_file.hpp"
#include "studies/sweep/study_cell.hpp"
#include "tests/studies/temporary_folder.hpp"

namespace stickslip::peer_solutions {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::SizeIs;

/// A block that is pressed on a floor and dragged along it, so that some of its sole slips.
json scene_of(double friction) {
  json scene = json::parse(R"({
    "bodies": {"block": {"mesh": {"box": {"min": [0, 0], "max": [4, 2], "cells": [4, 2]}},
                         "material": {"linear_elastic": {"E": 1000, "nu": 0.3}}}},
    "obstacles": {"floor": {"plane": {"point": [0, 0], "normal": [0, 1]}}},
    "contacts": {"sole": {"slave": "block.bottom", "master": "floor"}},
    "supports": [{"on": "block.top", "move": {"x": [[0, 0], [1, 0.004]], "y": -0.01}}],
    "time": {"end": 1, "steps": 3},
    "responses": {"drag": {"contact_force": {"contact": "sole", "component": "x"}},
                  "press": {"contact_force": {"contact": "sole", "component": "normal"}},
                  "heat": {"dissipation": {"contact": "sole"}}}})");
  scene["contacts"]["sole"]["friction"] = friction;
  return scene;
}

/// As another program would write it: nodes from the last to the first.
json peer_of(const CaseResult& result, const json& scene) {
  const json own = json::parse(solution_file(result, scene).text);
  json peer = {
      {"schema", own["schema"]}, {"version", 1}, {"nodes", own["mesh"]["nodes"]}, {"increments", json::array()}};
  std::reverse(peer["nodes"].begin(), peer["nodes"].end());
  for (const json& increment : own["increments"]) {
    const json& u = increment["displacement"];
    json turned = json::array();
    for (std::size_t n = u.size() / 2; n-- > 0;) turned.insert(turned.end(), {u[2 * n], u[2 * n + 1]});
    peer["increments"].push_back({{"time", increment["time"]}, {"displacement", turned}});
  }
  return peer;
}

class PeerSolutions : public InOwnFolder {
 protected:
  PeerSolutions() {
    write("scene.json", scene_of(0.3));
    const auto [study, cells] = read({{"methods", {{{"monolithic_al", json::object()}}}}});
    CellRunner runner(study, cells, meshes_);
    peer_ = peer_of(runner.showcase(0), input_of(cells[0], meshes_).document);
    write("peer.json", peer_);
  }

  void write(const char* name, const json& content) { std::ofstream(folder_ / name) << content.dump(); }

  /// The study and its cells; its faults are left in `diagnostics_`.
  std::pair<Study, std::vector<CellInput>> read(json study) {
    study["scene"] = "scene.json";
    write("a.study.json", study);
    auto valid = read_study((folder_ / "a.study.json").string(), diagnostics_);
    auto cells = valid ? expand(*valid, "1.0", diagnostics_, meshes_) : std::vector<CellInput>();
    return {valid.value_or(Study{}), cells};
  }

  std::vector<json> rows(const json& text) {
    const auto [study, cells] = read(text);
    EXPECT_FALSE(diagnostics_.has_errors()) << diagnostics_.text();
    CellRunner runner(study, cells, meshes_);
    std::vector<json> all;
    for (std::size_t i = 0; i < cells.size(); ++i) all.push_back(runner.row(i));
    return all;
  }

  std::string faults(const json& text) {
    diagnostics_ = {};
    read(text);
    return diagnostics_.text();
  }

  MeshFiles meshes_;
  Diagnostics diagnostics_;
  json peer_;
};

const json monolithic = {{"monolithic_al", json::object()}};

json study_with(json solutions) {
  return {{"methods", {{{"penalty", json::object()}}, monolithic}},
          {"reference", {{{"method", monolithic}}}},
          {"solutions", std::move(solutions)}};
}

TEST_F(PeerSolutions, AreRowsUnderTheSameCertificate) {
  const auto all = rows(study_with({{{"name", "Other"}, {"file", "peer.json"}}}));
  ASSERT_THAT(all, SizeIs(3));
  const json &own = all[1], &row = all[2];
  EXPECT_EQ(row["label"], "Other");
  EXPECT_EQ(row["status"], "converged") << row["message"];
  for (const json& each : all) EXPECT_EQ(each["certificate"]["holds"], true) << each["certificate"];
  ASSERT_THAT(row["steps"], SizeIs(3));
  constexpr double rounding = 1e-10;  // forces are sums of a body's stiffness times its displacements
  for (std::size_t n = 0; n < 3; ++n)
    for (const char* name : {"drag", "press", "heat"})
      EXPECT_NEAR(row["steps"][n]["responses"][name], own["steps"][n]["responses"][name].get<double>(),
                  rounding * std::abs(own["responses"]["press"].get<double>()))
          << name;
  for (const char* name : {"response:drag", "response:press", "field:normal_traction", "field:tangential_traction"})
    EXPECT_LT(row["errors"]["enforcement"].value(name, 1.0), rounding) << name;
  EXPECT_GT(all[0]["errors"]["enforcement"]["response:drag"], 1e-6) << "the penalty's is another solution";
  for (const char* part : {"normal", "tangential"}) {
    const auto of = row["interface"]["sole"][part].get<std::vector<double>>(),
               twin = own["interface"]["sole"][part].get<std::vector<double>>();
    ASSERT_EQ(of.size(), twin.size());
    for (std::size_t i = 0; i < of.size(); ++i) EXPECT_NEAR(of[i], twin[i], rounding * 1000) << part << i;  // of E
  }
  EXPECT_FALSE(row.contains("cost"));
}

TEST_F(PeerSolutions, ThatAreNoneAreToldByTheirLaw) {
  json slid = peer_;
  for (json& u : slid["increments"][1]["displacement"]) u = 1.01 * u.get<double>();
  write("slid.json", slid);
  const auto all = rows(study_with({{{"name", "Other"}, {"file", "slid.json"}}}));
  EXPECT_EQ(all[2]["status"], "inaccurate");
  EXPECT_EQ(all[2]["certificate"]["holds"], false);
  EXPECT_THAT(all[2]["message"].get<std::string>(), HasSubstr("at t = 0.666666667"));
}

TEST_F(PeerSolutions, BelongToAVariantThatTheyName) {
  json text = study_with({{{"name", "Other"}, {"file", "peer.json"}, {"vary", {{"/contacts/sole/friction", 0.3}}}}});
  text["vary"] = {{"/contacts/sole/friction", {0.1, 0.3}}};
  const auto all = rows(text);
  ASSERT_THAT(all, SizeIs(5));
  EXPECT_EQ(all[4]["vary"], json({{"/contacts/sole/friction", 0.3}}));
  EXPECT_EQ(all[4]["status"], "converged") << all[4]["message"];
  text["solutions"][0]["vary"]["/contacts/sole/friction"] = 0.2;
  EXPECT_THAT(faults(text), HasSubstr("/solutions/0: is of no one variant"));
  text["solutions"][0].erase("vary");
  EXPECT_THAT(faults(text), HasSubstr("/solutions/0: is of no one variant"));
  text["solutions"][0]["vary"] = {{"/contacts/sole/friction", 0.3}, {"/time/end", 1}};
  EXPECT_THAT(faults(text), HasSubstr("/solutions/0: is of no one variant"));
}

TEST_F(PeerSolutions, ThatCannotBeReadAreFaultsOfTheStudy) {
  const json good = {{"name", "Other"}, {"file", "peer.json"}};
  EXPECT_THAT(faults(study_with({good, good})), HasSubstr("/solutions/1/name: is \"Other\", which another"));
  json entry = good;
  entry["name"] = "penalty";
  EXPECT_THAT(faults(study_with(json::array({entry}))), HasSubstr("is the name of a method"));
  entry = good;
  entry["file"] = "none.json";
  EXPECT_THAT(faults(study_with(json::array({entry}))), HasSubstr("none.json: cannot be read"));
  entry["file"] = "scene.json";
  EXPECT_THAT(faults(study_with(json::array({entry}))), HasSubstr(R"(must have "schema": "stickslip_solution")"));
  EXPECT_THAT(faults(study_with(json::object())), HasSubstr("/solutions: is {}; must be a list"));
  for (const std::string key : {"name", "file"}) {
    entry = good;
    entry.erase(key);
    EXPECT_THAT(faults(study_with(json::array({entry}))), HasSubstr("the key \"" + key + "\" is missing"));
  }
}

TEST_F(PeerSolutions, ThatAreNotAsTheyShouldBeAreToldWithTheirPlace) {
  const auto fault_of = [&](const char* pointer, const json& value) {
    json wrong = peer_;
    wrong[json::json_pointer(pointer)] = value;
    write("wrong.json", wrong);
    return faults(study_with({{{"name", "Other"}, {"file", "wrong.json"}}}));
  };
  for (const auto& [pointer, value, words] :
       {std::tuple{"/accuracy", json("good"), "/accuracy: is \"good\"; must be a number >= 0"},
        std::tuple{"/acuracy", json(1e-4), "/acuracy: unknown key \"acuracy\"; did you mean \"accuracy\"?"},
        std::tuple{"/increments/1/time", json("now"), "/increments/1/time: is \"now\"; must be a number"},
        std::tuple{"/nodes/3", json("x"), "/nodes: is "}}) {
    EXPECT_THAT(fault_of(pointer, value), HasSubstr(words));
    EXPECT_THAT(fault_of(pointer, value), HasSubstr("wrong.json:1:"));
  }
}

TEST_F(PeerSolutions, ThatDoNotFitTheMeshAreToldWithTheirPlace) {
  const json own = json::parse(R"({"scene": {}, "mesh": {"nodes": [[0, 0], [1, 0]], "bodies": {}}})");
  const auto pointer_of = [&](const json& solution) {
    try {
      certificate_of_peer(own, solution);
    } catch (const SolutionFault& fault) {
      return fault.pointer;
    }
    return std::string("no fault");
  };
  EXPECT_EQ(pointer_of({{"nodes", {{0, 0}, {1000, 0}}}, {"increments", json::array()}}), "/nodes/1");
  EXPECT_EQ(pointer_of({{"nodes", {{0, 0}, {1, 0}}}, {"increments", {{{"time", 1}, {"displacement", {0, 0, 0}}}}}}),
            "/increments/0/displacement");
}

TEST_F(PeerSolutions, ThatAreNoJsonAreToldWithTheirPlace) {
  std::ofstream(folder_ / "torn.json") << "{\n \"schema\": \"stickslip_solution\",\n \"increments\": [{\"time\": 1,}]";
  try {
    read_solution(folder_ / "torn.json");
    ADD_FAILURE() << "a torn file was read";
  } catch (const InputFault& fault) {
    EXPECT_THAT(fault.what(), HasSubstr("torn.json:3:")) << fault.what();
    EXPECT_THAT(fault.what(), HasSubstr("comma")) << fault.what();
  }
}

}  // namespace
}  // namespace stickslip::peer_solutions
