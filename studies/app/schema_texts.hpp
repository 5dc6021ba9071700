/// What files may hold, in JSON Schema: for every key its type, its meaning with unit, its default and an example. This
/// is where they are described, but for meshes, materials and obstacles, which say their keys themselves (core):
/// editors read it by `stickslip schema`, and the tables of docs/ are printed from it (tools/key_tables.py).
///
/// "title" is the name of a type in the tables; "default" is what holds where the key is left out.
#pragma once

namespace stickslip::schema_texts {

// Definitions by name.
extern const char* const common;  ///< of both files
extern const char* const motion;

// Properties by key.
extern const char* const scene;
extern const char* const response;  ///< of all kinds of responses
extern const char* const study;

}  // namespace stickslip::schema_texts
