/// What the charts are made of: series, rows, choices, and the words of Vega-Lite.
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

/// An axis over a field of the rows.
nlohmann::json channel(const std::string& field, const std::string& title, bool logarithmic);
/// [{"filter": test}].
nlohmann::json only_if(const std::string& test);
nlohmann::json tooltip(const std::vector<std::pair<std::string, std::string>>& fields);
/// Adds a panel that shows the rows of its own alone: those whose `panel` is panel.only.
void add_panel(Figure&, Panel panel);

/// Lines, markers, crosses for what failed, and the ground for exact zeros. Rows: series, line, order, shown, zero,
/// failed, and in the field `tag` a word beside the marker, at the side that `tag`_at says: "right", "left", "right
/// below" or "left below".
nlohmann::json curves(const std::string& description, const nlohmann::json& x, const nlohmann::json& y,
                      const nlohmann::json& tips, const std::string& tag = "tag");

/// The field of the words in a work-precision chart against the field `across`.
std::string tag_field(const std::string& across);

/// Writes beside the lines of such a chart, of so many pixels' height: the option's value at both ends, so that a
/// reader sees which way a line runs, and the name of its series, so that grey print needs no legend. A line that stays
/// in one place, where the option does nothing, has its name alone. No word covers another, a marker or a curve: a name
/// is tried on each side of each point, and is left to the legend where there is no room; then so are its values. Words
/// that have no room in the lower chart on paper have the field `tag`_tall. What narrow screens show beside a point,
/// names alone or what tells those of a method apart, is in `tag`_narrow and `tag`_narrow_at.
void tag_lines(nlohmann::json& rows, const std::string& across, double height, const std::string& text_field);

/// Writes the name of each line, its `line`, beside one of its points, where it has room in a chart that stands beside
/// one other and in one beside two; for narrow screens as tag_lines does.
void name_lines(nlohmann::json& rows, const std::string& across);

}  // namespace stickslip::report
