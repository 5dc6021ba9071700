/// Scenes at finite strain, or with bodies that flow, whose points slide: short enough for every method and scheme.
#pragma once

#include "tests/support/blocks.hpp"

namespace stickslip::scenes {

/// A soft metal block pressed onto a rough disk, drawn along it, and lifted a bit.
inline Scene pressed_metal(bool finite) {
  Scene s;
  s.finite_strain = finite;
  s.legs = {{1, 3}, {2, 4}, {3, 2}};
  BoxMesh box;
  box.max = {2.0, parameter(s, "height", 0.8)};
  box.cells = {4, 2};
  const J2Plastic material{parameter(s, "E", 100), 0.3, parameter(s, "yield", 2.3), parameter(s, "hardening", 12)};
  s.bodies = {{"block", box, material, "Q4_mean_dilatation", 1.0}};
  s.obstacles = {{"disk", Circle{{1.07, -1.5}, parameter(s, "R", 1.5)}}};
  s.contacts = {contact("sole", "block.bottom", "disk")};
  s.contacts[0].friction = parameter(s, "mu", 0.3);
  s.supports = {support("block.top", {{'y', table({{0, 0.0}, {1, -0.11}, {2, -0.11}, {3, -0.098}})},
                                      {'x', table({{0, 0.0}, {1, 0.0}, {2, 0.06}})}})};
  s.responses = {response("drag", Response::Kind::reaction, "block.top", "x"),
                 response("energy", Response::Kind::strain_energy, ""),
                 response("heat", Response::Kind::dissipation, "sole")};
  return s;
}

/// A rubber die pressed into a slab and dragged along it, from patch to patch of its smoothed side.
inline Scene sliding_die() {
  Scene s;
  s.finite_strain = true;
  s.legs = {{1, 3}, {2, 7}};
  s.bodies = {box_body("slab", {0, 0}, {4, 1}, {12, 3}), box_body("die", {0.9, 1}, {1.7, 1.6}, {4, 2})};
  s.bodies[0].material = NeoHookean{parameter(s, "E", 1), 0.3, NeoHookean::Volumetric::quadratic};
  s.bodies[1].material = NeoHookean{parameter(s, "E_die", 5), 0.3, NeoHookean::Volumetric::quadratic};
  s.contacts = {contact("sole", "die.bottom", "slab.top")};
  s.contacts[0].smoothing = Smoothing::b_spline;
  s.contacts[0].friction = parameter(s, "mu", 0.3);
  const Table still = table({{0, 0.0}});
  s.supports = {support("slab.bottom", {{'x', still}, {'y', still}}),
                support("die.top", {{'x', table({{0, 0.0}, {1, 0.0}, {2, parameter(s, "along", 1.4)}})},
                                    {'y', table({{0, 0.0}, {1, -0.15}})}})};
  s.responses = {response("pull", Response::Kind::reaction, "die.top", "x"),
                 response("energy", Response::Kind::strain_energy, ""), response("slid", Response::Kind::slip, "sole")};
  return s;
}

/// The same die, integrated over the facets that it comes to face.
inline Scene integrated_die() {
  Scene s = sliding_die();
  s.contacts[0].smoothing = Smoothing::none;
  s.contacts[0].segment = true;
  return s;
}

}  // namespace stickslip::scenes
