// press SCENE.json: the first response at the end of the scene, and its derivative by the first parameter.
#include <cstdio>

#include "studies/run/simulation.hpp"

int main(int argc, char** argv) {
  stickslip::Diagnostics faults;
  const auto scene = stickslip::prepare(argc > 1 ? argv[1] : "", {}, "monolithic_al", faults);
  if (!scene) return std::fprintf(stderr, "%s", faults.text().c_str()), 2;
  const auto result = stickslip::simulate(*scene);
  if (!is_converged(result.status())) return std::fprintf(stderr, "%s\n", result.message().c_str()), 3;
  const auto& [responses, derivatives] = std::pair(result.steps.back().responses, result.steps.back().sensitivities);
  std::printf("%s = %.12g\nd/d%s = %.12g\n", scene->input.scene.responses[0].name.c_str(), responses[0],
              scene->input.scene.parameters[0].name.c_str(), derivatives(0, 0));
}
