#include "tests/chaos/chaos_farm.h"

#include <signal.h>

#include <stdexcept>
#include <utility>

namespace tessera {
namespace {

constexpr std::chrono::seconds kEndPatience{15};  // 10 s are promised; the machine may be loaded

}  // namespace

ChaosFarm::ChaosFarm(std::string folder, std::string data_dir, int workers)
    : folder_(std::move(folder)), data_dir_(std::move(data_dir)), workers_(static_cast<size_t>(workers)) {
  StartCoordinator();
  for (size_t i = 0; i < workers_.size(); ++i) StartWorker(i);
}

void ChaosFarm::StartCoordinator() {
  coordinator_.process.emplace(folder_, "tessera-coordinator",
                               std::vector<std::string>{"--listen", address_, "--data-dir", data_dir_});
  const std::string phrase = "listening on ";
  if (!coordinator_.process->AwaitErrors(phrase)) {
    throw std::runtime_error("the coordinator does not listen: " + coordinator_.process->Errors());
  }
  const std::string log = coordinator_.process->Errors();
  const size_t begin = log.find(phrase) + phrase.size();
  address_ = log.substr(begin, log.find('\n', begin) - begin);
}

void ChaosFarm::StartWorker(size_t i) {
  const std::string name = "w" + std::to_string(i);
  workers_[i].process.emplace(
      folder_, "tessera-worker",
      std::vector<std::string>{"--coordinator", address_, "--threads", "1", "--cache-dir",
                               folder_ + "/cache-" + name, "--name", name, "--log-level", "debug"});
}

// Waits for a process that was killed or has ended.
void ChaosFarm::Reap(Member& member, const std::string& name) {
  const auto code = member.process->Wait(kEndPatience);
  // A process that has not reached its main function yet does not catch signals.
  const bool is_newborn = member.is_draining && code == -SIGTERM && member.process->Errors().empty();
  if (!code) {
    failures_.push_back(name + " does not end: " + member.process->Errors());
  } else if (*code != -SIGKILL && !(member.is_draining && *code == 0) && !is_newborn) {
    failures_.push_back(name + " ended with " + std::to_string(*code) + ": " + member.process->Errors());
  }
  if (&member != &coordinator_) logs_.push_back(member.process->Errors());
  member.process.reset();
  member.is_stopped = member.is_draining = false;
}

void ChaosFarm::KillWorker(int i, Clock::duration away) {
  Member& member = workers_[static_cast<size_t>(i)];
  member.process->Signal(SIGKILL);
  Reap(member, "worker " + std::to_string(i));
  member.back_at = Clock::now() + away;
}

void ChaosFarm::StopWorker(int i, Clock::duration pause) {
  Member& member = workers_[static_cast<size_t>(i)];
  member.process->Signal(SIGSTOP);
  member.is_stopped = true;
  member.back_at = Clock::now() + pause;
}

void ChaosFarm::DrainWorker(int i, Clock::duration away) {
  Member& member = workers_[static_cast<size_t>(i)];
  member.process->Signal(SIGTERM);
  member.is_draining = true;
  member.back_at = Clock::now() + away;
}

void ChaosFarm::KillCoordinator(Clock::duration away) {
  coordinator_.process->Signal(SIGKILL);
  Reap(coordinator_, "the coordinator");
  coordinator_.back_at = Clock::now() + away;
}

void ChaosFarm::StopCoordinator(Clock::duration pause) {
  coordinator_.process->Signal(SIGSTOP);
  coordinator_.is_stopped = true;
  coordinator_.back_at = Clock::now() + pause;
}

void ChaosFarm::Return(Member& member, size_t i) {
  const bool is_coordinator = &member == &coordinator_;
  member.back_at.reset();
  if (member.is_stopped) {
    member.process->Signal(SIGCONT);
    member.is_stopped = false;
    return;
  }
  if (member.process) Reap(member, is_coordinator ? "the coordinator" : "worker " + std::to_string(i));
  if (is_coordinator) {
    StartCoordinator();
  } else {
    StartWorker(i);
  }
}

void ChaosFarm::Tick() {
  const auto is_due = [](const Member& member) { return member.back_at && Clock::now() >= *member.back_at; };
  const auto has_ended = [](const Member& member) {
    return member.process && !IsAlive(member.process->pid());
  };
  if (is_due(coordinator_) || has_ended(coordinator_)) Return(coordinator_, 0);
  for (size_t i = 0; i < workers_.size(); ++i) {
    if (is_due(workers_[i]) || (has_ended(workers_[i]) && !workers_[i].back_at)) Return(workers_[i], i);
  }
}

void ChaosFarm::Heal() {
  if (coordinator_.back_at) Return(coordinator_, 0);
  for (size_t i = 0; i < workers_.size(); ++i) {
    if (workers_[i].back_at) Return(workers_[i], i);
  }
}

void ChaosFarm::End() {
  for (Member& member : workers_) {
    member.process->Signal(SIGTERM);
    member.is_draining = true;
  }
  for (size_t i = 0; i < workers_.size(); ++i) Reap(workers_[i], "worker " + std::to_string(i));
  coordinator_.process->Signal(SIGTERM);
  coordinator_.is_draining = true;
  Reap(coordinator_, "the coordinator");
}

std::vector<std::string> ChaosFarm::WorkerLogs() const {
  std::vector<std::string> logs = logs_;
  for (const Member& member : workers_) {
    if (member.process) logs.push_back(member.process->Errors());
  }
  return logs;
}

}  // namespace tessera
