#include "coordinator/core/schedule/loss_book.h"

#include <fmt/format.h>

#include <algorithm>

#include "coordinator/core/schedule/policy.h"

namespace tessera {
namespace {

std::string NamesOf(const std::vector<std::string>& names) {
  std::string text;
  for (size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 == names.size() ? " and " : ", ";
    text += names[i];
  }
  return text;
}

std::string TextOf(const Suspect& what) {
  if (what.is_scene()) return "the scene";
  return fmt::format("tile {} of frame {}", what.tile, what.frame);
}

}  // namespace

void LossBook::Lose(Instant now, const LostWorker& worker, const std::vector<InHand>& in_hand) {
  Instant since = in_hand.empty() ? Instant{} : in_hand.front().since;
  for (const InHand& each : in_hand) {
    since = std::min(since, each.since);
    std::vector<Loss>& losses = losses_[each.what];
    Loss loss{worker.id, worker.member,    worker.name, each.range,  each.since,
              now,       worker.is_silent, 1,           std::nullopt};
    loss.crowd_min = std::max<size_t>(1, worker.workers_live / kCrowdDivisor);
    losses.push_back(std::move(loss));
    if (losses.size() > kLossesKeptMax) losses.erase(losses.begin());
    of_worker_[worker.id].push_back(each.what);
  }
  vanished_.push_back({worker.id, since, now, trials_.contains(worker.id)});
  if (vanished_.size() > kVanishedKeptMax) vanished_.pop_front();
  trials_.erase(worker.id);
  for (const InHand& each : in_hand) Update(each.what, losses_.at(each.what));
}

void LossBook::Return(WorkerId worker) {
  const auto found = of_worker_.extract(worker);
  if (!found) return;
  for (const Suspect& what : found.mapped())
    EraseOf(losses_.find(what), [&](const Loss& loss) { return loss.worker == worker; });
}

void LossBook::Rendered(const Suspect& tile, const std::function<bool(SampleRange)>& is_done) {
  if (losses_.empty()) return;
  EraseOf(losses_.find(Suspect{tile.scene}), [](const Loss&) { return true; });
  EraseOf(losses_.find(tile), [&](const Loss& loss) { return is_done(loss.range); });
}

void LossBook::ForgetJob(JobId job) {
  for (auto each = losses_.begin(); each != losses_.end();) {
    const auto here = each++;
    if (!here->first.is_scene() && here->first.job == job) EraseOf(here, [](const Loss&) { return true; });
  }
}

void LossBook::Keep(const std::function<bool(const Suspect&)>& is_wanted) {
  for (auto each = losses_.begin(); each != losses_.end();) {
    const auto here = each++;
    if (!is_wanted(here->first)) EraseOf(here, [](const Loss&) { return true; });
  }
  if (losses_.empty()) of_worker_.clear();
}

void LossBook::EraseOf(Losses::iterator of, const std::function<bool(const Loss&)>& condition) {
  if (of == losses_.end() || std::erase_if(of->second, condition) == 0) return;
  Update(of->first, of->second);
  if (of->second.empty()) losses_.erase(of);
}

// A tile is suspect if the same samples of it were lost twice.
void LossBook::Update(const Suspect& what, const std::vector<Loss>& losses) {
  bool is_suspect = false;
  for (auto loss = losses.begin(); loss != losses.end() && !is_suspect; ++loss) {
    is_suspect = std::any_of(losses.begin(), loss, [&](const Loss& other) {
      return what.is_scene() || other.range.Overlaps(loss->range);
    });
  }
  if (is_suspect == suspects_.contains(what)) return;
  changed_ = true;
  if (is_suspect) {
    suspects_.insert(what);
    return;
  }
  suspects_.erase(what);
  std::erase_if(trials_, [&](const auto& trial) { return trial.second == what; });
}

// Whether no other worker vanished in the same moment that had what it held before this one was lost, and the
// other way round. Those that were on trial themselves have a cause of their own.
bool LossBook::IsAlone(const Loss& loss) const {
  const auto others = std::count_if(vanished_.begin(), vanished_.end(), [&](const Vanished& other) {
    const Instant apart = other.at > loss.at ? other.at - loss.at : loss.at - other.at;
    return other.worker != loss.worker && !other.was_on_trial && apart <= kCrowdWindow &&
           other.since <= loss.at && loss.since <= other.at;
  });
  return static_cast<size_t>(others) < loss.crowd_min;
}

// Losses of different workers that count, for those samples of a tile that were lost last.
std::vector<const LossBook::Loss*> LossBook::Counted(const Suspect& what, const std::vector<Loss>& losses,
                                                     Instant now) const {
  std::vector<const Loss*> counted;
  for (const Loss& loss : losses) {
    const Instant settled = loss.at + (loss.is_silent ? kSilentLossSettles : kCrowdWindow);
    const bool counts = loss.is_alone.value_or(false) && now >= settled &&
                        (what.is_scene() || loss.range.Overlaps(losses.back().range));
    const bool is_known = std::any_of(counted.begin(), counted.end(),
                                      [&](const Loss* each) { return each->worker == loss.worker; });
    if (counts && !is_known) counted.push_back(&loss);
  }
  return counted;
}

std::set<Party> LossBook::PartiesOf(const Suspect& what) const {
  std::set<Party> parties;
  const auto losses = losses_.find(what);
  if (losses == losses_.end()) return parties;
  for (const Loss& loss : losses->second) parties.insert(PartyOf(loss.member, loss.worker));
  return parties;
}

std::vector<LossBook::Killer> LossBook::Killers(Instant now, const MayOthersTry& may_others_try) {
  std::vector<Killer> killers;
  for (auto& [what, losses] : losses_) {
    for (Loss& loss : losses) {
      if (!loss.is_alone && now >= loss.at + kCrowdWindow) loss.is_alone = IsAlone(loss);
    }
    const auto counted = Counted(what, losses, now);
    if (counted.size() < kLossesMax) continue;
    std::set<Party> parties;
    for (const Loss* each : counted) parties.insert(PartyOf(each->member, each->worker));
    if (parties.size() < kLossesMax && may_others_try(what, parties)) continue;
    std::vector<std::string> names;
    names.reserve(counted.size());
    for (const Loss* each : counted) names.push_back(each->name);
    killers.push_back(
        {what,
         fmt::format("{} kills its workers: {} were lost one after the other while they {} it; it may "
                     "need more memory than they have",
                     TextOf(what), NamesOf(names), what.is_scene() ? "loaded or rendered" : "rendered")});
  }
  while (!vanished_.empty() && vanished_.front().at + 3 * kCrowdWindow < now) vanished_.pop_front();
  return killers;
}

std::vector<Suspect> LossBook::Untried(Instant now, Instant contact) const {
  std::vector<Suspect> untried;
  for (const Suspect& what : suspects_) {
    if (!what.is_scene() && suspects_.contains({what.scene})) continue;  // the scene is tried first
    const Instant lost = losses_.at(what).back().at;
    const bool is_tried =
        std::any_of(trials_.begin(), trials_.end(), [&](const auto& trial) { return trial.second == what; });
    if (!is_tried && now >= lost + kTrialRest && contact >= lost + kTrialContactAfter)
      untried.push_back(what);
  }
  return untried;
}

void LossBook::BeginTrial(const Suspect& what, WorkerId worker) {
  trials_[worker] = what;
}

void LossBook::EndTrial(WorkerId worker) {
  trials_.erase(worker);
}

std::vector<WorkerId> LossBook::Triers() const {
  std::vector<WorkerId> triers;
  for (const auto& [worker, what] : trials_) triers.push_back(worker);
  return triers;
}

std::optional<Suspect> LossBook::TrialOf(WorkerId worker) const {
  const auto trial = trials_.find(worker);
  return trial == trials_.end() ? std::nullopt : std::optional(trial->second);
}

std::string LossBook::Describe(const Suspect& what) const {
  const auto losses = losses_.find(what);
  if (losses == losses_.end()) return {};
  std::vector<std::string> names;
  for (const Loss& each : losses->second) names.push_back(each.name);
  constexpr size_t kNamesMax = 5;
  if (names.size() > kNamesMax) names.erase(names.begin(), names.end() - kNamesMax);
  return fmt::format(
      "{} is given to one worker at a time since {} workers were lost with it, the last of them {}",
      TextOf(what), losses->second.size(), NamesOf(names));
}

}  // namespace tessera
