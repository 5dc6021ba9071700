/// Ledger of a run: unknowns, memory, counts and seconds that each effect of the scene added.
///
/// Amounts are measured where they arise: sizes of arrays, entries and bytes that libraries report, counts of work. An
/// effect that is off is measured like one that is on, so its zero is a result. The forecast of the same rows before a
/// run is studies/run/ledger_forecast.hpp.
#pragma once

#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "studies/run/case.hpp"

namespace stickslip {

/// A number of a row. `spread`: factor by which a forecast may be wrong; 1: exact; 0: not known before the run.
struct Amount {
  std::string name;
  double value = 0;
  double spread = 1;
};

/// Seconds of a row that are not measured separately from those of other rows.
inline constexpr double not_apart = std::numeric_limits<double>::quiet_NaN();

/// A row of the ledger.
struct LedgerRow {
  std::string effect;
  bool on = false;
  std::vector<Amount> unknowns;
  std::vector<Amount> memory;  ///< bytes; for the output, of its files
  std::vector<Amount> counts;
  double seconds = 0;
};
using Ledger = std::vector<LedgerRow>;

/// What a run wrote beside result.json.
struct Written {
  long files = 0;
  double fields = 0, solution = 0, picture = 0, trace = 0;  ///< bytes
  double seconds = 0;
};

Ledger ledger(const CaseResult& result, const Written& written = {});

/// [{"effect", "on", "unknowns": {NAME: n}, "memory": {NAME: bytes}, "counts": {NAME: n}, "seconds"}]; null where an
/// amount is not known.
nlohmann::json ledger_json(const Ledger& ledger);
/// The same without seconds, which no two runs share.
nlohmann::json repeatable_ledger_json(const Ledger& ledger);

/// One line per effect that is on, and one line with the names of the others. "~": about; "?": not known before the
/// run.
std::string ledger_table(const Ledger& ledger);
/// "12 elements", "1 analysis"; of an amount that is not exact "~2.1e5 factor entries".
std::string amount_in_words(const Amount& amount);
/// "bodies: 2 displacements, 252 B; contact: ...": the effects of a recorded ledger that are on.
std::string ledger_line(const nlohmann::json& ledger);

}  // namespace stickslip
