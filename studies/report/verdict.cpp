#include "studies/report/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <sstream>

#include "studies/io/wording.hpp"
#include "studies/report/headline.hpp"
#include "studies/report/html.hpp"
#include "studies/report/labels.hpp"
#include "studies/report/look_up.hpp"
#include "studies/report/settings.hpp"

namespace stickslip::report {
namespace {

constexpr double rounding = 1e-12;    ///< what sixteen digits leave: no mesh errs by so little
constexpr double same = 1 + 1e-9;     ///< of works: counts are whole, and what differs, differs by more
constexpr double much_faster = 1.25;  ///< seconds of runs this short vary by some 20 %

/// An accuracy that is asked for.
struct Level {
  double error = 0;
  std::string whose = {};  ///< "own error of mesh, steps: " where these err by so much

  std::string title() const { return percent(error); }
  std::string html() const { return escape(whose) + "<span>" + escape(title()) + "</span>"; }
};

/// Responses or derivatives, by which errors they are judged, and to which accuracies.
struct Measure {
  Of of = Of::responses;
  bool on_same_mesh = true;  ///< else against the closed form, a finer mesh or given values
  std::vector<Level> levels;

  std::string prefix() const { return of == Of::responses ? "response:" : "sensitivity:"; }
  std::string noun() const { return of == Of::responses ? "response" : "derivative"; }
  std::optional<double> error(const Cell& cell) const {
    return cell.converged ? worst(on_same_mesh ? cell.enforcement : cell.discretization, prefix()) : std::nullopt;
  }
  double work(const Cell& cell) const { return work_of(cell, of); }
  double seconds(const Cell& cell) const { return of == Of::responses ? cell.seconds : cell.sensitivity_seconds; }
};

std::vector<const Cell*> runs_of(const Study& study) {
  std::vector<const Cell*> out;
  for (const auto& cell : study.cells)
    if (cell.variant == study.main_variant) out.push_back(&cell);
  return out;
}

/// A row of the table: the runs of a method or, in a study of one method, of one choice of the options beside the one
/// that its curves run along.
struct Row {
  std::string name;
  std::vector<const Cell*> runs;
  std::string head = name;  ///< what the table's first column says
};

/// The rows, and what the head of their column says.
std::pair<std::vector<Row>, std::string> rows_of(const Study& study) {
  constexpr std::size_t most = 8;  // that a first screen has room for
  std::vector<Row> by_method, by_series;
  for (const auto& family : study.families) by_method.push_back({family_name(family), {}});
  const std::string knob = study.families.size() == 1 ? running_knob(study, study.families.front()) : "";
  for (const Cell* cell : runs_of(study)) {
    const auto method = std::find(study.families.begin(), study.families.end(), cell->family) - study.families.begin();
    by_method[static_cast<std::size_t>(method)].runs.push_back(cell);
    const std::string series = series_of(*cell, knob);
    const auto known = std::find_if(by_series.begin(), by_series.end(), [&](auto& row) { return row.name == series; });
    (known == by_series.end() ? by_series.emplace_back(Row{series, {}, beside_method(series, cell->family)}) : *known)
        .runs.push_back(cell);
  }
  if (knob.empty() || by_series.size() < 2 || by_series.size() > most) return {by_method, "method"};
  return {by_series, family_name(study.families.front())};
}

std::optional<Measure> measure_of(const Study& study, Of of) {
  Measure measure{of, true, {}};
  const auto runs = runs_of(study);
  const auto has_errors = [&] {
    return std::any_of(runs.begin(), runs.end(), [&](auto* c) { return measure.error(*c); });
  };
  if (!has_errors()) measure.on_same_mesh = false;
  if (!has_errors()) return std::nullopt;
  std::vector<double> asked;
  for (const auto& error : array_at(study.description, "accuracy"))
    if (error.is_number()) asked.push_back(error.get<double>());
  if (asked.empty()) asked = {1e-2, 1e-4, 1e-6};
  std::sort(asked.rbegin(), asked.rend());
  for (const double error : asked) measure.levels.push_back({error});
  const double digits = discretization_reference(study) == "the given values" ? digits_of_given_values : rounding;
  if (const auto own = own_error(study, of); measure.on_same_mesh && own && *own > digits)
    measure.levels.push_back({*own, fmt::format("own error of {}: ", fmt::join(what_else_errs(study), ", "))});
  return measure;
}

/// The options that tell a run from others of its row; "default" where there are none.
std::string setting_of(const Cell& cell, const std::string& row) {
  std::string out;
  std::istringstream words(series_of(cell, "")), common(row);
  const std::set<std::string> known{std::istream_iterator<std::string>(common), {}};
  for (std::string word; words >> word;)
    if (known.count(word) == 0) out += (out.empty() ? "" : " ") + word;
  return out.empty() ? "default" : out;
}

/// Escaped words, of which none is broken over two lines.
std::string unbroken(const std::string& text) {
  std::string out;
  std::istringstream words(text);
  for (std::string word; words >> word;) out += (out.empty() ? "<span>" : " <span>") + escape(word) + "</span>";
  return out;
}

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream words(text);
  return {std::istream_iterator<std::string>(words), {}};
}

/// "scale=1, 10 or 100" of "scale=1", "scale=10" and "scale=100": of settings that differ in one option, what the first
/// says is not said again. Of more than three the first two, and how many others there are.
std::string alternatives(const std::vector<std::string>& settings) {
  constexpr std::size_t most = 3;
  const std::size_t told = settings.size() > most ? most - 1 : settings.size();
  const auto first = words_of(settings.front());
  const auto value = [&](const std::string& setting) {  // "" where more than the value of the last option differs
    const auto words = words_of(setting);
    const std::string option = first.back().substr(0, first.back().find('=') + 1);
    const bool alike = !option.empty() && words.size() == first.size() && words.back().starts_with(option) &&
                       std::equal(words.begin(), words.end() - 1, first.begin());
    return alike ? words.back().substr(option.size()) : "";
  };
  const bool alike =
      std::none_of(settings.begin(), settings.end(), [&](auto& setting) { return value(setting).empty(); });
  std::string out = settings.front();
  for (std::size_t i = 1; i < told; ++i)
    out += (i + 1 < settings.size() ? ", " : " or ") + (alike ? value(settings[i]) : settings[i]);
  return told < settings.size() ? out + " or " + counted(static_cast<long>(settings.size() - told), "other") : out;
}

/// A run, and others of its method that do the same for the same work.
struct Choice {
  const Cell* run = nullptr;  ///< nullptr: none
  std::vector<const Cell*> equals = {};
  std::string row = {};  ///< its name

  std::string setting() const {
    std::vector<std::string> settings = {setting_of(*run, row)};
    for (const Cell* equal : equals) settings.push_back(setting_of(*equal, row));
    return alternatives(settings);
  }
  std::string name() const { return row + (setting() == "default" ? "" : " (" + setting() + ")"); }
};

/// The run of a row that reaches an accuracy with least work; of equals the default setting, else the first.
Choice cheapest(const Row& row, const Measure& measure, double level) {
  Choice best;
  best.row = row.name;
  for (const Cell* cell : row.runs) {
    const auto error = measure.error(*cell);
    if (!error || *error > level) continue;
    const double work = measure.work(*cell), least = best.run ? measure.work(*best.run) : INFINITY;
    if (work * same < least) {
      best = {cell, {}, row.name};
    } else if (work <= least * same) {
      best.equals.push_back(cell);
      if (at(cell->record, "default") == true) std::swap(best.run, best.equals.back());
    }
  }
  return best;
}

/// Of an accuracy: the cheapest run of each row, the least work among them, and the least seconds.
struct Column {
  std::vector<Choice> runs;       ///< per row
  const Cell* least = nullptr;    ///< by work
  const Cell* fastest = nullptr;  ///< by seconds, where they were measured
};

Column column_of(const std::vector<Row>& rows, const Measure& measure, double level) {
  Column column;
  for (const auto& row : rows) {
    const Choice choice = cheapest(row, measure, level);
    column.runs.push_back(choice);
    const Cell* run = choice.run;
    if (!run) continue;
    if (!column.least || measure.work(*run) < measure.work(*column.least)) column.least = run;
    if (measure.seconds(*run) > 0 && (!column.fastest || measure.seconds(*run) < measure.seconds(*column.fastest)))
      column.fastest = run;
  }
  return column;
}

bool is_least(const Column& column, const Measure& measure, const Cell& cell) {
  return measure.work(cell) <= much_the_same * measure.work(*column.least);
}

/// Whether a run is, up to what seconds vary by, as fast as any, while one of least work clearly is not.
bool is_fastest(const Column& column, const Measure& measure, const Cell& cell) {
  if (!column.fastest || measure.seconds(cell) == 0) return false;
  const double fast = much_faster * measure.seconds(*column.fastest);
  return measure.seconds(cell) <= fast && std::any_of(column.runs.begin(), column.runs.end(), [&](const Choice& other) {
           return other.run && is_least(column, measure, *other.run) && measure.seconds(*other.run) > fast;
         });
}

/// The least error of a row's runs.
std::optional<double> nearest_of(const Row& row, const Measure& measure) {
  std::optional<double> nearest;
  for (const Cell* cell : row.runs)
    if (const auto error = measure.error(*cell)) nearest = std::min(nearest.value_or(*error), *error);
  return nearest;
}

/// `within`: the heads of the column, which narrow screens show beside each entry.
std::string entry(const Row& row, const Measure& measure, const Column& column, const Choice& choice,
                  const std::string& within) {
  const auto cell = [&](const std::string& kind, const std::string& content) {
    return fmt::format("<td data-within=\"{}\"{}>{}</td>", within, kind.empty() ? "" : " class=\"" + kind + "\"",
                       content);
  };
  const Cell* run = choice.run;
  if (!run) {
    const auto nearest = nearest_of(row, measure);
    return cell("missed", nearest ? "best " + percent(*nearest) : "no run");
  }
  const bool least = is_least(column, measure, *run), fastest = is_fastest(column, measure, *run);
  std::string cost = "<span>work " + number(measure.work(*run), 2) + (least ? " &#9733;" : "") + "</span>";
  if (measure.seconds(*run) > 0)
    cost += " <span>&middot; " + escape(seconds_in_words(measure.seconds(*run))) + "</span>";
  if (fastest) cost += ", <span>fastest</span>";
  return cell(least ? "least" : "", fmt::format("{}<br><small>{}</small>", unbroken(choice.setting()), cost));
}

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
bool counts_leave_open(const std::vector<const Choice*>& winners, const std::vector<const Choice*>& others, Of of) {
  auto all = winners;
  all.insert(all.end(), others.begin(), others.end());
  return std::any_of(winners.begin(), winners.end(), [&](const Choice* winner) {
    return std::any_of(all.begin(), all.end(), [&](const Choice* other) {
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
  std::string of(const Choice& choice) {
    const Counts counts = counts_of(*choice.run, measure_.of);
    std::string out = told_ ? fmt::format("{} and {}", counts.factorizations, counts.backsolves)
                            : work_in_words(*choice.run, measure_.of);
    told_ = true;
    const long augmentations = measure_.of == Of::responses ? std::lround(choice.run->count("augmentations")) : 0;
    if (augmentations > 0) out += " in " + counted(augmentations, "augmentation");
    return weighed_ ? out + " (work " + number(measure_.work(*choice.run), 3) + ")" : out;
  }
  bool are_the_same(const Choice& a, const Choice& b) const { return Costs(*this).brief(a) == Costs(*this).brief(b); }

 private:
  std::string brief(const Choice& choice) {
    told_ = true;
    return of(choice);
  }

  const Measure& measure_;
  bool weighed_, told_ = false;
};

/// Methods with what they take: once where that is the same for all.
std::string winners_in_words(const std::vector<const Choice*>& winners, Costs& costs) {
  const bool alike = std::all_of(winners.begin(), winners.end(),
                                 [&](const Choice* choice) { return costs.are_the_same(*choice, *winners.front()); });
  std::vector<std::string> names;
  for (const Choice* choice : winners)
    names.push_back("<b>" + escape_sentence(choice->name()) + "</b>" + (alike ? "" : " with " + costs.of(*choice)));
  return enumerated(names) + (alike ? " with " + costs.of(*winners.front()) : "");
}

/// Those of least work and, set off, those near it. pre: sorted by work.
std::string cheapest_in_words(const std::vector<const Choice*>& winners, const Measure& measure, Costs& costs) {
  const auto first_near = std::find_if(winners.begin(), winners.end(), [&](const Choice* choice) {
    return measure.work(*choice->run) > same * measure.work(*winners.front()->run);
  });
  const std::vector<const Choice*> least(winners.begin(), first_near), near(first_near, winners.end());
  const std::string out = "cheapest by " + winners_in_words(least, costs);
  return near.empty() ? out : out + "; within 5 % of that " + winners_in_words(near, costs);
}

/// Of more than three the dearest alone.
std::vector<const Choice*> few_of(const std::vector<const Choice*>& others, const Measure& measure) {
  if (others.size() <= 3) return others;
  return {*std::max_element(others.begin(), others.end(), [&](const Choice* a, const Choice* b) {
    return measure.work(*a->run) < measure.work(*b->run);
  })};
}

/// What those take that are not the cheapest; `many`: of more, these are the dearest.
std::string what_others_take(const std::vector<const Choice*>& others, bool many, Costs& costs) {
  std::string out;
  for (const Choice* choice : others)
    out += (many ? "; the dearest, " : "; ") + escape_sentence(choice->name()) + (many ? ", takes " : " takes ") +
           costs.of(*choice);
  return out;
}

/// Who was faster by the clock than the slowest of those of least work; "" where none was.
std::string who_is_faster(const Measure& measure, const Column& column) {
  std::vector<std::string> faster;
  const Choice* slowest = nullptr;
  const auto timed = [&](const Choice& choice) {
    return escape_sentence(choice.row + " (" + seconds_in_words(measure.seconds(*choice.run)) + ")");
  };
  for (const Choice& choice : column.runs) {
    if (!choice.run) continue;
    if (is_fastest(column, measure, *choice.run)) faster.push_back(timed(choice));
    if (is_least(column, measure, *choice.run) &&
        (!slowest || measure.seconds(*choice.run) > measure.seconds(*slowest->run)))
      slowest = &choice;
  }
  if (faster.empty()) return "";
  return fmt::format("; by the clock {} {} {}", enumerated(faster), faster.size() == 1 ? "beats" : "beat",
                     timed(*slowest));
}

/// "Penalty does not get there (best 2.4 %)" of rows that no choice stands for; "" where there is none.
std::string who_misses(const std::vector<Row>& rows, const Measure& measure, const Column& column) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (const auto nearest = nearest_of(rows[i], measure); !column.runs[i].run)
      names.push_back(escape_sentence(rows[i].name + (nearest ? " (best " + percent(*nearest) + ")" : " (no run)")));
  if (names.empty()) return "";
  return " " + enumerated(names) + (names.size() == 1 ? " does" : " do") + " not get there.";
}

/// Who is the cheapest at the first accuracy that any method reaches, what the others need, and who misses it.
std::string reason(const std::vector<Row>& rows, const Measure& measure) {
  for (const auto& level : measure.levels) {
    const Column column = column_of(rows, measure, level.error);
    if (!column.least) continue;
    std::vector<const Choice*> winners, others;
    for (const Choice& choice : column.runs)
      if (choice.run) (is_least(column, measure, *choice.run) ? winners : others).push_back(&choice);
    std::stable_sort(winners.begin(), winners.end(),
                     [&](const Choice* a, const Choice* b) { return measure.work(*a->run) < measure.work(*b->run); });
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

}  // namespace

Verdict verdict(const Study& study) {
  std::vector<Measure> measures;
  for (const Of of : {Of::responses, Of::sensitivities})
    if (auto measure = measure_of(study, of)) measures.push_back(*std::move(measure));
  if (measures.empty()) return {};
  std::string groups, heads, sentences;
  const auto [rows, rows_are] = rows_of(study);
  std::vector<std::string> entries(rows.size());
  for (const auto& measure : measures) {
    groups +=
        fmt::format("<th scope=\"colgroup\" colspan=\"{}\">{} within</th>", measure.levels.size(), measure.noun());
    for (const auto& level : measure.levels) {
      heads += "<th scope=\"col\">" + level.html() + "</th>";
      const Column column = column_of(rows, measure, level.error);
      const std::string within = escape(measure.noun() + " within " + level.whose + level.title());
      for (std::size_t i = 0; i < rows.size(); ++i)
        entries[i] += entry(rows[i], measure, column, column.runs[i], within);
    }
    sentences += reason(rows, measure);
  }
  std::string body;
  for (std::size_t i = 0; i < rows.size(); ++i)
    body += "<tr><th scope=\"row\">" + unbroken(rows[i].head) + "</th>" + entries[i] + "</tr>\n";
  const std::string against =
      measures.front().on_same_mesh ? "exact contact on the same mesh" : discretization_reference(study);
  const std::string table = fmt::format(
      "<div class=\"wide\" role=\"region\" tabindex=\"0\" aria-label=\"Verdict\"><table class=\"verdict\">"
      "<caption>The cheapest setting of each method within an accuracy of {}{}; &#9733; within "
      "5 % of the least work</caption>\n<thead><tr><th rowspan=\"2\">{}</th>{}</tr>"
      "<tr>{}</tr></thead><tbody>\n{}</tbody></table></div>\n",
      escape(against), study.main_variant.empty() ? "" : escape(" (" + study.main_variant + ")"), escape(rows_are),
      groups, heads, body);
  return {sentences, table, rows.size()};
}

}  // namespace stickslip::report
