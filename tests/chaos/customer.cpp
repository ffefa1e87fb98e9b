#include "tests/chaos/customer.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <thread>

#include "renderer/util/file.h"
#include "tests/end_to_end/process.h"

namespace tessera {
namespace {

constexpr std::chrono::minutes kJobPatience{10};  // of a farm with faults
// With a full disk the farm refuses the files of a scene. A user frees space and tries again.
constexpr const char* kDiskFull = "No space left on device";
// A file of the scene was damaged before a worker had it. The next submission sends it again.
constexpr const char* kFileLost = "or found it corrupt; submit the scene again";
constexpr const char* kKillsWorkers = "kills its workers: ";
// What commands report after farms have changed, and never without a change: they were refused by another
// farm, they found its job of the same number or none, or the files that they had sent are gone.
constexpr const char* kChanges[] = {"another farm (",
                                    "restored to an earlier state",
                                    "is the number of another job now",
                                    "there is no job ",
                                    " not finished",
                                    "was cancelled",
                                    "was not uploaded"};
constexpr std::chrono::milliseconds kPause{200};
constexpr std::chrono::milliseconds kChangePoll{20};
constexpr uint64_t kPictureBytesMax = uint64_t{1} << 30;
constexpr size_t kFetchedAgainMax = 40;  // of each customer, at the end

bool Has(const std::string& text, const char* phrase) {
  return text.find(phrase) != std::string::npos;
}

}  // namespace

void Customers::Work(size_t customer) {
  for (size_t i = customer; !closed_; ++i) {
    const int farm = static_cast<int>((i / jobs_.size() + customer) % kFarms);
    if (!Do(jobs_[i % jobs_.size()], customer, farm)) return;
  }
  FetchAgain(customer);
}

bool Customers::Do(const ChaosJob& job, size_t customer, int farm) {
  while (true) {
    const auto placed = Submit(job, farm);
    if (!placed) return false;
    const Outcome outcome = Collect(*placed, customer);
    if (outcome == Outcome::kFailed) return false;
    if (outcome == Outcome::kLost) continue;
    const std::lock_guard lock(mutex_);
    finished_.at(customer).push_back(*placed);
    return true;
  }
}

// Pictures may have been damaged since they were fetched.
void Customers::FetchAgain(size_t customer) {
  std::vector<Placed> placed;
  {
    const std::lock_guard lock(mutex_);
    placed = finished_.at(customer);
  }
  if (placed.size() > kFetchedAgainMax) placed.erase(placed.begin(), placed.end() - kFetchedAgainMax);
  for (const Placed& each : placed) {
    if (gave_up_) return;
    const int before = pictures_;
    if (Collect(each, customer) == Outcome::kFailed) return;
    pictures_again_ += pictures_ - before;
  }
}

std::optional<Customers::Placed> Customers::Submit(const ChaosJob& job, int farm) {
  std::vector<std::string> words{"submit", job.scene};
  words.insert(words.end(), job.options.begin(), job.options.end());
  while (!gave_up_) {
    const uint64_t change = AwaitNoChange();
    std::string answer;
    const Answer asked = Ask(words, history_.Address(farm), change, &answer);
    const FarmHistory::Place place = history_.Now(farm);
    if (asked == Answer::kDone && place.change == change)
      return Placed{place, answer.substr(0, answer.find('\n')), &job};
    if (asked != Answer::kDone && asked != Answer::kChanged) break;
  }
  return std::nullopt;
}

Customers::Answer Customers::Watch(const Placed& placed, uint64_t* change) {
  while (true) {
    *change = AwaitNoChange();
    if (history_.IsLost(placed.place)) return Answer::kChanged;
    std::string answer;
    const Answer asked = Ask({"watch", placed.id}, history_.Address(placed.place.farm), *change, &answer);
    // After a change it may have been another farm's job that ended.
    if (asked == Answer::kFailed || (asked != Answer::kChanged && history_.change() == *change)) return asked;
  }
}

Customers::Outcome Customers::Collect(const Placed& placed, size_t customer) {
  const std::string output = fmt::format("{}/customer-{}", folder_, customer);
  const bool is_sequence = placed.job->pictures.size() > 1;
  while (true) {
    uint64_t change = 0;
    const Answer watched = Watch(placed, &change);
    if (watched == Answer::kFileLost) return Outcome::kLost;
    if (watched == Answer::kChanged) {
      ++jobs_lost_;
      return Outcome::kLost;
    }
    if (watched == Answer::kKillsWorkers)
      Report(fmt::format("job {} ({}) failed because it kills its workers", placed.id, placed.job->scene));
    if (watched != Answer::kDone) return Outcome::kFailed;
    // A farm that has been restored since may not have finished the job.
    std::string answer;
    const Answer fetched = Ask({"fetch", placed.id, "-o", output + (is_sequence ? ".#.exr" : ".exr")},
                               history_.Address(placed.place.farm), change, &answer);
    if (fetched == Answer::kFailed) return Outcome::kFailed;
    if (history_.change() == change && fetched == Answer::kDone)
      return Compare(placed, customer) ? Outcome::kDone : Outcome::kFailed;
  }
}

bool Customers::Compare(const Placed& placed, size_t customer) {
  const std::vector<std::string>& pictures = placed.job->pictures;
  bool are_equal = true;
  for (size_t i = 0; i < pictures.size(); ++i) {
    const std::string path = pictures.size() > 1
                                 ? fmt::format("{}/customer-{}.{}.exr", folder_, customer, i + 1)
                                 : fmt::format("{}/customer-{}.exr", folder_, customer);
    ++pictures_;
    const auto bytes = ReadFile(path, kPictureBytesMax);
    if (!bytes || *bytes != pictures[i]) {
      Report(fmt::format("frame {} of job {} of farm {} ({}) differs from the undisturbed picture", i,
                         placed.id, placed.place.farm, placed.job->scene));
      are_equal = false;
    }
    std::filesystem::remove(path);
  }
  return are_equal;
}

void Customers::WorkOnDeadlyJobs() {
  while (true) {
    std::unique_lock lock(mutex_);
    is_deadly_job_open_ = false;
    ordered_.wait(lock, [this] { return deadly_order_ || closed_; });
    if (!deadly_order_) return;
    const int farm = *std::exchange(deadly_order_, std::nullopt);
    is_deadly_job_open_ = true;
    lock.unlock();
    const auto placed = Submit(deadly_, farm);
    if (!placed) return;
    uint64_t change = 0;
    const Answer watched = Watch(*placed, &change);
    if (watched == Answer::kKillsWorkers) ++deadly_jobs_failed_;
    if (watched == Answer::kDone) Report("the job that kills its workers is finished");
    if (watched == Answer::kDone || watched == Answer::kFailed) return;
  }
}

bool Customers::OrderDeadlyJob(int farm) {
  const std::lock_guard lock(mutex_);
  if (is_deadly_job_open_ || deadly_order_ || closed_) return false;
  deadly_order_ = farm;
  ordered_.notify_all();
  return true;
}

bool Customers::is_deadly_job_open() const {
  const std::lock_guard lock(mutex_);
  return is_deadly_job_open_ || deadly_order_;
}

void Customers::Close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  ordered_.notify_all();
}

void Customers::GiveUp() {
  gave_up_ = true;
  Close();
}

uint64_t Customers::AwaitNoChange() const {
  uint64_t change = history_.change();
  while (change % 2 != 0 && !gave_up_) {
    std::this_thread::sleep_for(kChangePoll);
    change = history_.change();
  }
  return change;
}

std::optional<Customers::Answer> Customers::Understand(int code, const std::string& errors,
                                                       uint64_t change) const {
  if (code == 0) return Answer::kDone;
  if (code == 1 && Has(errors, kFileLost)) return Answer::kFileLost;
  if (code == 1 && Has(errors, kKillsWorkers)) return Answer::kKillsWorkers;
  const bool is_known =
      std::ranges::any_of(kChanges, [&](const char* phrase) { return Has(errors, phrase); });
  if (history_.change() != change && is_known) return Answer::kChanged;
  return std::nullopt;
}

Customers::Answer Customers::Ask(std::vector<std::string> arguments, const std::string& address,
                                 uint64_t change, std::string* answer) {
  arguments.insert(arguments.end(), {"--coordinator", address, "--patience", "120"});
  const auto deadline = std::chrono::steady_clock::now() + kJobPatience;
  while (true) {
    Process process(folder_, "tessera", arguments);
    std::optional<int> code;
    while (!code && !gave_up_ && std::chrono::steady_clock::now() < deadline) code = process.Wait(kPause);
    *answer = process.Output();
    const std::string errors = process.Errors();
    if (const auto known = Understand(code.value_or(-1), errors, change)) return *known;
    if (code == 1 && Has(errors, kDiskFull) && !gave_up_) {
      std::this_thread::sleep_for(kPause);
      continue;
    }
    Report(fmt::format("tessera {} {} {}: {}", arguments[0], arguments[1],
                       code ? fmt::format("ended with {}", *code) : "took too long", errors));
    return Answer::kFailed;
  }
}

std::optional<Customers::Placed> Customers::LastFinished() const {
  const std::lock_guard lock(mutex_);
  for (const auto& finished : finished_) {
    if (!finished.empty() && !history_.IsLost(finished.back().place)) return finished.back();
  }
  return std::nullopt;
}

void Customers::Report(const std::string& problem) {
  const std::lock_guard lock(mutex_);
  problems_.push_back(problem);
}

std::vector<std::string> Customers::problems() const {
  const std::lock_guard lock(mutex_);
  return problems_;
}

}  // namespace tessera
