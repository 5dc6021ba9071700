/// Who brings an error down to an accuracy for the least work: what a verdict is made of.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "studies/report/records.hpp"
#include "studies/report/settings.hpp"

namespace stickslip::report {

/// An accuracy that is asked for.
struct Level {
  double error = 0;
  std::string whose = {};  ///< "own error of mesh, steps: " where these err by so much

  std::string title() const;
};

/// Responses or derivatives, by which errors they are judged, and to which accuracies.
struct Measure {
  Of of = Of::responses;
  bool on_same_mesh = true;  ///< else against the closed form, a finer mesh or given values
  std::vector<Level> levels = {};
  std::map<std::string, double> ratio = {};  ///< Study::ratio

  std::string noun() const;  ///< "response"
  std::optional<double> error(const Cell& cell) const;
  double work(const Cell& cell) const;
  double weight(const Cell& cell) const;  ///< of a back-solve in its work; 0 where it was not measured
  double seconds(const Cell& cell) const;
  double median(const Cell& cell) const;  ///< of the seconds; 0 without a timing pass
};

/// Nothing where no error was measured.
std::optional<Measure> measure_of(const Study& study, Of of);

/// A row of the table: the runs of a method or, in a study of one method, of one choice of the options beside the one
/// that its curves run along.
struct Row {
  std::string name;
  std::vector<const Cell*> runs;
  std::string head = name;  ///< what the table's first column says
  std::string swept = {};   ///< "stiffness 1 to 100"; "" where its runs have one value
};

/// The rows, and what the head of their column says.
std::pair<std::vector<Row>, std::string> rows_of(const Study& study);

/// The least error of a row's runs.
std::optional<double> nearest_of(const Row& row, const Measure& measure);

/// A run, and others of its method that do the same for the same work.
struct Pick {
  const Cell* run = nullptr;  ///< nullptr: none
  std::vector<const Cell*> equals = {};
  std::string row = {};  ///< its name

  std::string setting() const;  ///< "scale=1, 10 or 100"; "default" where there are no options
  std::string name() const;     ///< the row's, with the setting
};

/// Of an accuracy: the cheapest run of each row, the least work among them, and the least seconds.
struct Column {
  std::vector<Pick> runs;         ///< per row; of equals the default setting, else the first
  const Cell* least = nullptr;    ///< by work
  const Cell* fastest = nullptr;  ///< by seconds, where they were measured
};
Column column_of(const std::vector<Row>& rows, const Measure& measure, double level);

constexpr double same = 1 + 1e-9;  ///< of works: counts are whole, and what differs, differs by more

/// Whether a run does as much as the least work, up to what names no winner. pre: some run gets there.
bool is_least(const Column& column, const Measure& measure, const Cell& cell);

/// Whether a run is, up to what seconds vary by, as fast as any, while one of least work clearly is not.
bool is_fastest(const Column& column, const Measure& measure, const Cell& cell);

}  // namespace stickslip::report
