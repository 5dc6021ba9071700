/// Certificates: whether displacements and tractions are a solution of a scene, judged from files alone by code that
/// shares nothing with the solver (docs/verify.md). A solution of another program gets the same certificate.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace stickslip::verify {

using Json = nlohmann::json;
using Vec2 = Eigen::Vector2d;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// A file that cannot be read, or does not fit the scene.
struct BadFile : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The worst violation of a law at one time, over what it is measured by.
struct Finding {
  std::string law, where;  ///< where: in words of the scene
  double value = 0, allowed = 0;
  std::string why;  ///< why so much is allowed
  bool holds() const { return value <= allowed; }
  double share() const { return allowed > 0 ? value / allowed : value > 0 ? infinity : 0; }  ///< of what is allowed
};

struct Step {
  double time = 0;
  std::vector<Finding> findings;
  std::map<std::string, double> responses = {};  ///< of the scene, measured of the solution; without what is not
  /// By contact and slave node: the pressure, and friction along the normal turned by a quarter.
  std::map<std::string, std::map<int, Vec2>> tractions = {};
  const Finding& worst() const;  ///< of the law that is broken most, over what is allowed
  bool holds() const { return worst().holds(); }
};

struct Certificate {
  std::vector<Step> steps;
  std::vector<std::string> remarks;  ///< what could not be checked, and why
  bool holds() const;
};

/// Times at which a scene asks for a state; none of a path by arc length.
std::vector<double> asked_times(const Json& scene);

/// Checks a solution (docs/verify.md has its keys) of a scene on a mesh. `result`: result.json, whose responses are
/// measured again; null: of another program. Throws BadFile, or what nlohmann/json throws of keys that are missing.
Certificate certify(const Json& scene, const Json& mesh, const Json& solution, const Json& result);

}  // namespace stickslip::verify
