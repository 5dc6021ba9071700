/// The main findings of a study as plain English sentences, computed from its cells.
#pragma once

#include <string>
#include <vector>

#include "studies/report/records.hpp"
#include "studies/report/settings.hpp"

namespace stickslip::report {

constexpr double digits_of_given_values = 1e-9;  ///< errors below it are of the reference, not of the mesh

/// Sentences, plain text, of what the verdict does not say: how penalty's error follows its stiffness; what the mesh
/// itself costs in accuracy; what failed; what runs disagree about; what they warn of. At least one sentence.
std::vector<std::string> headline(const Study& study);

/// Which methods are lost in which variants, and how many runs failed; "" where all converged.
std::string failures(const Study& study);

/// The run that the picture is of, "Monolithic AL, friction = 0.4"; "" where it is not recorded.
std::string run_of_picture(const Study& study);

/// What enforcement errors are against, and whether that is one of the runs: "Monolithic AL scale=1, one of the runs";
/// "" where there is no such reference.
std::string reference_run(const Study& study);

/// What work is in this study: "work (factorisations + 0.11 back-solves)".
std::string work_in_words(const Study& study);

/// What, besides the method, makes the difference to the references: of mesh, steps and references those that may.
std::vector<std::string> what_else_errs(const Study& study);

/// A sentence for each kind of warning and place, in the words of the run where it is worst.
std::vector<std::string> warning_sentences(const Study& study);

/// What a run solved, what its derivatives took included where they are what is asked for.
struct Counts {
  long factorizations = 0, backsolves = 0;
};
Counts counts_of(const Cell& cell, Of of);

/// "1.3 ms", "0.25 s".
std::string seconds_in_words(double seconds);

/// "2.4 %"; below 0.1 % and from 1 on the number itself.
std::string percent(double error);

/// "4 factorisations and 19 back-solves" of a run, those of the derivatives included where they are what is asked for.
std::string work_in_words(const Cell& cell, Of of);

}  // namespace stickslip::report
