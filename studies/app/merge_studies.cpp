/// The merge command: the shards of a study, joined.
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <set>

#include "studies/app/commands.hpp"
#include "studies/app/exit_codes.hpp"
#include "studies/app/recorded.hpp"
#include "studies/app/say.hpp"
#include "studies/io/atomic_file.hpp"
#include "studies/io/input_fault.hpp"
#include "studies/io/output_folder.hpp"
#include "studies/io/printing.hpp"
#include "studies/io/result_rows.hpp"
#include "studies/report/report.hpp"
#include "studies/run/fields.hpp"
#include "studies/sweep/run_study.hpp"

namespace stickslip {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

/// A directory to join: its study.json and rows.
struct Part {
  fs::path directory;
  json description;
  StoredRows stored;
  Timings timings;
};

Part read_part(const fs::path& directory) {
  Part part{directory, read_description(directory), read_rows(directory), read_timings(directory)};
  for (const char* key : {"program", "cells"})
    if (!part.description.contains(key))
      throw InputFault((directory / "study.json").string() + ": has no \"" + key +
                       "\"; was it recorded by another version?");
  drop_unsealed(part.stored);
  return part;
}

/// Whether the share that writes there never began: there is no study.json, nor any row.
bool never_began(const fs::path& directory) {
  return !holds(directory, "study.json") && !holds(directory, "results.jsonl");
}

/// The study alone, without what differs from shard to shard.
json identity(json description) {
  for (const char* own : {"command", "shard", "size", "analytic"}) description.erase(own);
  return description;
}

/// Why the two are not shards of one study; "" where they are.
std::string difference(const Part& a, const Part& b) {
  const json first = identity(a.description), second = identity(b.description);
  if (first == second) return {};
  const auto& program = first["program"];
  if (program != second["program"])
    return fmt::format("{} was run by stickslip {}, {} by {}: run all shards with one version", a.directory.string(),
                       json_text(program), b.directory.string(), json_text(second["program"]));
  for (const auto& [key, value] : first.items())
    if (!second.contains(key) || second[key] != value)
      return fmt::format("{} and {} are of different studies: their \"{}\" differ", a.directory.string(),
                         b.directory.string(), key);
  return fmt::format("{} and {} are of different studies", a.directory.string(), b.directory.string());
}

/// Throws InputFault where the output holds what would be lost: a run, another study, or rows and timed runs of this
/// one that none of the parts has.
void check_output(const std::vector<Part>& parts, const fs::path& output) {
  const std::string name = output.string(), elsewhere = "; -o DIR writes to another directory";
  if (holds(output, "result.json")) throw InputFault(name + ": holds the result of a run" + elsewhere);
  const bool described = holds(output, "study.json");
  if (described && identity(read_description(output)) != identity(parts.front().description))
    throw InputFault(name + ": holds another study" + elsewhere);
  const auto in_parts = [&](const auto& has) { return std::any_of(parts.begin(), parts.end(), has); };
  const auto rows = read_rows(output).rows;
  if (!described && !rows.empty()) throw InputFault(name + ": holds rows, of another study as it seems" + elsewhere);
  const auto alone = std::count_if(rows.begin(), rows.end(), [&](const auto& row) {
    return !in_parts([&](const Part& part) { return part.stored.rows.count(row.first) > 0; });
  });
  const std::string as_well = "; name it among the directories too, or -o another";
  if (alone > 0)
    throw InputFault(
        fmt::format("{}: holds {} row(s) of this study that are in none of the directories{}", name, alone, as_well));
  for (const auto& [id, rounds] : read_timings(output))
    if (!in_parts([&, &id = id, &rounds = rounds](const Part& part) {
          const auto timed = part.timings.find(id);
          return timed != part.timings.end() && timed->second.size() >= rounds.size();
        }))
      throw InputFault(name + ": holds timed runs that are in none of the directories" + as_well);
}

/// Copies what one shard drew: the picture and the fields of the last variant.
void copy_drawings(const std::vector<Part>& parts, const fs::path& output) {
  const auto drawn = std::find_if(parts.begin(), parts.end(),
                                  [](const Part& part) { return fs::exists(part.directory / "picture.json"); });
  if (drawn == parts.end() || fs::equivalent(drawn->directory, output)) return;
  remove_outputs(output, {std::begin(field_names), std::end(field_names)});
  for (const auto& entry : fs::directory_iterator(drawn->directory)) {
    const std::string name = entry.path().filename();
    if ((name == "picture.json" || name.starts_with("fields")) && entry.is_regular_file())
      write_output(output / name, read_file(entry.path()));
  }
}

/// "label" of a missing cell is not recorded anywhere: it follows from its place in the study's order.
std::string places(const std::vector<std::size_t>& missing) {
  constexpr std::size_t most = 12;
  std::string text;
  for (std::size_t i = 0; i < std::min(missing.size(), most); ++i)
    text += (i ? ", " : "") + std::to_string(missing[i] + 1);
  return missing.size() > most ? text + ", ..." : text;
}

json merged_description(const std::vector<Part>& parts, const std::string& output) {
  json out = parts.front().description;
  out["shard"] = "1/1";
  out["command"] = "stickslip merge";
  for (const auto& part : parts) {
    out["command"] = out["command"].get<std::string>() + " " + shell_word(part.directory.string());
    for (const char* drawn : {"size", "analytic"})
      if (out.value(drawn, json()).is_null() && part.description.contains(drawn)) out[drawn] = part.description[drawn];
  }
  out["command"] = out["command"].get<std::string>() + " -o " + shell_word(output);
  return out;
}

int join(const std::vector<Part>& parts, const fs::path& output) {
  check_output(parts, output);
  const OutputFolder folder(output, study_files());
  const std::vector<std::string> ids = parts.front().description["cells"];
  const std::set<std::string> known(ids.begin(), ids.end());
  RowsById rows;
  int doubles = 0, failed = 0;
  for (const auto& part : parts)
    for (const auto& [id, row] : part.stored.rows) {
      if (known.count(id) == 0) continue;
      const auto [place, is_new] = rows.emplace(id, row);
      doubles += !is_new;
      failed += is_new && !converged(row);
      if (!is_new && row["cost"].contains("timing")) place->second = row;  // the one that was timed
    }
  std::vector<std::size_t> missing;
  for (std::size_t i = 0; i < ids.size(); ++i)
    if (rows.count(ids[i]) == 0) missing.push_back(i);
  remove_outputs(output, {"timings.jsonl"});
  for (const auto& part : parts)
    for (const auto& [id, rounds] : part.timings)
      for (const auto& [round, seconds] : rounds) append_timing(output, id, round, seconds);
  copy_drawings(parts, output);
  write_output(output / "study.json", json_text(merged_description(parts, output.string()), 2) + "\n");
  write_rows(output, ids, rows);
  const std::size_t joined = rows.size();
  const auto broken = refuted(ids, rows);
  rows.clear();  // the report reads them again, and not all of each
  write_report(output);
  say(std::cout,
      "{} of {} cells from {} directories, {} of these without a converged result (kept as rows), {} double\n", joined,
      ids.size(), parts.size(), failed, doubles);
  say(std::cout, "report: {}\n", printable((output / "report.html").string()));
  for (const auto& line : broken) say(std::cerr, "{}\n", printable(line));
  if (!missing.empty())
    say(std::cerr, "{} cells are still missing, in the study's order: {}\n", missing.size(), places(missing));
  return missing.empty() && broken.empty() ? done : not_solved;
}

}  // namespace

int merge_command(const std::vector<std::string>& directories, const std::string& output) {
  std::vector<Part> parts;
  std::string faults, absent;
  for (const auto& directory : directories) {
    if (never_began(directory)) {
      absent += directory + ": there is no study.json; its share was never begun, or the name is wrong\n";
      continue;
    }
    parts.push_back(read_part(directory));
    tell_faults(parts.back().stored, directory);
    if (const std::string fault = difference(parts.front(), parts.back()); !fault.empty()) faults += fault + "\n";
  }
  std::cerr << printable_lines(absent + faults);
  if (parts.empty() || !faults.empty()) return bad_input;
  const int code = join(parts, output);
  return absent.empty() ? code : not_solved;
}

}  // namespace stickslip
