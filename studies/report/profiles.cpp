#include <fmt/format.h>

#include <algorithm>

#include "studies/report/chart_parts.hpp"
#include "studies/report/settings.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

/// Every scene variant with every accuracy that some run reaches there, from a hundredth down to 1e-10.
std::vector<Problem> problems_of(const Study& study, Of of) {
  std::vector<Problem> out;
  for (const auto& variant : study.variants)
    for (const double target : {1e-2, 1e-4, 1e-6, 1e-8, 1e-10})
      if (std::any_of(study.cells.begin(), study.cells.end(), [&](const Cell& cell) {
            return cell.variant == variant && cell.converged && accuracy(cell, of).value_or(1) <= target;
          }))
        out.push_back({variant, target});
  return out;
}

std::string name_of(const Contestant& contestant) {
  return family_name(contestant.family) + ", " + name_of(contestant.setting);
}

/// A staircase over `places` (where one more problem is solved) up to `end`, as rows of a panel.
void add_stairs(Figure& figure, const json& base, std::vector<double> places, std::size_t problems, double begin,
                double end) {
  std::sort(places.begin(), places.end());
  // of many problems every n-th stair stands for those before it, at the height they reach together
  constexpr std::size_t most = 300;
  const std::size_t stride = (places.size() + most - 1) / most;
  double share = 0;
  int order = 0;
  const auto add = [&](double x, double y, bool corner) {
    json r = base;
    r["x"] = x;
    r["share"] = y;
    r["order"] = order++;
    r["unmarked"] = !corner;
    figure.rows.push_back(r);
  };
  add(begin, 0, false);
  for (std::size_t i = 0; i < places.size(); ++i) {
    if ((places.size() - 1 - i) % stride != 0) continue;
    add(places[i], share, false);
    share = static_cast<double>(i + 1) / static_cast<double>(problems);
    add(places[i], share, i + 1 == places.size() || places[i + 1] > places[i]);
  }
  add(end, share, false);
}

/// Works of one contestant, and how many times the least each is.
struct Solved {
  std::vector<double> work, factor;
};

std::vector<Solved> solve_all(const std::vector<Contestant>& all, const std::vector<Problem>& problems, Of of) {
  std::vector<Solved> out(all.size());
  for (std::size_t i = 0; i < problems.size(); ++i) {
    double least = INFINITY;
    for (const auto& each : all) least = std::min(least, each.work(i, problems, of).value_or(INFINITY));
    for (std::size_t c = 0; c < all.size(); ++c)
      if (const auto work = all[c].work(i, problems, of); work && *work > 0) {
        out[c].work.push_back(*work);
        out[c].factor.push_back(*work / least);
      }
  }
  return out;
}

void describe(Figure& figure, const Study& study, Of of, std::size_t problems) {
  const bool derivative = of == Of::sensitivities;
  figure.id = derivative ? "profiles-sensitivities" : "profiles";
  figure.title =
      derivative ? "Profiles: sensitivities solved for a given work" : "Profiles: problems solved for a given work";
  figure.text = fmt::format(
      "{} problems: each of the {} scenes with each accuracy asked for, from 0.01 down to 1e-10, that some run reaches "
      "there. The first chart shows the share of them that a method solves within a factor of the least work any of "
      "the methods needs (Dolan and More's performance profile): left is fast, high is dependable. The second shows "
      "the "
      "share solved with a given work (data profile). A line that stays below 1 has lost the rest: runs that failed or "
      "missed the accuracy. Default: no option given. Tuned: the cheapest of the settings tried for each problem, as "
      "one knows it only afterwards. Strict: the most accurate setting of each scene.",
      problems, study.variants.size());
}

}  // namespace

std::optional<Figure> profiles(const Study& study, Of of) {
  const auto problems = problems_of(study, of);
  const auto all = contestants(study, problems, of);
  if (study.variants.size() < 2 || all.size() < 2) return std::nullopt;
  Figure figure;
  describe(figure, study, of, problems.size());
  const auto solved = solve_all(all, problems, of);
  double largest_factor = 1, least = INFINITY, largest = 0;
  for (const auto& each : solved) {
    for (const double factor : each.factor) largest_factor = std::max(largest_factor, factor);
    for (const double work : each.work) {
      least = std::min(least, work);
      largest = std::max(largest, work);
    }
  }
  if (largest == 0) return std::nullopt;
  SeriesList series(study);
  for (std::size_t c = 0; c < all.size(); ++c) {
    const std::string name = name_of(all[c]);
    series.add(name, all[c].family);
    json base = {{"series", name}, {"line", name}, {"family", all[c].family}, {"failed", false}};
    base["panel"] = "factor";
    add_stairs(figure, base, solved[c].factor, problems.size(), 1, 1.3 * largest_factor);
    base["panel"] = "work";
    add_stairs(figure, base, solved[c].work, problems.size(), least / 1.3, 1.3 * largest);
  }
  figure.series = series.list;
  const auto add = [&](const std::string& panel, const std::string& title, const Quantity& x) {
    figure.charts.push_back({.title = title,
                             .x = x,
                             .y = {"share", "share of the problems solved"},
                             .tooltip = {{"series", "method"}, {"x", x.title}, {"share", "share solved"}},
                             .only = panel});
  };
  add("factor", "performance profile",
      {.field = "x",
       .title = "work over the least work for the problem",
       .spacing = Spacing::logarithmic,
       .bounded = true});  // nothing takes less than the least work
  add("work", "data profile", {"x", "work (factorisations and weighted back-solves)", Spacing::logarithmic});
  const bool of_meshes = std::all_of(study.cells.begin(), study.cells.end(), [](auto& c) { return c.scene.empty(); });
  if (of_meshes)
    figure.folded = "of the meshes of one scene alone";
  else if (study.variants.size() < 3)
    figure.folded = "of two scenes alone";
  return figure;
}

}  // namespace stickslip::report
