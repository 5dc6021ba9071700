#include "studies/app/trace_table.hpp"

#include <fmt/format.h>

#include <cmath>

#include "studies/run/contact_points.hpp"

namespace stickslip {

namespace {

/// A residual of the table on the terminal; a dash where it is no number, as of an iterate that overflowed.
std::string residual_in_words(double value) { return std::isfinite(value) ? fmt::format("{:.2e}", value) : "-"; }

/// A number of the file; empty where it is none.
std::string cell(double value) { return std::isfinite(value) ? fmt::format("{}", value) : ""; }

}  // namespace

std::string trace_table(const Trace& trace) {
  std::string text = fmt::format("{:>10} {:>6} {:>5} {:>10} {:>11} {:>10} {:>10} {:>6} {:>6} {:>6} {:>8} {:>6}\n",
                                 "time", "solve", "iter.", "residual", "equilibrium", "normal", "tangential", "open",
                                 "stick", "slip", "changed", "step");
  for (const auto& i : trace.iterates)
    text +=
        fmt::format("{:>10.6g} {:>6} {:>5} {:>10} {:>11} {:>10} {:>10} {:>6} {:>6} {:>6} {:>8} {:>6.3g}\n", i.time,
                    i.solve, i.number, residual_in_words(i.record.residual), residual_in_words(i.record.equilibrium),
                    residual_in_words(i.record.normal), residual_in_words(i.record.tangential), i.record.open,
                    i.record.stick, i.record.slip, i.record.changed, i.record.step_length);
  return text;
}

std::string trace_csv(const Problem& problem, const Trace& trace) {
  const auto& points = problem.model.points;
  const bool few = points.size() <= Trace::most_points;
  std::string text = "time,solve,iterate,residual,equilibrium,normal,tangential,open,stick,slip,changed,step_length";
  for (std::size_t p = 0; few && p < points.size(); ++p) {
    text += fmt::format(",state_{}", p);
    for (const char* what : {"lambda", "trial", "traction"})
      for (int c = 0; c < points[p].components(); ++c)
        text += fmt::format(",{}_{}_{}", what, p, c == 0 ? "n" : c == 1 ? "t" : "t2");
  }
  text += "\n";
  for (const auto& i : trace.iterates) {
    const auto& r = i.record;
    text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{}", i.time, i.solve, i.number, cell(r.residual),
                        cell(r.equilibrium), cell(r.normal), cell(r.tangential), r.open, r.stick, r.slip, r.changed,
                        cell(r.step_length));
    for (std::size_t p = 0; few && p < points.size(); ++p) {
      text += fmt::format(",{}", branch_name(i.state[p]));
      for (const auto* of : {&i.multiplier, &i.trial, &i.traction})
        for (int c = 0; c < points[p].components(); ++c) text += "," + cell((*of)[points[p].multiplier + c]);
    }
    text += "\n";
  }
  return text;
}

std::vector<report::ConePath> cone_paths(const Problem& problem, const Trace& trace) {
  const auto& [model, slots, unused] = problem;
  std::vector<report::ConePath> paths;
  for (std::size_t p = 0; p < model.points.size() && model.points.size() <= Trace::most_points; ++p) {
    const auto& point = model.points[p];
    if (point.tangents == 0) continue;
    auto tangential = [&](const Vector<double>& of) {
      const auto t = of.segment(point.multiplier + 1, point.tangents);
      return point.tangents == 1 ? t[0] : t.norm();
    };
    report::ConePath path{fmt::format("{}, point {}", model.scene.contacts[point.contact].name, p),
                          slots.friction[point.contact],
                          point.tangents > 1,
                          model.bodies[point.slave_body].mesh.shape == ElementShape::point,
                          {}};
    for (std::size_t i = 0; i < trace.iterates.size(); ++i) {
      const auto& now = trace.iterates[i];
      const bool last = i + 1 == trace.iterates.size() || trace.iterates[i + 1].solve != now.solve;
      path.iterates.push_back({-now.trial[point.multiplier], tangential(now.trial), -now.traction[point.multiplier],
                               tangential(now.traction), last, now.time});
    }
    paths.push_back(std::move(path));
  }
  return paths;
}

}  // namespace stickslip
