#include "studies/run/certificate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "studies/io/input_fault.hpp"
#include "studies/io/json_document.hpp"
#include "studies/io/json_pointer.hpp"
#include "studies/io/wording.hpp"

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

bool are_numbers(const json& list) {
  return list.is_array() && std::all_of(list.begin(), list.end(), [](const json& each) { return each.is_number(); });
}
bool are_indices(const json& list) {
  return list.is_array() &&
         std::all_of(list.begin(), list.end(), [](const json& each) { return each.is_number_unsigned(); });
}

/// Throws SolutionFault if a key that is there, or must be, has not the kind of value that docs/verify.md says.
void check_value(const json& object, const std::string& pointer, const char* key, bool required, const char* kind,
                 const auto& is_kind) {
  if (!object.contains(key)) {
    if (required) throw SolutionFault(pointer, "the key " + in_quotes(key) + " is missing: " + kind);
    return;
  }
  if (!is_kind(object.at(key)))
    throw SolutionFault(child_pointer(pointer, key), "is " + shown(object.at(key)) + "; must be " + kind);
}

void check_contact(const json& contact, const std::string& pointer) {
  if (!contact.is_object()) throw SolutionFault(pointer, "is " + shown(contact) + R"(; must be {"nodes", "traction"})");
  check_value(contact, pointer, "nodes", true, "a list of nodes, whole numbers from 0", are_indices);
  check_value(contact, pointer, "traction", true, "a list of numbers, of each node by axis", are_numbers);
}

void check_increment(const json& increment, const std::string& pointer) {
  if (!increment.is_object()) throw SolutionFault(pointer, "is " + shown(increment) + "; must be an object");
  check_value(increment, pointer, "time", true, "a number", [](const json& time) { return time.is_number(); });
  check_value(increment, pointer, "displacement", true, "a list of numbers, of each node by axis", are_numbers);
  const auto is_object = [](const json& value) { return value.is_object(); };
  check_value(increment, pointer, "contacts", false, R"(an object, {"NAME": {"nodes", "traction"}})", is_object);
  const json contacts = increment.value("contacts", json::object());
  for (const auto& [name, contact] : contacts.items())
    check_contact(contact, child_pointer(pointer + "/contacts", name));
}

/// Throws SolutionFault at the first value that is not as docs/verify.md says.
void check_solution(const json& solution) {
  if (!solution.is_object() || solution.value("schema", json()) != "stickslip_solution" ||
      solution.value("version", json()) != 1)
    throw SolutionFault("", R"(must have "schema": "stickslip_solution" and "version": 1)");
  static const std::vector<std::string> known = {"schema",     "version", "scene",    "mesh",
                                                 "increments", "nodes",   "accuracy", "bodies"};
  for (const auto& [key, unused] : solution.items())
    if (std::ranges::find(known, key) == known.end())
      throw SolutionFault(child_pointer("", key), "unknown key " + in_quotes(key) + ";" + suggestion(key, known) +
                                                      " allowed: " + listed(known));
  const auto are_places = [](const json& nodes) {
    return nodes.is_array() && std::all_of(nodes.begin(), nodes.end(), are_numbers);
  };
  const auto by_name = [](const json& bodies) {
    return bodies.is_object() && std::all_of(bodies.begin(), bodies.end(), are_indices);
  };
  const auto is_share = [](const json& value) { return value.is_number() && value.get<double>() >= 0; };
  check_value(solution, "", "increments", true, "a list of increments", [](const json& v) { return v.is_array(); });
  check_value(solution, "", "nodes", false, "a list of coordinates, [[x, y], ...]", are_places);
  check_value(solution, "", "bodies", false, R"({"NAME": [nodes]}, nodes whole numbers from 0)", by_name);
  check_value(solution, "", "accuracy", false, "a number >= 0", is_share);
  for (std::size_t n = 0; n < solution["increments"].size(); ++n)
    check_increment(solution["increments"][n], "/increments/" + std::to_string(n));
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
    const json bodies = solution.value("bodies", json::object());
    for (const auto& [name, nodes] : bodies.items())
      for (const int node : nodes) given_body_[node] = name;
    const auto places = coordinates_of(solution.at("nodes"));
    for (std::size_t n = 0; n < places.size(); ++n) match_.push_back(find(places[n], static_cast<int>(n)));
  }
  int operator[](int node) const { return match_.at(node); }
  std::size_t size() const { return match_.size(); }

 private:
  int find(const std::vector<double>& place, int n) const {
    const auto body = given_body_.find(n);
    const std::string pointer = "/nodes/" + std::to_string(n);
    int found = -1;
    for (std::size_t m = 0; m < nodes_.size(); ++m) {
      if (place.size() != nodes_[m].size())
        throw SolutionFault(pointer, fmt::format("node {} of the solution has {} coordinates, those of the mesh {}", n,
                                                 place.size(), nodes_[m].size()));
      bool apart = false;
      for (std::size_t i = 0; i < place.size(); ++i) apart |= !(std::abs(nodes_[m][i] - place[i]) <= near_);
      if (apart || (body != given_body_.end() && body->second != body_of_.at(static_cast<int>(m)))) continue;
      if (found >= 0)
        throw SolutionFault(
            pointer,
            fmt::format("node {} of the solution is where several nodes are; \"bodies\" must name its body", n));
      found = static_cast<int>(m);
    }
    if (found < 0)
      throw SolutionFault(pointer,
                          fmt::format("node {} of the solution is at ({}), where the mesh has none; places agree to "
                                      "1e-6 of the largest coordinate, in the units of the scene",
                                      n, fmt::join(place, ", ")));
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
  for (std::size_t k = 0; k < solution.at("increments").size(); ++k) {
    json& increment = solution["increments"][k];
    const json given = increment.at("displacement");
    if (given.size() != match.size() * dimension)
      throw SolutionFault(fmt::format("/increments/{}/displacement", k),
                          fmt::format("has {} numbers; must have {}: {} nodes by {} axes", given.size(),
                                      match.size() * dimension, match.size(), dimension));
    json& own = increment["displacement"] = std::vector<double>(mesh.at("nodes").size() * dimension, NAN);
    for (std::size_t n = 0; n < match.size(); ++n)
      for (std::size_t i = 0; i < dimension; ++i)
        own[match[static_cast<int>(n)] * dimension + i] = given[n * dimension + i];
    if (increment.contains("contacts"))
      for (auto& [name, contact] : increment["contacts"].items())
        for (auto& node : contact.at("nodes")) node = match[node.get<int>()];
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
  try {
    check_solution(solution);
  } catch (const SolutionFault& fault) {
    throw InputFault(in_file(file, fault));
  }
  return solution;
}

std::string in_file(const fs::path& file, const SolutionFault& fault) {
  Diagnostics none;
  const auto document = JsonDocument::read(file.string(), none);
  return Diagnostic{document ? document->place(fault.pointer) : Place{file.string()}, "", fault.what()}.text();
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
    if (!result.contains("solution"))
      throw InputFault((directory / "solution.json").string() +
                       ": is not there, as of results of earlier versions; run the scene again");
    const json left_out = result.value("solution", json::object()).value("left_out", json());
    if (left_out.is_string())
      throw InputFault((directory / "solution.json").string() + ": was left out: " + left_out.get<std::string>());
    const json own = read_solution(directory / "solution.json");
    if (solution.empty()) return verify::certify(own.at("scene"), own.at("mesh"), own, result);
    const json peer = read_solution(solution);
    try {
      return certificate_of_peer(own, peer);
    } catch (const SolutionFault& fault) {
      throw InputFault(in_file(solution, fault));
    } catch (const InputFault& fault) {
      throw InputFault(solution + ": " + fault.what());
    }
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
