#include "studies/report/certificates.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "studies/report/html.hpp"
#include "studies/report/look_up.hpp"

namespace stickslip::report {

using nlohmann::json;

std::string certificate_of_run(const Study& run) {
  if (!run.certificate.is_object()) return "";
  struct Worst {
    const json* law = nullptr;
    double ratio = -1, time = 0;
  };
  std::map<std::string, Worst> worst;
  for (const auto& step : array_at(run.certificate, "steps"))
    for (const auto& [name, law] : object_at(step, "laws").items()) {
      const double value = number_at(law, "value"), allowed = number_at(law, "allowed");
      const double ratio = !std::isfinite(value) ? INFINITY : allowed > 0 ? value / allowed : value > 0 ? INFINITY : 0;
      if (ratio > worst[name].ratio) worst[name] = {&law, ratio, number_at(step, "time")};
    }
  Table table;
  table.header = {"law", "", "error", "allowed", "why so much is allowed", "at t", "where"};
  for (const auto& [name, found] : worst) {
    const bool holds = at(*found.law, "holds") == true;
    table.rows.push_back({name, holds ? "holds" : "does not hold", number(number_at(*found.law, "value"), 2),
                          number(number_at(*found.law, "allowed"), 2), text_at(*found.law, "why"),
                          number(found.time, 6), text_at(*found.law, "where")});
    table.row_classes.emplace_back(holds ? "" : "failed");
  }
  std::string out = fmt::format(
      "<p>{} Each law is checked from the files alone, by code that shares nothing with the solver (<code>stickslip "
      "verify</code>); of each the step is shown in which it is nearest to its bound.</p>\n",
      at(run.certificate, "holds") == true ? "Every law holds at every step." : "Not every law holds.");
  for (const auto& remark : array_at(run.certificate, "remarks"))
    out += "<p class=\"note\">" + escape(plain(remark)) + "</p>\n";
  return out + to_html(table, "Certificate");
}

std::string certificates_of_study(const Study& study) {
  if (study.peers.empty()) return "";
  Table table;
  table.header = {"solution",
                  "scene",
                  "certificate",
                  "nearest to its bound",
                  "error",
                  "allowed",
                  "at t",
                  "where",
                  "largest difference to exact contact, same mesh",
                  "largest difference to " + discretization_reference(study)};
  const auto shown = [](const std::optional<double>& v) { return v ? number(*v) : std::string(); };
  for (const auto* cells : {&study.peers, &study.cells})
    for (const auto& cell : *cells) {
      const json& found = object_at(cell.record, "certificate");
      const bool holds = at(found, "holds") == true, is_known = found.contains("law");
      const auto figure = [&](const char* key, int digits) {
        return is_known ? number(number_at(found, key), digits) : std::string();
      };
      table.rows.push_back({cell.label, cell.variant,
                            holds      ? "holds"
                            : is_known ? "does not hold"
                                       : "none: " + text_at(found, "left_out"),
                            text_at(found, "law"), figure("value", 2), figure("allowed", 2), figure("time", 6),
                            text_at(found, "where"), shown(worst(cell.enforcement, "response:")),
                            shown(worst(cell.discretization, "response:"))});
      table.row_classes.emplace_back(holds ? "" : "failed");
    }
  return "<p>Solutions of other programs, and of the runs, under one certificate: each law is checked by code that "
         "shares nothing with the solver (<code>stickslip verify</code>). The law is shown that is nearest to its "
         "bound. A point counts as pressing if its pressure is more than 1e-6 of the largest traction, whatever "
         "accuracy a solution claims. Differences are of responses, over their largest values.</p>\n" +
         compact_html(table, "Certificates");
}

}  // namespace stickslip::report
