#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "studies/io/wording.hpp"
#include "studies/report/chart_parts.hpp"
#include "studies/report/headline.hpp"
#include "studies/report/labels.hpp"
#include "studies/report/look_up.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

constexpr double together = 0.1;  ///< curves that are nowhere further apart, relatively, are drawn as one
const char* const worst_response = "worst response";

/// Whether a study without levels varies the mesh of a scene: then its meshes are a series of their own.
bool varies_meshes(const Study& study) {
  std::map<std::string, std::set<std::string>> meshes;  // by what else varies
  for (const auto& cell : study.cells) meshes[cell.beside].insert(cell.mesh);
  return !study.refined && std::any_of(meshes.begin(), meshes.end(), [](auto& of) { return of.second.size() > 1; });
}

/// Where a cell stands in the series of meshes: its level or, of meshes that are varied, its unknowns, and the mesh,
/// for two meshes may have as many.
struct MeshPlace {
  int level;
  std::string mesh;
  auto operator<=>(const MeshPlace&) const = default;
};
MeshPlace place_of(const Study& study, const Cell& cell) {
  if (study.refined) return {cell.refine, ""};
  return {static_cast<int>(number_at(at(cell.record, "size"), "displacements")), cell.mesh};
}

const std::string& scene_of(const Study& study, const Cell& cell) { return study.refined ? cell.scene : cell.beside; }

/// One setting over the meshes.
struct Curve {
  std::string name, family;
  std::map<MeshPlace, double> errors;
  double own = 0;  ///< worst enforcement error of its responses: what the method adds
};

/// How far apart two curves are at most, of the second; infinite where they have not the same levels.
double distance(const Curve& curve, const Curve& other) {
  if (curve.errors.size() != other.errors.size()) return INFINITY;
  double most = 0;
  for (const auto& [level, error] : other.errors) {
    const auto found = curve.errors.find(level);
    if (found == curve.errors.end()) return INFINITY;
    if (std::max(found->second, error) > rounding_error) most = std::max(most, std::abs(found->second / error - 1));
  }
  return most;
}

/// Curves that lie on each other; the first stands for them all.
struct Bundle {
  std::vector<Curve> curves;

  /// How far the largest error of a mesh is from the least, relatively, where it is so most.
  double spread() const {
    double most = 0;
    for (const auto& [level, unused] : curves.front().errors) {
      double least = INFINITY, largest = rounding_error;
      for (const Curve& curve : curves) {
        least = std::min(least, std::max(curve.errors.at(level), rounding_error));
        largest = std::max(largest, curve.errors.at(level));
      }
      most = std::max(most, largest / least - 1);
    }
    return most;
  }
  bool is_of_one_method() const {
    return std::all_of(curves.begin(), curves.end(),
                       [&](const Curve& curve) { return curve.family == curves.front().family; });
  }
  /// "Penalty stiffness=1"; "12 runs, within 0.9 %".
  std::string name() const {
    if (curves.size() == 1) return curves.front().name;
    const std::string runs = is_of_one_method() ? family_name(curves.front().family) + " runs" : "runs";
    return fmt::format("{} {}, {}", curves.size(), runs, spread() > 0 ? "within " + percent(spread()) : "alike");
  }
  std::string members() const {
    std::string out;
    for (const Curve& curve : curves) out += (out.empty() ? "" : ", ") + curve.name;
    return out;
  }
};

/// The curves of a quantity in bundles. The strictest begin, so that those that a loose setting bends away stand alone.
std::vector<Bundle> bundled(std::vector<Curve> curves) {
  std::stable_sort(curves.begin(), curves.end(), [](const Curve& a, const Curve& b) { return a.own < b.own; });
  std::vector<Bundle> bundles;
  for (Curve& curve : curves) {
    const auto near = std::find_if(bundles.begin(), bundles.end(), [&](const Bundle& bundle) {
      return distance(curve, bundle.curves.front()) <= together / 2;  // two of them are then no further apart than all
    });
    if (near == bundles.end()) {
      bundles.push_back({{std::move(curve)}});
    } else {
      near->curves.push_back(std::move(curve));
    }
  }
  return bundles;
}

/// What errors on different meshes have in common with one another, or have not: a mesh compared with itself shows less
/// than its error, and not the same share of it on each.
std::string against_itself(const Study& study) {
  for (const auto& reference : array_at(study.description, "reference"))
    if (const json& overkill = at(reference, "overkill"); !overkill.is_null() && object_at(overkill, "vary").empty())
      return fmt::format(" Each mesh is compared with itself, {} finer, and not with one common mesh.",
                         counted(static_cast<long>(number_at(overkill, "refine")), "level"));
  return {};
}

/// The curves of each scene and quantity.
std::map<std::pair<std::string, std::string>, std::vector<Curve>> curves_of(const Study& study) {
  std::map<std::pair<std::string, std::string>, std::vector<Curve>> out;
  for (const auto& cell : study.cells) {
    if (!cell.converged) continue;
    const double own = worst(cell.enforcement, "response:").value_or(0);
    for (const auto& [quantity, error] :
         quantities(cell.discretization, {"response:", "sensitivity:"}, worst_response)) {
      auto& curves = out[{scene_of(study, cell), quantity}];
      auto curve = std::find_if(curves.begin(), curves.end(), [&](const Curve& c) { return c.name == in_words(cell); });
      if (curve == curves.end()) curve = curves.insert(curves.end(), {in_words(cell), cell.family, {}, 0});
      curve->errors[place_of(study, cell)] = error;
      curve->own = std::max(curve->own, own);
    }
  }
  return out;
}

/// A curve a bundle, against place_of().
void add_bundles(const Study& study, SeriesList& series, json& rows) {
  for (auto& [choice, curves] : curves_of(study))
    for (const Bundle& bundle : bundled(std::move(curves))) {
      const std::string name = bundle.name(), &family = bundle.curves.front().family;
      if (!bundle.is_of_one_method() && series.place(name) == series.list.size())
        series.list.push_back({name, "$ink", "circle", {1, 0}, 60});
      series.add(name, family);
      for (const auto& [place, error] : bundle.curves.front().errors)
        rows.push_back({{"panel", "level"},
                        {"label", bundle.members()},
                        {"family", family},
                        {"failed", false},
                        {"series", name},
                        {"line", name},
                        {"scene", choice.first},
                        {"quantity", choice.second},
                        {"error", error},
                        {"level", place.level},
                        {"order", place.level}});
    }
}

/// A curve a setting, against seconds.
void add_settings(const Study& study, SeriesList& series, json& rows) {
  for (const auto& cell : study.cells) {
    if (!(cell.sensitivity_seconds > 0)) continue;
    const std::string name = in_words(cell);
    for (const auto& [quantity, error] :
         quantities(cell.discretization, {"response:", "sensitivity:"}, worst_response)) {
      json r = row_of(cell);
      r["panel"] = "seconds";
      r["series"] = r["line"] = name;
      r["of_cell"] = "yes";
      r["scene"] = scene_of(study, cell);
      r["quantity"] = quantity;
      r["error"] = error;
      r["level"] = r["order"] = place_of(study, cell).level;
      r["seconds"] = cell.sensitivity_seconds;
      rows.push_back(r);
      series.add(name, cell.family);
    }
  }
}

}  // namespace

std::optional<Figure> mesh_convergence(const Study& study) {
  const bool varied = varies_meshes(study);
  if (!study.refined && !varied) return std::nullopt;
  Figure figure;
  SeriesList series(study);
  figure.id = "mesh";
  figure.title = varied ? "The same error on each of the meshes" : "The same error as the mesh is refined";
  const auto shown = telling_cells(study, Furthest::added);
  add_first(series, study, shown);
  add_bundles(study, series, figure.rows);
  add_settings(study, series, figure.rows);
  if (figure.rows.empty()) return std::nullopt;
  show_zeros(figure.rows, "error");
  figure.series = series.list;
  figure.text =
      std::string(varied ? "The meshes are those that the study varies." : "Each level halves the elements.") +
      " Errors are against " + discretization_reference(study) + "." + against_itself(study) +
      " In the first chart runs that differ by less than 10 % on every mesh are one curve. Where a loose "
      "setting's curve levels off, its own error has overtaken the mesh's. ";
  const std::string meshes = varied ? "displacement unknowns" : "mesh level";
  const Quantity error{"shown", "relative error", Spacing::logarithmic};
  figure.charts.push_back({.title = varied ? "against unknowns" : "against the mesh level",
                           .x = {.field = "level",
                                 .title = meshes,
                                 .spacing = varied ? Spacing::logarithmic : Spacing::linear,
                                 .least_step = 1},
                           .y = error,
                           .tooltip = {{"label", "runs"}, {"level", meshes}, {"error", "error"}},
                           .only = "level"});
  if (!distinct(figure.rows, "series", "seconds").empty()) {
    figure.text +=
        "Cost is in seconds, since counts are of unlike matrices; shown at first are the most accurate run of each "
        "method and the one furthest off.";
    figure.charts.push_back(
        {.title = "against seconds",
         .x = {"seconds", "seconds", Spacing::logarithmic},
         .y = error,
         .tooltip = {{"label", "method"}, {"level", meshes}, {"error", "error"}, {"seconds", "seconds"}},
         .only = "seconds"});
  }
  offer(figure, "Quantity", "quantity", worst_response);
  const auto main =
      std::find_if(study.cells.begin(), study.cells.end(), [&](auto& c) { return c.variant == study.main_variant; });
  offer(figure, "Scene", "scene", scene_of(study, *main));
  offer_cells(figure, shown);
  return figure;
}

}  // namespace stickslip::report
