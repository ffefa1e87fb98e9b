#include "proto/shell/log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tessera {
namespace {

using testing::HasSubstr;

TEST(Log, AuditEntriesAreWrittenWhateverTheLevelIs) {
  testing::internal::CaptureStderr();
  StartLog("error");
  WriteAuditEntry("call=Jobs.Cancel job=3 result=done");
  const std::string lines = testing::internal::GetCapturedStderr();
  EXPECT_THAT(lines, HasSubstr(" info audit call=Jobs.Cancel job=3 result=done\n"));
}

}  // namespace
}  // namespace tessera
