#include "studies/report/figure_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "studies/io/input_fault.hpp"
#include "studies/io/other_program.hpp"
#include "studies/io/output_folder.hpp"
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
  return names.count(field) > 0;
}

/// By name.
using Files = std::map<std::string, std::string>;

/// `narrow`: the same for one column of a paper.
void add_drawing(const std::string& stem, const Drawing& drawing, Files& files,
                 const std::optional<Drawing>& narrow = std::nullopt) {
  files[stem + ".svg"] = drawing.svg_file();
  constexpr std::size_t most_pieces = 20'000;  // TeX's memory holds some ten times that
  if (drawing.pieces() <= most_pieces) files[stem + ".pgf"] = drawing.pgf(narrow ? &*narrow : nullptr);
}

/// PDFs of the drawings in a folder, the same bytes each time.
void add_pdfs(const fs::path& folder, const Files& drawings) {
  Files pdfs;
  for (const auto& [name, content] : drawings) {
    const fs::path svg = folder / name;
    if (svg.extension() != ".svg") continue;
    auto pdf = output_of({"rsvg-convert", "--format=pdf", fs::absolute(svg)}, {{"SOURCE_DATE_EPOCH", "0"}});
    if (!pdf) throw InputFault(svg.string() + ": rsvg-convert makes no PDF of it");
    pdfs[svg.stem().string() + ".pdf"] = *std::move(pdf);
  }
  write_outputs(folder, {pdfs.begin(), pdfs.end()});
}

}  // namespace

std::string file_of(const Figure& figure, const Chart& chart) {
  return figure.id + (chart.title.empty() ? "" : "-" + slug(chart.title));
}

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

void write_figures(const fs::path& directory, const std::vector<Figure>& figures, const std::vector<Plate>& plates,
                   Pdfs pdfs) {
  Files files;
  for (const auto& figure : figures) {
    for (const auto& chart : figure.charts)
      if (const auto drawing = draw_plot(figure, chart))
        add_drawing(file_of(figure, chart), *drawing, files, draw_plot(figure, chart, one_column));
    files[figure.id + ".csv"] = to_csv(figure.rows);
  }
  for (const auto& plate : plates) {
    add_drawing(plate.id, plate.drawing, files);
    files[plate.id + ".csv"] = to_csv(plate.rows);
  }
  remove_outputs(directory, {std::begin(figure_files), std::end(figure_files)});
  write_outputs(directory / "figures", {files.begin(), files.end()});
  if (pdfs == Pdfs::added) add_pdfs(directory / "figures", files);
}

}  // namespace stickslip::report
