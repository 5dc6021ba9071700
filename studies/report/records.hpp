/// What a study left behind, as the report sees it: study.json, results.jsonl and picture.json, read tolerantly.
/// A key that is missing leaves an empty value; a line that is no row is told, not fatal.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace stickslip::report {

/// Errors of a response below this are what sixteen digits leave after a solve, and order no runs.
constexpr double rounding_error = 1e-12;

/// One swept option of a method and the value this cell gave it.
struct Knob {
  std::string name;             ///< option name; "NAME (absolute)" where the value is {"absolute": number}
  std::string text;             ///< the value as shown
  std::optional<double> value;  ///< the number, where it is one; of "auto" the one that it stands for
};

/// One cell of a study: a method with its options, on one variant of the scene.
struct Cell {
  nlohmann::json record;  ///< the line; without its steps, film and interface but where attach_curves() adds them
  std::string label;      ///< method, in words, and options: see labels.hpp
  std::string family;     ///< key of the method: penalty, uzawa_al, monolithic_al, ...
  std::string status;
  bool converged = false;
  std::string file;     ///< of the scene, of a study of several; else empty
  std::string scene;    ///< file, and values of `vary`: "friction = 0.3"; empty where there is neither
  int refine = 0;       ///< mesh level
  std::string variant;  ///< scene and, where there are several, mesh level
  std::string beside;   ///< scene without what makes its mesh
  std::string mesh;     ///< what of the variant makes its mesh: file, values of `vary` and mesh level
  std::vector<Knob> knobs;
  std::map<std::string, std::string> bare = {};  ///< option and value, of those whose value stands alone in the label
  std::map<std::string, double> enforcement;     ///< against the same mesh; keys response:* sensitivity:* field:*
  std::map<std::string, double> discretization;  ///< against discretization_reference(); same keys
  std::map<std::string, double> kkt;             ///< method-blind measures
  double work = 0;              ///< flop equivalents in factorisations, the response alone (see Study::ratio)
  double sensitivity_work = 0;  ///< the same with the derivatives' share added
  double seconds = 0, sensitivity_seconds = 0;  ///< 0 where not recorded; without output; of several the least
  double median_seconds = 0, median_sensitivity_seconds = 0;  ///< of a timing pass; 0 where there was none
  double count(const std::string& name) const;                ///< cost.counts[name]; 0 where not recorded
};

struct Study {
  nlohmann::json description;         ///< study.json; null where missing
  nlohmann::json picture;             ///< picture.json; null where missing
  nlohmann::json certificate;         ///< certificate.json; null where missing
  std::vector<Cell> cells;            ///< in recorded order; of an id recorded twice, the last
  std::vector<Cell> peers;            ///< solutions of other programs, in recorded order; none of what follows has them
  std::vector<std::string> families;  ///< in order of appearance
  std::vector<std::string> variants;  ///< in order of appearance
  std::string main_variant;           ///< the one shown first: most cells converged, of equals the last
  std::vector<std::string> shared;    ///< "METHOD OPTION=VALUE" that tells no two runs of the method apart
  std::vector<std::string> understood;  ///< "METHOD OPTION=VALUE" of runs whose label does not name the option
  std::map<std::string, double> ratio;  ///< cost of one back-solve over one factorisation, by Cell::mesh; measured
  bool refined = false;                 ///< more than one mesh level
  std::string faults;                   ///< of results.jsonl, in words
  std::size_t unrecorded = 0;           ///< cells of the study without a row
};

/// Reads `directory`. Throws InputFault where there is no results.jsonl or study.json is no JSON.
Study read_study(const std::filesystem::path& directory);

/// Reads the result of a run, with what picture.json holds beside it, as a study of one cell. Throws InputFault where
/// result.json is none.
Study read_run(const std::filesystem::path& directory);

/// "Penalty", "Uzawa AL", "Monolithic AL"; another key as it stands.
std::string family_name(const std::string& family);

/// The knob a curve of `family` runs along: the one swept; of several, stiffness, then tolerance, then scale, then the
/// one with most values. Empty where nothing is swept.
std::string running_knob(const Study& study, const std::string& family);

/// Names of the knobs with at least two different numbers, over all families, in order of appearance.
std::vector<std::string> knob_names(const Study& study);

const Knob* find_knob(const Cell& cell, const std::string& name);

/// What the discretisation errors are against: "the closed form", "the finer mesh", "the common mesh (fine.msh)", "the
/// given values", or, where the study has several of them or names none, "the references".
std::string discretization_reference(const Study& study);

/// Whether that is finer meshes alone, which have the steps of the runs.
bool is_against_meshes_alone(const Study& study);

/// Study::ratio of the mesh of a cell; 0 where it was not measured.
double ratio_of(const std::map<std::string, double>& ratio, const Cell& cell);

/// The lists that a study varies together, by name, from its description.
std::vector<std::pair<std::string, nlohmann::json>> linked_lists(const nlohmann::json& description);

/// The cells of the main variant, in recorded order.
std::vector<const Cell*> main_cells(const Study& study);

/// What a study has of one of its scenes.
Study of_scene(const Study& all, const std::string& file);

/// Whether no contact has friction: the ledgers say so or, in records without them, all that touches is "closed", and
/// no measure speaks of slip.
bool is_frictionless(const Study& study);

/// Whether a method-blind measure is of Coulomb's law.
bool is_of_friction(const std::string& measure);

/// Largest value of those whose key starts with `prefix`; nothing where there is none.
std::optional<double> worst(const std::map<std::string, double>& errors, const std::string& prefix);

}  // namespace stickslip::report
