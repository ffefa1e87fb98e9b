#include "coordinator/core/fact_message.h"

#include <fmt/format.h>

#include <type_traits>

namespace tessera {
namespace {

std::string ByOwner(const Job& job) {
  return job.owner.name.empty() ? "" : " by " + job.owner.name;
}

std::string TextOf(const JobOrdered& fact, const Job& job) {
  return fmt::format("submitted{}: a worker prepares {}, priority {}", ByOwner(job),
                     fact.order->scene.scene_file, fact.order->priority);
}

std::string TextOf(const JobSubmitted&, const Job& job) {
  const size_t frames = job.spec->frames.size();
  return fmt::format("submitted{}: {} frame{}, {} samples per pixel, priority {}", ByOwner(job), frames,
                     frames == 1 ? "" : "s", job.spec->frames.front().spec.samples_per_pixel,
                     job.spec->priority);
}

std::string TextOf(const FrameFinished& fact, const Job& job) {
  return fmt::format("frame {} is finished", job.spec->frames.at(fact.frame).number);
}

std::string TextOf(const FrameFailed& fact, const Job& job) {
  return fmt::format("frame {} failed: {}", job.spec->frames.at(fact.frame).number, fact.reason);
}

std::string TextOf(const JobEnded& fact, const Job&) {
  return fact.reason.empty() ? JobStateName(fact.state)
                             : fmt::format("{}: {}", JobStateName(fact.state), fact.reason);
}

std::string TextOf(const JobExtended& fact, const Job&) {
  return fmt::format("extended to {} samples per pixel", fact.samples_per_pixel);
}

std::string TextOf(const JobPaused& fact, const Job&) {
  return fact.paused ? "paused by the user" : "resumed";
}

std::string TextOf(const JobPriorityChanged& fact, const Job&) {
  return fmt::format("priority {}", fact.priority);
}

template <typename EachFact>
MessageLevel LevelOf([[maybe_unused]] const EachFact& fact) {
  if constexpr (std::is_same_v<EachFact, JobEnded>) {
    if (fact.state == JobState::kFailed) return MessageLevel::kError;
  }
  if (std::is_same_v<EachFact, FrameFailed>) return MessageLevel::kError;
  return MessageLevel::kInfo;
}

template <typename EachFact>
std::optional<JobMessage::Change> ChangeOf(const EachFact&) {
  if (std::is_same_v<EachFact, JobEnded>) return JobMessage::Change::kEnds;
  if (std::is_same_v<EachFact, JobExtended> || std::is_same_v<EachFact, JobSubmitted> ||
      std::is_same_v<EachFact, JobOrdered>)
    return JobMessage::Change::kOpens;
  return std::nullopt;
}

}  // namespace

std::optional<JobMessage> MessageOf(const Fact& fact, const JobTable& jobs) {
  return std::visit(
      [&](const auto& each) -> std::optional<JobMessage> {
        if constexpr (requires(const Job& job) { TextOf(each, job); }) {
          const Job* const job = jobs.Find(each.job);
          if (job == nullptr) return std::nullopt;
          return JobMessage{each.job, LevelOf(each), TextOf(each, *job), ChangeOf(each)};
        } else {
          return std::nullopt;
        }
      },
      fact);
}

}  // namespace tessera
