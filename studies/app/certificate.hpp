/// The certificate of a result in a folder, or of another program's solution of the same scene (docs/verify.md).
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "studies/verify/verify.hpp"

namespace stickslip {

/// `solution`: file of another program's solution; empty: the run's own. Throws InputFault where a file is missing, was
/// left out, or is not as it should be.
verify::Certificate certificate_of(const std::filesystem::path& directory, const std::string& solution = "");

/// {"holds", "remarks", "steps": [{"time", "holds", "laws": {law: {"value", "allowed", "where", "why", "holds"}}}]}.
nlohmann::json certificate_json(const verify::Certificate& certificate);

}  // namespace stickslip
