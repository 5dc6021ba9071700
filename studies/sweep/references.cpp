#include "studies/sweep/references.hpp"

#include <cmath>
#include <optional>

#include "studies/run/contact_points.hpp"
#include "studies/sweep/closed_forms.hpp"

namespace stickslip {
namespace {

using nlohmann::json;
using D = Dual<1>;

/// 1/E* of a contact, from the elastic bodies of its sides (a rigid one adds nothing). In plane stress sum 1/E.
D contact_modulus(const Scene& scene, const Numbers<D>& numbers, const Contact& contact) {
  D compliance{};
  for (const auto& side : {contact.slave, contact.master})
    for (const auto& body : scene.bodies) {
      if (side.rfind(body.name + ".", 0) != 0) continue;
      const auto add = [&](const auto& material) {
        if constexpr (requires { material.E, material.nu; }) {
          const D nu = scene.space == Space::plane_stress ? D(0) : numbers(material.nu);
          compliance += (D(1) - nu * nu) / numbers(material.E);
        }
      };
      std::visit(add, body.material);
    }
  return D(1) / compliance;
}

std::optional<std::size_t> index_of(const std::string& name, const auto& named) {
  for (std::size_t i = 0; i < named.size(); ++i)
    if (named[i].name == name) return i;
  return std::nullopt;
}

/// A parameter as a quantity: its number over its weight; the derivative is 1 along itself.
D parameter_quantity(const Parameter& parameter, const Numbers<D>& numbers) {
  const auto& [slot, weight] = parameter.slots.front();
  return numbers.at_slot[static_cast<std::size_t>(slot)] / D(weight);
}

/// Inputs of the closed form; their derivatives are along `parameter` (none: zero).
Quantities<D> inputs_of(const ClosedForm& form, const json& entry, const CaseResult& result,
                        std::optional<std::size_t> parameter) {
  const auto& scene = result.problem->model.scene;
  const auto& step = result.steps.back();
  auto numbers = scene.as<D>();
  if (parameter)
    for (const auto& [slot, weight] : scene.parameters[*parameter].slots)
      numbers.at_slot[static_cast<std::size_t>(slot)].d[0] += weight;
  Quantities<D> in;
  const json map = entry.value("map", json::object()), inputs = entry.value("inputs", json::object());
  for (const auto& [response, role] : map.items()) {
    const auto i = index_of(response, scene.responses);
    if (!i || !form.has_input(role)) continue;
    const auto row = static_cast<Eigen::Index>(*i);
    D measured(step.responses[row]);
    if (parameter) measured.d[0] = step.sensitivities(row, static_cast<Eigen::Index>(*parameter));
    in[role.get<std::string>()] = measured;
  }
  for (const auto& [quantity, given] : inputs.items())
    if (given.is_number())
      in[quantity] = D(given.get<double>());
    else if (const auto j = index_of(given.get<std::string>(), scene.parameters))
      in[quantity] = parameter_quantity(scene.parameters[*j], numbers);
  if (scene.contacts.empty()) return in;
  const auto& contact = scene.contacts.front();
  if (form.has_input("modulus") && !in.count("modulus")) in["modulus"] = contact_modulus(scene, numbers, contact);
  if (form.has_input("friction") && !in.count("friction") && contact.friction)
    if (const auto* law = std::get_if<Coulomb<Number>>(&contact.friction->law); law && !law->limit)
      in["friction"] = numbers(law->coefficient);
  return in;
}

/// Initial abscissa of the centre of pressure of the first contact.
double pressure_centre(const CaseResult& result) {
  const auto& model = result.problem->model;
  const auto& slots = result.problem->slots;
  const auto& traction = result.steps.back().increment->state.contact.traction;
  double force = 0, moment = 0;
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    const auto& point = model.points[p];
    if (point.contact != 0) continue;
    const double share = slots.geometry[p].area * traction[point.multiplier];
    force += share;
    moment += share * slots.points(0, point.nodes[0]);
  }
  return moment / force;
}

/// Sign of the sum of tangential components over the contact, to draw the curve on the side of the data.
double tangential_sign(const CaseResult& result) {
  const auto& model = result.problem->model;
  double sum = 0;
  for (std::size_t p = 0; p < model.points.size(); ++p)
    if (model.points[p].tangents == 1)
      sum += result.problem->slots.geometry[p].area *
             result.steps.back().increment->state.contact.traction[model.points[p].multiplier + 1];
  return sum < 0 ? -1 : 1;
}

/// Reference tractions along the first contact, over its initial abscissa "x" or its arc "s"; none where nothing
/// presses there, or the form has no curve for these inputs.
json curves_of(const ClosedForm& form, const CaseResult& result, const Quantities<double>& all) {
  const bool over_arc = form.over == ClosedForm::Over::arc;
  const auto arc = arc_of(*result.problem, 0);
  const double begin = over_arc ? 0 : pressure_centre(result), sign = tangential_sign(result);
  const auto curve = form.tractions(all, arc.empty() ? 0 : arc.back());
  if (!std::isfinite(begin) || curve.empty()) return {};
  json place = json::array(), normal = json::array(), tangential = json::array();
  for (const auto& at : curve) {
    place.push_back(begin + at.place);
    normal.push_back(-at.pressure);
    tangential.push_back(sign * at.tangential);
  }
  return {{result.problem->model.scene.contacts.front().name,
           {{over_arc ? "s" : "x", place}, {"normal", normal}, {"tangential", tangential}}}};
}

ReferenceValues from_values(const json& values) {
  ReferenceValues reference;
  for (const auto& [key, number] : values.items()) {
    const auto slash = key.find('/');
    if (slash == std::string::npos)
      reference.responses[key] = number;
    else
      reference.sensitivities[key.substr(0, slash)][key.substr(slash + 1)] = number;
  }
  return reference;
}

}  // namespace

ReferenceValues reference_values(const json& entry, const CaseResult& result) {
  if (entry.contains("values")) return from_values(entry["values"]);
  ReferenceValues reference;
  const ClosedForm* const form = find_closed_form(entry.value("analytic", ""));
  if (!form || result.steps.empty()) return reference;
  const auto& scene = result.problem->model.scene;
  const json map = entry.value("map", json::object());
  const auto in = inputs_of(*form, entry, result, std::nullopt), out = form->outputs_of(in, scene.space);
  if (out.empty()) return reference;
  for (const auto& [response, role] : map.items())
    if (const auto quantity = out.find(role); quantity != out.end())
      reference.responses[response] = value(quantity->second);
  if (form->tractions && !scene.contacts.empty()) {
    Quantities<double> all;
    for (const auto* quantities : {&in, &out})
      for (const auto& [name, quantity] : *quantities) all[name] = value(quantity);
    reference.curves = curves_of(*form, result, all);
  }
  for (std::size_t j = 0; result.steps.back().sensitivities.size() > 0 && j < scene.parameters.size(); ++j) {
    const auto along = form->outputs_of(inputs_of(*form, entry, result, j), scene.space);
    for (const auto& [response, role] : map.items())
      if (const auto quantity = along.find(role); quantity != along.end())
        reference.sensitivities[response][scene.parameters[j].name] = quantity->second.d[0];
  }
  return reference;
}

ReferenceValues values_of(const CaseResult& result) {
  ReferenceValues values;
  if (result.steps.empty()) return values;
  const auto& scene = result.problem->model.scene;
  const auto& last = result.steps.back();
  for (std::size_t i = 0; i < scene.responses.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    values.responses[scene.responses[i].name] = last.responses[row];
    for (std::size_t j = 0; last.sensitivities.size() > 0 && j < scene.parameters.size(); ++j)
      values.sensitivities[scene.responses[i].name][scene.parameters[j].name] =
          last.sensitivities(row, static_cast<Eigen::Index>(j));
  }
  const auto& gradients = result.gradients.of_objectives;
  for (std::size_t i = 0; i < scene.objectives.size(); ++i) {
    values.responses[scene.objectives[i].name] = result.objectives[i];
    for (std::size_t j = 0; gradients.size() > 0 && j < scene.parameters.size(); ++j)
      values.sensitivities[scene.objectives[i].name][scene.parameters[j].name] = gradients(i, j);
  }
  return values;
}

}  // namespace stickslip
