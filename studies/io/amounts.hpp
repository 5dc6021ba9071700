/// Names and amounts of the ledger as pages and commands show them.
#pragma once

#include <string>

namespace stickslip {

/// A name of the ledger in words: "back-solves", "model data".
std::string ledger_words(const std::string& name);

/// "12 elements", "1 analysis": an amount that is exact.
std::string amount_in_words(const std::string& name, double amount);

}  // namespace stickslip
