#include "studies/run/solution_file.hpp"

#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>
#include <variant>

#include "core/solids/kinematics.hpp"
#include "methods/newton/regularisation.hpp"
#include "methods/stepping/checkpoints.hpp"
#include "studies/run/element_fields.hpp"
#include "studies/run/fields.hpp"

namespace stickslip {
namespace {

/// JSON as it grows. Keys need no escapes but those of names, which quoted() adds.
class SolutionWriter {
 public:
  SolutionWriter& raw(std::string_view text) {
    text_ += text;
    return *this;
  }
  SolutionWriter& quoted(const std::string& name) { return raw(nlohmann::json(name).dump()); }
  SolutionWriter& number(double value) {
    if (!std::isfinite(value)) return raw("null");
    char digits[32];
    text_.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
    return *this;
  }
  /// Items between brackets; `write(item)` writes one.
  template <class Items, class Write>
  SolutionWriter& list(const Items& items, Write&& write) {
    raw("[");
    bool first = true;
    for (const auto& item : items) {
      if (!std::exchange(first, false)) raw(",");
      write(item);
    }
    return raw("]");
  }
  template <class Numbers>
  SolutionWriter& numbers(const Numbers& values) {
    return list(values, [&](double value) { number(value); });
  }
  const std::string& text() const { return text_; }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

std::string_view element_name(const BodyMesh& body) {
  switch (body.mesh.shape) {
    case ElementShape::point:
      return "point";
    case ElementShape::bar2:
      return "bar";
    case ElementShape::tri3:
      return "T3";
    case ElementShape::quad4:
      return has_mean_dilatation(body.kinematics) ? "Q4_mean_dilatation" : "Q4";
    case ElementShape::tri6:
      return "T6";
    case ElementShape::quad8:
      return "Q8";
    case ElementShape::tet4:
      return "T4";
    case ElementShape::hex8:
      return has_mean_dilatation(body.kinematics) ? "H8_mean_dilatation" : "H8";
    case ElementShape::tet10:
      return "T10";
    case ElementShape::hex20:
      return "H20";
    case ElementShape::hex27:
      return "H27";
  }
  return "";
}

void write_solution_body(SolutionWriter& out, const BodyMesh& body) {
  const auto node = [&](int local) { out.number(body.first_node + local); };
  std::vector<int> elements(body.mesh.element_count());
  for (std::size_t e = 0; e < elements.size(); ++e) elements[e] = static_cast<int>(e);
  const int each = nodes_of(body.mesh.shape);
  out.raw(R"({"element":")").raw(element_name(body)).raw(R"(","elements":)");
  out.list(elements, [&](int e) {
    const auto first = body.mesh.connectivity.begin() + static_cast<std::ptrdiff_t>(e) * each;
    out.list(std::vector<int>(first, first + each), node);
  });
  out.raw(R"(,"sides":{)");
  bool first = true;
  for (const auto& [name, side] : body.mesh.sides) {
    if (!std::exchange(first, false)) out.raw(",");
    out.quoted(name).raw(":").list(side.nodes, node);
  }
  out.raw("}}");
}

void write_solution_mesh(SolutionWriter& out, const Problem& problem) {
  const auto& [model, slots, seconds] = problem;
  out.raw(R"({"nodes":)").list(slots.points.colwise(), [&](const auto& x) { out.numbers(x); }).raw(R"(,"bodies":{)");
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    out.raw(b > 0 ? ",\n" : "\n").quoted(model.scene.bodies[b].name).raw(":");
    write_solution_body(out, model.bodies[b]);
  }
  out.raw(R"(},"contacts":{)");
  bool first = true;
  for (const auto& contact : model.scene.contacts) {
    out.raw(std::exchange(first, false) ? "\n" : ",\n").quoted(contact.name).raw(R"(:{"of":)");
    out.quoted(contact.group.empty() ? contact.name : contact.group);
    out.raw(R"(,"slave":)").quoted(contact.slave).raw(R"(,"master":)").quoted(contact.master).raw("}");
  }
  out.raw("}");
  first = true;
  for (std::size_t o = 0; o < model.scene.obstacles.size(); ++o) {
    const auto& [name, shape, move, rotate] = model.scene.obstacles[o];
    if (!has_facets(shape) || std::holds_alternative<Polyline>(shape)) continue;  // (a polyline stands in the scene)
    out.raw(std::exchange(first, false) ? R"(,"obstacles":{)" : ",").raw("\n").quoted(name);
    out.raw(R"(:{"vertices":)").list(slots.vertices[o].colwise(), [&](const auto& x) { out.numbers(x); });
    out.raw(R"(,"facets":)").list(facets_of(shape), [&](const auto& facet) { out.numbers(facet); }).raw("}");
  }
  out.raw(first ? "}" : "}}");
}

/// 1 / rho of each point where the traction is that of springs; empty where a multiplier bears it.
RegularisationField<double> springs_of(const CaseResult& result, const Increment<double>& increment) {
  if (prevents_penetration(result.method)) return {};
  return adapted(initial_regularisation(result.problem->slots, result.method), increment.rho_factor);
}

void write_contact(SolutionWriter& out, const CaseResult& result, const Increment<double>& increment, int contact) {
  const auto& model = result.problem->model;
  std::vector<int> points;
  for (std::size_t p = 0; p < model.points.size(); ++p)
    if (model.points[p].contact == contact) points.push_back(static_cast<int>(p));
  out.raw(R"({"nodes":)").list(points, [&](int p) { out.number(model.points[p].nodes[0]); });
  out.raw(R"(,"traction":)").list(points, [&](int p) {
    const Vector<double> traction = traction_vector(*result.problem, increment.state, p);
    for (Eigen::Index i = 0; i < traction.size(); ++i) out.raw(i > 0 ? "," : "").number(traction[i]);
  });
  const auto rho = springs_of(result, increment);
  if (!rho.empty())
    out.raw(R"(,"compliance":)").list(points, [&](int p) {
      out.number(1 / rho[p].normal).raw(",").number(1 / rho[p].tangential);
    });
  out.raw("}");
}

/// Mean equivalent plastic strains of the elements of each body that flows.
void write_flow(SolutionWriter& out, const Problem& problem, const State<double>& state) {
  const auto& [model, slots, seconds] = problem;
  out.raw(R"(,"plastic_strain":{)");
  bool first = true;
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    if (model.bodies[b].memory == 0) continue;
    if (!std::exchange(first, false)) out.raw(",");
    out.quoted(model.scene.bodies[b].name).raw(":").numbers(mean_plastic_strains(problem, state, static_cast<int>(b)));
  }
  out.raw("}");
}

void write_increment(SolutionWriter& out, const CaseResult& result, const Increment<double>& increment) {
  const auto& contacts = result.problem->model.scene.contacts;
  out.raw(R"({"time":)").number(increment.time).raw(R"(,"status":")").raw(name_of(increment.status));
  out.raw(R"(","displacement":)").numbers(increment.state.displacement).raw(R"(,"contacts":{)");
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    out.raw(c > 0 ? "," : "").quoted(contacts[c].name).raw(":");
    write_contact(out, result, increment, static_cast<int>(c));
  }
  out.raw("}");
  if (result.problem->model.effects.plasticity) write_flow(out, *result.problem, increment.state);
  out.raw("}");
}

}  // namespace

nlohmann::json solution_frame(const Problem& problem, const nlohmann::json& scene) {
  SolutionWriter mesh;
  write_solution_mesh(mesh, problem);
  return {{"scene", scene}, {"mesh", nlohmann::json::parse(mesh.text())}};
}

SolutionFile solution_file(const CaseResult& result, const nlohmann::json& scene, std::size_t largest) {
  SolutionWriter out;
  out.raw(R"({"schema":"stickslip_solution","version":1,)").raw("\n\"scene\":").raw(scene.dump());
  out.raw(",\n\"mesh\":");
  write_solution_mesh(out, *result.problem);
  out.raw(",\n\"increments\":[");
  const std::size_t solved = result.trajectory.solved_count();
  for (std::size_t n = 0; n < solved; ++n) {
    const auto& increment = result.trajectory.increments[n];
    if (!is_whole(increment.state)) return {"", "states were let go to save memory (sensitivity/memory)"};
    out.raw(n > 0 ? ",\n" : "\n");
    write_increment(out, result, increment);
    if (out.text().size() > largest) return {"", "it would be larger than " + std::to_string(largest >> 20) + " MB"};
  }
  out.raw("]}\n");
  return {out.take(), ""};
}

}  // namespace stickslip
