// tessera doctor
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "client/commands/commands.h"
#include "client/commands/connection.h"
#include "client/doctor/coordinator_checks.h"
#include "client/doctor/file_checks.h"
#include "client/doctor/login_checks.h"
#include "client/doctor/machine_checks.h"
#include "proto/shell/program.h"

namespace tessera {
namespace {

struct DoctorOptions {
  std::string data_dir;
  std::string state_dir;  // of a worker
  FarmChoice farm;
  bool json = false;
};

void AddDoctorFlags(CLI::App& app, DoctorOptions& options) {
  AddText(app, "--data-dir", "DIR",
          WithDefault("Examine this data directory of a coordinator",
                      "those of the running coordinators of this user"),
          options.data_dir);
  AddText(app, "--state-dir", "DIR",
          WithDefault("Examine the worker with this --state-dir", "that of a worker of this user"),
          options.state_dir);
  AddText(app, "--coordinator", "ADDR", "Also examine the way to this coordinator: HOST:PORT or unix:PATH",
          options.farm.coordinator);
  AddTlsFlags(app, options.farm.tls);
  AddJsonFlag(app, options.json);
}

Findings CheckNamedCoordinator(const DoctorOptions& options, std::stop_token stop) {
  const std::string where = fmt::format("coordinator {}", options.farm.coordinator);
  const auto endpoint = ChooseFarm(options.farm);
  if (!endpoint)
    return {{Severity::kProblem, where, endpoint.error().message, "ask an operator of the farm for a token"}};
  return CheckCoordinatorAt(where, *endpoint, std::move(stop));
}

Findings Examine(const DoctorOptions& options, std::stop_token stop) {
  Findings findings = CheckMachine();
  const size_t of_machine = findings.size();
  Append(findings, CheckLogins(LoginStore(PersonalLoginFolder(Environment)), "login", stop));
  const std::string state = options.state_dir.empty() ? WorkerLoginFolder(Environment) : options.state_dir;
  Append(findings, CheckLogins(LoginStore(state), "worker of", stop));
  bool is_examined = false;
  for (const RunningCoordinator& each : FindCoordinators()) {
    Findings of_process = CheckListening(each, stop);
    if (!each.data_dir.empty()) Append(of_process, CheckDataDirectory(each.data_dir));
    if (!IsRunning(each)) continue;  // what was found has passed
    Append(findings, std::move(of_process));
    is_examined = is_examined || each.data_dir == options.data_dir;
  }
  if (!options.data_dir.empty() && !is_examined) Append(findings, CheckDataDirectory(options.data_dir));
  if (!options.farm.coordinator.empty()) Append(findings, CheckNamedCoordinator(options, stop));
  if (findings.size() == of_machine) {
    findings.push_back({Severity::kGood, "farms",
                        "no login, worker or running coordinator of this user was found here",
                        "ask an operator for a token, or name --coordinator, --state-dir or --data-dir"});
  }
  return findings;
}

const char* NameOf(Severity severity) {
  switch (severity) {
    case Severity::kGood: return "ok";
    case Severity::kWarning: return "warning";
    case Severity::kProblem: return "problem";
  }
  return "";
}

size_t Count(const Findings& findings, Severity severity) {
  return static_cast<size_t>(std::ranges::count(findings, severity, &Finding::severity));
}

// Each place is named once, above what was found there.
std::string FindingsText(const Findings& findings) {
  std::string text, where;
  for (const Finding& each : findings) {
    if (each.where != where) text += each.where + "\n";
    where = each.where;
    text += fmt::format("  {:<8} {}\n", NameOf(each.severity), each.what);
    if (!each.remedy.empty()) text += fmt::format("  {:<8} -> {}\n", "", each.remedy);
  }
  return text + Counted(Count(findings, Severity::kProblem), "problem") + ", " +
         Counted(Count(findings, Severity::kWarning), "warning") + "\n";
}

std::string FindingsJson(const Findings& findings) {
  nlohmann::ordered_json json;
  json["problems"] = Count(findings, Severity::kProblem);
  json["warnings"] = Count(findings, Severity::kWarning);
  json["findings"] = nlohmann::ordered_json::array();
  for (const Finding& each : findings) {
    nlohmann::ordered_json entry;
    entry["severity"] = NameOf(each.severity);
    entry["where"] = each.where;
    entry["what"] = each.what;
    entry["remedy"] = each.remedy;
    json["findings"].push_back(std::move(entry));
  }
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

Result<int> RunDoctor(const DoctorOptions& options, Cancellation& cancellation) {
  const Findings findings = Examine(options, cancellation.token());
  if (cancellation.cancelled()) return cancellation.error();
  fmt::print("{}", options.json ? FindingsJson(findings) : FindingsText(findings));
  return Count(findings, Severity::kProblem) > 0 ? 1 : 0;
}

}  // namespace

Command DoctorCommand() {
  return MakeCommand<DoctorOptions>({
      .name = "doctor",
      .summary = "Examine this machine, its keys and its way to the farm, and explain what to do",
      .examples = {{"Examine this machine", "tessera doctor"},
                   {"Examine the way to a coordinator", "tessera doctor --coordinator farm.example:7700"}},
      .add_flags = AddDoctorFlags,
      .run = RunDoctor,
  });
}

}  // namespace tessera
