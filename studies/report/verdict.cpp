#include "studies/report/verdict.hpp"

#include <fmt/format.h>

#include <sstream>

#include "studies/report/cheapest.hpp"
#include "studies/report/headline.hpp"
#include "studies/report/html.hpp"
#include "studies/report/verdict_reason.hpp"

namespace stickslip::report {
namespace {

std::string head_of(const Level& level) { return escape(level.whose) + "<span>" + escape(level.title()) + "</span>"; }

/// Escaped words, of which none is broken over two lines.
std::string unbroken(const std::string& text) {
  std::string out;
  std::istringstream words(text);
  for (std::string word; words >> word;) out += (out.empty() ? "<span>" : " <span>") + escape(word) + "</span>";
  return out;
}

/// The least seconds of a run and, where a timing pass has more, their median: "0.66–0.71 ms".
std::string timed(const Measure& measure, const Cell& run) {
  const std::string least = seconds_in_words(measure.seconds(run));
  const std::string median = seconds_in_words(measure.median(run));
  if (measure.median(run) <= measure.seconds(run) || median == least) return least;
  const std::string unit = median.substr(median.find(' '));
  return (least.ends_with(unit) ? least.substr(0, least.find(' ')) : least) + "–" + median;
}

/// `within`: the heads of the column, which narrow screens show beside each entry.
std::string entry(const Row& row, const Measure& measure, const Column& column, const Pick& pick,
                  const std::string& within) {
  const auto cell = [&](const std::string& kind, const std::string& content) {
    return fmt::format("<td data-within=\"{}\"{}>{}</td>", within, kind.empty() ? "" : " class=\"" + kind + "\"",
                       content);
  };
  const Cell* run = pick.run;
  if (!run) {
    const auto nearest = nearest_of(row, measure);
    return cell("missed", nearest ? "best " + percent(*nearest) : "no run");
  }
  const bool least = is_least(column, measure, *run), fastest = is_fastest(column, measure, *run);
  std::string cost = "<span>work " + number(measure.work(*run), 2) + (least ? " &#9733;" : "") + "</span>";
  if (measure.seconds(*run) > 0) cost += " <span>&middot; " + escape(timed(measure, *run)) + "</span>";
  if (fastest) cost += " &#9670;";
  return cell(least ? "least" : "", fmt::format("{}<br><small>{}</small>", unbroken(pick.setting()), cost));
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
      heads += "<th scope=\"col\">" + head_of(level) + "</th>";
      const Column column = column_of(rows, measure, level.error);
      const std::string within = escape(measure.noun() + " within " + level.whose + level.title());
      for (std::size_t i = 0; i < rows.size(); ++i)
        entries[i] += entry(rows[i], measure, column, column.runs[i], within);
    }
    sentences += reason(rows, measure, study.main_variant);
  }
  std::string body;
  for (std::size_t i = 0; i < rows.size(); ++i)
    body += "<tr><th scope=\"row\">" + unbroken(rows[i].head) + "</th>" + entries[i] + "</tr>\n";
  const std::string against =
      measures.front().on_same_mesh ? "exact contact on the same mesh" : discretization_reference(study);
  const std::string table = fmt::format(
      "<div class=\"wide\" role=\"region\" tabindex=\"0\" aria-label=\"Verdict\"><table class=\"verdict\">"
      "<caption>Cheapest settings within an accuracy of {}{}. &#9733; least work, up to 5 %{}{}</caption>\n<thead><tr>"
      "<th rowspan=\"2\">{}</th>{}</tr><tr>{}</tr></thead><tbody>\n{}</tbody></table></div>\n",
      escape(against), study.main_variant.empty() ? "" : escape(" (" + study.main_variant + ")"),
      body.find("&#9670;") == std::string::npos ? "" : "; &#9670; least time, up to 25 %",
      body.find("–") == std::string::npos ? "" : "; times: least–median", escape(rows_are), groups, heads, body);
  return {sentences, table, rows.size()};
}

}  // namespace stickslip::report
