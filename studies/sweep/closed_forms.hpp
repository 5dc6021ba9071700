/// Closed forms that a study's responses are held against. Each is written once, in dual numbers, which carry the
/// derivatives with respect to whatever rides on the inputs.
///
/// hertz_line        [J85 4.2] two cylinders, force P per length: b = sqrt(4 P R / (pi E*)), p0 = 2 P / (pi b),
///                   p(x) = p0 sqrt(1 - x^2/b^2). 1/R = 1/R1 + 1/R2, 1/E* = sum (1 - nu^2)/E over both bodies (plane
///                   stress: sum 1/E).
/// cattaneo_mindlin  [J85 7.2] then sheared by Q < mu P: c = b sqrt(1 - Q/(mu P)),
///                   q(x) = mu p(x) - (c/b) mu p0 sqrt(1 - x^2/c^2) where |x| < c.
/// hertz_point       [J85 4.2] two balls, force P: a = (3 P R / (4 E*))^(1/3), p0 = 3 P / (2 pi a^2), approach a^2 / R.
/// cattaneo_mindlin_point
///                   [J85 7.2] then sheared by Q < mu P: what sticks has the radius a (1 - Q/(mu P))^(1/3).
/// flat_punch        [J85 2.8] rigid, frictionless, width 2a, on a half plane: p(x) = P / (pi sqrt(a^2 - x^2)).
/// press_fit         [Lame 1852] ring Ri..R in ring R..Ro, interference D, one material: with E1 = E/(1 - nu^2),
///                   n = nu/(1 - nu) (plane stress: E, nu),
///                   p = (D E1 / R) / ((Ro^2 + R^2)/(Ro^2 - R^2) + (R^2 + Ri^2)/(R^2 - Ri^2)); radial displacements
///                   u_outer = (p R / E1)((Ro^2 + R^2)/(Ro^2 - R^2) + n) of the bore, u_inner = u_outer - D, and
///                   u_rim = (p R / E1) 2 R Ro / (Ro^2 - R^2) at Ro. Full slip needs the torque 2 pi R^2 mu p.
/// belt              [Euler 1769, Eytelwein 1808] on a drum, wrapped by b: T2 = T1 e^(mu b). Where it touches at n
///                   nodes that turn by b/n each: balance of a node gives T2 = T1 ((1 + mu t)/(1 - mu t))^n,
///                   t = tan(b / 2n). On a drum of radius R the pressure is T/R, at a node of a polygon the mean of
///                   both its bars' over R; the traction along is mu times that.
/// pull_out          a bar EA drawn by P against a limit friction f per length, far end not reached: N' = f over the
///                   slip length P/f, so u = P^2/(2 EA f), work of friction P^3/(6 EA f). Unloading slips back over
///                   P/(2f) and leaves u/2; a full cycle between P and -P costs 2 P^3/(3 EA f).
/// cantilever_stop   [Timoshenko 1921] length L, height H, width 1, load q per length, a stop at distance g under the
///                   tip: free tip w = q L^4/(8 EI) + q L^2/(2 kGA), 1/k = L^3/(3 EI) + L/(kGA), reaction k (w - g);
///                   I = H^3/12, k = 5/6, G = E/(2(1 + nu)), in plane strain E/(1 - nu^2) in EI.
/// cantilever_floor  [Euler, Bernoulli] clamped at distance g over a flat floor, load q: it lies on the floor from
///                   a = (72 EI g/q)^(1/4) on, with a line reaction q a/3 there and the pressure q beyond.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/algebra/scalar.hpp"
#include "core/model/scene.hpp"
#include "studies/io/json_node.hpp"

namespace stickslip {

/// Quantities of a closed form by name.
template <class T>
using Quantities = std::map<std::string, T>;

struct ClosedForm {
  struct Quantity {
    std::string name, meaning;
    Rule rule = any_number;   ///< of an input: what it must be
    bool required = true;     ///< of an input: without it there is no answer
    bool of_contact = false;  ///< of an input: taken from the scene's first contact where it is not given
  };
  /// Tractions of a contact at a place.
  struct Tractions {
    double place = 0, pressure = 0, tangential = 0;
  };
  /// What a place is: the distance from the centre of pressure along x, or the length along the contact's points from
  /// the first.
  enum class Over { distance, arc };

  std::string name, about;
  std::vector<Quantity> inputs, outputs;
  /// The formula. pre: `inputs` holds all that are required, and each is as its rule says.
  Quantities<Dual<1>> (*evaluate)(const Quantities<Dual<1>>& inputs, Space space);
  /// Along a contact of that length, places ascending; `all`: inputs and outputs together. Empty where it takes an
  /// input that is not given. nullptr where the form has no curve.
  std::vector<Tractions> (*tractions)(const Quantities<double>& all, double length) = nullptr;
  Over over = Over::distance;

  /// The outputs; empty where the inputs are not those of the closed form (one is missing or not as its rule says, as a
  /// pressing force of an open contact) or where it has no finite answer.
  Quantities<Dual<1>> outputs_of(const Quantities<Dual<1>>& inputs, Space space) const;

  bool has_input(const std::string& quantity) const { return find_input(quantity) != nullptr; }
  /// nullptr where there is none of this name.
  const Quantity* find_input(const std::string& quantity) const;
  std::vector<std::string> input_names() const;
  /// Names of the inputs, then of the outputs.
  std::vector<std::string> quantities() const;
};

const std::vector<ClosedForm>& closed_forms();
/// nullptr where there is none of this name.
const ClosedForm* find_closed_form(const std::string& name);
std::vector<std::string> analytic_names();

}  // namespace stickslip
