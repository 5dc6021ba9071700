/// The solution of another program as a study records it: judged by its certificate, and measured by it.
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>

#include "studies/run/case.hpp"
#include "studies/run/certificate.hpp"
#include "studies/sweep/study_reader.hpp"

namespace stickslip {

struct MeasuredPeer {
  verify::Certificate certificate;
  CaseResult result;  ///< of each step its responses and tractions alone: not a number of what was not measured
};

/// `scene`: the document as it would be simulated. Throws InputFault where the solution does not fit.
MeasuredPeer measured(const PeerSolution& peer, const nlohmann::json& scene, std::shared_ptr<const Problem> problem,
                      const Method& method);

/// Its part of a row (docs/results.md): the certificate and what follows from it. The status is `converged` where that
/// holds, else `inaccurate`.
nlohmann::json row_of(const MeasuredPeer& peer);

/// The worst of each law that says how near a state is to equilibrium and to the laws of contact and friction.
nlohmann::json errors_of(const verify::Certificate& certificate);

}  // namespace stickslip
