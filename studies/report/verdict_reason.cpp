#include "studies/report/verdict_reason.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "studies/io/wording.hpp"
#include "studies/report/headline.hpp"
#include "studies/report/html.hpp"

namespace stickslip::report {
namespace {

/// "a and b"; of more than three "a, b and 4 others".
std::string enumerated(const std::vector<std::string>& names) {
  const std::size_t shown = names.size() > 3 ? 2 : names.size();
  std::string out = names.front();
  for (std::size_t i = 1; i < shown; ++i) out += (i + 1 == names.size() ? " and " : ", ") + names[i];
  return shown < names.size() ? out + fmt::format(" and {} others", names.size() - shown) : out;
}

/// Whether counts alone leave open which of two runs is the cheaper.
bool counts_leave_open(const Counts& a, const Counts& b) {
  return (a.factorizations < b.factorizations && a.backsolves > b.backsolves) ||
         (a.factorizations > b.factorizations && a.backsolves < b.backsolves);
}

/// Whether counts alone leave open that the winners are the cheapest of all.
bool counts_leave_open(const std::vector<const Pick*>& winners, const std::vector<const Pick*>& others, Of of) {
  auto all = winners;
  all.insert(all.end(), others.begin(), others.end());
  return std::any_of(winners.begin(), winners.end(), [&](const Pick* winner) {
    return std::any_of(all.begin(), all.end(), [&](const Pick* other) {
      return counts_leave_open(counts_of(*winner->run, of), counts_of(*other->run, of));
    });
  });
}

/// What runs take, in words.
class Costs {
 public:
  /// `weighed`: with the work that counts make, where they alone do not order the runs.
  Costs(const Measure& measure, bool weighed) : measure_(measure), weighed_(weighed) {}

  /// "7 factorisations and 204 back-solves in 24 augmentations"; after the first "7 and 204".
  std::string of(const Pick& pick) {
    const Counts counts = counts_of(*pick.run, measure_.of);
    std::string out = told_ ? fmt::format("{} and {}", counts.factorizations, counts.backsolves)
                            : work_in_words(*pick.run, measure_.of);
    told_ = true;
    const long augmentations = measure_.of == Of::responses ? std::lround(pick.run->count("augmentations")) : 0;
    if (augmentations > 0) out += " in " + counted(augmentations, "augmentation");
    return weighed_ ? out + " (work " + number(measure_.work(*pick.run), 3) + ")" : out;
  }
  bool are_the_same(const Pick& a, const Pick& b) const { return Costs(*this).brief(a) == Costs(*this).brief(b); }

 private:
  std::string brief(const Pick& pick) {
    told_ = true;
    return of(pick);
  }

  const Measure& measure_;
  bool weighed_, told_ = false;
};

/// Methods with what they take: once where that is the same for all.
std::string winners_in_words(const std::vector<const Pick*>& winners, Costs& costs) {
  const bool alike = std::all_of(winners.begin(), winners.end(),
                                 [&](const Pick* pick) { return costs.are_the_same(*pick, *winners.front()); });
  std::vector<std::string> names;
  for (const Pick* pick : winners)
    names.push_back("<b>" + escape_sentence(pick->name()) + "</b>" + (alike ? "" : " with " + costs.of(*pick)));
  return enumerated(names) + (alike ? " with " + costs.of(*winners.front()) : "");
}

/// Those of least work and, set off, those near it. pre: sorted by work.
std::string cheapest_in_words(const std::vector<const Pick*>& winners, const Measure& measure, Costs& costs) {
  const auto first_near = std::find_if(winners.begin(), winners.end(), [&](const Pick* pick) {
    return measure.work(*pick->run) > same * measure.work(*winners.front()->run);
  });
  const std::vector<const Pick*> least(winners.begin(), first_near), near(first_near, winners.end());
  const std::string out = "cheapest by " + winners_in_words(least, costs);
  return near.empty() ? out : out + "; within 5 % of that " + winners_in_words(near, costs);
}

/// Of more than three the dearest alone.
std::vector<const Pick*> few_of(const std::vector<const Pick*>& others, const Measure& measure) {
  if (others.size() <= 3) return others;
  return {*std::max_element(others.begin(), others.end(), [&](const Pick* a, const Pick* b) {
    return measure.work(*a->run) < measure.work(*b->run);
  })};
}

/// What those take that are not the cheapest; `many`: of more, these are the dearest.
std::string what_others_take(const std::vector<const Pick*>& others, bool many, Costs& costs) {
  std::string out;
  for (const Pick* pick : others)
    out += (many ? "; the dearest, " : "; ") + escape_sentence(pick->name()) + (many ? ", takes " : " takes ") +
           costs.of(*pick);
  return out;
}

/// Who was faster by the clock than the slowest of those of least work; "" where none was.
std::string who_is_faster(const Measure& measure, const Column& column) {
  std::vector<std::string> faster;
  const Pick* slowest = nullptr;
  const auto timed = [&](const Pick& pick) {
    return escape_sentence(pick.row + " (" + seconds_in_words(measure.seconds(*pick.run)) + ")");
  };
  for (const Pick& pick : column.runs) {
    if (!pick.run) continue;
    if (is_fastest(column, measure, *pick.run)) faster.push_back(timed(pick));
    if (is_least(column, measure, *pick.run) &&
        (!slowest || measure.seconds(*pick.run) > measure.seconds(*slowest->run)))
      slowest = &pick;
  }
  if (faster.empty()) return "";
  return fmt::format("; by the clock {} {} {}", enumerated(faster), faster.size() == 1 ? "beats" : "beat",
                     timed(*slowest));
}

/// "Penalty does not get there (best 2.4 %)" of rows that no pick stands for; "" where there is none.
std::string who_misses(const std::vector<Row>& rows, const Measure& measure, const Column& column) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (const auto nearest = nearest_of(rows[i], measure); !column.runs[i].run)
      names.push_back(escape_sentence(rows[i].name + (nearest ? " (best " + percent(*nearest) + ")" : " (no run)")));
  if (names.empty()) return "";
  return " " + enumerated(names) + (names.size() == 1 ? " does" : " do") + " not get there.";
}

}  // namespace

std::string reason(const std::vector<Row>& rows, const Measure& measure) {
  for (const auto& level : measure.levels) {
    const Column column = column_of(rows, measure, level.error);
    if (!column.least) continue;
    std::vector<const Pick*> winners, others;
    for (const Pick& pick : column.runs)
      if (pick.run) (is_least(column, measure, *pick.run) ? winners : others).push_back(&pick);
    std::stable_sort(winners.begin(), winners.end(),
                     [&](const Pick* a, const Pick* b) { return measure.work(*a->run) < measure.work(*b->run); });
    const auto told = few_of(others, measure);
    Costs costs(measure, counts_leave_open(winners, told, measure.of));
    const std::string noun = measure.of == Of::responses ? "Response" : "Derivative";
    std::string out = noun + " to " + escape_sentence(level.title()) + ": ";
    out += cheapest_in_words(winners, measure, costs);
    out += what_others_take(told, told.size() < others.size(), costs);
    out += who_is_faster(measure, column);
    return "<p class=\"reason\">" + out + "." + who_misses(rows, measure, column) + "</p>\n";
  }
  return "";
}

}  // namespace stickslip::report
