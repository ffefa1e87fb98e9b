#include "tests/chaos/chaos_farms.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <signal.h>

#include <chrono>
#include <filesystem>
#include <stdexcept>
#include <thread>
#include <utility>

#include "tests/build_paths.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::seconds kEndPatience{15};  // 10 s are promised; the machine may be loaded
// In which a worker that was stopped logs what was acknowledged to it before.
constexpr std::chrono::milliseconds kLogPatience{500};

// Runs a program with this hard limit of descriptors.
std::vector<std::string> Limited(int descriptors, const std::vector<std::string>& prefix,
                                 const std::string& program, const std::vector<std::string>& arguments) {
  std::vector<std::string> words{"-c", fmt::format("ulimit -n {}; exec \"$0\" \"$@\"", descriptors)};
  words.insert(words.end(), prefix.begin(), prefix.end());
  words.push_back(BinaryDir() + "/bin/" + program);
  words.insert(words.end(), arguments.begin(), arguments.end());
  return words;
}

// The time as it is written in logs.
std::string LogTime() {
  const auto now = std::chrono::system_clock::now();
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(now.time_since_epoch()).count();
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}", fmt::localtime(std::chrono::system_clock::to_time_t(now)),
                     ms % 1000);
}

// Continues a process that is stopped. Returns whether it was.
template <typename Member>
bool Continue(Member& member) {
  member.back_at.reset();
  if (!std::exchange(member.is_stopped, false)) return false;
  member.process->Signal(SIGCONT);
  return true;
}

}  // namespace

ChaosFarms::ChaosFarms(std::string folder, std::string disk, int workers, std::vector<std::string> prefix,
                       FarmHistory& history)
    : folder_(std::move(folder)),
      disk_(std::move(disk)),
      prefix_(std::move(prefix)),
      history_(history),
      addresses_{"127.0.0.1:0", "unix:" + folder_ + "/socket"},
      workers_(static_cast<size_t>(workers)) {
  for (int farm = 0; farm < kFarms; ++farm) {
    At(farm).address = static_cast<size_t>(farm);
    StartCoordinator(farm);
  }
  for (size_t i = 0; i < workers_.size(); ++i) StartWorker(i);
  LearnIds();
}

std::string ChaosFarms::DataDir(int farm) const {
  return fmt::format("{}/farm-{}", disk_, farm);
}
std::string ChaosFarms::BackupDir(int farm) const {
  return fmt::format("{}/backup-{}", folder_, farm);
}

void ChaosFarms::StartCoordinator(int farm) {
  std::string& address = addresses_.at(At(farm).address);
  std::optional<Process>& process = At(farm).coordinator.process;
  process.emplace(folder_, "/bin/bash",
                  Limited(kCoordinatorDescriptors, prefix_, "tessera-coordinator",
                          {"--listen", address, "--data-dir", DataDir(farm)}));
  const std::string phrase = "listening on ";
  if (!process->AwaitErrors(phrase))
    throw std::runtime_error("the coordinator does not listen: " + process->Errors());
  const std::string log = process->Errors();
  const size_t begin = log.find(phrase) + phrase.size();
  address = log.substr(begin, log.find('\n', begin) - begin);
  history_.SetAddress(farm, address);
}

void ChaosFarms::StartWorker(size_t i) {
  const std::string name = fmt::format("w{}", i);
  workers_[i].process.emplace(
      folder_, "/bin/bash",
      Limited(kWorkerDescriptors, {}, "tessera-worker",
              {"--coordinator", addresses_.at(i % kFarms), "--threads", "1", "--cache-dir",
               folder_ + "/cache-" + name, "--name", name, "--log-level", "debug"}));
}

// The first worker of each farm logs which one it met.
void ChaosFarms::LearnIds() {
  const std::string phrase = " farm=";
  for (int farm = 0; farm < kFarms; ++farm) {
    Process& worker = *workers_.at(static_cast<size_t>(farm)).process;
    if (!worker.AwaitErrors(phrase))
      throw std::runtime_error("a worker does not connect: " + worker.Errors());
    const std::string log = worker.Errors();
    const size_t begin = log.find(phrase) + phrase.size();
    At(farm).id = log.substr(begin, log.find_first_of(" \n", begin) - begin);
  }
}

// Waits for a process that was killed or has ended.
void ChaosFarms::Reap(Member& member, const std::string& name, std::vector<std::string>& logs) {
  const auto code = member.process->Wait(kEndPatience);
  // A process that has not reached its main function yet does not catch signals.
  const bool is_newborn = member.is_draining && code == -SIGTERM && member.process->Errors().empty();
  if (!code) {
    failures_.push_back(name + " does not end: " + member.process->Errors());
  } else if (*code != -SIGKILL && !(member.is_draining && *code == 0) && !is_newborn) {
    failures_.push_back(fmt::format("{} ended with {}: {}", name, *code, member.process->Errors()));
  }
  logs.push_back(member.process->Errors());
  member.process.reset();
  member.is_stopped = member.is_draining = false;
}

void ChaosFarms::ReapCoordinator(int farm) {
  Reap(At(farm).coordinator, fmt::format("coordinator {}", farm), coordinator_logs_);
}
void ChaosFarms::ReapWorker(size_t i) {
  Reap(workers_[i], fmt::format("worker {}", i), worker_logs_);
}

void ChaosFarms::KillWorker(int i, Clock::duration away) {
  Member& member = workers_[static_cast<size_t>(i)];
  member.process->Signal(SIGKILL);
  ReapWorker(static_cast<size_t>(i));
  member.back_at = Clock::now() + away;
}

void ChaosFarms::StopWorker(int i, Clock::duration pause) {
  Member& member = workers_[static_cast<size_t>(i)];
  member.process->Signal(SIGSTOP);
  member.is_stopped = true;
  member.back_at = Clock::now() + pause;
}

void ChaosFarms::DrainWorker(int i, Clock::duration away) {
  Member& member = workers_[static_cast<size_t>(i)];
  member.process->Signal(SIGTERM);
  member.is_draining = true;
  member.back_at = Clock::now() + away;
}

void ChaosFarms::KillCoordinator(int farm, Clock::duration away) {
  Member& member = At(farm).coordinator;
  ++At(farm).faults;
  member.process->Signal(SIGKILL);
  ReapCoordinator(farm);
  member.back_at = Clock::now() + away;
}

void ChaosFarms::StopCoordinator(int farm, Clock::duration pause) {
  Member& member = At(farm).coordinator;
  ++At(farm).faults;
  member.process->Signal(SIGSTOP);
  member.is_stopped = true;
  member.back_at = Clock::now() + pause;
}

void ChaosFarms::ExchangeAddresses() {
  history_.BeginChange();
  for (int farm = 0; farm < kFarms; ++farm) KillCoordinator(farm, {});
  std::swap(At(0).address, At(1).address);
  for (int farm = 0; farm < kFarms; ++farm) ReturnCoordinator(farm);
  history_.EndChange();
}

void ChaosFarms::BackUp(int farm) {
  KillCoordinator(farm, {});
  fs::remove_all(BackupDir(farm));
  fs::copy(DataDir(farm), BackupDir(farm), fs::copy_options::recursive);
  history_.NoteBackup(farm);
  ReturnCoordinator(farm);
}

bool ChaosFarms::Restore(int farm) {
  if (!fs::exists(BackupDir(farm))) return false;
  for (size_t i = 0; i < workers_.size(); ++i) {
    if (workers_[i].is_stopped) ReturnWorker(i);
  }
  std::this_thread::sleep_for(kLogPatience);
  history_.BeginChange();
  KillCoordinator(farm, {});
  std::this_thread::sleep_for(kLogPatience);
  restores_.push_back({At(farm).id, LogTime()});
  fs::remove_all(DataDir(farm));
  fs::copy(BackupDir(farm), DataDir(farm), fs::copy_options::recursive);
  history_.NoteRestored(farm);
  ReturnCoordinator(farm);
  history_.EndChange();
  return true;
}

void ChaosFarms::ReturnCoordinator(int farm) {
  Member& member = At(farm).coordinator;
  ++At(farm).faults;
  if (Continue(member)) return;
  if (member.process) ReapCoordinator(farm);
  StartCoordinator(farm);
}

void ChaosFarms::ReturnWorker(size_t i) {
  if (Continue(workers_[i])) return;
  if (workers_[i].process) ReapWorker(i);
  StartWorker(i);
}

void ChaosFarms::Tick() {
  const auto is_due = [](const Member& member) { return member.back_at && Clock::now() >= *member.back_at; };
  const auto has_ended = [](const Member& member) {
    return member.process && !IsAlive(member.process->pid());
  };
  for (int farm = 0; farm < kFarms; ++farm) {
    const Member& member = At(farm).coordinator;
    if (is_due(member) || has_ended(member)) ReturnCoordinator(farm);
  }
  for (size_t i = 0; i < workers_.size(); ++i) {
    if (is_due(workers_[i]) || (has_ended(workers_[i]) && !workers_[i].back_at)) ReturnWorker(i);
  }
}

void ChaosFarms::Heal() {
  for (int farm = 0; farm < kFarms; ++farm) {
    if (IsCoordinatorHurt(farm)) ReturnCoordinator(farm);
  }
  for (size_t i = 0; i < workers_.size(); ++i) {
    if (workers_[i].back_at) ReturnWorker(i);
  }
}

void ChaosFarms::End() {
  const auto terminate = [](Member& member) {
    member.process->Signal(SIGTERM);
    member.is_draining = true;
  };
  for (Member& member : workers_) terminate(member);
  for (size_t i = 0; i < workers_.size(); ++i) ReapWorker(i);
  for (Farm& farm : farms_) terminate(farm.coordinator);
  for (int farm = 0; farm < kFarms; ++farm) ReapCoordinator(farm);
}

std::vector<std::string> ChaosFarms::WorkerLogs() const {
  std::vector<std::string> logs = worker_logs_;
  for (const Member& member : workers_) {
    if (member.process) logs.push_back(member.process->Errors());
  }
  return logs;
}

std::vector<std::string> ChaosFarms::CoordinatorLogs() const {
  std::vector<std::string> logs = coordinator_logs_;
  for (const Farm& farm : farms_) {
    if (farm.coordinator.process) logs.push_back(farm.coordinator.process->Errors());
  }
  return logs;
}

}  // namespace tessera
