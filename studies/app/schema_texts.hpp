/// What files may hold, in JSON Schema: for every key its type, its meaning with unit, its default and an example. This
/// is where they are described, but for what says its keys itself: meshes, materials, obstacles and
/// laws of friction (core), options of methods (methods/options.hpp), kinds of responses and small objects, which are
/// null here (studies/input):
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
extern const char* const study;

}  // namespace stickslip::schema_texts
