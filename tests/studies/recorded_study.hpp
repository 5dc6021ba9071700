/// A small recorded study on the disk, for tests of its report.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "studies/report/records.hpp"
#include "tests/studies/temporary_folder.hpp"

namespace stickslip::recorded {

using nlohmann::json;

/// A record with errors of one response and one sensitivity, `factorizations` as its cost.
json cell(const std::string& family, const json& knobs, double error, int factorizations);

/// Penalty at four stiffnesses with error 1/stiffness, Uzawa, and a monolithic run that is its own reference.
std::vector<json> three_methods();

/// These; penalty at 1e3 as the default, and failed at 1e7.
std::vector<json> with_failure();

/// The same runs again in a second scene.
std::vector<json> in_two_scenes(std::vector<json> cells);

json description();

/// A plane mesh of two squares with one contact point of each state.
json picture();

/// A directory of its own for each test.
class StudyOnDisk : public InOwnFolder {
 protected:
  void record(const json& study, const std::vector<json>& cells, const json& picture = nullptr);
  std::string page();
  report::Study study();

  const std::filesystem::path& directory_ = folder_;
};

}  // namespace stickslip::recorded
