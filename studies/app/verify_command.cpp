/// The verify command: reads a result, or the solution of another program, and prints its certificate (docs/verify.md).
#include <fmt/format.h>

#include <iostream>
#include <map>
#include <nlohmann/json.hpp>

#include "studies/app/commands.hpp"
#include "studies/app/exit_codes.hpp"
#include "studies/app/recorded.hpp"
#include "studies/app/say.hpp"
#include "studies/io/json_document.hpp"
#include "studies/io/printing.hpp"
#include "studies/run/certificate.hpp"

namespace stickslip {
namespace {

void print(const verify::Certificate& certificate) {
  say(std::cout, "{:>10}  {:<13}  {:<20} {:>9} {:>9}\n", "time", "", "nearest to its bound", "error", "allowed");
  for (const auto& step : certificate.steps) {
    const auto& worst = step.worst();
    say(std::cout, "{:>10.6g}  {:<13}  {:<20} {:>9.1e} {:>9.1e}\n", step.time, step.holds() ? "holds" : "does not hold",
        worst.law, worst.value, worst.allowed);
  }
  for (const auto& remark : certificate.remarks) say(std::cout, "{}\n", printable(remark));
}

/// Each law that is broken, where it is broken most.
void print_faults(const verify::Certificate& certificate) {
  std::map<std::string, std::pair<double, const verify::Finding*>> broken;
  for (const auto& step : certificate.steps)
    for (const auto& finding : step.findings)
      if (!finding.holds() && (!broken.contains(finding.law) || finding.value > broken[finding.law].second->value))
        broken[finding.law] = {step.time, &finding};
  for (const auto& [law, fault] : broken)
    say(std::cerr, "{} at t = {:.9g}: {}: {:.3e}, allowed are {:.1e} ({})\n", law, fault.first,
        printable(fault.second->where), fault.second->value, fault.second->allowed, fault.second->why);
}

}  // namespace

int verify_command(const VerifyArguments& arguments) {
  check_recorded(arguments.directory);
  const auto certificate = certificate_of(arguments.directory, arguments.solution);
  if (arguments.json)
    std::cout << json_text(certificate_json(certificate), 2) << '\n';
  else
    print(certificate);
  print_faults(certificate);
  return certificate.holds() ? done : not_solved;
}

}  // namespace stickslip
