/// What the charts are made of: series, rows and choices.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "studies/report/charts.hpp"

namespace stickslip::report {

/// The series of a figure, each once. Colour and size go by method, the colour's shade and the dash by the place among
/// the method's series, starting with another dash for each method. The first series of each method has a marker of its
/// own; further ones share the others.
class SeriesList {
 public:
  explicit SeriesList(const Study& study) : study_(study) {}

  void add(const std::string& name, const std::string& family);
  /// Where `name` stands in the list; its length where it does not.
  std::size_t place(const std::string& name) const;

  std::vector<Series> list;

 private:
  const Study& study_;
  std::map<std::string, std::size_t> count_;
  std::size_t further_ = 0;  ///< beyond the first of each method
};

/// What every row of a cell has: label, family, status, failed.
nlohmann::json row_of(const Cell& cell);

/// Adds `shown` to each row: `field` where it is positive. Where it is exactly 0, which no logarithmic axis can hold,
/// more than a decade below the smallest other value of the same choice, with `zero` set, so that the point is kept,
/// and stands off the values that the axis names.
void show_zeros(nlohmann::json& rows, const std::string& field);

/// Texts of `field` in the rows (of one panel), each once.
std::vector<std::string> distinct(const nlohmann::json& rows, const std::string& field, const std::string& panel = "");

/// A choice of one among the values of `field`, where there are several; `first` is chosen if it is among them.
void offer(Figure& figure, const std::string& label, const std::string& field, const std::string& first = "",
           const std::string& panel = "");

/// A choice of several cells, `chosen` at first.
void offer_cells(Figure& figure, const std::vector<std::string>& chosen);

/// The quantities of one cell: the worst of the first prefix where there are several, then each that starts with one of
/// the prefixes.
std::vector<std::pair<std::string, double>> quantities(const std::map<std::string, double>& errors,
                                                       const std::vector<std::string>& prefixes,
                                                       const std::string& worst_name);

/// The method and its constant options in words, with the status of a failed run.
std::string in_words(const Cell& cell);

/// Adds those of `labels` in the main variant: cells that are shown at first get the most unlike markers.
void add_first(SeriesList& series, const Study& study, const std::vector<std::string>& labels);

/// An axis title for knobs that share it.
std::string knob_title(const std::vector<std::string>& knobs);

/// Labels of the best cell of each family and, where asked, of the converged cell furthest from the reference.
enum class Furthest { left_out, added };
std::vector<std::string> telling_cells(const Study& study, Furthest furthest);

}  // namespace stickslip::report
