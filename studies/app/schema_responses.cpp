#include "studies/app/schema_texts.hpp"

namespace stickslip::schema_texts {

const char* const response = R"json({
  "kinds": {
    "reaction": {"description": "force of the support on the body, summed over the side",
      "required": ["on", "component"], "optional": ["about"],
      "descriptions": {"component": "an axis, or the moment about a point"},
      "example": {"on": "block.left", "component": "x"}},
    "contact_force": {"description": "force on the slave", "required": ["contact", "component"],
      "optional": ["about"],
      "descriptions": {"component": "an axis; normal: positive in compression; moment: about a point"},
      "example": {"contact": "sole", "component": "normal"}},
    "displacement": {"description": "of a side, or of a point (length)", "required": ["component"],
      "optional": ["on", "take", "at"], "one_of": ["on", "at"],
      "descriptions": {"on": "where; beside at: the body that the point is in"},
      "example": {"on": "block.right", "component": "x"}},
    "contact_pressure": {"description": "force per area of the start", "required": ["contact"],
      "optional": ["take", "at"],
      "example": {"contact": "sole", "take": "max"}},
    "gap": {"description": "negative: penetration (length)", "required": ["contact"], "optional": ["take", "at"],
      "example": {"contact": "sole", "take": "min"}},
    "slip": {"description": "since the start, of a contact with friction (length)", "required": ["contact"],
      "optional": ["component", "take", "at"],
      "descriptions": {"component": "in space: an axis"},
      "example": {"contact": "sole"}},
    "dissipation": {"description": "work of friction since the start", "required": ["contact"], "optional": [],
      "example": {"contact": "sole"}},
    "strain_energy": {"description": "of all bodies", "required": [], "optional": [], "example": {}},
    "plastic_strain": {"description": "equivalent plastic strain of a body of j2_plastic", "required": ["on"],
      "optional": ["take"],
      "descriptions": {"on": "a body", "take": "of its points, mean by volume"},
      "example": {"on": "block", "take": "max"}},
    "contact_half_width": {"description": "2 sqrt(sum of p x^2 A / P), Hertz's a; around an axis the radius",
      "required": ["contact"], "optional": ["about"],
      "descriptions": {"about": "in a plane space: the middle of the contact, where it is no end held by symmetry (length)"},
      "example": {"contact": "sole"}}},
  "keys": {
    "on": {"description": "where", "$ref": "#/$defs/side",
      "examples": ["block.left"]},
    "contact": {"description": "name of a contact", "type": "string", "examples": ["sole"]},
    "component": {"description": "an axis"},
    "take": {"description": "of the nodes of the side, or of the contact", "enum": ["mean", "max", "min"],
      "default": "mean"},
    "at": {"description": "in place of take: a point of the initial configuration (length)",
      "$ref": "#/$defs/vector", "examples": [[4, 0]]},
    "about": {"description": "of the component moment, in a plane space: the point that it is about (length)",
      "$ref": "#/$defs/pair", "examples": [[0, 0]]}}
})json";

}  // namespace stickslip::schema_texts
