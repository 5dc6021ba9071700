/// Where a result comes from: all that seconds, and in the last digits the numbers too, depend on besides the scene.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace stickslip {

/// The `provenance` of a result: `version`, `git`, `compiler`, `flags`, `build_type`, `cpu` (model name), `cores`,
/// `blas` (as loaded), `libraries` {name: version}, `threads` (as given: workers of the run), `date` (UTC, ISO 8601),
/// `load_average` (of the last minute, at the call; null where the system does not say).
nlohmann::json provenance(int threads);

/// What `stickslip --version` prints: version and commit, build, libraries, BLAS, and the terms under which this
/// binary may be passed on. Several lines, each ended.
std::string version_text();

}  // namespace stickslip
