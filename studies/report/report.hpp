/// The report of a study or of a run: one HTML file that needs no network, from recorded results alone.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace stickslip {

/// Whether figures are also written as PDF, which rsvg-convert (of librsvg) makes.
enum class Pdfs { left_out, added };

/// Throws InputFault, which says how to install it, if rsvg-convert is not there.
void check_pdf_writer();

/// What the names of the files of a report are.
std::vector<std::string> report_files();

/// Reads study.json, results.jsonl and picture.json of `directory` (all but results.jsonl may be missing) and writes
/// directory/report.html and its figures, each whole or not at all (write_output).
/// Throws std::runtime_error, with the path, where results.jsonl cannot be read or study.json or picture.json is no
/// JSON, and its kind std::system_error where the file cannot be written.
///
/// Conventions it relies on: interface tractions `normal` are negative in compression and pressure is drawn positive,
/// for the analytic curves too; an analytic curve's `s` is the contact's `arc`, its `x` (used where present) the
/// contact's `x`; contact points of picture.json stand at their deformed place.
void write_report(const std::filesystem::path& directory, Pdfs pdfs = Pdfs::left_out);

/// The same of the run in `directory`, from result.json and, where it is there, picture.json.
void write_run_report(const std::filesystem::path& directory, Pdfs pdfs = Pdfs::left_out);

}  // namespace stickslip
