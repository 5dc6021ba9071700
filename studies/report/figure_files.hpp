/// Every figure of a report as files of its own, for papers and for other programs.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "studies/report/charts.hpp"

namespace stickslip::report {

/// Comma-separated values (RFC 4180), the header first; all columns, empty ones too.
std::string to_csv(const Table& table);

/// Writes DIR/figures anew: NAME.svg and NAME.pdf of each panel with what the report shows at first, and the figure's
/// table as ID.csv; `drawings` by their names, which have no numbers of their own. Other files there stay; those of the
/// three kinds go, since they are of a former report.
void write_figures(const std::filesystem::path& directory, const std::vector<Figure>& figures,
                   const std::vector<Plate>& plates, const std::vector<std::pair<std::string, Drawing>>& drawings);

}  // namespace stickslip::report
