#include "studies/io/result_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <set>
#include <utility>

#include "studies/io/atomic_file.hpp"
#include "studies/io/input_fault.hpp"
#include "studies/io/json_node.hpp"
#include "studies/io/output_folder.hpp"
#include "studies/io/printing.hpp"

namespace stickslip {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

fs::path rows_of(const fs::path& directory) { return directory / "results.jsonl"; }
fs::path timings_of(const fs::path& directory) { return directory / "timings.jsonl"; }

/// Digits that a change of the content changes.
std::string checksum_of(json row) {
  if (row.contains("provenance") && row["provenance"].is_object()) row["provenance"].erase("checksum");
  return fingerprint(json_text(row));
}

bool has_checksum(const json& row) { return value_at(row, "/provenance/checksum") != nullptr; }

const char* kind_of(const json& value) {
  return value.is_array() ? "an array" : value.is_string() ? "a text" : value.is_number() ? "a number" : "no object";
}

/// What is wrong with a line of results.jsonl; "" where it is a row. It does not say what the line holds.
std::string row_fault(const json& row) {
  if (!row.is_object()) return row.is_discarded() ? "it is not JSON" : std::string("it is ") + kind_of(row);
  for (const char* name : {"id", "status"})
    if (!row.contains(name)) return "it has no " + in_quotes(name);
  if (has_checksum(row) && row["provenance"]["checksum"] != checksum_of(row)) return "its checksum is of another row";
  static const std::array<std::pair<const char*, json::value_t>, 21> kinds{{
      {"/id", json::value_t::string},
      {"/scene", json::value_t::string},
      {"/status", json::value_t::string},
      {"/label", json::value_t::string},
      {"/message", json::value_t::string},
      {"/scene_hash", json::value_t::string},
      {"/method", json::value_t::object},
      {"/knobs", json::value_t::object},
      {"/vary", json::value_t::object},
      {"/errors", json::value_t::object},
      {"/errors/enforcement", json::value_t::object},
      {"/errors/discretization", json::value_t::object},
      {"/errors/kkt", json::value_t::object},
      {"/responses", json::value_t::object},
      {"/sensitivities", json::value_t::object},
      {"/error_budget", json::value_t::object},
      {"/error_budget/quantities", json::value_t::object},
      {"/error_budget/failed", json::value_t::array},
      {"/cost", json::value_t::object},
      {"/cost/counts", json::value_t::object},
      {"/cost/seconds", json::value_t::object},
  }};
  for (const auto& [pointer, kind] : kinds)
    if (const json* value = value_at(row, pointer); value && value->type() != kind)
      return std::string(pointer) + " is " + shown(*value) + "; must be " +
             (kind == json::value_t::string  ? "a text"
              : kind == json::value_t::array ? "an array"
                                             : "an object");
  for (const char* pointer :
       {"/errors/enforcement", "/errors/discretization", "/errors/kkt", "/cost/counts", "/cost/seconds"})
    if (const json* group = value_at(row, pointer))
      for (const auto& [name, value] : group->items())
        if (!value.is_number() && !value.is_null())
          return child_pointer(pointer, name) + " is " + shown(value) + "; must be a number";
  if (const auto level = row.find("refine"); level != row.end() && !level->is_number_integer())
    return "/refine is " + shown(*level) + "; must be a whole number";
  return "";
}

[[noreturn]] void throw_damaged(const Diagnostics& diagnostics) {
  throw InputFault(diagnostics.text() + "delete the file, and resume the study");
}

/// Reports what in study.json is of another kind than the program writes.
void check_description(const JsonNode& root) {
  if (!root.is_map("what a study recorded of itself")) return;
  for (const char* name : {"program", "command", "shard", "scene_title", "scene_hash", "explain"})
    if (const auto text = root.find(name)) text->text();
  for (const char* name : {"mesh", "size", "scene_titles"})
    if (const auto group = root.find(name); group && !group->value().is_null()) group->is_map("numbers by name");
  const auto cells = root.find("cells");
  if (cells && !cells->value().is_array()) cells->must_be("a list of cells");
  for (const JsonNode& cell : cells && cells->value().is_array() ? cells->elements() : std::vector<JsonNode>{})
    cell.text();
}

std::string lines(const std::vector<const json*>& rows) {
  std::string text;
  for (const json* row : rows) text += json_text(*row) + "\n";
  return text;
}

/// Seconds as cost.seconds has them.
bool is_seconds(const json& value) {
  return value.is_object() && value.contains("total") && std::all_of(value.begin(), value.end(), [](const json& each) {
           return each.is_number() && each.get<double>() >= 0;
         });
}

/// A line of timings.jsonl with a sum over the rest of it.
json sealed_timing(json entry) {
  entry.erase("checksum");
  entry["checksum"] = fingerprint(json_text(entry));
  return entry;
}

}  // namespace

std::string StoredRows::faults() const {
  std::vector<std::string> all;
  if (torn_bytes > 0) all.push_back(fmt::format("a torn last line ({} bytes) was dropped", torn_bytes));
  all.insert(all.end(), damaged.begin(), damaged.end());
  if (doubles > 0) all.push_back(fmt::format("{} double row(s) were dropped", doubles));
  // a file of another kind may have as many faults as lines
  constexpr std::size_t most = 20;
  if (all.size() > most) {
    const std::size_t more = all.size() - most;
    all.resize(most);
    all.push_back(fmt::format("and {} more like these", more));
  }
  return fmt::format("{}", fmt::join(all, "; "));
}

json sealed(json row) {
  if (!row.contains("provenance") || !row["provenance"].is_object()) row["provenance"] = json::object();
  row["provenance"]["checksum"] = checksum_of(row);
  return row;
}

StoredRows read_rows(const fs::path& directory, const std::function<void(json&)>& trim) {
  StoredRows stored;
  const auto path = rows_of(directory);
  if (!fs::exists(path)) return stored;
  std::ifstream file = open_to_read(path);
  std::string text;
  for (int line = 1; std::getline(file, text); ++line) {
    if (file.eof()) {  // no newline ends it
      stored.torn_bytes = text.size();
      break;
    }
    json row = json::parse(text, nullptr, false);
    if (const std::string fault = row_fault(row); !fault.empty()) {
      stored.damaged.push_back(fmt::format("line {} is no row and was dropped: {}", line, fault));
      stored.dropped += text + "\n";
      continue;
    }
    const std::string id = row["id"];
    if (!has_checksum(row)) stored.unsealed.push_back(id);
    if (trim) trim(row);
    if (stored.rows.count(id) == 0)
      stored.order.push_back(id);
    else
      ++stored.doubles;
    stored.rows[id] = std::move(row);
  }
  return stored;
}

void drop_unsealed(StoredRows& stored) {
  if (stored.unsealed.empty()) return;
  for (const auto& id : stored.unsealed)
    if (const auto row = stored.rows.extract(id); row) stored.dropped += json_text(row.mapped()) + "\n";
  std::erase_if(stored.order, [&](const auto& id) { return stored.rows.count(id) == 0; });
  stored.damaged.push_back(fmt::format("{} row(s) without a checksum were dropped", stored.unsealed.size()));
  stored.unsealed.clear();
}

RowsById resume_rows(const fs::path& directory, const std::vector<std::string>& ids, std::vector<std::string>& notes) {
  StoredRows stored = read_rows(directory);
  drop_unsealed(stored);
  if (!stored.sound()) notes.push_back(stored.faults());
  const std::set<std::string> own(ids.begin(), ids.end());
  std::vector<const json*> stale;
  for (const auto& [id, row] : stored.rows)
    if (own.count(id) == 0) stale.push_back(&row);
  const auto path = directory / "results.stale.jsonl";
  if (const std::string aside = stored.dropped + lines(stale); !aside.empty())
    write_output(path, (fs::exists(path) ? read_file(path) : std::string()) + aside, Sums::of_each_line);
  if (!stale.empty())
    notes.push_back(fmt::format("{} row(s) of another study or version of the program were put aside in {}",
                                stale.size(), path.string()));
  const bool rewrite = !stored.sound() || !stale.empty();
  std::erase_if(stored.rows, [&](const auto& each) { return own.count(each.first) == 0; });
  if (rewrite) write_rows(directory, ids, stored.rows);
  return std::move(stored.rows);
}

void append_row(const fs::path& directory, const json& row) {
  append_output(rows_of(directory), json_text(sealed(row)));
}

void write_rows(const fs::path& directory, const std::vector<std::string>& ids, const RowsById& rows) {
  std::string text;
  for (const auto& id : ids)
    if (const auto row = rows.find(id); row != rows.end()) text += json_text(sealed(row->second)) + "\n";
  write_output(rows_of(directory), text, Sums::of_each_line);
}

Timings read_timings(const fs::path& directory, int* damaged) {
  Timings timings;
  for (const auto& line : read_lines(timings_of(directory))) {
    const json entry = json::parse(line, nullptr, false);
    const auto has = [&](const char* name) { return entry.is_object() && entry.contains(name); };
    const bool sound = has("id") && entry["id"].is_string() && has("round") && entry["round"].is_number_integer() &&
                       has("seconds") && is_seconds(entry["seconds"]) && entry == sealed_timing(entry);
    if (sound)
      timings[entry["id"].get<std::string>()][entry["round"].get<int>()] = entry["seconds"];
    else if (damaged)
      ++*damaged;
  }
  return timings;
}

void append_timing(const fs::path& directory, const std::string& id, int round, const json& seconds) {
  append_output(timings_of(directory), json_text(sealed_timing({{"id", id}, {"round", round}, {"seconds", seconds}})));
}

json read_description(const fs::path& directory) {
  const auto path = directory / "study.json";
  if (!fs::exists(path)) throw InputFault(directory.string() + ": there is no study.json; not a study's directory");
  Diagnostics diagnostics;
  const auto document = JsonDocument::read(path.string(), diagnostics);
  if (document) check_description(JsonNode(*document, diagnostics));
  if (diagnostics.has_errors()) throw_damaged(diagnostics);
  return document->root();
}

void check_records(const fs::path& directory) {
  if (fs::exists(directory / "study.json")) read_description(directory);
  const auto picture = directory / "picture.json";
  if (!fs::exists(picture)) return;
  if (const json drawn = json::parse(read_file(picture), nullptr, false); drawn.is_object() || drawn.is_null()) return;
  Diagnostics diagnostics;  // the places in a large file are looked for only where they are needed
  if (const auto document = JsonDocument::read(picture.string(), diagnostics))
    JsonNode(*document, diagnostics).is_map("what a study drew");
  throw_damaged(diagnostics);
}

std::string variant_text(const json& row) {
  std::string text = row.value("scene", "");
  const json vary = row.value("vary", json::object());
  for (const auto& [pointer, value] : vary.items())
    text += (text.empty() ? "" : ", ") + pointer + " = " + json_text(value);
  if (const int level = row.value("refine", 0)) text += fmt::format("{}level {}", text.empty() ? "" : ", ", level);
  return text;
}

bool converged(const json& row) { return row.value("status", "").starts_with("converged"); }

std::string broken_law(const json& certificate) {
  return fmt::format("{} at t = {:.9g}, {}", certificate["law"].get<std::string>(), certificate["time"].get<double>(),
                     certificate["where"].get<std::string>());
}

std::vector<std::string> refuted(const std::vector<std::string>& ids, const RowsById& rows) {
  std::vector<std::string> lines;
  for (const std::string& id : ids) {
    const auto found = rows.find(id);
    if (found == rows.end()) continue;
    const json& row = found->second;
    const json certificate = row.value("certificate", json::object());
    if (certificate.value("holds", true) || !(row.contains("peer") || converged(row))) continue;
    const std::string variant = variant_text(row);
    lines.push_back(fmt::format("{}{}: its certificate does not hold: {}", row.value("label", ""),
                                variant.empty() ? "" : ", " + variant, broken_law(certificate)));
  }
  return lines;
}

}  // namespace stickslip
