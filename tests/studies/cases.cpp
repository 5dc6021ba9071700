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

nlohmann::json block_on_a_slab(int cells, double soft) {
  const auto body = [](double modulus, const nlohmann::json& min, const nlohmann::json& max, int across) {
    return nlohmann::json{{"mesh", {{"box", {{"min", min}, {"max", max}, {"cells", {across, 1}}}}}},
                          {"material", {{"linear_elastic", {{"E", modulus}, {"nu", 0.3}}}}}};
  };
  return {{"bodies", {{"block", body(1000, {0.5, 1}, {1.5, 1.5}, cells)}, {"slab", body(soft, {0, 0}, {1.5, 1}, 1)}}},
          {"contacts", {{"t", {{"slave", "block.bottom"}, {"master", "slab.top"}, {"friction", 0.3}}}}},
          {"supports",
           {{{"on", "slab.bottom"}, {"move", {{"x", 0}, {"y", 0}}}},
            {{"on", "block.top"}, {"move", {{"x", {{0, 0}, {1, 1e-6}}}, {"y", {{0, 0}, {1, -0.02}}}}}}}},
          {"time", {{"end", 1}, {"steps", 1}}},
          {"responses", {{"Fx", {{"reaction", {{"on", "block.top"}, {"component", "x"}}}}}}}};
}

}  // namespace stickslip::cases
