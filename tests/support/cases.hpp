/// Scene documents run as the program runs them: read, checked, solved, differentiated.
#pragma once

#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>

#include "studies/case.hpp"
#include "studies/scene_reader.hpp"

namespace stickslip::cases {

/// What a scene file says, comments dropped.
inline nlohmann::json load(const std::filesystem::path& file) {
  std::ifstream in(file);
  return nlohmann::json::parse(in, nullptr, true, true);
}

/// Reads a document as the file `name` (other files are looked for beside it). Throws with all faults.
inline Input read(const nlohmann::json& document, const std::filesystem::path& name) {
  Diagnostics diagnostics;
  MeshFiles meshes;
  const auto parsed = JsonDocument::parse(document.dump(), name.string(), diagnostics);
  auto input = parsed ? read_scene(*parsed, std::nullopt, diagnostics, meshes) : std::nullopt;
  if (!input) throw std::runtime_error(diagnostics.text());
  return *std::move(input);
}

/// Runs a document with `method` ({"penalty": {...}}) in place of its own.
inline CaseResult run(nlohmann::json document, const nlohmann::json& method, const std::filesystem::path& name) {
  document["method"] = method;
  const Input input = read(document, name);
  std::shared_ptr<Condensation<double>> condensation;
  return run_case(std::make_shared<const Problem>(input.scene), input.method,
                  {input.linear_algebra, input.backend, {}, {}}, condensation);
}

}  // namespace stickslip::cases
