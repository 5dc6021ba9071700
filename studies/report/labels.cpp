#include "studies/report/labels.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <sstream>

namespace stickslip::report {

namespace {

/// `label` without " NAME=VALUE" of a knob. An absolute value may be written in any form, so all up to the blank goes.
std::string without(std::string label, const std::string& knob) {
  const std::string key = " " + knob.substr(0, knob.find(" (")) + "=";
  if (const std::size_t from = label.find(key); from != std::string::npos)
    label.erase(from, std::min(label.find(' ', from + 1), label.size()) - from);
  return label;
}

/// The options that the labels of a method name, with the values that they have there, each with its number of labels.
using Options = std::map<std::string, std::map<std::string, long>>;

std::set<std::string> labels_of(const Study& study, const std::string& family) {
  std::set<std::string> labels;
  for (const auto& cell : study.cells)
    if (cell.family == family) labels.insert(cell.label);
  return labels;
}

Options options_in(const std::set<std::string>& labels) {
  Options out;
  for (const auto& label : labels) {
    std::istringstream words(label);
    for (std::string word; words >> word;)
      if (const std::size_t sign = word.find('='); sign != std::string::npos)
        ++out[word.substr(0, sign)][word.substr(sign + 1)];
  }
  return out;
}

/// Takes options out of the labels that name them with a value, as long as runs stay apart without.
class Shortening {
 public:
  Shortening(Study& study, const std::string& family)
      : study_(study), family_(family), labels_(labels_of(study, family)) {}

  const std::set<std::string>& labels() const { return labels_; }

  /// `left_out`: where it is told.
  void take_out(const std::string& option, const std::string& value, std::vector<std::string>& left_out) {
    const auto shortened = [&](const std::string& label) {
      return (label + " ").find(" " + option + "=" + value + " ") == std::string::npos ? label : without(label, option);
    };
    std::set<std::string> shorter;
    for (const auto& label : labels_) shorter.insert(shortened(label));
    if (shorter.size() < labels_.size()) return;
    labels_ = std::move(shorter);
    left_out.push_back(family_name(family_) + " " + option + "=" + value);
    for (auto& cell : study_.cells)
      if (cell.family == family_) cell.label = shortened(cell.label);
  }

 private:
  Study& study_;
  const std::string& family_;
  std::set<std::string> labels_;
};

/// The value that most labels have of a switch which all of them name; "" of what is none, and where both have as many.
std::string usual_of_switch(const std::map<std::string, long>& values, std::size_t labels) {
  const auto on = values.find("true"), off = values.find("false");
  if (values.size() != 2 || on == values.end() || off == values.end() || on->second == off->second) return "";
  if (on->second + off->second < static_cast<long>(labels))
    return "";  // what is not named is the default, not the usual
  return on->second > off->second ? "true" : "false";
}

/// Takes out of the labels the options that have one value in all runs of a method that name them, and switches with
/// the value that most of these have.
void shorten_labels(Study& study) {
  for (const auto& family : study.families) {
    Shortening shortening(study, family);
    if (shortening.labels().size() < 2) continue;
    for (const auto& [option, values] : options_in(shortening.labels())) {
      if (values.size() == 1) shortening.take_out(option, values.begin()->first, study.shared);
      const std::string usual = usual_of_switch(values, shortening.labels().size());
      if (!usual.empty()) shortening.take_out(option, usual, study.understood);
    }
  }
}

/// Whether a value says by itself which option it is of: a word that no other option has.
bool speaks_for_itself(const std::string& value, const std::string& option, const Options& options) {
  static const std::set<std::string> says_little = {"none", "auto", "true", "false"};
  return std::all_of(value.begin(), value.end(), [](unsigned char c) { return std::islower(c) != 0 || c == '_'; }) &&
         says_little.count(value) == 0 && std::none_of(options.begin(), options.end(), [&](const auto& other) {
           return other.first != option && other.second.count(value) > 0;
         });
}

/// Says values that speak for themselves without their options: "anderson" for "acceleration=anderson".
void say_values_alone(Study& study) {
  for (const auto& family : study.families) {
    const Options options = options_in(labels_of(study, family));
    std::map<std::string, std::pair<std::string, std::string>> alone;  // by the words of the labels
    for (const auto& [option, values] : options)
      for (const auto& [value, unused] : values)
        if (speaks_for_itself(value, option, options)) alone[" " + option + "=" + value + " "] = {option, value};
    for (auto& cell : study.cells) {
      if (cell.family != family) continue;
      for (const auto& [word, entry] : alone) {
        const auto& [option, value] = entry;
        const std::size_t at = (cell.label + " ").find(word);
        if (at == std::string::npos) continue;
        cell.label.replace(at, word.size() - 1, " " + value);
        cell.bare[option] = value;
      }
    }
  }
}

/// Puts the methods' names before their options.
void put_in_words(std::vector<Cell>& cells) {
  for (auto& cell : cells)
    cell.label =
        family_name(cell.family) + cell.label.substr(cell.label.starts_with(cell.family) ? cell.family.size() : 0);
}

}  // namespace

void name_runs(Study& study) {
  shorten_labels(study);
  say_values_alone(study);
  put_in_words(study.cells);
}

std::string series_of(const Cell& cell, const std::string& knob) {
  if (knob.empty()) return cell.label;
  const auto bare = cell.bare.find(knob);
  if (bare == cell.bare.end()) return without(cell.label, knob);
  std::string label = cell.label + " ";
  label.erase(label.find(" " + bare->second + " "), bare->second.size() + 1);
  label.pop_back();
  return label;
}

std::string beside_method(const std::string& series, const std::string& family) {
  const std::string method = family_name(family) + " ";
  return series.starts_with(method) ? series.substr(method.size()) : series;
}

std::string understood(const Study& study) {
  std::string out;
  for (const auto& option : study.understood)
    out += (out.empty() ? "" : ", ") +
           (study.families.size() == 1 ? beside_method(option, study.families.front()) : option);
  return out.empty() ? out : "Where not named: " + out + ".";
}

}  // namespace stickslip::report
