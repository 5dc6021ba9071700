#include "studies/run/certificate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "studies/io/input_fault.hpp"
#include "studies/io/json_document.hpp"

namespace stickslip {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

json parsed_file(const fs::path& file) {
  std::ifstream stream(file);
  if (!stream) throw InputFault(file.string() + ": cannot be read");
  try {
    return json::parse(stream);
  } catch (const json::exception& fault) {
    Diagnostics located;
    JsonDocument::read(file.string(), located);
    throw InputFault(located.has_errors() ? located.text() : file.string() + ": " + fault.what());
  }
}

/// Coordinates of nodes, [[x, y], ...] or with z.
std::vector<std::vector<double>> coordinates_of(const json& nodes) { return nodes; }

/// The node of the mesh for each node of another program: by its place, and by its body where several nodes share one.
class NodeMatch {
 public:
  NodeMatch(const json& mesh, const json& solution) : nodes_(coordinates_of(mesh.at("nodes"))) {
    for (const auto& node : nodes_)
      for (const double x : node) near_ = std::max(near_, same_place * std::abs(x));
    for (const auto& [name, body] : mesh.at("bodies").items())
      for (const auto& element : body.at("elements"))
        for (const int node : element) body_of_[node] = name;
    for (const auto& [name, nodes] : solution.value("bodies", json::object()).items())
      for (const int node : nodes) given_body_[node] = name;
    const auto places = coordinates_of(solution.at("nodes"));
    for (std::size_t n = 0; n < places.size(); ++n) match_.push_back(find(places[n], static_cast<int>(n)));
  }
  int operator[](int node) const { return match_.at(node); }
  std::size_t size() const { return match_.size(); }

 private:
  int find(const std::vector<double>& place, int n) const {
    const auto body = given_body_.find(n);
    int found = -1;
    for (std::size_t m = 0; m < nodes_.size(); ++m) {
      if (place.size() != nodes_[m].size())
        throw InputFault(fmt::format("node {} of the solution has {} coordinates, those of the mesh {}", n,
                                     place.size(), nodes_[m].size()));
      bool apart = false;
      for (std::size_t i = 0; i < place.size(); ++i) apart |= !(std::abs(nodes_[m][i] - place[i]) <= near_);
      if (apart || (body != given_body_.end() && body->second != body_of_.at(static_cast<int>(m)))) continue;
      if (found >= 0)
        throw InputFault(
            fmt::format("node {} of the solution is where several nodes are; \"bodies\" must name its body", n));
      found = static_cast<int>(m);
    }
    if (found < 0) throw InputFault(fmt::format("node {} of the solution is where the mesh has none", n));
    return found;
  }

  static constexpr double same_place = 1e-6;  ///< of the largest coordinate: files have six digits and more
  std::vector<std::vector<double>> nodes_;
  double near_ = 0;  ///< length
  std::map<int, std::string> body_of_, given_body_;
  std::vector<int> match_;
};

/// A solution with the nodes of the mesh in place of its own.
void renumber(const json& mesh, json& solution) {
  if (!solution.contains("nodes")) return;
  const NodeMatch match(mesh, solution);
  const std::size_t dimension = mesh.at("nodes").at(0).size();
  for (auto& increment : solution.at("increments")) {
    const json given = increment.at("displacement");
    if (given.size() != match.size() * dimension) throw InputFault("a displacement has not as many numbers as nodes");
    json& own = increment["displacement"] = std::vector<double>(mesh.at("nodes").size() * dimension, NAN);
    for (std::size_t n = 0; n < match.size(); ++n)
      for (std::size_t i = 0; i < dimension; ++i)
        own[match[static_cast<int>(n)] * dimension + i] = given[n * dimension + i];
    for (auto& [name, contact] : increment.value("contacts", json::object()).items())
      for (auto& node : increment["contacts"][name].at("nodes")) node = match[node.get<int>()];
  }
}

/// What `certify` gives; what is thrown of files that do not fit becomes an InputFault.
template <class Certify>
verify::Certificate of_files(const std::string& name, Certify&& certify) {
  const std::string before = name.empty() ? "" : name + ": ";
  try {
    return certify();
  } catch (const verify::BadFile& fault) {
    throw InputFault(before + fault.what());
  } catch (const json::exception& fault) {
    throw InputFault(before + "is not as docs/verify.md says: " + fault.what());
  }
}

}  // namespace

json read_solution(const fs::path& file) {
  json solution = parsed_file(file);
  if (!solution.is_object() || solution.value("schema", "") != "stickslip_solution" ||
      solution.value("version", 0) != 1)
    throw InputFault(file.string() + R"(: must have "schema": "stickslip_solution" and "version": 1)");
  return solution;
}

verify::Certificate certificate_of_peer(const json& own, json solution) {
  return of_files("", [&] {
    renumber(own.at("mesh"), solution);
    auto certificate = verify::certify(own.at("scene"), own.at("mesh"), solution, json::object());
    const double accuracy = solution.value("accuracy", 0.0);
    for (auto& step : certificate.steps)
      for (auto& finding : step.findings)
        if (finding.allowed > 0 && finding.allowed < accuracy) {
          finding.allowed = accuracy;
          finding.why = "the accuracy that the solution claims";
        }
    return certificate;
  });
}

verify::Certificate certificate_of(const fs::path& directory, const std::string& solution) {
  return of_files(directory.string(), [&] {
    const json result = parsed_file(directory / "result.json");
    const json left_out = result.value("solution", json::object()).value("left_out", json());
    if (left_out.is_string())
      throw InputFault((directory / "solution.json").string() + ": was left out: " + left_out.get<std::string>());
    const json own = read_solution(directory / "solution.json");
    return solution.empty() ? verify::certify(own.at("scene"), own.at("mesh"), own, result)
                            : certificate_of_peer(own, read_solution(solution));
  });
}

json worst_of_certificate_json(const verify::Certificate& certificate) {
  const auto share = [](const verify::Step& step) { return step.worst().share(); };
  const auto& step = *std::ranges::max_element(certificate.steps, {}, share);
  const auto& worst = step.worst();
  return {{"holds", certificate.holds()},
          {"law", worst.law},
          {"time", step.time},
          {"value", std::isfinite(worst.value) ? json(worst.value) : json(nullptr)},
          {"allowed", worst.allowed},
          {"where", worst.where}};
}

json certificate_json(const verify::Certificate& certificate) {
  json steps = json::array();
  for (const auto& step : certificate.steps) {
    json laws = json::object();
    for (const auto& [law, where, value, allowed, why] : step.findings)
      laws[law] = {{"value", std::isfinite(value) ? json(value) : json(nullptr)},
                   {"allowed", allowed},
                   {"where", where},
                   {"why", why},
                   {"holds", value <= allowed}};
    steps.push_back({{"time", step.time}, {"holds", step.holds()}, {"laws", laws}});
  }
  return {{"holds", certificate.holds()}, {"remarks", certificate.remarks}, {"steps", steps}};
}

}  // namespace stickslip
