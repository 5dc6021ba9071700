// press SCENE.json: the first response at the end of the scene, and its derivative by the first parameter.
#include <cstdio>
#include <tuple>

#include "studies/run/simulation.hpp"

int main(int argc, char** argv) {
  stickslip::Diagnostics faults;
  const auto scene = stickslip::prepare(argc > 1 ? argv[1] : "", {}, "monolithic_al", faults);
  if (!scene) return std::fprintf(stderr, "%s", faults.text().c_str()), 2;
  const auto& [responses, parameters] = std::tie(scene->input.scene.responses, scene->input.scene.parameters);
  if (responses.empty() || parameters.empty() ||
      scene->input.scene.sensitivity_mode != stickslip::SensitivityMode::direct)
    return std::fprintf(stderr, "%s: must have a response, a parameter, and derivatives in direct mode\n", argv[1]), 2;
  const auto result = stickslip::simulate(*scene);
  if (!is_converged(result.status())) return std::fprintf(stderr, "%s\n", result.message().c_str()), 3;
  const auto& last = result.steps.back();
  std::printf("%s = %.12g\nd/d%s = %.12g\n", responses[0].name.c_str(), last.responses[0], parameters[0].name.c_str(),
              last.sensitivities(0, 0));
}
