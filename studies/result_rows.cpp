#include "studies/result_rows.hpp"

#include <fmt/format.h>

#include <array>
#include <set>
#include <utility>

#include "studies/atomic_file.hpp"
#include "studies/input_fault.hpp"
#include "studies/json_node.hpp"

namespace stickslip {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

fs::path rows_of(const fs::path& directory) { return directory / "results.jsonl"; }
fs::path timings_of(const fs::path& directory) { return directory / "timings.jsonl"; }

/// What is wrong with a line of results.jsonl; "" where it is a row.
std::string row_fault(const json& row) {
  if (!row.is_object()) return row.is_discarded() ? "it is not JSON" : "it is " + shown(row);
  for (const char* name : {"id", "status"})
    if (!row.contains(name)) return "it has no " + in_quotes(name);
  static const std::array<std::pair<const char*, json::value_t>, 17> kinds{{
      {"/id", json::value_t::string},
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
      {"/cost", json::value_t::object},
      {"/cost/counts", json::value_t::object},
      {"/cost/seconds", json::value_t::object},
  }};
  for (const auto& [pointer, kind] : kinds)
    if (const json* value = value_at(row, pointer); value && value->type() != kind)
      return std::string(pointer) + " is " + shown(*value) + "; must be " +
             (kind == json::value_t::string ? "a text" : "an object");
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
  throw InputFault(diagnostics.text() + "delete the file, and run the study again with --resume");
}

/// Reports what in study.json is of another kind than the program writes.
void check_description(const JsonNode& root) {
  if (!root.is_map("what a study recorded of itself")) return;
  for (const char* name : {"program", "command", "shard", "scene_title", "scene_hash", "explain"})
    if (const auto text = root.find(name)) text->text();
  for (const char* name : {"mesh", "size"})
    if (const auto group = root.find(name); group && !group->value().is_null()) group->is_map("numbers by name");
  const auto cells = root.find("cells");
  if (cells && !cells->value().is_array()) cells->must_be("a list of cells");
  for (const JsonNode& cell : cells && cells->value().is_array() ? cells->elements() : std::vector<JsonNode>{})
    cell.text();
}

std::string lines(const std::vector<const json*>& rows) {
  std::string text;
  for (const json* row : rows) text += row->dump() + "\n";
  return text;
}

}  // namespace

std::string StoredRows::faults() const {
  std::vector<std::string> all;
  if (torn_bytes > 0) all.push_back(fmt::format("a torn last line ({} bytes) was dropped", torn_bytes));
  all.insert(all.end(), damaged.begin(), damaged.end());
  if (doubles > 0) all.push_back(fmt::format("{} double row(s) were dropped", doubles));
  return fmt::format("{}", fmt::join(all, "; "));
}

StoredRows read_rows(const fs::path& directory) {
  StoredRows stored;
  const auto path = rows_of(directory);
  if (!fs::exists(path)) return stored;
  const std::string content = read_file(path);
  const auto end = content.rfind('\n');
  stored.torn_bytes = content.size() - (end == std::string::npos ? 0 : end + 1);
  int line = 0;
  for (std::size_t begin = 0, next; (next = content.find('\n', begin)) != std::string::npos; begin = next + 1) {
    json row = json::parse(content.begin() + static_cast<long>(begin), content.begin() + static_cast<long>(next),
                           nullptr, false);
    ++line;
    if (const std::string fault = row_fault(row); !fault.empty()) {
      stored.damaged.push_back(fmt::format("line {} is no row and was dropped: {}", line, fault));
      continue;
    }
    const std::string id = row["id"];
    if (stored.rows.count(id) == 0)
      stored.order.push_back(id);
    else
      ++stored.doubles;
    stored.rows[id] = std::move(row);
  }
  return stored;
}

RowsById resume_rows(const fs::path& directory, const std::vector<std::string>& ids, std::vector<std::string>& notes) {
  StoredRows stored = read_rows(directory);
  if (!stored.sound()) notes.push_back(stored.faults());
  const std::set<std::string> own(ids.begin(), ids.end());
  std::vector<const json*> stale;
  for (const auto& [id, row] : stored.rows)
    if (own.count(id) == 0) stale.push_back(&row);
  if (!stale.empty()) {
    const auto path = directory / "results.stale.jsonl";
    write_file_atomically(path, (fs::exists(path) ? read_file(path) : std::string()) + lines(stale));
    notes.push_back(fmt::format("{} row(s) of another study or version of the program were put aside in {}",
                                stale.size(), path.string()));
  }
  const bool rewrite = !stored.sound() || !stale.empty();
  std::erase_if(stored.rows, [&](const auto& each) { return own.count(each.first) == 0; });
  if (rewrite) write_rows(directory, ids, stored.rows);
  return std::move(stored.rows);
}

void append_row(const fs::path& directory, const json& row) { append_line(rows_of(directory), row.dump()); }

void write_rows(const fs::path& directory, const std::vector<std::string>& ids, const RowsById& rows) {
  std::vector<const json*> ordered;
  for (const auto& id : ids)
    if (const auto row = rows.find(id); row != rows.end()) ordered.push_back(&row->second);
  write_file_atomically(rows_of(directory), lines(ordered));
}

Timings read_timings(const fs::path& directory) {
  Timings timings;
  for (const auto& line : read_lines(timings_of(directory))) {
    const json entry = json::parse(line, nullptr, false);
    if (entry.is_object() && entry.contains("id") && entry["id"].is_string() && entry.contains("round") &&
        entry["round"].is_number_integer() && entry.contains("seconds"))
      timings[entry["id"].get<std::string>()][entry["round"].get<int>()] = entry["seconds"];
  }
  return timings;
}

void append_timing(const fs::path& directory, const std::string& id, int round, const json& seconds) {
  append_line(timings_of(directory), json{{"id", id}, {"round", round}, {"seconds", seconds}}.dump());
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
  if (!fs::exists(picture) || json::parse(read_file(picture), nullptr, false).is_object()) return;
  Diagnostics diagnostics;  // the places in a large file are looked for only where they are needed
  if (const auto document = JsonDocument::read(picture.string(), diagnostics))
    JsonNode(*document, diagnostics).is_map("what a study drew");
  throw_damaged(diagnostics);
}

std::string variant_text(const json& row) {
  std::string text;
  const json vary = row.value("vary", json::object());
  for (const auto& [pointer, value] : vary.items()) text += (text.empty() ? "" : ", ") + pointer + " = " + value.dump();
  if (const int level = row.value("refine", 0)) text += fmt::format("{}level {}", text.empty() ? "" : ", ", level);
  return text;
}

bool converged(const json& row) { return row.value("status", "").starts_with("converged"); }

}  // namespace stickslip
