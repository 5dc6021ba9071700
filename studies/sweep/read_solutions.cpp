#include <algorithm>
#include <filesystem>
#include <set>

#include "studies/input/method_options.hpp"
#include "studies/io/input_fault.hpp"
#include "studies/run/certificate.hpp"
#include "studies/sweep/study_reading.hpp"

namespace stickslip {
namespace {

using nlohmann::json;

/// A name that a curve can have: not empty, no method's, and no other's.
std::optional<std::string> read_name(const JsonNode& node, std::set<std::string>& names) {
  const auto name = node.text();
  if (!name) return std::nullopt;
  const auto methods = method_names();
  if (name->empty())
    node.must_be("a name, as of the program");
  else if (std::ranges::count(methods, *name) > 0)
    node.error("is the name of a method; must be another");
  else if (!names.insert(*name).second)
    node.error("is " + shown(node.value()) + ", which another solution has already");
  else
    return name;
  return std::nullopt;
}

std::optional<json> read_beside(const JsonNode& node, const std::string& study) {
  const auto name = node.text();
  if (!name) return std::nullopt;
  try {
    const auto path = (std::filesystem::path(study).parent_path() / *name).lexically_normal();
    return read_solution(path);
  } catch (const InputFault& fault) {
    node.error(fault.what());
    return std::nullopt;
  }
}

}  // namespace

std::vector<std::shared_ptr<const PeerSolution>> read_solutions(const JsonNode& list, const std::string& file) {
  std::vector<std::shared_ptr<const PeerSolution>> solutions;
  std::set<std::string> names;
  if (!list.value().is_array()) {
    list.must_be(R"(a list, as in [{"name": "GetFEM", "file": "getfem.json"}])");
    return solutions;
  }
  for (const JsonNode& node : list.elements()) {
    if (!node.is_object(keys_of(study_object("solution")))) continue;
    const auto called = node.find("name"), beside = node.find("file");
    if (!called || !beside) continue;
    PeerSolution one;
    one.place = node.place();
    const auto name = read_name(*called, names);
    auto solution = read_beside(*beside, file);
    if (!name || !solution) continue;
    one.solution = *std::move(solution);
    one.name = *name;
    one.file = beside->value().get<std::string>();
    if (const auto vary = node.find("vary"); vary && vary->is_map("values by JSON pointer of the scene"))
      for (const auto& [pointer, value] : vary->members()) one.vary[pointer] = value.value();
    if (const auto scene = node.find("scene")) one.scene = scene->text();
    if (const auto refine = node.find("refine")) one.refine = refine->count(0, finest_level);
    solutions.push_back(std::make_shared<const PeerSolution>(std::move(one)));
  }
  return solutions;
}

}  // namespace stickslip
