/// What a study has recorded in its directory: a line per cell in results.jsonl, a line per timed run in timings.jsonl,
/// and study.json, which says which cells there are. Lines are only ever appended; the file is put in order at the end.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace stickslip {

/// Files of a study, but for what is drawn of it.
inline constexpr const char* record_files[] = {"study.json", "results.jsonl", "results.stale.jsonl", "timings.jsonl"};

/// Rows by the id of their cell; of an id recorded twice, the last.
using RowsById = std::map<std::string, nlohmann::json>;

/// results.jsonl as it was found, with what was wrong with it.
struct StoredRows {
  RowsById rows;
  std::vector<std::string> order;     ///< their ids, as they first stand in the file
  std::size_t torn_bytes = 0;         ///< of a last line that a killed process left
  std::vector<std::string> damaged;   ///< whole lines that are no rows: "line 3 is no row: ..."
  std::string dropped;                ///< these, as they stand
  int doubles = 0;                    ///< rows of an id that a later line repeats
  std::vector<std::string> unsealed;  ///< ids of rows without a checksum, as another version of the program wrote them

  bool sound() const { return torn_bytes == 0 && damaged.empty() && doubles == 0; }
  /// "a torn last line (12 bytes) was dropped; line 3 is no row: it has no "status"", or "".
  std::string faults() const;
};

/// The row with its checksum in "provenance", which is what two runs need not share: 16 digits over all else in it.
nlohmann::json sealed(nlohmann::json row);

/// Empty where there is no file. A row has the texts "id" and "status", what else the program writes of the kind that
/// it writes, and, where it has a checksum, the content that this is of; lines that are none are left out. `trim` may
/// take parts out of each row before the next is read. Throws InputFault or std::system_error where it cannot be read.
StoredRows read_rows(const std::filesystem::path& directory, const std::function<void(nlohmann::json&)>& trim = {});

/// Drops the rows without a checksum, which this version did not write, and says so among `damaged`.
void drop_unsealed(StoredRows& stored);

/// Takes the rows in `directory` up again for the cells of `ids`: what read_rows() mends is mended on the disk, and
/// lines that are none of its rows, and rows of other cells (of another study, or of another version of the program),
/// go to results.stale.jsonl. `notes`: what was done, a sentence each.
RowsById resume_rows(const std::filesystem::path& directory, const std::vector<std::string>& ids,
                     std::vector<std::string>& notes);

/// Adds a row with its checksum. On the disk when it returns.
void append_row(const std::filesystem::path& directory, const nlohmann::json& row);

/// Writes results.jsonl anew, whole or not at all: the rows there are, in the order of `ids`.
void write_rows(const std::filesystem::path& directory, const std::vector<std::string>& ids, const RowsById& rows);

/// Seconds of each timed run, by cell id and round (from 1).
using Timings = std::map<std::string, std::map<int, nlohmann::json>>;

/// Lines that are none, or whose checksum is of another, are left out, and counted in `damaged`.
Timings read_timings(const std::filesystem::path& directory, int* damaged = nullptr);
void append_timing(const std::filesystem::path& directory, const std::string& id, int round,
                   const nlohmann::json& seconds);

/// study.json of a directory. Throws InputFault, with the place in the file, where it is missing or damaged.
nlohmann::json read_description(const std::filesystem::path& directory);

/// Throws InputFault where study.json or picture.json are there and damaged.
void check_records(const std::filesystem::path& directory);

/// What sets a cell apart from others of its label: "/contacts/sole/friction = 0.3, level 1"; "" where nothing is
/// varied.
std::string variant_text(const nlohmann::json& row);

/// Whether a row's status is converged, or converged_at_roundoff.
bool converged(const nlohmann::json& row);

/// Which law a row's certificate says is broken, when and where.
std::string broken_law(const nlohmann::json& certificate);

/// Of the rows of `ids` those whose certificate does not hold, a line each that says why. Of a run without a converged
/// result its status says it.
std::vector<std::string> refuted(const std::vector<std::string>& ids, const RowsById& rows);

}  // namespace stickslip
