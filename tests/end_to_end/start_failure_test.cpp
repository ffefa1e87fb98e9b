// Programs that cannot start end with an error, whatever the system refuses.
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>

#include "renderer/util/cores.h"
#include "tests/end_to_end/farm_fixture.h"
#include "tests/sanitizers.h"

namespace tessera {
namespace {

using testing::HasSubstr;
using testing::Not;

// A soft limit of this process and of those that it starts, as long as it lives.
class SoftLimit {
 public:
  SoftLimit(__rlimit_resource resource, rlim_t value) : resource_(resource) {
    EXPECT_EQ(::getrlimit(resource, &before_), 0);
    const rlimit changed{value, before_.rlim_max};
    EXPECT_EQ(::setrlimit(resource, &changed), 0);
  }
  ~SoftLimit() { ::setrlimit(resource_, &before_); }
  SoftLimit(const SoftLimit&) = delete;
  SoftLimit& operator=(const SoftLimit&) = delete;

 private:
  __rlimit_resource resource_;
  rlimit before_{};
};

constexpr rlim_t kGigabyte = rlim_t{1} << 30;

class StartFailure : public EndToEnd {
 protected:
  // The ways in which programs start.
  std::vector<std::pair<std::string, std::vector<std::string>>> Commands() const {
    return {{"tessera", {"render", BoxScene(), "--in-process", "--spp", "1", "-o", "out.exr"}},
            {"tessera", {"render", BoxScene(), "--spp", "1", "-o", "out.exr"}},
            {"tessera", {"jobs", "--coordinator", "127.0.0.1:1", "--patience", "1"}},
            {"tessera-worker", {"--coordinator", "127.0.0.1:1", "--cache-dir", Path("cache")}},
            {"tessera-coordinator",
             {"--listen", "127.0.0.1:0", "--http", "127.0.0.1:0", "--data-dir", Path("data")}}};
  }
  void ExpectErrors(const std::string& message) {
    for (const auto& [program, words] : Commands()) {
      const Outcome outcome = RunProgram(folder(), program, words);
      EXPECT_EQ(outcome.code, 1) << program << " " << words[0] << "\n" << outcome.errors;
      EXPECT_THAT(outcome.errors, HasSubstr(program + ": ")) << words[0];
      EXPECT_THAT(outcome.errors, HasSubstr(message)) << program << " " << words[0];
    }
  }
};

TEST_F(StartFailure, RenderThreadsThatCannotStartAreAnError) {
  if (kHasSanitizer) GTEST_SKIP() << "cannot limit the address space beside a sanitizer";
  const SoftLimit limit(RLIMIT_AS, 6 * kGigabyte);
  const Outcome render =
      Tessera({"render", BoxScene(), "--in-process", "--threads", "1024", "--spp", "1", "-o", "out.exr"});
  EXPECT_EQ(render.code, 1) << render.errors;
  EXPECT_THAT(render.errors, HasSubstr("cannot start a thread"));
  EXPECT_FALSE(Exists("out.exr"));
  const Outcome worker =
      RunProgram(folder(), "tessera-worker",
                 {"--coordinator", "127.0.0.1:1", "--threads", "1024", "--cache-dir", Path("cache")});
  EXPECT_EQ(worker.code, 1) << worker.errors;
  EXPECT_THAT(worker.errors, HasSubstr("cannot start a thread"));
}

TEST_F(StartFailure, NoThreadAtAllIsAnErrorOfTheCoordinator) {
  if (kHasSanitizer) GTEST_SKIP() << "cannot limit the address space beside a sanitizer";
  // Stacks that do not fit into the address space.
  const SoftLimit stack(RLIMIT_STACK, 8 * kGigabyte);
  const SoftLimit limit(RLIMIT_AS, 6 * kGigabyte);
  const auto coordinator = Commands().back();
  const Outcome outcome = RunProgram(folder(), coordinator.first, coordinator.second);
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.errors, HasSubstr("cannot start a thread"));
}

TEST_F(StartFailure, TooFewDescriptorsAreAnErrorOfEveryProgram) {
  // Some more than the programs inherit here, so that their libraries can be loaded.
  for (const rlim_t descriptors : {24, 63}) {
    const SoftLimit limit(RLIMIT_NOFILE, descriptors);
    ExpectErrors("ulimit -n");
  }
}

// Programs of a user who may have only a few threads, whatever the number is.
class ThreadLimit : public EndToEnd {
 protected:
  // The limit does not hold for root, and counts all threads of a user. So this is a user of this test alone.
  void SetUp() override {
    if (kHasSanitizer) GTEST_SKIP() << "a sanitizer starts threads of its own";
    if (::geteuid() != 0) GTEST_SKIP() << "only root can run programs as another user";
    for (const std::string& path : {folder(), Path("tmp")}) ASSERT_EQ(::chown(path.c_str(), user_, user_), 0);
    if (RunAsUser(1000, "tessera", {"--version"}).Wait() != 0)
      GTEST_SKIP() << "another user cannot run the programs";
  }
  Process RunAsUser(int threads_max, const std::string& program,
                    const std::vector<std::string>& words) const {
    const std::string user = std::to_string(user_);
    std::vector<std::string> arguments{"--reuid",
                                       user,
                                       "--regid",
                                       user,
                                       "--clear-groups",
                                       "prlimit",
                                       "--nproc=" + std::to_string(threads_max),
                                       BinaryDir() + "/bin/" + program};
    arguments.insert(arguments.end(), words.begin(), words.end());
    return {folder(), "/usr/bin/setpriv", arguments};
  }
  std::vector<std::string> ProcessesOfUser() const {
    std::vector<std::string> processes;
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
      struct stat status {};
      if (::stat(entry.path().c_str(), &status) == 0 && status.st_uid == user_)
        processes.push_back(entry.path().filename());
    }
    return processes;
  }
  // From no thread besides the first to more than the program needs.
  static std::vector<int> Limits() {
    const int needed = 28 + 2 * UsableCores();
    std::vector<int> limits{1, 2, 3, 4, 5, 6, 8, 12, 20};
    for (const int more : {-2, -1, 0, 1, 2, 3, 4, 8, 16, 24, 32, 40, 64}) limits.push_back(needed + more);
    return limits;
  }
  // Whatever the limit is, the program works or ends with an error that says what to do, and leaves nothing
  // behind. One that does not end by itself is asked to when it has written `ready`.
  void ExpectErrorOrWork(const std::string& program, const std::vector<std::string>& words,
                         const std::string& ready) {
    bool has_failed = false, has_worked = false;
    for (const int limit : Limits()) {
      Process process = RunAsUser(limit, program, words);
      if (!ready.empty() && process.AwaitErrors(ready)) process.Signal(SIGTERM);
      const int code = process.Wait().value_or(1000);
      const std::string errors = process.Errors();
      (code == 0 ? has_worked : has_failed) = true;
      if (code != 0) {
        EXPECT_EQ(code, 1) << limit << " threads: " << errors;
        EXPECT_THAT(errors, HasSubstr("cannot start a thread")) << limit << " threads";
        EXPECT_THAT(errors, HasSubstr("ulimit -u")) << limit << " threads";
      }
      EXPECT_TRUE(Eventually([&] { return ProcessesOfUser().empty(); }, std::chrono::seconds(10)))
          << limit << " threads: " << testing::PrintToString(ProcessesOfUser());
    }
    EXPECT_TRUE(has_failed && has_worked);
  }

  const uid_t user_ = 100'000 + static_cast<uid_t>(::getpid());
};

TEST_F(ThreadLimit, IsAnErrorOfARenderInOneProcess) {
  ExpectErrorOrWork("tessera", {"render", BoxScene(), "--in-process", "--spp", "1", "-o", "out.exr"}, "");
}

TEST_F(ThreadLimit, IsAnErrorWhenAPictureFormatNeedsThreads) {
  ExpectErrorOrWork("tessera", {"render", BoxScene(), "--in-process", "--spp", "1", "-o", "out.png"}, "");
}

TEST_F(ThreadLimit, IsAnErrorOfALocalFarm) {
  ExpectErrorOrWork("tessera", {"render", BoxScene(), "--spp", "1", "-o", "out.exr"}, "");
}

TEST_F(ThreadLimit, IsAnErrorOfTheWorker) {
  ExpectErrorOrWork("tessera-worker", {"--coordinator", "127.0.0.1:1", "--cache-dir", Path("cache")},
                    "worker_started");
}

TEST_F(ThreadLimit, IsAnErrorOfTheCoordinator) {
  ExpectErrorOrWork("tessera-coordinator",
                    {"--listen", "127.0.0.1:0", "--http", "127.0.0.1:0", "--data-dir", Path("data")},
                    "listening on");
}

// Copies of the programs in a folder without the module for picture formats.
class MissingModule : public EndToEnd {
 protected:
  MissingModule() {
    std::filesystem::create_directory(Path("bin"));
    for (const char* program : {"tessera", "tessera-coordinator", "tessera-worker"})
      std::filesystem::copy_file(BinaryDir() + "/bin/" + program, Path(std::string("bin/") + program));
  }
  Outcome Run(const std::string& program, const std::vector<std::string>& words) const {
    return RunProgram(folder(), Path("bin/" + program), words);
  }
  // Names the file and what to do about it.
  void ExpectNamed(const Outcome& outcome, int code = 1) const {
    EXPECT_EQ(outcome.code, code);
    EXPECT_THAT(outcome.errors, HasSubstr(Path("bin/libtessera_image_formats.so: ")));
    EXPECT_THAT(outcome.errors, HasSubstr("No such file or directory"));
    EXPECT_THAT(outcome.errors, HasSubstr("install"));
  }
};

TEST_F(MissingModule, IsAnErrorBeforeAnythingIsRendered) {
  for (const char* name : {"a.png", "a.jpg", "a.tif", "a.hdr"}) {
    const Outcome outcome = Run("tessera", {"render", BoxScene(), "--in-process", "-o", name});
    ExpectNamed(outcome);
    EXPECT_THAT(outcome.errors, Not(HasSubstr("samples/s"))) << name;
    EXPECT_FALSE(Exists(name));
  }
  ExpectNamed(Run("tessera", {"render", BoxScene(), "--in-process", "-o", "a.exr", "--png", "a.png"}));
  EXPECT_FALSE(Exists("a.exr"));
  ExpectNamed(Run("tessera-worker", {"--coordinator", "127.0.0.1:1", "--cache-dir", Path("cache")}));
}

TEST_F(MissingModule, ScenesThatNeedItFailWithItsName) {
  const Outcome outcome =
      Run("tessera", {"render", SourceDir() + "/tests/scenes/original/earth.pbrt", "--in-process"});
  ExpectNamed(outcome, 2);
  EXPECT_THAT(outcome.errors, HasSubstr("earth.jpg"));
}

TEST_F(MissingModule, IsNotMissedWhereItIsNotNeeded) {
  for (const char* name : {"a.exr", "a.pfm"}) {
    const Outcome outcome = Run("tessera", {"render", BoxScene(), "--in-process", "--spp", "1", "-o", name});
    EXPECT_EQ(outcome.code, 0) << outcome.errors;
    EXPECT_TRUE(Exists(name));
  }
  for (const char* program : {"tessera", "tessera-worker", "tessera-coordinator"})
    EXPECT_EQ(Run(program, {"--version"}).code, 0) << program;
}

}  // namespace
}  // namespace tessera
