/// Responses that equilibrium does not determine, because they hang on forces that it leaves open
/// (sensitivity/force_search.hpp). They have no derivative.
#pragma once

#include <utility>
#include <vector>

#include "methods/method.hpp"
#include "sensitivity/force_search.hpp"

namespace stickslip {

class OpenResponses {
 public:
  /// `model` and `slots` must outlive it.
  OpenResponses(const Model& model, const Slots<double>& slots, const Method& method);

  /// Whether a state of the model can have any. Otherwise no state is searched.
  bool is_called_for() const { return forces_.is_called_for(); }
  /// As ForceSearch::undetermined() takes it: of the tangential springs of the method; empty for methods without them,
  /// and without friction.
  const std::vector<double>& compliance() const { return compliance_; }

  struct Found {
    std::vector<char> contacts;   ///< per contact, whether its forces are undetermined; empty if none are
    std::vector<char> responses;  ///< per response, whether it hangs on such forces; empty if there are none
  };
  /// Of a state at a time; `values`: its responses. pre: is_called_for()
  Found of(const State<double>& state, double time, const Vector<double>& values) const;

 private:
  std::vector<char> that_hang_on(const State<double>& state, double time, const Matrix<double>& changes,
                                 const Vector<double>& values) const;

  const Model& model_;
  const Slots<double>& slots_;
  ForceSearch forces_;
  std::vector<double> compliance_;
};

/// Per objective, whether it is made of a response that is undetermined. `steps`: time and Found::responses of each.
std::vector<char> open_objectives(const Model& model, const Slots<double>& slots,
                                  const std::vector<std::pair<double, std::vector<char>>>& steps);

}  // namespace stickslip
