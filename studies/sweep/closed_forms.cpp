#include "studies/sweep/closed_forms.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace stickslip {
namespace {

using D = Dual<1>;
using In = Quantities<D>;
using Out = Quantities<D>;

const double pi = std::acos(-1.0);

/// sqrt(1 - (x/a)^2), 0 outside.
double half_ellipse(double x, double a) { return std::abs(x) < a ? std::sqrt(1 - x * x / (a * a)) : 0; }

using Curve = std::vector<ClosedForm::Tractions>;

constexpr int samples = 400;  // of a curve that bends

double hertz_pressure(const Quantities<double>& all, double x) {
  return all.at("peak_pressure") * half_ellipse(x, all.at("half_width"));
}

/// Pressure and tangential traction at distances up to `reach` on either side.
template <class At>
Curve symmetric_curve(double reach, At at) {
  Curve curve;
  for (int i = 0; i <= samples; ++i) {
    const double x = reach * (2.0 * i / samples - 1);
    const auto [pressure, tangential] = at(x);
    curve.push_back({x, pressure, tangential});
  }
  return curve;
}

/// Stiffness E1 and ratio n of plane strain in the formulas of plane stress.
struct Plane2D {
  D E, nu;
  Plane2D(const In& in, Space space) : E(in.at("E")), nu(in.at("nu")) {
    if (space == Space::plane_stress) return;
    E = E / (D(1) - nu * nu);
    nu = nu / (D(1) - nu);
  }
};

const ClosedForm::Quantity force{"force", "pressing force per length", positive}, E{"E", "Young's modulus", positive},
    nu{"nu", "Poisson's ratio", poisson_ratio}, radius{"radius", "relative radius, 1/R = 1/R1 + 1/R2", positive},
    modulus{"modulus", "contact modulus E* [of the two bodies of the contact]", positive, true, true},
    friction{"friction", "coefficient [of the contact]", not_negative, true, true},
    half_width{"half_width", "half the width of the contact"}, peak{"peak_pressure", "largest pressure"},
    load{"load", "load per length", positive}, gap{"gap", "distance at the start", positive},
    height{"height", "of the beam", positive};

Out hertz_line(const In& in, Space) {
  const D& P = in.at("force");
  const D b = sqrt(D(4) * P * in.at("radius") / (D(pi) * in.at("modulus")));
  return {{"half_width", b}, {"peak_pressure", D(2) * P / (D(pi) * b)}};
}

Curve hertz_tractions(const Quantities<double>& all, double) {
  return symmetric_curve(1.3 * all.at("half_width"), [&](double x) { return std::pair{hertz_pressure(all, x), 0.0}; });
}

ClosedForm hertz_line_form() {
  return {"hertz_line",
          "two cylinders pressed together [J85 4.2]",
          {force, radius, modulus},
          {half_width, peak},
          hertz_line,
          hertz_tractions};
}

Out cattaneo_mindlin(const In& in, Space space) {
  Out out = hertz_line(in, space);
  const D& Q = in.at("tangential_force");
  const D share = D(1) - (value(Q) < 0 ? -Q : Q) / (in.at("friction") * in.at("force"));
  out["stick_half_width"] = value(share) > 0 ? out.at("half_width") * sqrt(share) : D(0);
  return out;
}

Curve cattaneo_tractions(const Quantities<double>& all, double) {
  const double b = all.at("half_width"), c = all.at("stick_half_width"), bound = all.at("friction");
  return symmetric_curve(1.3 * b, [&](double x) {
    const double pressure = hertz_pressure(all, x);
    const double held = c > 0 ? bound * all.at("peak_pressure") * c / b * half_ellipse(x, c) : 0;
    return std::pair{pressure, bound * pressure - held};
  });
}

ClosedForm cattaneo_mindlin_form() {
  return {"cattaneo_mindlin",
          "then sheared until the rim slips [J85 7.2]",
          {force,
           {"tangential_force", "shearing force per length, less than friction times force"},
           radius,
           modulus,
           friction},
          {half_width, peak, {"stick_half_width", "half the width of what sticks"}},
          cattaneo_mindlin,
          cattaneo_tractions};
}

Out hertz_point(const In& in, Space) {
  const D &P = in.at("force"), &R = in.at("radius");
  const D a = pow(D(3) * P * R / (D(4) * in.at("modulus")), 1.0 / 3);
  return {{"contact_radius", a}, {"peak_pressure", D(3) * P / (D(2 * pi) * a * a)}, {"approach", a * a / R}};
}

const ClosedForm::Quantity pressing{"force", "pressing force", positive},
    contact_radius{"contact_radius", "radius of the contact"}, approach{"approach", "of places far from the contact"};

ClosedForm hertz_point_form() {
  return {"hertz_point",
          "two balls pressed together, in space [J85 4.2]",
          {pressing, radius, modulus},
          {contact_radius, peak, approach},
          hertz_point};
}

Out cattaneo_mindlin_point(const In& in, Space space) {
  Out out = hertz_point(in, space);
  const D& Q = in.at("tangential_force");
  const D share = D(1) - (value(Q) < 0 ? -Q : Q) / (in.at("friction") * in.at("force"));
  out["stick_radius"] = value(share) > 0 ? out.at("contact_radius") * pow(share, 1.0 / 3) : D(0);
  return out;
}

ClosedForm cattaneo_mindlin_point_form() {
  return {"cattaneo_mindlin_point",
          "then sheared until a ring slips [J85 7.2]",
          {pressing, {"tangential_force", "shearing force, less than friction times force"}, radius, modulus, friction},
          {contact_radius, peak, approach, {"stick_radius", "radius of what sticks"}},
          cattaneo_mindlin_point};
}

Out flat_punch(const In& in, Space) {
  const D &P = in.at("force"), &a = in.at("half_width");
  return {{"centre_pressure", P / (D(pi) * a)}, {"mean_pressure", P / (D(2) * a)}};
}

Curve flat_punch_tractions(const Quantities<double>& all, double) {
  const double a = all.at("half_width"), inside = 0.999;  // of the width: at its edge the pressure is infinite
  return symmetric_curve(inside * a, [&](double x) {
    return std::pair{all.at("force") / (pi * std::sqrt(a * a - x * x)), 0.0};
  });
}

ClosedForm flat_punch_form() {
  return {"flat_punch",
          "rigid flat punch on a half plane [J85 2.8]",
          {force, {"half_width", "half the width of the punch", positive}},
          {{"centre_pressure", "pressure at the middle"}, {"mean_pressure", "force over width"}},
          flat_punch,
          flat_punch_tractions};
}

Out press_fit(const In& in, Space space) {
  const Plane2D m(in, space);
  const D &Ri = in.at("inner"), &R = in.at("interface"), &Ro = in.at("outer"), &interference = in.at("interference");
  if (!(value(Ri) < value(R) && value(R) < value(Ro))) return {};
  const D outer = (Ro * Ro + R * R) / (Ro * Ro - R * R), inner = (R * R + Ri * Ri) / (R * R - Ri * Ri);
  const D p = interference * m.E / (R * (outer + inner)), u = p * R / m.E;
  Out out{{"pressure", p},
          {"u_outer", u * (outer + m.nu)},
          {"u_inner", -(u * (inner - m.nu))},
          {"u_rim", u * D(2) * R * Ro / (Ro * Ro - R * R)}};
  if (in.count("friction")) out["slip_torque"] = D(2 * pi) * R * R * in.at("friction") * p;
  return out;
}

Curve press_fit_tractions(const Quantities<double>& all, double length) {
  return {{0, all.at("pressure"), 0}, {length, all.at("pressure"), 0}};
}

ClosedForm press_fit_form() {
  return {"press_fit",
          "ring pressed into a ring of the same material [Lame]",
          {{"inner", "bore of the inner ring", positive},
           {"interface", "radius where they meet", positive},
           {"outer", "rim of the outer ring", positive},
           {"interference", "how much too large the inner one is", positive},
           E,
           nu,
           {"friction", "coefficient", not_negative, false}},
          {{"pressure", "between the rings"},
           {"u_outer", "radial displacement of the outer ring's bore"},
           {"u_inner", "of the inner ring's outside"},
           {"u_rim", "of the outer ring's rim"},
           {"slip_torque", "per length, at which all slips (with friction)"}},
          press_fit,
          press_fit_tractions,
          ClosedForm::Over::arc};
}

Out belt(const In& in, Space) {
  const D &mu = in.at("friction"), angle = in.at("angle") * D(pi / 180);
  D log_ratio = mu * angle;
  if (in.count("nodes")) {
    const D n = in.at("nodes"), half = angle / (D(2) * n), t = sin(half) / cos(half);
    if (!(value(mu * t) < 1)) return {};
    log_ratio = n * log((D(1) + mu * t) / (D(1) - mu * t));
  }
  const D ratio = exp(log_ratio);
  const D tight = in.at("slack") * ratio;
  return {{"ratio", ratio}, {"tight", tight}, {"tight_reaction", -tight}};
}

Curve belt_tractions(const Quantities<double>& all, double length) {
  if (!all.count("radius")) return {};
  const double R = all.at("radius"), slack = all.at("slack"), bound = all.at("friction");
  const bool polygon = all.count("nodes") > 0;
  const int n = polygon ? static_cast<int>(all.at("nodes")) : samples;
  const double growth = std::pow(all.at("ratio"), 1.0 / n), chord = 2 * R * std::sin(all.at("angle") * pi / 360 / n);
  Curve curve;
  for (int i = 0; polygon ? i < n : i <= n; ++i) {
    const double tension = slack * std::pow(growth, i);
    const double pressure = polygon ? tension * (1 + growth) / (2 * R) : tension / R;
    curve.push_back({polygon ? chord * i : length * i / n, pressure, bound * pressure});
  }
  return curve;
}

ClosedForm belt_form() {
  return {"belt",
          "belt on a drum, about to slip [Euler, Eytelwein]",
          {{"slack", "tension of the slack end", positive},
           friction,
           {"angle", "wrapped, degrees", positive},
           {"nodes", "of a polygonal belt [a smooth one]", positive, false},
           {"radius", "of the drum, for the tractions along it", positive, false}},
          {{"tight", "tension of the tight end"},
           {"tight_reaction", "minus that: of a support that pulls the end down"},
           {"ratio", "tight over slack"}},
          belt,
          belt_tractions,
          ClosedForm::Over::arc};
}

Out pull_out(const In& in, Space) {
  const D &P = in.at("force"), &EA = in.at("stiffness"), &f = in.at("friction_per_length");
  const D u = P * P / (D(2) * EA * f), work = P * P * P / (D(6) * EA * f);
  return {{"slip_length", P / f},
          {"end_displacement", u},
          {"dissipation", work},
          {"residual_displacement", u / D(2)},
          {"cycle_dissipation", D(4) * work}};
}

ClosedForm pull_out_form() {
  return {"pull_out",
          "bar drawn against friction along it",
          {{"force", "at the end", positive},
           {"stiffness", "Young's modulus times cross-section", positive},
           {"friction_per_length", "limit of the friction", positive}},
          {{"slip_length", "that slips under the force"},
           {"end_displacement", "under the force"},
           {"dissipation", "of the first loading"},
           {"residual_displacement", "of the end, force taken away"},
           {"cycle_dissipation", "of a full cycle to the force either way"}},
          pull_out};
}

D bending_stiffness(const In& in, Space space) {
  const D& H = in.at("height");
  return Plane2D(in, space).E * H * H * H / D(12);
}

Out cantilever_stop(const In& in, Space space) {
  const D &q = in.at("load"), &L = in.at("length"), EI = bending_stiffness(in, space);
  const D shear = D(5.0 / 6) * in.at("height") * in.at("E") / (D(2) * (D(1) + in.at("nu")));
  const D tip = q * L * L * L * L / (D(8) * EI) + q * L * L / (D(2) * shear);
  const D k = D(1) / (L * L * L / (D(3) * EI) + L / shear);
  const bool touches = value(tip) > value(in.at("gap"));
  return {{"free_tip", tip}, {"stiffness", k}, {"reaction", touches ? k * (tip - in.at("gap")) : D(0)}};
}

ClosedForm cantilever_stop_form() {
  return {"cantilever_stop",
          "loaded cantilever whose tip meets a stop [Timoshenko]",
          {load, gap, {"length", "of the beam", positive}, height, E, nu},
          {{"reaction", "of the stop"}, {"free_tip", "deflection without it"}, {"stiffness", "of the tip"}},
          cantilever_stop};
}

Out cantilever_floor(const In& in, Space space) {
  const D& q = in.at("load");
  const D a = pow(D(72) * bending_stiffness(in, space) * in.at("gap") / q, 0.25);
  return {{"lift_off", a}, {"line_reaction", q * a / D(3)}};
}

ClosedForm cantilever_floor_form() {
  return {"cantilever_floor",
          "loaded cantilever that comes to lie on a floor [Euler, Bernoulli]",
          {load, gap, height, E, nu},
          {{"lift_off", "distance from the clamp to where it touches"}, {"line_reaction", "force there"}},
          cantilever_floor};
}

}  // namespace

const std::vector<ClosedForm>& closed_forms() {
  static const std::vector<ClosedForm> all = {
      hertz_line_form(),      cattaneo_mindlin_form(), hertz_point_form(), cattaneo_mindlin_point_form(),
      flat_punch_form(),      press_fit_form(),        belt_form(),        pull_out_form(),
      cantilever_stop_form(), cantilever_floor_form()};
  return all;
}

Quantities<D> ClosedForm::outputs_of(const Quantities<D>& in, Space space) const {
  for (const auto& input : inputs) {
    const auto given = in.find(input.name);
    if (given == in.end() ? input.required : !input.rule.holds(value(given->second))) return {};
  }
  Out out = evaluate(in, space);
  const bool finite =
      std::all_of(out.begin(), out.end(), [](const auto& each) { return std::isfinite(value(each.second)); });
  return finite ? out : Out{};
}

const ClosedForm::Quantity* ClosedForm::find_input(const std::string& quantity) const {
  const auto input =
      std::find_if(inputs.begin(), inputs.end(), [&](const auto& each) { return each.name == quantity; });
  return input == inputs.end() ? nullptr : &*input;
}

std::vector<std::string> ClosedForm::input_names() const {
  std::vector<std::string> names;
  for (const auto& input : inputs) names.push_back(input.name);
  return names;
}

std::vector<std::string> ClosedForm::quantities() const {
  auto names = input_names();
  for (const auto& output : outputs) names.push_back(output.name);
  return names;
}

const ClosedForm* find_closed_form(const std::string& name) {
  for (const auto& form : closed_forms())
    if (form.name == name) return &form;
  return nullptr;
}

std::vector<std::string> analytic_names() {
  std::vector<std::string> names;
  for (const auto& form : closed_forms()) names.push_back(form.name);
  return names;
}

}  // namespace stickslip
