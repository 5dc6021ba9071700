#include "studies/report/headline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "studies/io/wording.hpp"
#include "studies/report/disagreement.hpp"
#include "studies/report/html.hpp"
#include "studies/report/look_up.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

/// " for VARIANT"; "" where nothing is varied.
std::string for_variant(const std::string& variant) { return variant.empty() ? "" : " for " + variant; }

/// Where penalty fails, by variant: "It fails at 1e8 (cap) and 1e10 (singular) for friction = 0.3."
std::string penalty_failures(const Study& study) {
  std::string out;
  for (const auto& variant : study.variants) {
    std::string places;
    for (const auto& cell : study.cells) {
      const Knob* knob = find_knob(cell, "stiffness");
      if (cell.family != "penalty" || cell.variant != variant || cell.converged || !knob) continue;
      places += fmt::format("{}{} ({})", places.empty() ? "" : " and ", knob->value ? number(*knob->value) : knob->text,
                            cell.status);
    }
    if (!places.empty()) out += (out.empty() ? " It fails at " : ", at ") + places + for_variant(variant);
  }
  return out.empty() ? out : out + ".";
}

/// How penalty's error follows its stiffness up to the smallest error, where rounding takes over, and where it fails.
std::string penalty_sentence(const Study& study) {
  std::vector<std::pair<double, double>> points;
  for (const Cell* cell : main_cells(study))
    if (const Knob* knob = find_knob(*cell, "stiffness"); cell->family == "penalty" && cell->converged && knob)
      if (const auto error = worst(cell->enforcement, "response:"); error && *error > 0 && knob->value.value_or(0) > 0)
        points.emplace_back(*knob->value, *error);
  std::sort(points.begin(), points.end());
  const auto least =
      std::min_element(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  if (points.size() < 3 || least - points.begin() < 2) return {};
  // The median slope between neighbours: neither the soft end, where the bodies pass through each other, nor the first
  // rounding near the least error sways it.
  std::vector<double> slopes;
  for (auto p = points.begin(); p != least; ++p)
    if ((p + 1)->first > p->first)
      slopes.push_back(std::log((p + 1)->second / p->second) / std::log((p + 1)->first / p->first));
  if (slopes.empty()) return {};
  std::nth_element(slopes.begin(), slopes.begin() + static_cast<long>(slopes.size() / 2), slopes.end());
  std::string out = fmt::format("Penalty's error{} falls as stiffness to the power {} down to {} at stiffness {}",
                                for_variant(study.main_variant), number(slopes[slopes.size() / 2], 2),
                                number(least->second, 2), number(least->first, 3));
  if (least + 1 != points.end())
    out += fmt::format(", and rises again beyond it, to {} at {}", number(points.back().second, 2),
                       number(points.back().first, 3));
  return out + "." + penalty_failures(study);
}

/// "the mesh", "mesh and steps", "mesh, steps or the references themselves".
std::string in_words(const std::vector<std::string>& errs) {
  if (errs.size() == 1) return "the " + errs.front();
  std::string out = errs.front();
  for (std::size_t i = 1; i + 1 < errs.size(); ++i) out += ", " + errs[i];
  return out + (errs.back() == "references" ? " or the references themselves" : " and " + errs.back());
}

std::string mesh_sentence(const Study& study) {
  std::optional<double> best_mesh, best_method;
  for (const Cell* cell : main_cells(study)) {
    if (!cell->converged) continue;
    if (const auto error = worst(cell->discretization, "response:"))
      best_mesh = std::min(best_mesh.value_or(*error), *error);
    if (const auto error = accuracy(*cell, Of::responses)) best_method = std::min(best_method.value_or(*error), *error);
  }
  const auto own = own_error(study, Of::responses), error = own ? own : best_mesh;
  if (!error) return {};
  std::string out = fmt::format("Against {} the {} is off by {} in its worst response", discretization_reference(study),
                                own ? "run that enforces contact best" : "best run", percent(*error));
  if (*error <= rounding_error) return out + ", which is rounding.";
  if (*error <= digits_of_given_values && discretization_reference(study) == "the given values")
    return out + ", which is within the digits that are given.";
  if (own && *best_method < *own)
    out += fmt::format(": that is {}, and enforcing contact more strictly does not bring the answer nearer to it",
                       in_words(what_else_errs(study)));
  return out + ".";
}

/// Whether a run of a family converged in a variant; of a family without runs there, too.
bool converges_in(const Study& study, const std::string& family, const std::string& variant) {
  bool ran = false;
  for (const auto& cell : study.cells) {
    if (cell.family != family || cell.variant != variant) continue;
    if (cell.converged) return true;
    ran = true;
  }
  return !ran;
}

/// "a", "a and b", "a, b and c"; of more than four "a, b, c and 4 others".
std::string listed(std::vector<std::string> names) {
  constexpr std::size_t most = 4;
  if (names.size() > most) names = {names[0], names[1], names[2], fmt::format("{} others", names.size() - 3)};
  std::string out = names.front();
  for (std::size_t i = 1; i < names.size(); ++i) out += (i + 1 == names.size() ? " and " : ", ") + names[i];
  return out;
}

/// "At friction = 0.4 only Monolithic AL converged." of the variants in which some method never did.
std::string lost_methods(const Study& study) {
  std::map<std::vector<std::string>, std::vector<std::string>> variants;  // by the methods that are lost there
  for (const auto& variant : study.variants) {
    std::vector<std::string> lost;
    for (const auto& family : study.families)
      if (!converges_in(study, family, variant)) lost.push_back(family_name(family));
    if (!lost.empty()) variants[lost].push_back(variant);
  }
  std::string out;
  for (const auto& [lost, where] : variants) {
    std::vector<std::string> left;
    for (const auto& family : study.families)
      if (std::find(lost.begin(), lost.end(), family_name(family)) == lost.end()) left.push_back(family_name(family));
    const std::string who = left.empty()       ? "no run"
                            : left.size() == 1 ? "only " + left.front()
                                               : "no run of " + listed(lost);
    std::string sentence =
        (where.size() == study.variants.size() ? "" : "at " + listed(where) + " ") + who + " converged. ";
    sentence[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(sentence[0])));
    out += sentence;
  }
  return out;
}

/// What a study without references does not tell.
std::string reference_sentence(const Study& study) {
  const bool measured = std::any_of(study.cells.begin(), study.cells.end(), [](const Cell& cell) {
    return !cell.enforcement.empty() || !cell.discretization.empty();
  });
  return measured ? ""
                  : "No error was measured: the study names no reference, or none that its runs could be held against. "
                    "What is here is what they gave, what they cost, and how far each is from " +
                        std::string(is_frictionless(study) ? "the contact conditions" : "Coulomb's law") + " (KKT).";
}

std::string failure_sentence(const Study& study) {
  std::map<std::string, long> by_status;
  long failed = 0;
  for (const auto& cell : study.cells)
    if (!cell.converged) {
      ++failed;
      ++by_status[cell.status];
    }
  if (failed == 0) return study.cells.size() == 1 ? "The run converged." : "All runs converged.";
  std::string kinds;
  for (const auto& [status, n] : by_status) kinds += fmt::format("{}{} {}", kinds.empty() ? "" : ", ", n, status);
  return fmt::format("{} of {} runs did not converge ({}).", failed, study.cells.size(), kinds);
}

}  // namespace

std::string run_of_picture(const Study& study) {
  const json& ids = array_at(study.description, "cells");
  for (const auto& cell : study.cells)
    if (!ids.empty() && at(cell.record, "id") == ids.back())
      return cell.label + (cell.variant.empty() ? "" : ", " + cell.variant);
  return "";
}

std::string failures(const Study& study) {
  const bool failed = std::any_of(study.cells.begin(), study.cells.end(), [](auto& cell) { return !cell.converged; });
  return failed ? lost_methods(study) + failure_sentence(study) : "";
}

std::string reference_run(const Study& study) {
  for (const auto& entry : array_at(study.description, "reference"))
    for (const auto& [family, options] : object_at(entry, "method").items()) {
      const Cell* same = nullptr;
      for (const auto& cell : study.cells)
        if (cell.family == family && cell.variant == study.main_variant && cell.converged &&
            !cell.enforcement.empty() && worst(cell.enforcement, "") == 0.0 &&
            (!same || at(cell.record, "default") == true))
          same = &cell;
      return same ? same->label + ", one of the runs" : family_name(family) + ", run as the reference only";
    }
  return "";
}

std::string work_in_words(const Study& study) {
  const auto weight = study.ratio.begin();
  return study.ratio.empty()       ? "work (factorisations)"
         : study.ratio.size() == 1 ? fmt::format("work (factorisations + {} back-solves)", number(weight->second, 2))
                                   : "work (factorisations + weighted back-solves)";
}

std::vector<std::string> what_else_errs(const Study& study) {
  if (is_against_meshes_alone(study)) return {"mesh"};
  std::vector<std::string> out = {"mesh", "steps"};
  if (number_at(at(study.description, "mesh"), "elements") == 1) out.erase(out.begin());  // there is none to refine
  if (discretization_reference(study) != "the closed form") out.emplace_back("references");
  return out;
}

Counts counts_of(const Cell& cell, Of of) {
  const bool derivative = of == Of::sensitivities;
  return {std::lround(cell.count("factorizations") - (derivative ? 0 : cell.count("sensitivity_factorizations"))),
          std::lround(cell.count("backsolves") + (derivative ? cell.count("sensitivity_backsolves") : 0))};
}

std::string seconds_in_words(double seconds) {
  constexpr double rounds_to_a_tenth = 0.0995;
  return seconds < rounds_to_a_tenth ? number(1e3 * seconds, 2) + " ms" : number(seconds, 2) + " s";
}

std::string percent(double error) {
  return error >= 1e-3 && error < 1 ? number(100 * error, 2) + " %" : number(error, 2);
}

std::string work_in_words(const Cell& cell, Of of) {
  const Counts counts = counts_of(cell, of);
  return counted(counts.factorizations, "factorisation") + " and " + counted(counts.backsolves, "back-solve");
}

std::vector<std::string> warning_sentences(const Study& study) {
  struct Kind {
    long runs = 0;
    double worst = 0;
    std::string words;
  };
  std::map<std::pair<std::string, std::string>, Kind> kinds;  // code, place
  for (const auto& cell : study.cells)
    for (json warning : array_at(cell.record, "warnings")) {
      if (warning.is_string())  // as 0.1.0 wrote them
        warning = {
            {"code", "of an earlier version"}, {"where", warning}, {"text", warning}, {"remedy", "run it again"}};
      Kind& kind = kinds[{text_at(warning, "code"), text_at(warning, "where")}];
      const double value = number_at(warning, "value");
      if (kind.runs++ > 0 && value <= kind.worst) continue;
      kind.worst = value;
      kind.words = text_at(warning, "text") + "; " + text_at(warning, "remedy");
      std::erase(kind.words, '`');  // (marks of names on a terminal)
    }
  std::vector<std::string> out;
  for (const auto& [key, kind] : kinds)
    out.push_back(study.cells.size() == 1 ? fmt::format("Warning ({}): {}.", key.first, kind.words)
                                          : fmt::format("Warning ({}, {} of {} runs): {}.", key.first, kind.runs,
                                                        study.cells.size(), kind.words));
  return out;
}

/// " Their best runs are off by 12 % at h = 1 and 3 % at h = 2." of the variants beside the main one; of more than four
/// the range. "" where no error of them is known.
std::string other_variants(const Study& study) {
  std::vector<std::pair<double, std::string>> off;
  for (const auto& variant : study.variants) {
    std::optional<double> best;
    for (const auto& cell : study.cells)
      if (cell.converged && cell.variant == variant && variant != study.main_variant)
        if (const auto error = worst(cell.discretization, "response:")) best = std::min(best.value_or(*error), *error);
    if (best) off.emplace_back(*best, variant);
  }
  if (off.empty()) return "";
  constexpr std::size_t most = 4;
  if (off.size() > most) {
    const auto [least, largest] = std::minmax_element(off.begin(), off.end());
    return fmt::format(" Their best runs are off by {} to {}.", percent(least->first), percent(largest->first));
  }
  std::vector<std::string> names;
  for (const auto& [error, variant] : off) names.push_back(percent(error) + " at " + variant);
  return fmt::format(" Their best runs are off by {}.", listed(names));
}

std::vector<std::string> headline(const Study& study) {
  if (study.cells.empty()) return {"The study has no results yet."};
  std::vector<std::string> out;
  out.push_back(penalty_sentence(study));
  out.push_back(mesh_sentence(study));
  out.push_back(reference_sentence(study));
  out.erase(std::remove(out.begin(), out.end(), std::string()), out.end());
  if (!out.empty() && !study.main_variant.empty())
    out.push_back("These figures are for " + study.main_variant +
                  (study.variants.size() > 1 ? "; the charts offer the others." + other_variants(study) : "."));
  std::vector<const nlohmann::json*> rows;
  for (const auto& cell : study.cells) rows.push_back(&cell.record);
  for (auto& sentence : disagreements(rows)) out.push_back(std::move(sentence));
  for (auto& sentence : warning_sentences(study)) out.push_back(std::move(sentence));
  return out;
}

}  // namespace stickslip::report
