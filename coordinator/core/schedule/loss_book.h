// Workers that vanished, what they had in hand, what that makes suspect of having killed them, and which
// worker tries a suspect alone. Owned by the scheduler.
//
// A machine that fails, a power cut and a unit that kills its worker look alike when they happen once. So
// what was lost twice is suspect: it is given to one worker at a time that has nothing else in hand, and what
// three workers of three parties were lost with has killed them; of fewer, if there are no others who could
// try it. A loss does not count if other workers vanished in the same
// moment, is void if the worker returns (the network was cut, the process lives), and is forgotten when what
// was lost is rendered. Losses are not journalled: they are observations of a process of the coordinator, and
// another one observes the next three deaths.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "coordinator/core/schedule/failure_book.h"
#include "coordinator/core/schedule/frame_work.h"
#include "coordinator/core/schedule/instant.h"
#include "proto/terms.h"

namespace tessera {

// What may have killed a worker: a tile of a frame, or a whole scene.
struct Suspect {
  Digest scene;
  JobId job{};  // of the tile; 0: the scene
  uint32_t frame = 0, tile = 0;
  auto operator<=>(const Suspect&) const = default;
  bool is_scene() const { return job == JobId{}; }
};

class LossBook {
 public:
  struct InHand {
    Suspect what;
    SampleRange range;  // of a tile
    Instant since{};
  };
  struct LostWorker {
    WorkerId id{};
    MemberId member{};  // 0: none
    std::string name;
    bool is_silent = false;  // it hangs or is cut off, perhaps; if not, its connection broke
    size_t workers_live = 0;
  };
  struct Killer {
    Suspect what;
    std::string reason;
  };

  // The worker vanished without a goodbye.
  void Lose(Instant now, const LostWorker& worker, const std::vector<InHand>& in_hand);
  // A worker that had vanished is there again.
  void Return(WorkerId worker);
  // A unit of the tile was rendered.
  void Rendered(const Suspect& tile, const std::function<bool(SampleRange)>& is_done);
  void ForgetJob(JobId job);
  // Forgets what is rendered or given up.
  void Keep(const std::function<bool(const Suspect&)>& is_wanted);
  // What has killed as many workers as it takes. Tells whether a worker of none of the parties may try it.
  using MayOthersTry = std::function<bool(const Suspect& what, const std::set<Party>& parties)>;
  std::vector<Killer> Killers(Instant now, const MayOthersTry& may_others_try);
  bool empty() const { return losses_.empty(); }

  // ---- Suspects: not to be given to any worker, except on trial ----
  const std::set<Suspect>& suspects() const { return suspects_; }
  // Whether they differ from what they were at the last call.
  bool TakeChanged() { return std::exchange(changed_, false); }
  // Suspects that no worker tries, and that a worker that was in contact at `contact` may try: it must have
  // outlived the last loss for long enough not to be a part of it.
  std::vector<Suspect> Untried(Instant now, Instant contact) const;
  void BeginTrial(const Suspect& what, WorkerId worker);
  void EndTrial(WorkerId worker);
  std::vector<WorkerId> Triers() const;
  // The suspect that the worker tries; nullopt if it tries none.
  std::optional<Suspect> TrialOf(WorkerId worker) const;
  // Whose workers were lost with the suspect.
  std::set<Party> PartiesOf(const Suspect& what) const;
  // For people: who was lost with the suspect.
  std::string Describe(const Suspect& what) const;

 private:
  struct Loss {
    WorkerId worker{};
    MemberId member{};
    std::string name;
    SampleRange range;
    Instant since{}, at{};
    bool is_silent = false;
    size_t crowd_min = 1;          // others that vanish at the same time and are the cause then
    std::optional<bool> is_alone;  // decided a moment later
  };
  struct Vanished {
    WorkerId worker{};
    Instant since{};  // the first of what it had in hand
    Instant at{};
    bool was_on_trial = false;
  };
  using Losses = std::map<Suspect, std::vector<Loss>>;

  bool IsAlone(const Loss& loss) const;
  std::vector<const Loss*> Counted(const Suspect& what, const std::vector<Loss>& losses, Instant now) const;
  // Erases losses of one suspect.
  void EraseOf(Losses::iterator of, const std::function<bool(const Loss&)>& condition);
  void Update(const Suspect& what, const std::vector<Loss>& losses);

  Losses losses_;
  std::map<WorkerId, std::vector<Suspect>> of_worker_;  // what it was lost with, at least
  std::deque<Vanished> vanished_;                       // lately
  std::set<Suspect> suspects_;
  std::map<WorkerId, Suspect> trials_;
  bool changed_ = false;
};

}  // namespace tessera
