/// The ledger of a run: what each effect of the scene added to it in unknowns, memory, counts and seconds.
///
/// Amounts are taken where they arise: sizes of the arrays that are there, entries and bytes that the libraries tell,
/// counts of what was done. What is off is looked up as what is on is; that it comes to nothing is a result. The same
/// rows, told before a run from counts alone, are studies/run/ledger_forecast.hpp.
#pragma once

#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "studies/run/case.hpp"

namespace stickslip {

/// A number of a row. `spread`: of a forecast, the factor that it holds to; 1: exactly; 0: not known before the run.
struct Amount {
  std::string name;
  double value = 0;
  double spread = 1;
};

/// Seconds of a row that the clock does not tell apart from those of others.
inline constexpr double not_apart = std::numeric_limits<double>::quiet_NaN();

/// A row of the ledger.
struct LedgerRow {
  std::string effect;
  bool on = false;
  std::vector<Amount> unknowns;
  std::vector<Amount> memory;  ///< bytes; of the output, those of its files
  std::vector<Amount> counts;
  double seconds = 0;
};
using Ledger = std::vector<LedgerRow>;

/// What a run wrote beside result.json.
struct Written {
  long files = 0;
  double fields = 0, picture = 0, trace = 0;  ///< bytes
  double seconds = 0;
};

Ledger ledger(const CaseResult& result, const Written& written = {});

/// [{"effect", "on", "unknowns": {NAME: n}, "memory": {NAME: bytes}, "counts": {NAME: n}, "seconds"}]; null where an
/// amount is not known.
nlohmann::json ledger_json(const Ledger& ledger);
/// The same without seconds, which no two runs share.
nlohmann::json repeatable_ledger_json(const Ledger& ledger);

/// A line for each effect that is on, and one that names the others. "~": about; "?": not known before the run.
std::string ledger_table(const Ledger& ledger);
/// "12 elements", "1 analysis"; of an amount that is not exact "~2.1e5 factor entries".
std::string amount_in_words(const Amount& amount);
/// What is on of a recorded ledger in one line: unknowns, memory, and seconds from a tenth on.
std::string ledger_line(const nlohmann::json& ledger);

}  // namespace stickslip
