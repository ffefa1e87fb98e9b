#include "proto/shell/program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <new>

#include "proto/shell/pause.h"

namespace tessera {
namespace {

constexpr std::chrono::seconds kPatience{30};

int RunMain(const ProgramBody& body) {
  char name[] = "program", word[] = "word";
  char* arguments[] = {name, word, nullptr};
  return RunProgram("program", 2, arguments, body);
}

TEST(Program, ReturnsTheExitCodeOfItsBody) {
  EXPECT_EQ(RunMain([](const std::vector<std::string>& arguments, std::stop_token) -> Result<int> {
              return arguments == std::vector<std::string>{"word"} ? 0 : 7;
            }),
            0);
}

TEST(Program, TokensReachTheBodyAndAreNoLongerInTheArguments) {
  char name[] = "program";
  std::string token = "tessera-" + std::string(80, 'A');
  const std::string given = token;
  char* arguments[] = {name, token.data(), nullptr};
  RunProgram("program", 2, arguments,
             [&](const std::vector<std::string>& words, std::stop_token) -> Result<int> {
               EXPECT_EQ(words, std::vector<std::string>{given});
               return 0;
             });
  EXPECT_EQ(token, "tessera-" + std::string(80, 'x'));
}

TEST(Program, AnErrorIsOneLineOnStderrAndItsKindIsTheExitCode) {
  testing::internal::CaptureStderr();
  const int code =
      RunMain([](const auto&, std::stop_token) -> Result<int> { return BadInput("two\nlines"); });
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "program: two lines\n");
  EXPECT_EQ(code, 2);
}

TEST(Program, AnExceptionIsAFailure) {
  testing::internal::CaptureStderr();
  EXPECT_EQ(RunMain([](const auto&, std::stop_token) -> Result<int> { throw std::bad_alloc(); }), 1);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "program: std::bad_alloc\n");
}

TEST(Program, TheFirstSignalRequestsAStop) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) {
    EXPECT_EQ(RunMain([signal](const auto&, std::stop_token termination) -> Result<int> {
                ::kill(::getpid(), signal);
                return Pause(termination, kPatience) ? 1 : 0;
              }),
              0);
  }
}

TEST(ProgramDeathTest, TheSecondSignalEndsTheProcessImmediately) {
  const auto ignore_signals = [](const auto&, std::stop_token termination) -> Result<int> {
    ::kill(::getpid(), SIGTERM);
    Pause(termination, kPatience);
    ::kill(::getpid(), SIGTERM);
    Pause({}, kPatience);
    return 0;
  };
  EXPECT_EXIT(RunMain(ignore_signals), testing::ExitedWithCode(130), "");
}

TEST(Program, ASecondHangupDoesNotCutTheEndShort) {
  for (const int first : {SIGHUP, SIGTERM}) {
    EXPECT_EQ(RunMain([first](const auto&, std::stop_token termination) -> Result<int> {
                ::kill(::getpid(), first);
                Pause(termination, kPatience);
                ::kill(::getpid(), SIGHUP);
                Pause({}, std::chrono::milliseconds(200));
                return 5;
              }),
              5);
  }
}

TEST(Program, IgnoresTheHangupThatNohupIgnores) {
  ::signal(SIGHUP, SIG_IGN);
  EXPECT_EQ(RunMain([](const auto&, std::stop_token termination) -> Result<int> {
              ::kill(::getpid(), SIGHUP);
              return Pause(termination, std::chrono::milliseconds(200)) ? 0 : 1;
            }),
            0);
  ::signal(SIGHUP, SIG_DFL);
}

TEST(ProgramDeathTest, AnErrorIsReportedWithItsExitCodeThoughNobodyCanReadIt) {
  const auto fail_unheard = [](const auto&, std::stop_token) -> Result<int> {
    ::close(STDERR_FILENO);
    return BadInput("unheard");
  };
  EXPECT_EXIT(std::_Exit(RunMain(fail_unheard)), testing::ExitedWithCode(2), "");
}

}  // namespace
}  // namespace tessera
