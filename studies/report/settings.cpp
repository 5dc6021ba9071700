#include "studies/report/settings.hpp"

#include <algorithm>
#include <cmath>

#include "studies/report/look_up.hpp"

namespace stickslip::report {
namespace {

bool solves(const Cell& cell, double target, Of of) {
  const auto error = accuracy(cell, of);
  return cell.converged && error && *error <= target;
}

/// The run of a family in a variant that stands for a setting; nullptr where there is none.
const Cell* stand_in(const Study& study, const std::string& family, Contestant::Setting setting, const Problem& problem,
                     Of of) {
  using Setting = Contestant::Setting;
  const auto error = [&](const Cell& cell) {
    return cell.converged ? accuracy(cell, of).value_or(INFINITY) : INFINITY;
  };
  const auto better = [&](const Cell& a, const Cell& b) {
    if (setting == Setting::tuned && solves(a, problem.target, of) != solves(b, problem.target, of))
      return solves(a, problem.target, of);
    if (setting == Setting::tuned && solves(a, problem.target, of)) return work_of(a, of) < work_of(b, of);
    return error(a) < error(b) || (error(a) == error(b) && work_of(a, of) < work_of(b, of));
  };
  const Cell* best = nullptr;
  for (const auto& cell : study.cells) {
    if (cell.family != family || cell.variant != problem.variant) continue;
    if (setting == Setting::standard && at(cell.record, "default") != true) continue;
    if (!best || better(cell, *best)) best = &cell;
  }
  return best;
}

}  // namespace

std::optional<double> accuracy(const Cell& cell, Of of) {
  return worst(cell.enforcement, of == Of::sensitivities ? "sensitivity:" : "response:");
}

double work_of(const Cell& cell, Of of) { return of == Of::responses ? cell.work : cell.sensitivity_work; }

bool tells_apart(const Study& study, Of of) {
  constexpr double rounding = 1e-9;
  return std::any_of(study.cells.begin(), study.cells.end(), [&](const Cell& cell) {
    return cell.variant == study.main_variant && cell.converged && accuracy(cell, of).value_or(0) > rounding;
  });
}

std::optional<double> own_error(const Study& study, Of of) {
  const Cell* best = nullptr;
  for (const auto& cell : study.cells)
    if (cell.variant == study.main_variant && cell.converged && accuracy(cell, of))
      if (!best || *accuracy(cell, of) < *accuracy(*best, of)) best = &cell;
  return best ? worst(best->discretization, of == Of::sensitivities ? "sensitivity:" : "response:") : std::nullopt;
}

std::optional<double> target_error(const Study& study, Of of) {
  std::optional<double> least;
  for (const auto& cell : study.cells)
    if (const auto error = accuracy(cell, of); error && cell.converged)
      least = std::min(least.value_or(*error), *error);
  if (!least) return std::nullopt;
  return *least <= 1e-6 ? 1e-6 : std::pow(10, std::ceil(std::log10(*least)));
}

std::optional<double> Contestant::work(std::size_t i, const std::vector<Problem>& problems, Of of) const {
  if (!cells[i] || !solves(*cells[i], problems[i].target, of)) return std::nullopt;
  return work_of(*cells[i], of);
}

std::string name_of(Contestant::Setting setting) {
  using Setting = Contestant::Setting;
  return setting == Setting::standard ? "default" : setting == Setting::tuned ? "tuned" : "strict";
}

std::vector<Contestant> contestants(const Study& study, const std::vector<Problem>& problems, Of of) {
  using Setting = Contestant::Setting;
  std::vector<Contestant> out;
  for (const auto& family : study.families)
    for (const auto setting : {Setting::standard, Setting::tuned, Setting::strict}) {
      Contestant contestant{family, setting, {}};
      for (const auto& problem : problems) contestant.cells.push_back(stand_in(study, family, setting, problem, of));
      if (std::any_of(contestant.cells.begin(), contestant.cells.end(), [](const Cell* cell) { return cell; }))
        out.push_back(std::move(contestant));
    }
  return out;
}

}  // namespace stickslip::report
