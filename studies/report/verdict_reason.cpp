#include "studies/report/verdict_reason.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "studies/io/wording.hpp"
#include "studies/report/headline.hpp"
#include "studies/report/html.hpp"

namespace stickslip::report {
namespace {

using Picks = std::vector<const Pick*>;

/// What runs take, in words.
class Costs {
 public:
  explicit Costs(const Measure& measure) : measure_(measure) {}

  /// "work 6.1 (4 factorisations + 20 back-solves at 0.11 each, in 3 augmentations), 0.66 ms"; after the first, which
  /// so says what work is, "work 6.1 (4 + 20), 0.66 ms".
  std::string of(const Pick& pick) {
    const Cell& run = *pick.run;
    const Counts counts = counts_of(run, measure_.of);
    const double weight = measure_.weight(run);
    std::string sum = fmt::format("{} + {}", counts.factorizations, counts.backsolves);
    if (!told_)
      sum = counted(counts.factorizations, "factorisation") + " + " + counted(counts.backsolves, "back-solve") +
            (weight > 0 ? " at " + number(weight, 2) + " each" : ", which are not weighed");
    told_ = true;
    const long augmentations = measure_.of == Of::responses ? std::lround(run.count("augmentations")) : 0;
    if (augmentations > 0) sum += ", in " + counted(augmentations, "augmentation");
    const double seconds = measure_.seconds(run);
    return fmt::format("work {} ({}){}", number(measure_.work(run), 3), sum,
                       seconds > 0 ? ", " + seconds_in_words(seconds) : "");
  }

 private:
  const Measure& measure_;
  bool told_ = false;
};

/// The cheapest or, where others are within 5 % of it, a tie of these; of more than three the first two. `alone`: there
/// is no other row.
std::string winners_in_words(const Picks& winners, bool alone, Costs& costs) {
  const auto name = [](const Pick* pick) { return "<b>" + escape_sentence(pick->name()) + "</b>"; };
  if (winners.size() == 1)
    return name(winners.front()) + (alone ? " takes least: " : " is cheapest: ") +
           escape_sentence(costs.of(*winners.front()));
  const std::size_t told = winners.size() > 3 ? 2 : winners.size();
  std::string out = "a tie (work within 5 %)";
  for (std::size_t i = 0; i < told; ++i)
    out += (i == 0 ? ": " : "; ") + name(winners[i]) + ", " + escape_sentence(costs.of(*winners[i]));
  return told == winners.size() ? out : out + fmt::format("; and {} others", winners.size() - told);
}

/// Of more than three the dearest alone.
Picks few_of(const Picks& others, const Measure& measure) {
  if (others.size() <= 3) return others;
  return {*std::max_element(others.begin(), others.end(), [&](const Pick* a, const Pick* b) {
    return measure.work(*a->run) < measure.work(*b->run);
  })};
}

/// What those take that are not the cheapest; `many`: of more, these are the dearest.
std::string what_others_take(const Picks& others, bool many, Costs& costs) {
  std::string out;
  for (const Pick* pick : others)
    out += (many ? ". The dearest, " : ". ") + escape_sentence(pick->name()) + (many ? ", takes " : " takes ") +
           escape_sentence(costs.of(*pick));
  return out;
}

/// "Penalty does not get there within the swept stiffness 1 to 100 (best 2.4 %)." of rows that no pick stands for; ""
/// where there is none.
std::string who_misses(const std::vector<Row>& rows, const Measure& measure, const Column& column) {
  std::string out;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (column.runs[i].run) continue;
    const auto nearest = nearest_of(rows[i], measure);
    out += " " + escape_sentence(rows[i].name + " does not get there" +
                                 (rows[i].swept.empty() ? "" : " within the swept " + rows[i].swept) +
                                 (nearest ? " (best " + percent(*nearest) + ")." : " (no run converged)."));
  }
  return out;
}

}  // namespace

std::string reason(const std::vector<Row>& rows, const Measure& measure, const std::string& variant) {
  for (const auto& level : measure.levels) {
    const Column column = column_of(rows, measure, level.error);
    if (!column.least) continue;
    Picks winners, others;
    for (const Pick& pick : column.runs)
      if (pick.run) (is_least(column, measure, *pick.run) ? winners : others).push_back(&pick);
    for (Picks* picks : {&winners, &others})
      std::stable_sort(picks->begin(), picks->end(),
                       [&](const Pick* a, const Pick* b) { return measure.work(*a->run) < measure.work(*b->run); });
    const auto told = few_of(others, measure);
    Costs costs(measure);
    std::string out = measure.of == Of::responses ? "Response" : "Derivative";
    out += escape_sentence(" within " + level.title() + (variant.empty() ? "" : " at " + variant)) + ": ";
    out += winners_in_words(winners, rows.size() == 1, costs);
    out += what_others_take(told, told.size() < others.size(), costs);
    return "<p class=\"reason\">" + out + "." + who_misses(rows, measure, column) + "</p>\n";
  }
  return "";
}

}  // namespace stickslip::report
