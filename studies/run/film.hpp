/// The active set over time: which contact points are open, stick or slip at each step.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "studies/run/case.hpp"

namespace stickslip {

/// {"times": [...], "contacts": {NAME: ["ooks", ...]}}: per contact one text a step, per point (in the order of
/// interface_json()) one letter: o open, k sticks, s slips, c touches without friction. Of long runs some 48 steps,
/// evenly spaced, with the last.
nlohmann::json film_json(const CaseResult& result);

}  // namespace stickslip
