#include "tests/studies/cases.hpp"

#include <algorithm>
#include <fstream>
#include <memory>
#include <optional>
#include <stdexcept>

namespace stickslip::cases {

nlohmann::json load(const std::filesystem::path& file) {
  std::ifstream in(file);
  return nlohmann::json::parse(in, nullptr, true, true);
}

Input read(const nlohmann::json& document, const std::filesystem::path& name) {
  Diagnostics diagnostics;
  MeshFiles meshes;
  const auto parsed = JsonDocument::parse(document.dump(), name.string(), diagnostics);
  auto input = parsed ? read_scene(*parsed, std::nullopt, diagnostics, meshes) : std::nullopt;
  if (!input) throw std::runtime_error(diagnostics.text());
  return *std::move(input);
}

CaseResult run(nlohmann::json document, const nlohmann::json& method, const std::filesystem::path& name) {
  document["method"] = method;
  const Input input = read(document, name);
  std::shared_ptr<Condensation<double>> condensation;
  return run_case(std::make_shared<const Problem>(input.scene), input.method, {input.linear_algebra, input.backend},
                  condensation);
}

std::vector<nlohmann::json> scales_of(const nlohmann::json& scene) {
  const auto is_faceted = [](const nlohmann::json& contact) {
    return !contact.contains("surface") || contact["surface"] == "faceted";
  };
  const auto& contacts = scene["contacts"];
  const bool finite = scene.value("strain", "small") == "finite";
  if (finite && std::any_of(contacts.begin(), contacts.end(), is_faceted)) return {1e-2, "auto"};
  return {1e-2, "auto", 1e2};
}

}  // namespace stickslip::cases
