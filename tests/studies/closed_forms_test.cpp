/// Values: the catalogue's numbers, computed there by another program. Derivatives: central differences.
#include "studies/sweep/closed_forms.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace stickslip {
namespace {

using D = Dual<1>;

struct Example {
  const char* form;
  Quantities<double> in, out;
  Space space = Space::plane_strain;
};

const double modulus = 200 / (2 * (1 - 0.09));  // two cylinders of E = 200, nu = 0.3

const std::vector<Example>& examples() {
  static const std::vector<Example> all = {
      {"hertz_line",
       {{"force", 10}, {"radius", 4}, {"modulus", modulus}},
       {{"half_width", 0.6807783738}, {"peak_pressure", 9.3513512890}}},
      {"cattaneo_mindlin",
       {{"force", 10}, {"tangential_force", -0.93616}, {"radius", 4}, {"modulus", modulus}, {"friction", 0.2}},
       {{"half_width", 0.6807783738}, {"stick_half_width", 0.4965110418}}},
      {"hertz_point",
       {{"force", 100}, {"radius", 10}, {"modulus", 1000 / (1 - 0.09)}},
       {{"contact_radius", 0.8804422708}, {"peak_pressure", 61.5941712}, {"approach", 0.0775178592}},
       Space::solid},
      {"cattaneo_mindlin_point",
       {{"force", 100}, {"tangential_force", 15}, {"radius", 5}, {"modulus", 500 / (1 - 0.09)}, {"friction", 0.3}},
       {{"contact_radius", 0.8804422708}, {"stick_radius", 0.6988074934}, {"approach", 0.1550357184}},
       Space::solid},
      {"flat_punch",
       {{"force", 21.97802198}, {"half_width", 1}},
       {{"centre_pressure", 21.97802198 / std::acos(-1.0)}, {"mean_pressure", 10.98901099}}},
      {"press_fit",
       {{"inner", 1},
        {"interface", 2},
        {"outer", 4},
        {"interference", 0.01},
        {"E", 1000},
        {"nu", 0.3},
        {"friction", 0.2}},
       {{"pressure", 1.6483516484},
        {"u_outer", 0.0062857143},
        {"u_inner", -0.0037142857},
        {"u_rim", 0.004},
        {"slip_torque", 8.2855190864}}},
      {"press_fit",
       {{"inner", 1}, {"interface", 2}, {"outer", 4}, {"interference", 0.01}, {"E", 1000}, {"nu", 0.3}},
       {{"pressure", 1.5}, {"u_rim", 0.004}},
       Space::plane_stress},
      {"belt", {{"slack", 1}, {"friction", 0.3}, {"angle", 180}}, {{"tight", 2.5663323952}, {"ratio", 2.5663323952}}},
      {"belt",
       {{"slack", 2}, {"friction", 0.3}, {"angle", 180}, {"nodes", 8}},
       {{"tight", 2 * 2.6010497114}, {"ratio", 2.6010497114}}},
      {"pull_out",
       {{"force", 20}, {"stiffness", 1000}, {"friction_per_length", 30}},
       {{"slip_length", 2.0 / 3},
        {"end_displacement", 6.666666667e-3},
        {"dissipation", 0.0444444444},
        {"residual_displacement", 3.333333333e-3},
        {"cycle_dissipation", 0.1777777778}}},
      {"cantilever_stop",
       {{"load", 0.01}, {"gap", 0.05}, {"length", 10}, {"height", 1}, {"E", 1000}, {"nu", 0.3}},
       {{"free_tip", 0.15156}, {"stiffness", 0.2480650923}, {"reaction", 0.0251934908}},
       Space::plane_stress},
      {"cantilever_floor",
       {{"load", 0.01}, {"gap", 0.002}, {"height", 1}, {"E", 1000}, {"nu", 0.3}},
       {{"lift_off", 5.8856619128}, {"line_reaction", 0.0196188730}},
       Space::plane_stress}};
  return all;
}

Quantities<D> evaluate(const Example& example, const std::string& along = "", double shift = 0) {
  Quantities<D> in;
  for (const auto& [name, value] : example.in) in[name] = D(value);
  if (!along.empty()) in[along] = D::seed(value(in[along]) + shift, 0);
  return find_closed_form(example.form)->outputs_of(in, example.space);
}

TEST(ClosedForms, GiveTheNumbersOfTheCatalogue) {
  for (const auto& example : examples()) {
    const auto out = evaluate(example);
    // The catalogue prints ten decimals, and some inputs have ten digits.
    for (const auto& [name, expected] : example.out)
      EXPECT_NEAR(value(out.at(name)), expected, 1e-10 + 1e-9 * std::abs(expected)) << example.form << " " << name;
  }
}

TEST(ClosedForms, HaveTheDerivativesThatDifferencesFind) {
  for (const auto& example : examples())
    for (const auto& [along, at] : example.in) {
      const double h = 1e-5 * std::abs(at);  // error h^2 f'''/f' of 1e-10, rounding eps/1e-5 of 2e-11
      const auto exact = evaluate(example, along);
      const auto more = evaluate(example, along, h), less = evaluate(example, along, -h);
      for (const auto& [name, quantity] : exact) {
        const double difference = (value(more.at(name)) - value(less.at(name))) / (2 * h);
        const double scale = std::max(std::abs(difference), std::abs(value(quantity) / at));
        EXPECT_NEAR(quantity.d[0], difference, 1e-8 * scale) << example.form << " d " << name << " / d " << along;
      }
    }
}

TEST(ClosedForms, GiveAllTheOutputsTheyListFromTheInputsTheyList) {
  for (const auto& form : closed_forms()) {
    const auto example =
        std::find_if(examples().begin(), examples().end(), [&](const Example& each) { return form.name == each.form; });
    ASSERT_NE(example, examples().end()) << form.name;
    for (const auto& input : form.inputs)
      EXPECT_TRUE(!input.required || example->in.count(input.name)) << form.name << " " << input.name;
    for (const auto& [name, unused] : example->in) EXPECT_TRUE(form.has_input(name)) << form.name << " " << name;
    const auto out = evaluate(*example);
    EXPECT_EQ(out.size(), form.outputs.size()) << form.name;
    for (const auto& output : form.outputs) EXPECT_TRUE(out.count(output.name)) << form.name << " " << output.name;
  }
}

TEST(ClosedForms, SayNothingWhereAnInputIsNotWhatItMustBe) {
  const double nothing = std::nan("");
  for (const auto& [form, input, given] :
       std::vector<std::tuple<std::string, std::string, double>>{{"hertz_line", "force", 0},  // an open contact
                                                                 {"hertz_line", "radius", -1},
                                                                 {"hertz_line", "modulus", nothing},
                                                                 {"press_fit", "interface", 5},
                                                                 {"press_fit", "nu", 0.5},
                                                                 {"belt", "slack", -1},
                                                                 {"cantilever_floor", "gap", 0}}) {
    Example example = *std::find_if(examples().begin(), examples().end(),
                                    [&, &form = form](const Example& each) { return form == each.form; });
    example.in.at(input) = given;
    EXPECT_TRUE(evaluate(example).empty()) << form << " " << input << " = " << given;
  }
}

/// Tractions of a form for the inputs of an example, on a contact of that length.
std::vector<ClosedForm::Tractions> tractions_of(const Example& example, double length) {
  Quantities<double> all = example.in;
  for (const auto& [name, quantity] : evaluate(example)) all[name] = value(quantity);
  return find_closed_form(example.form)->tractions(all, length);
}

/// The curves integrate to the forces that made them.
TEST(ClosedForms, CarryTheForcesInTheirTractions) {
  const auto curve = tractions_of(examples()[1], 0);
  ASSERT_GT(curve.size(), 100u);
  double normal = 0, tangential = 0;
  for (std::size_t i = 1; i < curve.size(); ++i) {
    const double length = curve[i].place - curve[i - 1].place;
    normal += (curve[i].pressure + curve[i - 1].pressure) / 2 * length;
    tangential += (curve[i].tangential + curve[i - 1].tangential) / 2 * length;
  }
  // the trapezoidal rule at square roots: some h^1.5 at each of their ends, of a curve drawn through so many points
  const double exact = 3 * std::pow(static_cast<double>(curve.size()), -1.5);
  EXPECT_NEAR(normal, 10, 10 * exact);
  EXPECT_NEAR(tangential, 0.93616, 10 * exact);
}

/// The pressures of a polygonal belt hold its bars' tensions, node by node, and their friction is what these differ by.
TEST(ClosedForms, TractionsOfABeltHoldItsTensions) {
  const double slack = 2, mu = 0.3, radius = 1.5, turn = std::acos(-1.0) / 8, chord = 2 * radius * std::sin(turn / 2);
  const Example belt{
      "belt", {{"slack", slack}, {"friction", mu}, {"angle", 180}, {"nodes", 8}, {"radius", radius}}, {}};
  const auto curve = tractions_of(belt, 7 * chord);
  ASSERT_EQ(curve.size(), 8u);
  double tension = slack;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    EXPECT_NEAR(curve[i].place, chord * static_cast<double>(i), 1e-13);
    const double next = tension + curve[i].tangential * chord / std::cos(turn / 2);
    EXPECT_NEAR(curve[i].pressure * chord, (tension + next) * std::sin(turn / 2), 1e-13 * next);
    EXPECT_DOUBLE_EQ(curve[i].tangential, mu * curve[i].pressure);
    tension = next;
  }
  EXPECT_NEAR(tension, slack * 2.6010497114, 1e-9);
  EXPECT_TRUE(tractions_of({"belt", {{"slack", 1}, {"friction", mu}, {"angle", 180}}, {}}, 1).empty());  // no radius
}

TEST(ClosedForms, ThePressureOfAPressFitIsTheSameAllAround) {
  const auto curve =
      tractions_of({"press_fit",
                    {{"inner", 1}, {"interface", 2}, {"outer", 4}, {"interference", 0.01}, {"E", 1000}, {"nu", 0.3}},
                    {}},
                   3);
  ASSERT_EQ(curve.size(), 2u);
  EXPECT_EQ(curve.back().place, 3);
  for (const auto& at : curve) EXPECT_NEAR(at.pressure, 1.6483516484, 1e-10);
}

TEST(ClosedForms, ThePressureUnderAPunchCarriesItsForce) {
  const auto curve = tractions_of({"flat_punch", {{"force", 3}, {"half_width", 2}}, {}}, 4);
  EXPECT_NEAR(curve[curve.size() / 2].pressure, 3 / (2 * std::acos(-1.0)), 1e-14);
}

}  // namespace
}  // namespace stickslip
