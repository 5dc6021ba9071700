#include "studies/app/command_line.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "studies/input/method_options.hpp"
#include "studies/io/wording.hpp"

namespace stickslip {
namespace {

/// The methods that have an option of this name.
std::vector<std::string> methods_with(const std::string& option) {
  std::vector<std::string> methods;
  for (const auto& name : method_names())
    if (to_json(*default_method(name)).at(name).contains(option)) methods.push_back(name);
  return methods;
}

/// The names of a command's options, and as options those of the methods, which may be meant.
std::vector<std::string> with_options_of_methods(std::vector<std::string> options) {
  for (const auto& name : method_names()) {
    const auto of_method = to_json(*default_method(name)).at(name);
    for (const auto& [option, value] : of_method.items()) options.push_back("--" + option);
  }
  return options;
}

/// A word that may be the value of --set, and no further option or file.
bool is_value(const std::string& word) {
  const bool number = word.size() > 1 && word[0] == '-' && word.find_first_of("0123456789") == 1;
  return number || (!word.starts_with('-') && !word.ends_with(".json"));
}

}  // namespace

std::string set_in_two_words(const std::vector<std::string>& words) {
  for (std::size_t i = 0; i + 2 < words.size(); ++i) {
    const std::string &pointer = words[i + 1], &next = words[i + 2];
    if (words[i] != "--set" || !pointer.starts_with('/') || !is_value(next)) continue;
    if (next.starts_with('=') || (pointer.ends_with('=') && pointer.find('=') + 1 == pointer.size())) {
      const std::string value = next == "=" && i + 3 < words.size() ? words[i + 3] : next;
      return fmt::format("--set {} {}: must be one word, without spaces: --set {}={}", pointer, next,
                         pointer.substr(0, pointer.find('=')), value.substr(value.starts_with('=') ? 1 : 0));
    }
    if (pointer.find('=') == std::string::npos)
      return fmt::format("--set {0} {1}: is two words; must be one, with = between: --set {0}={1}", pointer, next);
  }
  return "";
}

std::string unexpected_word(const std::string& command, const std::vector<std::string>& options,
                            const std::vector<std::string>& words) {
  const auto found = std::find_if(words.begin(), words.end(), [](const auto& word) { return word.starts_with('-'); });
  if (found == words.end())
    return fmt::format("{} takes no further word {}; see stickslip {} --help", command, in_quotes(words.front()),
                       command);
  const std::size_t equals = found->find('=');
  const std::string option = found->substr(0, equals), name = option.substr(option.find_first_not_of('-') == 2 ? 2 : 0);
  const bool scene = std::find(options.begin(), options.end(), "--set") != options.end();
  if (const auto methods = methods_with(name); scene && !methods.empty()) {
    const bool next = found + 1 != words.end() && is_value(*(found + 1));
    const std::string value = equals != std::string::npos ? found->substr(equals + 1) : next ? *(found + 1) : "VALUE";
    return fmt::format("{} is no option of {}, but one of the method {}; try -m {} --set /method/{}/{}={}", option,
                       command, fmt::join(methods, " and of "), methods.front(), methods.front(), name, value);
  }
  return fmt::format("{} has no option {};{} allowed: {}", command, in_quotes(option),
                     suggestion(option, scene ? with_options_of_methods(options) : options), listed(options));
}

}  // namespace stickslip
