#include "studies/report/figure_files.hpp"

#include "studies/atomic_file.hpp"
#include "studies/report/chart_parts.hpp"
#include "studies/report/plot.hpp"

namespace stickslip::report {
namespace {

namespace fs = std::filesystem;

std::string csv_line(const std::vector<std::string>& cells) {
  std::string out;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (i > 0) out += ',';
    if (cells[i].find_first_of(",\"\r\n") == std::string::npos) {
      out += cells[i];
      continue;
    }
    out += '"';
    for (const char c : cells[i]) out += c == '"' ? std::string("\"\"") : std::string(1, c);
    out += '"';
  }
  return out + "\r\n";
}

void write_drawing(const fs::path& stem, const Drawing& drawing) {
  write_file_atomically(stem.string() + ".svg", drawing.svg_file());
  write_file_atomically(stem.string() + ".pdf", drawing.pdf());
}

void clear(const fs::path& directory) {
  std::vector<fs::path> old;
  for (const auto& entry : fs::directory_iterator(directory))
    if (const auto kind = entry.path().extension(); kind == ".svg" || kind == ".pdf" || kind == ".csv")
      old.push_back(entry.path());
  for (const auto& file : old) fs::remove(file);
}

}  // namespace

std::string to_csv(const Table& table) {
  std::string out = csv_line(table.header);
  for (const auto& row : table.rows) out += csv_line(row);
  return out;
}

void write_figures(const fs::path& directory, const std::vector<Figure>& figures, const std::vector<Plate>& plates,
                   const std::vector<std::pair<std::string, Drawing>>& drawings) {
  const auto folder = directory / "figures";
  fs::create_directories(folder);
  clear(folder);
  for (const auto& figure : figures) {
    for (const auto& panel : figure.panels)
      if (const auto drawing = draw_plot(figure, panel))
        write_drawing(folder / (figure.id + (panel.title.empty() ? "" : "-" + slug(panel.title))), *drawing);
    write_file_atomically(folder / (figure.id + ".csv"), to_csv(figure.table));
  }
  for (const auto& plate : plates) {
    write_drawing(folder / plate.id, plate.drawing);
    write_file_atomically(folder / (plate.id + ".csv"), to_csv(plate.table));
  }
  for (const auto& [name, drawing] : drawings) write_drawing(folder / name, drawing);
}

}  // namespace stickslip::report
