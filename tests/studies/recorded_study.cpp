#include "tests/studies/recorded_study.hpp"

#include <fstream>

#include "studies/io/atomic_file.hpp"
#include "studies/report/report.hpp"

namespace stickslip::recorded {

json cell(const std::string& family, const json& knobs, double error, int factorizations) {
  static int made = 0;
  std::string label = family;
  for (const auto& [name, value] : knobs.items()) label += " " + name + "=" + value.dump();
  const json history = json::array({{{"residual", 1.0}, {"changed", 3}}, {{"residual", 1e-4}}, {{"residual", 0.0}}});
  const json face = {{"x", {-1, 0, 1}},
                     {"y", {0, 0, 0}},
                     {"arc", {0, 1, 2}},
                     {"gap", {0.1, 0, 0}},
                     {"slip", {0, 0, 0.01}},
                     {"normal", {0, -2.0 - error, -1}},
                     {"state", {"open", "stick", "slip"}},
                     {"tangential", {0, 0.1, 0.3}}};
  return {{"id", "cell-" + std::to_string(++made)},
          {"label", label},
          {"method", {{family, knobs}}},
          {"knobs", knobs},
          {"vary", json::object()},
          {"refine", 0},
          {"status", "converged"},
          {"message", ""},
          {"errors",
           {{"enforcement", {{"response:press", error}, {"sensitivity:press/E", 2 * error}}},
            {"discretization", {{"response:press", 0.01 + error}}},
            {"kkt", {{"gap", error}}}}},
          {"responses", {{"press", 9.9}}},
          {"sensitivities", {{"press", {{"E", 0.1}}}}},
          {"steps", json::array({{{"time", 1}, {"status", "converged"}, {"newton", 3}, {"history", history}}})},
          {"interface", {{"sole", face}}},
          {"cost",
           {{"counts",
             {{"factorizations", factorizations},
              {"backsolves", 2 * factorizations},
              {"sensitivity_backsolves", 1},
              {"sensitivity_factorizations", 0},
              {"newton", factorizations}}},
            // One back-solve costs 0.1 factorisations: (0.2 s / 2 n) / (1 s / n).
            {"seconds",
             {{"total", 2.0 * factorizations},
              {"factorization", 1.0 * factorizations},
              {"backsolve", 0.2 * factorizations},
              {"sensitivity", 0.1}}}}},
          {"provenance", {{"git", "abc"}, {"cpu", "a processor"}, {"libraries", {{"solver", "1.2"}}}}}};
}

std::vector<json> three_methods() {
  std::vector<json> cells;
  for (const double stiffness : {1e3, 1e5, 1e7, 1e9})
    cells.push_back(cell("penalty", {{"stiffness", stiffness}}, 1 / stiffness, stiffness < 1e9 ? 14 : 18));
  cells.push_back(cell("uzawa_al", {{"tolerance", 1e-4}}, 1e-5, 20));
  cells.push_back(cell("uzawa_al", {{"tolerance", 1e-8}}, 1e-9, 40));
  cells.push_back(cell("monolithic_al", json::object(), 0, 10));
  return cells;
}

std::vector<json> with_failure() {
  auto cells = three_methods();
  cells[0]["default"] = true;
  cells[2]["status"] = "not_finite";
  return cells;
}

std::vector<json> in_two_scenes(std::vector<json> cells) {
  auto all = cells;
  for (auto& c : cells) {
    c["id"] = c["id"].get<std::string>() + "-again";
    c["vary"] = {{"/contacts/sole/friction", 0.3}};
    all.push_back(c);
  }
  return all;
}

json description() {
  return {{"title", "a study"},
          {"command", "stickslip study a.json -o out"},
          {"scene_title", "a scene"},
          {"explain", "No inertia."}};
}

json picture() {
  return {{"points", {{0, 0}, {1, 0}, {2, 0}, {0, 1}, {1, 1}, {2, 1}}},
          {"elements", {{0, 1, 4, 3}, {1, 2, 5, 4}}},
          {"displacement", {{0, 0}, {0, 0}, {0, 0}, {0, 0.1}, {0, 0.1}, {0, 0.1}}},
          {"von_mises", {1.0, 2.0}},
          {"contact",
           {{{"name", "sole"}, {"x", 0}, {"y", 0}, {"state", "stick"}, {"normal", -1}, {"tangential", 0}},
            {{"name", "sole"}, {"x", 2}, {"y", 0}, {"state", "slip"}, {"normal", -1}, {"tangential", 0}}}},
          {"obstacles", {{{"plane", {{"point", {0, 0}}, {"normal", {0, 1}}}}}}},
          {"bodies", {0, 0}},
          {"body_names", {"block"}}};
}

void StudyOnDisk::record(const json& study, const std::vector<json>& cells, const json& picture) {
  std::ofstream(directory_ / "study.json") << study.dump();
  if (!picture.is_null()) std::ofstream(directory_ / "picture.json") << picture.dump();
  std::ofstream results(directory_ / "results.jsonl");
  for (const auto& line : cells) results << line.dump() << '\n';
}

std::string StudyOnDisk::page() {
  write_report(directory_);
  return read_file(directory_ / "report.html");
}

report::Study StudyOnDisk::study() { return report::read_study(directory_); }

}  // namespace stickslip::recorded
