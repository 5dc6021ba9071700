#include "studies/result_rows.hpp"

#include <fmt/format.h>

#include <set>
#include <stdexcept>

#include "studies/atomic_file.hpp"

namespace stickslip {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

fs::path rows_of(const fs::path& directory) { return directory / "results.jsonl"; }
fs::path timings_of(const fs::path& directory) { return directory / "timings.jsonl"; }

bool is_row(const json& row) { return row.is_object() && row.contains("id") && row["id"].is_string(); }

std::string lines(const std::vector<const json*>& rows) {
  std::string text;
  for (const json* row : rows) text += row->dump() + "\n";
  return text;
}

}  // namespace

std::string StoredRows::faults() const {
  std::vector<std::string> all;
  if (torn_bytes > 0) all.push_back(fmt::format("a torn last line ({} bytes) was dropped", torn_bytes));
  if (unreadable > 0) all.push_back(fmt::format("{} unreadable line(s) were dropped", unreadable));
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
  for (std::size_t begin = 0, next; (next = content.find('\n', begin)) != std::string::npos; begin = next + 1) {
    json row = json::parse(content.begin() + static_cast<long>(begin), content.begin() + static_cast<long>(next),
                           nullptr, false);
    if (!is_row(row)) {
      ++stored.unreadable;
      continue;
    }
    const std::string id = row["id"];
    stored.doubles += stored.rows.count(id) > 0;
    stored.rows[id] = std::move(row);
  }
  return stored;
}

RowsById resume_rows(const fs::path& directory, const std::vector<std::string>& ids, std::vector<std::string>& notes) {
  for (const auto& entry : fs::directory_iterator(directory))  // what a killed process was about to put in place
    if (entry.path().extension() == ".part") fs::remove(entry.path());
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
    if (is_row(entry) && entry.contains("round") && entry["round"].is_number_integer() && entry.contains("seconds"))
      timings[entry["id"].get<std::string>()][entry["round"].get<int>()] = entry["seconds"];
  }
  return timings;
}

void append_timing(const fs::path& directory, const std::string& id, int round, const json& seconds) {
  append_line(timings_of(directory), json{{"id", id}, {"round", round}, {"seconds", seconds}}.dump());
}

json read_description(const fs::path& directory) {
  const auto path = directory / "study.json";
  if (!fs::exists(path))
    throw std::runtime_error(directory.string() + ": there is no study.json; not a study's directory");
  json description = json::parse(read_file(path), nullptr, false);
  if (!description.is_object()) throw std::runtime_error(path.string() + ": is not a JSON object");
  return description;
}

bool converged(const json& row) { return row.value("status", "").starts_with("converged"); }

}  // namespace stickslip
