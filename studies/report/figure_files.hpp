/// Every figure of a report as files of its own, for papers and for other programs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "studies/report/charts.hpp"
#include "studies/report/report.hpp"

namespace stickslip::report {

/// The name of a chart's files, without their ending.
std::string file_of(const Figure& figure, const Chart& chart);

/// What rows of a chart say, as opposed to how they look: the columns of their CSV, texts before numbers.
std::vector<std::string> columns_of(const nlohmann::json& rows);

/// Rows of a chart as comma-separated values (RFC 4180), the header first; numbers read back to the same bits.
std::string to_csv(const nlohmann::json& rows);

/// What the names of these files are.
inline constexpr const char* figure_files[] = {"figures/*.svg", "figures/*.pdf", "figures/*.pgf", "figures/*.csv"};

/// Writes DIR/figures anew: NAME.svg and NAME.pgf (but of a very fine mesh; laid out for one column of a paper and for
/// two) of each panel with what the report shows at first, NAME.pdf where `pdfs` asks for it, and the figure's rows, of
/// all that can be chosen, as ID.csv. Those of a former report go, files of others stay (write_outputs). Throws
/// InputFault if rsvg-convert cannot make a PDF.
void write_figures(const std::filesystem::path& directory, const std::vector<Figure>& figures,
                   const std::vector<Plate>& plates, Pdfs pdfs);

}  // namespace stickslip::report
