/// Words of the command line that no command takes, in the words of all other faults.
#pragma once

#include <string>
#include <vector>

namespace stickslip {

/// What is wrong where `--set POINTER VALUE` stands in place of `--set POINTER=VALUE`; "": nothing. `words`: all of the
/// line.
std::string set_in_two_words(const std::vector<std::string>& words);

/// What is wrong with the first word that a command does not take: an option that it has not, an option of a method, or
/// a word too many. `options`: the command's own, "--set" and so on. pre: there is such a word.
std::string unexpected_word(const std::string& command, const std::vector<std::string>& options,
                            const std::vector<std::string>& words);

}  // namespace stickslip
