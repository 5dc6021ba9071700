#include "studies/references.hpp"

#include <cmath>
#include <optional>

#include "sensitivity/direct.hpp"

namespace stickslip {
namespace {

using nlohmann::json;

struct ClosedForm {
  const char* name;
  std::vector<std::string> inputs, outputs;
};

const std::vector<ClosedForm>& closed_forms() {
  static const std::vector<ClosedForm> all = {
      {"hertz_line", {"force"}, {"peak_pressure", "half_width"}},
      {"cattaneo_mindlin", {"force", "tangential_force"}, {"peak_pressure", "half_width", "stick_half_width"}}};
  return all;
}

const ClosedForm* find(const std::string& name) {
  for (const auto& form : closed_forms())
    if (name == form.name) return &form;
  return nullptr;
}

/// The numbers of a line contact, in any scalar.
template <class T>
struct LineContact {
  T half_width, peak_pressure, stick_half_width{};

  LineContact(const T& force, const T& modulus, const T& radius) {
    const T pi(std::acos(-1.0));
    using std::sqrt;
    half_width = sqrt(T(4.0) * force * radius / (pi * modulus));
    peak_pressure = T(2.0) * force / (pi * half_width);
  }
  void shear(const T& force, const T& tangential, const T& friction) {
    using std::sqrt;
    const T share = T(1.0) - tangential / (friction * force);
    stick_half_width = value(share) > 0 ? half_width * sqrt(share) : T(0.0);
  }
};

/// 1/E* of a contact, from the bodies of its sides.
template <class T>
T compliance(const Model& model, const Numbers<T>& numbers, const Contact& contact) {
  T sum{};
  for (const auto& side : {contact.slave, contact.master})
    for (const auto& body : model.scene.bodies)
      if (side.rfind(body.name + ".", 0) == 0) {
        const auto& elastic = std::get<LinearElastic>(body.material);
        const T nu = numbers(elastic.nu);
        sum += (T(1.0) - nu * nu) / numbers(elastic.E);
      }
  return sum;
}

/// Index of the response that plays `quantity` in the map; -1 if none does.
int response_for(const json& map, const std::string& quantity, const Scene& scene) {
  for (const auto& [response, role] : map.items())
    if (role == quantity)
      for (std::size_t i = 0; i < scene.responses.size(); ++i)
        if (scene.responses[i].name == response) return static_cast<int>(i);
  return -1;
}

template <class T>
std::map<std::string, T> quantities(const std::string& form, const Model& model, const Numbers<T>& numbers,
                                    const Contact& contact, double radius, const T& force, const T& tangential) {
  LineContact<T> line(force, T(1.0) / compliance(model, numbers, contact), T(radius));
  std::map<std::string, T> out{{"peak_pressure", line.peak_pressure}, {"half_width", line.half_width}};
  if (form == "cattaneo_mindlin") {
    line.shear(force, tangential, contact.friction ? numbers(*contact.friction) : T(0.0));
    out["stick_half_width"] = line.stick_half_width;
  }
  return out;
}

/// Initial abscissa of the centre of pressure of the first contact.
double pressure_centre(const CaseResult& result) {
  const auto& [model, slots, unused] = *result.problem;
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

/// Reference tractions along the contact, over its initial abscissa.
json curves_of(const CaseResult& result, const std::map<std::string, double>& values, double friction, double sign) {
  const double b = values.at("half_width"), p0 = values.at("peak_pressure");
  const double c = values.count("stick_half_width") ? values.at("stick_half_width") : b;
  const bool sheared = values.count("stick_half_width") > 0;
  const double centre = pressure_centre(result);
  json place = json::array(), normal = json::array(), tangential = json::array();
  constexpr int samples = 400;
  for (int i = 0; i <= samples; ++i) {
    const double x = 1.3 * b * (2.0 * i / samples - 1);
    const double p = std::abs(x) < b ? p0 * std::sqrt(1 - x * x / (b * b)) : 0;
    double q = sheared ? friction * p : 0;
    if (sheared && std::abs(x) < c) q -= friction * p0 * c / b * std::sqrt(1 - x * x / (c * c));
    place.push_back(centre + x);
    normal.push_back(-p);
    tangential.push_back(sign * q);
  }
  return {{result.problem->model.scene.contacts.front().name,
           {{"x", place}, {"normal", normal}, {"tangential", tangential}}}};
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

std::vector<std::string> analytic_names() {
  std::vector<std::string> names;
  for (const auto& form : closed_forms()) names.push_back(form.name);
  return names;
}

std::vector<std::string> analytic_quantities(const std::string& name) {
  const auto* form = find(name);
  if (!form) return {};
  auto all = form->inputs;
  all.insert(all.end(), form->outputs.begin(), form->outputs.end());
  return all;
}

ReferenceValues reference_values(const json& entry, const CaseResult& result, std::string& error) {
  if (entry.contains("values")) return from_values(entry["values"]);
  ReferenceValues reference;
  const std::string name = entry.value("analytic", "");
  const auto& model = result.problem->model;
  const auto& scene = model.scene;
  if (!find(name) || result.steps.empty()) {
    error = "there is no closed form \"" + name + "\"";
    return reference;
  }
  const json map = entry.value("map", json::object());
  const int force = response_for(map, "force", scene), tangential = response_for(map, "tangential_force", scene);
  const double radius = entry.value("radius", 0.0);
  const bool sheared = name == "cattaneo_mindlin";
  if (force < 0 || (sheared && tangential < 0) || !(radius > 0) || scene.contacts.empty()) {
    error = name + " needs a response for force" + (sheared ? " and for tangential_force" : "") + ", and radius > 0";
    return reference;
  }
  const auto& contact = scene.contacts.front();
  const auto& step = result.steps.back();
  const double P = step.responses[force], Q = tangential < 0 ? 0 : std::abs(step.responses[tangential]);
  if (!(P > 0)) return reference;  // open: the closed form says nothing
  const auto plain = quantities<double>(name, model, scene.as<double>(), contact, radius, P, Q);
  reference.curves = curves_of(result, plain, contact.friction ? contact.friction->value : 0, tangential_sign(result));
  for (const auto& [response, role] : map.items())
    if (plain.count(role)) reference.responses[response] = plain.at(role);
  if (step.sensitivities.size() == 0) return reference;
  for (std::size_t j = 0; j < scene.parameters.size(); ++j) {
    using D = Dual<1>;
    auto numbers = scene.as<D>();
    for (const auto& [slot, weight] : scene.parameters[j].slots) numbers.at_slot[slot].d[0] += weight;
    D measured_force(P), measured_tangential(Q);
    measured_force.d[0] = step.sensitivities(force, j);
    if (tangential >= 0)
      measured_tangential.d[0] = (step.responses[tangential] < 0 ? -1 : 1) * step.sensitivities(tangential, j);
    const auto dual = quantities<D>(name, model, numbers, contact, radius, measured_force, measured_tangential);
    for (const auto& [response, role] : map.items())
      if (dual.count(role)) reference.sensitivities[response][scene.parameters[j].name] = dual.at(role).d[0];
  }
  return reference;
}

}  // namespace stickslip
