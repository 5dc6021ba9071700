#include "studies/report/figure_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "studies/io/atomic_file.hpp"
#include "studies/io/printing.hpp"
#include "studies/report/chart_parts.hpp"
#include "studies/report/look_up.hpp"
#include "studies/report/plot.hpp"

namespace stickslip::report {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string csv_cell(const json& value) {
  if (value.is_null()) return {};
  if (value.is_number_float()) return fmt::format("{}", value.get<double>());  // shortest that reads back the same
  if (value.is_string()) return csv_text(value.get<std::string>());
  return value.is_structured() ? csv_text(json_text(value)) : json_text(value);
}

/// How a row is drawn, as opposed to what it says.
bool is_of_looks(const std::string& field) {
  static const std::set<std::string> names = {"guide_tag", "line", "of_cell", "order", "shown", "unmarked", "zero"};
  return names.count(field) > 0 || field.starts_with("tag");
}

void write_drawing(const fs::path& stem, const Drawing& drawing) {
  write_file_atomically(stem.string() + ".svg", drawing.svg_file());
  write_file_atomically(stem.string() + ".pdf", drawing.pdf());
  constexpr std::size_t most_pieces = 20'000;  // TeX's memory holds some ten times that
  if (drawing.pieces() <= most_pieces) write_file_atomically(stem.string() + ".pgf", drawing.pgf());
}

/// Removes the figures that a folder holds.
void clear(const fs::path& directory) {
  std::vector<fs::path> old;
  for (const auto& entry : fs::directory_iterator(directory))
    if (const auto kind = entry.path().extension();
        kind == ".svg" || kind == ".pdf" || kind == ".pgf" || kind == ".csv")
      old.push_back(entry.path());
  for (const auto& file : old) fs::remove(file);
}

}  // namespace

std::vector<std::string> columns_of(const json& rows) {
  std::set<std::string> texts, others;
  for (const auto& row : rows)
    for (const auto& [field, value] : row.items())
      if (!is_of_looks(field)) (value.is_string() ? texts : others).insert(field);
  std::vector<std::string> fields(texts.begin(), texts.end());
  std::copy_if(others.begin(), others.end(), std::back_inserter(fields), [&](auto& f) { return !texts.count(f); });
  return fields;
}

std::string to_csv(const json& rows) {
  const auto fields = columns_of(rows);
  std::string out;
  const auto add_line = [&](auto cell) {
    for (std::size_t i = 0; i < fields.size(); ++i) out += (i ? "," : "") + cell(fields[i]);
    out += "\r\n";
  };
  add_line(csv_text);
  for (const auto& row : rows) add_line([&](const std::string& field) { return csv_cell(at(row, field)); });
  return out;
}

void remove_figures(const fs::path& directory) {
  const auto folder = directory / "figures";
  if (!fs::is_directory(folder)) return;
  clear(folder);
  if (fs::is_empty(folder)) fs::remove(folder);
}

void write_figures(const fs::path& directory, const std::vector<Figure>& figures, const std::vector<Plate>& plates) {
  const auto folder = directory / "figures";
  fs::create_directories(folder);
  clear(folder);
  for (const auto& figure : figures) {
    for (const auto& panel : figure.panels)
      if (const auto drawing = draw_plot(figure, panel))
        write_drawing(folder / (figure.id + (panel.title.empty() ? "" : "-" + slug(panel.title))), *drawing);
    write_file_atomically(folder / (figure.id + ".csv"), to_csv(figure.rows));
  }
  for (const auto& plate : plates) {
    write_drawing(folder / plate.id, plate.drawing);
    write_file_atomically(folder / (plate.id + ".csv"), to_csv(plate.rows));
  }
}

}  // namespace stickslip::report
