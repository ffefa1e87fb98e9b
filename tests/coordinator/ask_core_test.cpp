// Questions to the core thread that fail.
#include "coordinator/ask_core.h"

#include <gtest/gtest.h>

#include <new>

#include "coordinator/recovery.h"
#include "coordinator/store/file_pictures.h"
#include "tests/coordinator/store/temporary_dir.h"

namespace tessera {
namespace {

TEST(AskCore, AQuestionThatThrowsIsAnsweredAndTheCoreThreadGoesOn) {
  const TemporaryDir folder;
  const auto directory = DataDir::Open(folder / "data", DataDir::Journal::kRequired);
  ASSERT_TRUE(directory) << directory.error().message;
  FilePictures pictures(directory->PicturesPath());
  auto recovered = Recover(*directory, {}, [](const std::function<void()>& task) { task(); });
  ASSERT_TRUE(recovered) << recovered.error().message;
  CoreThread::Parts parts;
  parts.farm = std::move(recovered->farm);
  parts.journal = std::move(recovered->journal);
  parts.spool = std::move(recovered->spool);
  parts.pictures = std::make_unique<PictureWriter>(pictures);
  CoreThread core(std::move(parts));
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_FALSE(AskCore(core, [](CoreContext&) -> int { throw std::bad_alloc(); }));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, kCorePatience);
  EXPECT_EQ(AskCore(core, [](CoreContext&) { return 7; }), 7);
}

}  // namespace
}  // namespace tessera
