/// The certificate of a result in a folder, or of another program's solution of the same scene (docs/verify.md).
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "studies/io/input_fault.hpp"
#include "studies/verify/verify.hpp"

namespace stickslip {

/// A value in the file of a solution that is not as it should be; what() begins with its pointer.
struct SolutionFault : InputFault {
  std::string pointer;
  SolutionFault(const std::string& at, const std::string& message)
      : InputFault((at.empty() ? "" : at + ": ") + message), pointer(at) {}
};

/// "FILE:LINE:COL: POINTER: what is wrong".
std::string in_file(const std::filesystem::path& file, const SolutionFault& fault);

/// `solution`: file of another program's solution; empty: the run's own. Throws InputFault where a file is missing, was
/// left out, or is not as it should be.
verify::Certificate certificate_of(const std::filesystem::path& directory, const std::string& solution = "");

/// A file of a solution (docs/verify.md), of this program or another. Throws InputFault where it is none.
nlohmann::json read_solution(const std::filesystem::path& file);

/// The certificate of another program's solution; `own`: {"scene", "mesh"} of solution.json. Throws InputFault where
/// the solution does not fit these; the message begins with what does not.
verify::Certificate certificate_of_peer(const nlohmann::json& own, nlohmann::json solution);

/// {"holds", "remarks", "steps": [{"time", "holds", "laws": {law: {"value", "allowed", "where", "why", "holds"}}}]}.
nlohmann::json certificate_json(const verify::Certificate& certificate);

/// {"holds", "law", "time", "value", "allowed", "where"}: the law that is nearest to its bound, or broken most.
nlohmann::json worst_of_certificate_json(const verify::Certificate& certificate);

}  // namespace stickslip
