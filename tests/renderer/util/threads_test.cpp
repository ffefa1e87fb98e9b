#include "renderer/util/threads.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <new>

#include "tests/sanitizers.h"

namespace tessera {
namespace {

using testing::HasSubstr;

// Runs `body` in a child process whose threads find no address space for their stacks. Returns its exit code.
int RunWithoutStacks(const std::function<int()>& body) {
  const pid_t pid = ::fork();
  if (pid == 0) {
    const rlimit limit{1 << 20, 1 << 20};
    ::setrlimit(RLIMIT_AS, &limit);
    ::_exit(body());
  }
  int status = 0;
  EXPECT_EQ(::waitpid(pid, &status, 0), pid);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

TEST(CheckThreads, SucceedsWhereThreadsCanBeStarted) {
  EXPECT_TRUE(CheckThreads(8));
}

TEST(CheckThreads, AnErrorSaysWhatToDo) {
  if (kHasSanitizer) GTEST_SKIP() << "cannot limit the address space beside a sanitizer";
  EXPECT_EQ(RunWithoutStacks([] {
              const auto started = CheckThreads(8);
              return !started && started.error().message.find("ulimit") != std::string::npos ? 0 : 1;
            }),
            0);
}

TEST(ThreadGroup, RunsAndJoinsItsThreads) {
  std::atomic<int> ran = 0;
  ThreadGroup group([](const Error&) {});
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(group.Start([&] { ++ran; }));
  EXPECT_EQ(group.size(), 4u);
  group.Join();
  EXPECT_EQ(ran, 4);
}

TEST(ThreadGroup, AThreadThatCannotStartIsAnError) {
  if (kHasSanitizer) GTEST_SKIP() << "cannot limit the address space beside a sanitizer";
  EXPECT_EQ(RunWithoutStacks([] {
              ThreadGroup group([](const Error&) {});
              // The first ones may find the stacks of earlier threads.
              for (int i = 0; i < 100; ++i) {
                if (!group.Start([] { ::usleep(100'000); })) return 0;
              }
              return 1;
            }),
            0);
}

TEST(ThreadGroup, AnExceptionIsReportedAndDoesNotEndTheProcess) {
  std::string message;
  ThreadGroup group([&](const Error& why) { message = why.message; });
  ASSERT_TRUE(group.Start([] { throw std::bad_alloc(); }));
  group.Join();
  EXPECT_THAT(message, HasSubstr("bad_alloc"));
}

}  // namespace
}  // namespace tessera
