#include "coordinator/recovery.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "coordinator/store/file_journal.h"
#include "proto/shell/system.h"

namespace tessera {
namespace {

Result<void> RestoreSpool(FileSpool& spool, Farm& farm, const RecordLog::OnTorn& on_torn) {
  for (const auto& [frame, bytes, begun] : spool.Frames()) {
    switch (farm.FoundInSpool(frame, begun)) {
      case Farm::SpoolUse::kDrop: spool.Drop(frame); break;
      case Farm::SpoolUse::kKeep: break;
      case Farm::SpoolUse::kRestore: {
        const auto restored = spool.Restore(
            frame, [&, id = frame](TileNode node) { farm.RestoreNode(id, std::move(node)); }, on_torn);
        if (!restored) return restored;
      }
    }
  }
  return {};
}

}  // namespace

Result<RecoveredFarm> Recover(const DataDir& directory, const RecoveryOptions& options, FileSpool::Run run) {
  std::vector<std::string> log;
  // A crash does this, and so does damage to the end of a file: what was cut off should be known.
  const auto on_torn = [&log](const std::string& path, uint64_t offset, uint64_t bytes) {
    log.push_back(fmt::format("torn_tail_removed file=\"{}\" offset={} bytes={}", path, offset, bytes));
  };
  std::vector<Fact> facts;
  uint32_t epoch = 1;
  FarmId id;
  auto journal = FileJournal::Open(
      directory.JournalPath(),
      [&](const Fact& fact) {
        if (const auto* started = std::get_if<CoordinatorStarted>(&fact)) {
          epoch = started->epoch + 1;
          id = started->farm;
        }
        facts.push_back(fact);
      },
      on_torn);
  if (!journal) return journal.error();
  auto spool = FileSpool::Open(directory.SpoolPath(), std::move(run));
  if (!spool) return spool.error();
  if (id == FarmId{}) id = RandomFarmId();  // the directory is new, or from before farms had identities
  auto farm = std::make_unique<Farm>(SchedulerOptions{epoch, options.attempts_max, RandomId()},
                                     options.keep_sums_bytes, id);
  for (const Fact& fact : facts) farm->Restore(fact);
  // The spool is destroyed before the farm. Kept sums are read later, so this goes to the log directly.
  (*spool)->NameScenes([known = farm.get()](FrameId frame) { return known->SceneOf(frame); },
                       [](const std::string& file) {
                         spdlog::warn("spool_file_ignored file=\"{}\" reason=\"it is of another scene\"",
                                      file);
                       });
  // Results without a scene are those of this journal only if both come from the time before scenes were
  // named.
  if (directory.is_older()) {
    if (const auto bound = (*spool)->BindToScenes(); !bound) return bound.error();
  }
  if (const auto marked = directory.MarkUsed(); !marked) return marked.error();
  if (const auto restored = RestoreSpool(**spool, *farm, on_torn); !restored) return restored.error();
  return RecoveredFarm{std::move(farm), std::move(*journal), std::move(*spool), std::move(log)};
}

}  // namespace tessera
