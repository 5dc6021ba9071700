/// What a contact does at the start of a run, and that it never closes: gaps, and warnings of both.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "core/model/warning.hpp"
#include "studies/run/case.hpp"

namespace stickslip {

/// Gaps at the start of points that face their master, lengths, with the contact's `offset`; 0 up to rounding.
struct StartGaps {
  std::string name;  ///< of the contact; of pairs of one `between`: of their rule
  double least = std::numeric_limits<double>::infinity(), largest = -std::numeric_limits<double>::infinity();
  int points = 0;
  int overlapping = 0;  ///< points that overlap by more than rounding
  int unasked = 0;      ///< points that overlap by more than a negative `offset` asks for
  double overlap = 0;   ///< the deepest of these, without what `offset` asks for; length
  /// "least 0, largest 0.01, 2 of 9 points overlap".
  std::string in_words() const;
};

/// One for each contact. A contact none of whose points face a master has 0 points.
std::vector<StartGaps> start_gaps(const Problem& problem);

/// The same, those of the pairs of one `between` taken together.
std::vector<StartGaps> start_gaps_of_rules(const Problem& problem);

/// Contacts that overlap at the start although no `offset` asks for it.
std::vector<Warning> overlaps_at_start(const Problem& problem);

/// Contacts of which no point closed in any step. None if the run failed: its message says what its points did.
std::vector<Warning> contacts_never_closed(const CaseResult& result);

/// Whether no support holds a node of a body: then contact alone holds it, or nothing does.
bool is_held_by_contact_alone(const Model& model, std::size_t body);

}  // namespace stickslip
