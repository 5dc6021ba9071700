#include "studies/report/sample.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "studies/io/result_rows.hpp"
#include "studies/report/chart_parts.hpp"
#include "studies/report/look_up.hpp"
#include "studies/report/settings.hpp"

namespace stickslip::report {
namespace {

using nlohmann::json;

constexpr const char* curves_of_a_row[] = {"steps", "film", "interface"};

/// How many runs the page has room for: 250, fewer where each has many errors, since a chart has a mark for each.
std::size_t room(const Study& study) {
  constexpr std::size_t most_cells = 250, fewest_cells = 40, most_errors = 10'000;
  constexpr std::size_t marks_of_a_budget = 7;  // the error, five parts, and what is left
  std::size_t errors = 1;
  for (const auto& cell : study.cells)
    errors = std::max(errors, cell.enforcement.size() + cell.discretization.size() + cell.kkt.size() +
                                  marks_of_a_budget * object_at(at(cell.record, "error_budget"), "quantities").size());
  return std::clamp(most_errors / errors, fewest_cells, most_cells);
}

/// Every n-th of `all`, at most `most` of them.
template <class Item>
std::vector<Item> evenly(const std::vector<Item>& all, std::size_t most) {
  std::vector<Item> out;
  for (std::size_t i = 0; i < std::min(most, all.size()); ++i)
    out.push_back(all[i * all.size() / std::min(most, all.size())]);
  return out;
}

/// Of a main variant that is too large: the runs that are named elsewhere on the page, and others evenly spaced.
std::set<const Cell*> some_of_main_variant(const Study& study, std::size_t most) {
  std::set<const Cell*> out;
  const auto cells = main_cells(study);
  const auto labels = telling_cells(study, Furthest::added);
  for (const Cell* cell : cells)
    if (std::find(labels.begin(), labels.end(), cell->label) != labels.end()) out.insert(cell);
  for (const Of of : {Of::responses, Of::sensitivities})
    if (const auto target = target_error(study, of))
      for (const auto& contestant : contestants(study, {{study.main_variant, *target}}, of))
        for (const Cell* cell : contestant.cells)
          if (cell) out.insert(cell);
  for (const Cell* cell : evenly(cells, most))
    if (out.size() < most) out.insert(cell);
  return out;
}

}  // namespace

Study sample_of(const Study& study) {
  const std::size_t most = room(study);
  if (study.cells.size() <= most) return study;
  std::map<std::string, std::size_t> sizes;
  for (const auto& cell : study.cells) ++sizes[cell.variant];
  std::size_t left = most - std::min(most, sizes[study.main_variant]);
  std::set<std::string> variants;
  if (sizes[study.main_variant] <= most) variants.insert(study.main_variant);
  for (const auto& variant : evenly(study.variants, left))
    if (sizes[variant] <= left && variants.insert(variant).second) left -= sizes[variant];
  const auto some = variants.count(study.main_variant) ? std::set<const Cell*>() : some_of_main_variant(study, most);
  Study sample;
  sample.description = study.description;
  sample.picture = study.picture;
  sample.peers = study.peers;
  sample.families = study.families;
  sample.main_variant = study.main_variant;
  sample.shared = study.shared;
  sample.understood = study.understood;
  sample.ratio = study.ratio;
  sample.refined = study.refined;
  for (const auto& cell : study.cells)
    if (variants.count(cell.variant) || some.count(&cell)) sample.cells.push_back(cell);
  std::copy_if(study.variants.begin(), study.variants.end(), std::back_inserter(sample.variants),
               [&](const auto& variant) { return variant == study.main_variant || variants.count(variant) > 0; });
  return sample;
}

void attach_curves(Study& study, const std::filesystem::path& directory) {
  constexpr std::size_t most = 60;
  const auto telling = telling_cells(study, Furthest::added);
  std::vector<Cell*> wanted;
  for (const bool first : {true, false})
    for (auto& cell : study.cells)
      if (cell.variant == study.main_variant && wanted.size() < most &&
          (std::find(telling.begin(), telling.end(), cell.label) != telling.end()) == first)
        wanted.push_back(&cell);
  std::set<std::string> ids;
  for (const Cell* cell : wanted) ids.insert(cell->record.value("id", ""));
  StoredRows stored = read_rows(directory, [&](json& row) {
    if (ids.count(row["id"].get<std::string>()) == 0) row = json::object();
  });
  for (Cell* cell : wanted)
    for (const char* part : curves_of_a_row)
      if (json& row = stored.rows[cell->record.value("id", "")]; row.contains(part))
        cell->record[part] = std::move(row[part]);
}

void drop_bulk(json& row, bool first) {
  if (!row.contains("peer"))
    for (const char* part : curves_of_a_row) row.erase(part);
  if (const auto errors = row.find("errors"); errors != row.end() && errors->is_object()) errors->erase("by_reference");
  if (const auto provenance = row.find("provenance"); provenance != row.end() && provenance->is_object() && !first)
    for (const char* part : {"libraries", "date", "version", "build_type", "cores", "load_average", "checksum"})
      provenance->erase(part);
}

}  // namespace stickslip::report
