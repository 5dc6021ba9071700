/// How runs are called on a page.
#pragma once

#include "studies/report/records.hpp"

namespace stickslip::report {

/// Gives the cells their labels in words: "Uzawa AL anderson scale=10" of "uzawa_al acceleration=anderson adapt=false
/// scale=10". Options that tell no two runs of a method apart are left out (Study::shared); so is a switch where it
/// stands as in most of them (Study::understood); a word that no other option has for its value needs no option before
/// it (Cell::bare). `study`: its cells are read, and its families known.
void name_runs(Study& study);

/// Label without the part that says `knob`: what is constant along a curve.
std::string series_of(const Cell& cell, const std::string& knob);

/// What a series of a method says beside its name; the name, where it says no more.
std::string beside_method(const std::string& series, const std::string& family);

/// Study::understood as a sentence, of one method alone without its name; "" of none.
std::string understood(const Study& study);

}  // namespace stickslip::report
