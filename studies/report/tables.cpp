#include "studies/report/tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <set>

#include "studies/report/html.hpp"
#include "studies/report/look_up.hpp"
#include "studies/report/settings.hpp"

namespace stickslip::report {

using nlohmann::json;

std::string settings_table(const Study& study) {
  const auto target = target_error(study, Of::responses);
  if (!target) return {};
  std::vector<Problem> problems;
  for (const auto& variant : study.variants) problems.push_back({variant, *target});
  const auto all = contestants(study, problems, Of::responses);
  Table table;
  table.header = {"scene",
                  "method",
                  "setting",
                  "run",
                  "worst response error",
                  "worst sensitivity error",
                  "Newton",
                  "augmentations",
                  "work",
                  "with sensitivities",
                  "seconds",
                  "status",
                  "accurate enough"};
  const auto shown = [](const std::optional<double>& v) { return v ? number(*v) : std::string(); };
  for (std::size_t i = 0; i < problems.size(); ++i)
    for (const auto& each : all) {
      const Cell* cell = each.cells[i];
      if (!cell) continue;
      table.rows.push_back({problems[i].variant, family_name(each.family), name_of(each.setting), cell->label,
                            shown(worst(cell->enforcement, "response:")),
                            shown(worst(cell->enforcement, "sensitivity:")), whole(cell->count("newton")),
                            whole(cell->count("augmentations")), number(cell->work), number(cell->sensitivity_work),
                            number(cell->seconds), in_plain_words(cell->status)});
      const bool solved = each.work(i, problems, Of::responses).has_value();
      table.rows.back().push_back(solved ? "yes" : "no");
      table.row_classes.emplace_back(solved ? "" : "failed");
    }
  if (table.rows.empty()) return {};
  return fmt::format(
             "<h3>Default, tuned and strict</h3>\n<p class=\"note\">Default: no option given. Tuned: the cheapest of "
             "the "
             "settings tried whose worst response is within {} of the exact contact conditions, known only afterwards. "
             "Strict: the most accurate setting tried. The last column says what failed or missed that accuracy.</p>\n",
             number(*target)) +
         compact_html(table, "Default, tuned and strict settings");
}

std::string status_table(const Study& study) {
  if (study.variants.size() < 2) return {};
  Table table;
  table.header = {"method"};
  for (const auto& variant : study.variants) table.header.push_back(variant);
  std::vector<std::string> labels;
  std::map<std::pair<std::string, std::string>, const Cell*> at;
  for (const auto& cell : study.cells) {
    if (std::find(labels.begin(), labels.end(), cell.label) == labels.end()) labels.push_back(cell.label);
    at[{cell.label, cell.variant}] = &cell;
  }
  for (const auto& label : labels) {
    std::vector<std::string> row = {label};
    bool failed = false;
    for (const auto& variant : study.variants) {
      const auto found = at.find({label, variant});
      if (found == at.end()) {
        row.emplace_back("not run");
        continue;
      }
      const Cell& cell = *found->second;
      failed = failed || !cell.converged;
      row.push_back(cell.converged ? fmt::format("ok, {} Newton", whole(cell.count("newton")))
                                   : in_plain_words(cell.status));
    }
    table.rows.push_back(row);
    table.row_classes.emplace_back(failed ? "failed" : "");
  }
  const bool all_converged =
      std::all_of(study.cells.begin(), study.cells.end(), [](auto& cell) { return cell.converged; });
  const std::string title = "Which setting works where", content = to_html(table, "Status by setting and scene");
  return all_converged ? folded(title + " (all runs converged)", content) : "<h3>" + title + "</h3>\n" + content;
}

namespace {

/// What runs said of themselves: too long for a column.
std::string messages(const Study& study) {
  Table table{{"method", "scene", "status", "message"}, {}, {}};
  for (const auto& cell : study.cells)
    if (const std::string message = plain(at(cell.record, "message")); !message.empty()) {
      table.rows.push_back({cell.label, cell.variant, in_plain_words(cell.status), message});
      table.row_classes.emplace_back(cell.converged ? "" : "failed");
    }
  return table.rows.empty() ? "" : folded("Messages of the runs", to_html(table, "Messages"));
}

}  // namespace

std::string results_table(const Study& study) {
  const std::string reference = discretization_reference(study);
  Table errors, costs;
  errors.header = {"method",
                   "scene",
                   "status",
                   "worst response error",
                   "worst sensitivity error",
                   "response error to " + reference,
                   "sensitivity error to " + reference,
                   "worst KKT measure",
                   "condition"};
  costs.header = {"method",
                  "scene",
                  "status",
                  "Newton",
                  "augmentations",
                  "cutbacks",
                  "factorisations",
                  "back-solves",
                  "sensitivity back-solves",
                  "seconds",
                  "of these sensitivities",
                  "memory MB"};
  const auto shown = [](const std::optional<double>& v) { return v ? number(*v) : std::string(); };
  for (const auto& cell : study.cells) {
    const json &cost = at(cell.record, "cost"), &seconds = at(cost, "seconds");
    const auto count = [&](const char* name) { return whole(cell.count(name)); };
    const auto recorded = [](const json& v) { return v.is_number() ? number(v.get<double>()) : std::string(); };
    const std::string status = in_plain_words(cell.status);
    errors.rows.push_back({cell.label, cell.variant, status, shown(worst(cell.enforcement, "response:")),
                           shown(worst(cell.enforcement, "sensitivity:")),
                           shown(worst(cell.discretization, "response:")),
                           shown(worst(cell.discretization, "sensitivity:")), shown(worst(cell.kkt, "")),
                           recorded(at(cost, "condition_estimate"))});
    costs.rows.push_back({cell.label, cell.variant, status, count("newton"), count("augmentations"), count("cutbacks"),
                          count("factorizations"), count("backsolves"), count("sensitivity_backsolves"),
                          recorded(at(seconds, "total")), recorded(at(seconds, "sensitivity")),
                          recorded(at(cost, "peak_memory_mb"))});
    errors.row_classes.emplace_back(cell.converged ? "" : "failed");
  }
  costs.row_classes = errors.row_classes;
  return compact_html(errors, "All runs: errors") +
         folded("Costs of all runs", compact_html(costs, "All runs: costs")) + messages(study);
}

namespace {

/// A number of a run by its place in the record, and the response or objective that it belongs to.
struct TableColumn {
  std::string of;
  std::vector<std::string> place;
  std::string title;
  auto operator<=>(const TableColumn&) const = default;
};

/// Objectives and their gradients, responses and sensitivities of the last step.
std::set<TableColumn> value_columns(const json& record) {
  std::set<TableColumn> columns;
  const auto add = [&](std::vector<std::string> place, const std::string& of, const std::string& name, const json& by) {
    for (const auto& [parameter, unused] : by.items()) {
      auto one = place;
      one.push_back(parameter);
      columns.insert({of, one, "d " + name + " / d " + parameter});
    }
  };
  for (const auto& [name, value] : object_at(record, "responses").items())
    columns.insert({name, {"responses", name}, name});
  for (const auto& [name, by] : object_at(record, "sensitivities").items())
    if (by.is_object()) add({"sensitivities", name}, name, name, by);
  for (const auto& [name, objective] : object_at(record, "objectives").items()) {
    const std::string of = name + " (objective)";
    columns.insert({of, {"objectives", name, "value"}, name});
    add({"objectives", name, "gradient"}, of, name, object_at(objective, "gradient"));
  }
  return columns;
}

/// (A result has no derivative of what is not determined.)
std::string value_of(const Cell& cell, const TableColumn& column) {
  const json* v = &cell.record;
  for (const auto& key : column.place) v = &at(*v, key);
  const bool derivative = column.place.front() == "sensitivities" || column.place.size() == 4;
  if (derivative && v->is_null() && cell.converged) return "not determined";
  return v->is_number() ? number(v->get<double>(), 10) : plain(*v);
}

/// Columns in groups, each of one response or objective, and no wider than a sheet of paper.
std::vector<std::vector<TableColumn>> blocks_of(const std::set<TableColumn>& columns) {
  constexpr std::size_t widest = 6;
  std::vector<std::vector<TableColumn>> blocks;
  for (const auto& column : columns)
    if (blocks.empty() || blocks.back().front().of != column.of || blocks.back().size() == widest)
      blocks.push_back({column});
    else
      blocks.back().push_back(column);
  return blocks;
}

/// A block beside the names of the runs. Of one whose numbers are the same in all runs, the sentence that says so.
std::string block_html(const Study& study, Table table, const std::vector<TableColumn>& block) {
  const std::size_t names = table.header.size();
  for (const auto& column : block) {
    table.header.push_back(column.title);
    for (std::size_t i = 0; i < table.rows.size(); ++i) table.rows[i].push_back(value_of(study.cells[i], column));
  }
  const std::string constant = take_out_constant_columns(table);
  const std::string note = constant.empty() ? "" : "<p class=\"note\">" + escape_sentence(constant) + "</p>\n";
  return table.header.size() == names ? note : note + to_html(table, "Last step: " + block.front().of);
}

}  // namespace

std::string values_table(const Study& study) {
  std::set<TableColumn> columns;
  for (const auto& cell : study.cells) columns.merge(value_columns(cell.record));
  if (columns.empty()) return {};
  constexpr std::size_t most = 200;  // a table of more is read by programs alone, from results.jsonl
  if (columns.size() > most) columns.erase(std::next(columns.begin(), most), columns.end());
  Table runs{{"method", "scene", "status"}, {}, {}};
  for (const auto& cell : study.cells) {
    runs.rows.push_back({cell.label, cell.variant, in_plain_words(cell.status)});
    runs.row_classes.emplace_back(cell.converged ? "" : "failed");
  }
  const std::string constant = take_out_constant_columns(runs);
  std::string out = constant.empty() ? "" : "<p class=\"note\">" + escape(constant) + "</p>\n";
  for (const auto& block : blocks_of(columns)) out += block_html(study, runs, block);
  return folded("Values of responses and sensitivities at the last step, and of objectives", out);
}

}  // namespace stickslip::report
