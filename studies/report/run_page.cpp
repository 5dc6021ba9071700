#include "studies/report/run_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "studies/io/amounts.hpp"
#include "studies/io/wording.hpp"
#include "studies/report/about.hpp"
#include "studies/report/certificates.hpp"
#include "studies/report/differentiability.hpp"
#include "studies/report/headline.hpp"
#include "studies/report/html.hpp"
#include "studies/report/look_up.hpp"
#include "studies/report/picture.hpp"
#include "studies/report/steps.hpp"
#include "studies/report/tables.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

std::string how_it_ended(const Cell& cell) {
  const std::size_t steps = array_at(cell.record, "steps").size();
  std::string out =
      fmt::format("{}, {}: {} with {}", family_name(cell.family), counted(static_cast<long>(steps), "step"),
                  in_plain_words(cell.status), work_in_words(cell, Of::sensitivities));
  if (cell.sensitivity_seconds > 0) out += " in " + seconds_in_words(cell.sensitivity_seconds);
  const std::string message = text_at(cell.record, "message");
  return out + (message.empty() ? "" : ": " + message) + ".";
}

/// Whether a contact has no friction, so that what touches there does not slip.
bool is_frictionless(const Study& run, const std::string& contact) {
  const json& points = array_at(run.picture, "contact");
  return at(at(run.cells.front().record, "effects"), "friction") == false ||
         std::any_of(points.begin(), points.end(),
                     [&](const json& p) { return at(p, "name") == contact && at(p, "state") == "closed"; });
}

/// States of the contacts in a step; of one without a solution those of its last iterate.
const json& contacts_of(const json& step) {
  return object_at(step.contains("iterate") ? at(step, "iterate") : step, "contacts");
}

/// Points of a contact by state in a step: open, stick and slip, or open and touches.
std::vector<std::pair<const char*, double>> states_of(const json& step, const std::string& contact, bool frictionless) {
  const json& counts = at(contacts_of(step), contact);
  const double open = number_at(counts, "open"), stick = number_at(counts, "stick"), slip = number_at(counts, "slip");
  if (frictionless) return {{"open", open}, {"touches", stick + slip}};
  return {{"open", open}, {"stick", stick}, {"slip", slip}};
}

/// What the solver and the contacts did in each step.
std::string steps_table(const Study& run) {
  const Cell& cell = run.cells.front();
  Table table;
  table.header = {"time", "status", "Newton", "in the history", "augmentations", "cutbacks", "worst KKT measure"};
  const json& steps = array_at(cell.record, "steps");
  if (steps.empty()) return "";
  constexpr std::size_t most_apart = 3;  // of more contacts the states of each share a column
  const bool apart = contacts_of(steps.front()).size() <= most_apart;
  std::vector<std::pair<std::string, bool>> contacts;  // and whether there is no friction
  for (const auto& [contact, unused] : contacts_of(steps.front()).items()) {
    contacts.emplace_back(contact, is_frictionless(run, contact));
    std::string words;
    for (const auto& [state, n] : states_of(steps.front(), contact, contacts.back().second)) {
      if (apart) table.header.push_back(contact + ": " + state);
      words += (words.empty() ? "" : " / ") + std::string(state);
    }
    if (!apart) table.header.push_back(contact + ": " + words);
  }
  constexpr std::size_t most = 1000;
  const std::size_t stride = (steps.size() + most - 1) / most;
  for (std::size_t n = 0; n < steps.size(); ++n) {
    if ((steps.size() - 1 - n) % stride != 0) continue;
    const json& step = steps[n];
    double worst = 0;
    for (const auto& [measure, value] : object_at(step, "kkt").items())
      if (value.is_number()) worst = std::max(worst, value.get<double>());
    std::vector<std::string> row = {number(number_at(step, "time"), 6),
                                    in_plain_words(text_at(step, "status")),
                                    whole(number_at(step, "newton")),
                                    whole(static_cast<double>(array_at(step, "history").size())),
                                    whole(number_at(step, "augmentations")),
                                    whole(number_at(step, "cutbacks")),
                                    number(worst)};
    for (const auto& [contact, frictionless] : contacts) {
      std::string counts;
      for (const auto& [state, points] : states_of(step, contact, frictionless)) {
        if (apart) row.push_back(whole(points));
        counts += (counts.empty() ? "" : " / ") + whole(points);
      }
      if (!apart) row.push_back(counts);
    }
    table.rows.push_back(row);
    const std::string status = text_at(step, "status");
    table.row_classes.emplace_back(status.starts_with("converged") ? "" : "failed");
  }
  return "<p class=\"note\">Newton: iterations of all attempts at a step. History: lines recorded for the last "
         "attempt.</p>\n" +
         compact_html(table, "Steps");
}

/// Of a parameter the largest of its derivatives, each over its response: what is next to nothing beside it is
/// rounding.
double largest_share(const Cell& cell, const std::string& parameter) {
  double largest = 0;
  for (const auto& [response, by] : object_at(cell.record, "sensitivities").items()) {
    const json &slope = at(by, parameter), &value = at(object_at(cell.record, "responses"), response);
    if (slope.is_number() && value.is_number() && value != 0)
      largest = std::max(largest, std::abs(slope.get<double>() / value.get<double>()));
  }
  return largest;
}

/// A derivative in eight digits; 0 where it is rounding.
std::string slope_in_words(double slope, double value, double largest_share) {
  constexpr double rounding = 1e-12;
  return std::abs(slope) <= rounding * largest_share * std::abs(value) ? "0" : number(slope, 8);
}

/// Whether the last step has a solution, be it an inaccurate one.
bool has_values_at_end(const Cell& cell) {
  const json& steps = array_at(cell.record, "steps");
  return steps.empty() || steps.back().contains("responses");
}

/// Of a run without a solution at its end: where it failed, and what is shown in its place; of an inaccurate one that
/// its values are no result; else empty.
std::string banner(const Cell& cell) {
  const json& steps = array_at(cell.record, "steps");
  if (has_values_at_end(cell))
    return cell.status != "inaccurate"
               ? ""
               : "<p class=\"banner\"><strong>Inaccurate.</strong> Errors are larger than method "
                 "and rounding explain. Do not use these values.</p>\n";
  const std::string shown = steps.size() > 1 ? fmt::format("What is shown is the last step that converged, t = {}.",
                                                           number(number_at(steps[steps.size() - 2], "time"), 6))
                                             : "No step before it converged: what is shown is the start.";
  return fmt::format("<p class=\"banner\"><strong>No solution at t = {}: {}.</strong> {}</p>\n",
                     number(number_at(steps.back(), "time"), 6), escape(in_plain_words(cell.status)), shown);
}

/// Responses and their derivatives at the last step that was solved, a line each.
Table last_values(const Cell& cell) {
  Table table;
  table.header = {"response", "value"};
  const json& sensitivities = object_at(cell.record, "sensitivities");
  for (const auto& [response, by] : sensitivities.items())
    for (const auto& [parameter, unused] : by.items())
      if (const std::string title = "d / d " + parameter;
          std::find(table.header.begin(), table.header.end(), title) == table.header.end())
        table.header.push_back(title);
  for (const auto& [response, value] : object_at(cell.record, "responses").items()) {
    std::vector<std::string> row = {response, value.is_number() ? number(value, 10) : ""};
    for (std::size_t column = 2; column < table.header.size(); ++column) {
      const std::string parameter = table.header[column].substr(6);
      const json& slope = at(at(sensitivities, response), parameter);
      row.push_back(
          slope.is_number() && value.is_number() ? slope_in_words(slope, value, largest_share(cell, parameter)) : "");
    }
    table.rows.push_back(row);
  }
  return table;
}

/// "3 displacements, 12 points": what is not zero of a row's amounts.
std::string amounts_in_words(const json& amounts) {
  std::string out;
  for (const auto& [name, amount] : amounts.items())
    if (amount.is_number() && amount != 0)
      out += (out.empty() ? "" : ", ") + amount_in_words(name, amount.get<double>());
  return out;
}

/// What each effect added, those that are off last.
std::string ledger_table(const Cell& cell) {
  Table table;
  table.header = {"effect", "unknowns", "kB", "of which", "counts", "seconds"};
  for (const bool on : {true, false})
    for (const auto& row : array_at(cell.record, "ledger")) {
      if ((at(row, "on") == true) != on) continue;
      const json &memory = object_at(row, "memory"), &seconds = at(row, "seconds");
      double bytes = 0;
      std::string parts;
      for (const auto& [name, amount] : memory.items()) {
        if (!amount.is_number() || amount == 0) continue;
        bytes += amount.get<double>();
        parts += (parts.empty() ? "" : ", ") + ledger_words(name) + " " + number(amount.get<double>() / 1000);
      }
      table.rows.push_back({ledger_words(text_at(row, "effect")),
                            on ? amounts_in_words(object_at(row, "unknowns")) : "off",
                            bytes > 0 ? number(bytes / 1000) : "", parts, amounts_in_words(object_at(row, "counts")),
                            seconds.is_number() && seconds != 0 ? number(seconds.get<double>(), 2) : ""});
    }
  return table.rows.empty() ? "" : to_html(table, "What each effect of the scene added");
}

}  // namespace

std::string first_of_run(const Study& run, Figures& figures) {
  auto responses = response_histories(run);
  const bool wide = responses && responses->charts.size() > 1;  // then they stand side by side below
  constexpr double low = 200;                                   // so that the first screen has them whole
  if (wide)
    for (Chart& chart : responses->charts) chart.height = low;
  const std::string scene = figures.show(draw_overview(run.picture)), histories = figures.show(std::move(responses));
  std::string out =
      banner(run.cells.front()) + "<p class=\"reason\">" + escape_sentence(how_it_ended(run.cells.front())) + "</p>\n";
  for (const auto& warning : warning_sentences(run)) out += "<p class=\"warning\">" + escape(warning) + "</p>\n";
  if (run.picture.is_null())
    out += "<p class=\"note\">The bodies and tractions were not recorded; <code>run --report</code> does.</p>\n";
  constexpr std::size_t most_columns = 6;  // that half a page has room for
  const Table values = last_values(run.cells.front());
  const std::string when =
      has_values_at_end(run.cells.front()) ? "at the last step" : "at the last step that converged";
  const std::string table = values.rows.empty() ? "" : to_html(values, "Responses " + when + ", and their derivatives");
  const bool narrow = values.header.size() <= most_columns;
  const std::string words = "<div>" + out + (narrow ? table : "") + "</div>\n", below = narrow ? "" : table;
  if (!wide && !scene.empty() && !histories.empty())
    return "<div class=\"first\"><div>" + scene + words + "</div>\n" + histories + "</div>\n" + below;
  return "<div class=\"first\">" + scene + words + "</div>\n" + below +
         (histories.empty() ? "" : "<div class=\"first histories\">" + histories + "</div>\n");
}

std::vector<Section> sections_of_run(const Study& run, Figures& figures) {
  auto derivatives = derivative_histories(run, first_choice(response_histories(run), "response"));
  if (derivatives) derivatives->folded.clear();
  std::string solution = steps_of_run(run, figures);
  solution += figures.beside(std::move(derivatives), film_of_states(run));
  if (needs_close_up(run.picture)) solution += figures.show(draw_picture(run.picture));
  solution += figures.show(tractions(run));
  auto convergence = convergence_histories(run);
  if (convergence) convergence->folded.clear();
  return {{"solution", "The solution", solution},
          {"solver", "The solver at work",
           figures.show(std::move(convergence)) + steps_table(run) + ledger_table(run.cells.front())},
          {"differentiability", "Where derivatives hold", figures.show(map_of_changes(run)) + table_of_margins(run)},
          {"certificate", "Certificate", certificate_of_run(run)},
          {"provenance", "Provenance", provenance(run)}};
}

}  // namespace stickslip::report
