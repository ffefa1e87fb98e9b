// A data directory that release 0.1 left ("tessera-data 4") is read: every job and every sum in it is there.
// tests/end_to_end/migration_test.cpp continues it with real programs and says how it was made. One of the
// present format is kept too: tests/coordinator/kept_orders_test.cpp opens it and says how it was made.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>

#include "coordinator/core/fact.h"
#include "coordinator/store/data_dir.h"
#include "coordinator/store/file_journal.h"
#include "coordinator/store/file_spool.h"
#include "coordinator/store/record_log.h"
#include "renderer/film/picture_file.h"
#include "renderer/util/file.h"
#include "tests/build_paths.h"
#include "tests/coordinator/store/temporary_dir.h"

namespace tessera {
namespace {

struct Facts {
  std::map<JobId, std::shared_ptr<const JobSpec>> jobs;
  std::vector<JobId> finished, paused;
};

Facts ReadJournal(const std::string& path) {
  Facts facts;
  const auto journal = FileJournal::Open(path, [&](const Fact& fact) {
    if (const auto* job = std::get_if<JobSubmitted>(&fact)) facts.jobs[job->job] = job->spec;
    if (const auto* end = std::get_if<JobEnded>(&fact)) facts.finished.push_back(end->job);
    if (const auto* pause = std::get_if<JobPaused>(&fact)) facts.paused.push_back(pause->job);
  });
  EXPECT_TRUE(journal) << journal.error().message;
  return facts;
}

TEST(DataMigration, ADirectoryOfFormat4KeepsItsJobsAndSums) {
  TemporaryDir folder;
  const std::string path = folder / "data";
  std::filesystem::copy(SourceDir() + "/tests/coordinator/store/data/format-4", path,
                        std::filesystem::copy_options::recursive);
  const auto data = DataDir::Open(path);
  ASSERT_TRUE(data) << data.error().message;
  EXPECT_TRUE(data->is_older());
  ASSERT_TRUE(data->MarkUsed());
  EXPECT_EQ(*ReadFile(path + "/version", 100), "tessera-data 6\n");
  EXPECT_FALSE(data->is_older());

  const Facts facts = ReadJournal(data->JournalPath());
  ASSERT_EQ(facts.jobs.size(), 3u);
  EXPECT_EQ(facts.finished, std::vector{JobId{1}});
  EXPECT_EQ(facts.paused, (std::vector{JobId{2}, JobId{3}}));
  std::vector<Channel> channels = ColorsAndWeight({"R", "G", "B"});
  EXPECT_EQ(facts.jobs.at(JobId{2})->frames[0].spec.channels, channels);
  AddChannel(channels, SamplesChannel(true));
  EXPECT_EQ(facts.jobs.at(JobId{1})->frames[0].spec.channels, channels);
  EXPECT_EQ(facts.jobs.at(JobId{3})->frames[0].spec.channels, channels);

  auto spool = FileSpool::Open(data->SpoolPath(), [](auto task) { task(); });
  ASSERT_TRUE(spool);
  const std::map<JobId, uint64_t> samples{{JobId{1}, 16 * 16 * 13}, {JobId{2}, 212992}, {JobId{3}, 106496}};
  for (const auto& [job, merged] : samples) {
    const FrameSpec& spec = facts.jobs.at(job)->frames[0].spec;
    Merger merger(spec);
    const auto restored = (*spool)->Restore(
        {job, 0}, [&](TileNode node) { EXPECT_TRUE(merger.Add(std::move(node)).has_value()); });
    ASSERT_TRUE(restored) << restored.error().message;
    EXPECT_EQ(merger.samples_merged(), merged) << "of job " << Number(job);
    if (!merger.Complete()) continue;
    EXPECT_EQ(*EncodeExr(spec, merger.Picture()), *ReadFile(path + "/pictures/1/0.exr", 1 << 20))
        << "the kept sums are those of the picture, to the last bit";
  }
}

// If this fails, what is stored has another form. Keep this directory to be read, and add one that the
// changed release leaves, to which this test then belongs.
TEST(DataMigration, AJournalOfFormat6HasTheBytesThatAreWrittenNow) {
  const std::string path = SourceDir() + "/tests/coordinator/store/data/format-6";
  EXPECT_EQ(*ReadFile(path + "/version", 100), "tessera-data 6\n");
  std::set<size_t> kinds;
  const auto visit = [&](std::string_view payload, uint32_t) -> Result<void> {
    const auto fact = DecodeFact(payload);
    if (!fact) return fact.error();
    EXPECT_EQ(EncodeFact(*fact), payload) << "a fact of kind " << fact->index();
    kinds.insert(fact->index());
    return {};
  };
  const RecordFormat format{"TSRJ", 2, 2, kFactBytesMax};
  const auto read = RecordLog::Read(path + "/journal", format, RecordLog::Tail::kWhole, visit, "");
  EXPECT_TRUE(read) << read.error().message;
  for (const Fact& fact : {Fact(JobOrdered()), Fact(JobOwned()), Fact(JobSubmitted()), Fact(FrameFinished()),
                           Fact(JobEnded()), Fact(JobPaused()), Fact(JobPriorityChanged())})
    EXPECT_TRUE(kinds.contains(fact.index())) << "there is none of kind " << fact.index();
}

}  // namespace
}  // namespace tessera
