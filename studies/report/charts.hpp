/// The figures of a report: each is a set of rows and charts over them.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "studies/report/drawing.hpp"
#include "studies/report/html.hpp"
#include "studies/report/records.hpp"
#include "studies/report/settings.hpp"

namespace stickslip::report {

/// How one curve looks, in every chart of a figure: colour by method, and marker and dash so that grey print tells too.
struct Series {
  std::string name, color, shape;
  std::vector<int> dash;
  int size = 60;  ///< of the marker, px^2: methods differ, so that equal points show as nested markers
};

constexpr double chart_height = 330;  ///< in pixels of the page, unless a chart has another

enum class Spacing { linear, logarithmic };

/// What stands along an axis.
struct Quantity {
  std::string field;  ///< of the rows
  std::string title;  ///< "{FIELD}" stands for what the rows shown have there
  Spacing spacing = Spacing::linear;
  double least_step = 0;    ///< between ticks: 1 of what is counted
  bool bounded = false;     ///< nothing lies below its least value
  std::string spread = {};  ///< field with the other end of a line that starts at the point: how far a value varies
};

/// Fields of the rows with the words at the ends of lines: their names, and values; without a name no words.
struct EndWords {
  std::string name, value = {};
};

/// Points and lines over two axes. Written as a line drawing (plot.hpp), and by page.js, which draws it as Vega-Lite.
///
/// Rows have `series`, `line` (rows of one are joined, by `order`) and `failed` (a cross, joined to nothing), and where
/// they need it `zero` (an exact zero, which stands off the values that the axis names), `unmarked` (a point of a line
/// alone), and `guide` (a line that theory gives, with the words `guide_tag`).
struct Chart {
  std::string title;
  Quantity x, y;
  std::vector<std::pair<std::string, std::string>> tooltip;  ///< fields of the rows, with what they are called
  std::string only = {};  ///< rows of this chart: those whose `panel` is this; empty: all
  bool folded = false;
  EndWords words = {};
  double height = chart_height;
};

/// A choice of rows: those whose `field` is (one of) the chosen, among rows whose `when_field` is `when`.
struct Choice {
  std::string label, field;
  std::vector<std::string> options, chosen;
  bool several = false;
  std::string when_field, when;
};

struct Figure {
  std::string id, title, text;
  nlohmann::json rows = nlohmann::json::array();  ///< what is drawn, and all that its CSV holds
  std::vector<Series> series;
  std::vector<Chart> charts;
  std::vector<Choice> choices;
  std::string folded;  ///< why a reader may pass it by: it is then folded behind its title and this; "" shows it
};

/// What a figure offers by `field` and shows first; "" where it offers no such choice.
std::string first_choice(const std::optional<Figure>& figure, const std::string& field);

/// A drawing that needs no script.
struct Plate {
  std::string id, title, text;
  Drawing drawing;
  Table table;                                    ///< a summary in words; may have no rows
  nlohmann::json rows = nlohmann::json::array();  ///< what is drawn, and all that its CSV holds
  std::string folded = {};                        ///< as Figure's
};

enum class Against { same_mesh, discretization, coulomb };  ///< enforcement, discretisation, the KKT measures

/// Error against work (factorisations and weighted back-solves), seconds and back-solves; one curve per method and
/// constant option, joined along its swept knob. Nothing where no cell has such an error.
std::optional<Figure> work_precision(const Study& study, Against against, Of of);

/// Discretisation error against the mesh level and seconds, a curve a setting; nothing with one mesh level.
std::optional<Figure> mesh_convergence(const Study& study);

/// Enforcement errors of responses and sensitivities against a knob, methods without it as level lines.
/// `knobs` share the axis.
std::optional<Figure> error_against_knob(const Study& study, const std::vector<std::string>& knobs);

/// Newton iterations, augmentations and back-solves for derivatives of a whole run against the same knob; failed runs
/// are crosses.
std::optional<Figure> iterations_against_knob(const Study& study, const std::vector<std::string>& knobs);

/// The parts of each error budget along the option that a method's curve runs along, a panel a method. Nothing where
/// the study measured none.
std::optional<Figure> error_budget(const Study& study);

/// HTML below it: of each method the setting with the least error and what makes it, and what could not be measured.
std::string budget_in_words(const Study& study);

/// Residual per iteration of the step that took most iterations (of a failed run, the last), main variant.
std::optional<Figure> convergence_histories(const Study& study);

/// Every response over time and every force along every displacement, main variant, a curve a run; what the study gives
/// as exact stands at the end of time. Nothing where no run recorded responses of two steps.
std::optional<Figure> response_histories(const Study& study);

/// Every derivative of a response over time, main variant, a curve a run, those of `response` first; what the study
/// gives as exact stands at the end of time. Nothing where no run recorded derivatives of two steps.
std::optional<Figure> derivative_histories(const Study& study, const std::string& response);

/// Pressure and tangential traction along the interface at the last step with the closed form, and the difference from
/// the most accurate cell, main variant.
std::optional<Figure> tractions(const Study& study);

/// Share of the problems (scene variants, each with several accuracies) that each method solves within a factor of the
/// least work, and within a given work: default, tuned and strict settings side by side. Nothing of a single scene,
/// where the settings side by side say it, or of a single setting.
std::optional<Figure> profiles(const Study& study, Of of);

/// For each setting and scene variant the range of the knob in which it converges, as a bar; failures as crosses.
/// `knobs` share the axis. Nothing where none of them is swept.
std::optional<Plate> robustness_windows(const Study& study, const std::vector<std::string>& knobs);

/// States of the contact points over the steps, main variant, for the telling cells side by side. Nothing where no run
/// recorded more than one step of more than one point.
std::optional<Plate> film_of_states(const Study& study);

/// Groups of knobs that share an axis: stiffness and scale, both multiples of the local nodal stiffness, are one.
std::vector<std::vector<std::string>> knob_groups(const Study& study);

/// The converged cell of `family` in the main variant with the smallest enforcement error; of those whose error is no
/// more than rounding the default setting, else the one with least work. nullptr where none converged.
const Cell* best_cell(const Study& study, const std::string& family);

}  // namespace stickslip::report
