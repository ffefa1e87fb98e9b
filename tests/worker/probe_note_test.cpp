#include "worker/probe_note.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "proto/probe.h"
#include "tests/coordinator/store/temporary_dir.h"
#include "worker/build_id.h"

namespace tessera {
namespace {

Digest Expected() {
  return *Digest::FromHex(kProbeDigest);
}

// A renderer that counts how often it renders.
struct CountedProbe {
  Digest result = Expected();
  int renders = 0;

  Digest In(const std::string& folder, const std::optional<Digest>& circumstances) {
    const auto digest = NotedProbe(folder, circumstances, [this]() -> Result<Digest> {
      ++renders;
      return result;
    });
    return digest ? *digest : Digest{};
  }
};

TEST(ProbeNote, ThatThisMachineHasPassedSparesTheNextRender) {
  const TemporaryDir folder;
  CountedProbe probe;
  EXPECT_EQ(probe.In(folder / "a/b", Sha256("here")), Expected());
  EXPECT_EQ(probe.In(folder / "a/b", Sha256("here")), Expected());
  EXPECT_EQ(probe.renders, 1);
}

TEST(ProbeNote, OfOtherCircumstancesDoesNotCount) {
  const TemporaryDir folder;
  CountedProbe probe;
  probe.In(folder / "n", Sha256("here"));
  probe.In(folder / "n", Sha256("after an update"));
  EXPECT_EQ(probe.renders, 2);
  probe.In(folder / "n", Sha256("here"));
  EXPECT_EQ(probe.renders, 3) << "one note is kept";
  probe.In(folder / "n", std::nullopt);
  probe.In(folder / "n", std::nullopt);
  EXPECT_EQ(probe.renders, 5) << "unknown circumstances";
}

TEST(ProbeNote, IsNotMadeOfAFailure) {
  const TemporaryDir folder;
  CountedProbe probe;
  probe.result = Sha256("other pixels");
  EXPECT_EQ(probe.In(folder / "n", Sha256("here")), probe.result);
  EXPECT_EQ(probe.In(folder / "n", Sha256("here")), probe.result);
  EXPECT_EQ(probe.renders, 2);
}

TEST(ProbeNote, ThatIsDamagedOrCutDoesNotCount) {
  const TemporaryDir folder;
  CountedProbe probe;
  probe.In(folder / "n", Sha256("here"));
  const std::string path = folder / "n/passed";
  const auto size = std::filesystem::file_size(path);
  for (const uintmax_t kept : {uintmax_t{0}, size / 2, size - 1}) {
    std::filesystem::resize_file(path, kept);
    const int before = probe.renders;
    EXPECT_EQ(probe.In(folder / "n", Sha256("here")), Expected());
    EXPECT_EQ(probe.renders, before + 1) << kept;
  }
  std::ofstream(path) << "passed\n";
  probe.In(folder / "n", Sha256("here"));
  EXPECT_EQ(probe.renders, 5);
}

TEST(ProbeNote, ThatOthersMayHaveWrittenDoesNotCount) {
  const TemporaryDir folder;
  CountedProbe probe;
  probe.In(folder / "n", Sha256("here"));
  ASSERT_EQ(::chmod((folder / "n/passed").c_str(), 0666), 0);
  probe.In(folder / "n", Sha256("here"));
  EXPECT_EQ(probe.renders, 2);
  probe.In(folder / "n", Sha256("here"));
  EXPECT_EQ(probe.renders, 2) << "it was replaced";
  ASSERT_EQ(::symlink((folder / "n").c_str(), (folder / "link").c_str()), 0);
  probe.In(folder / "link", Sha256("here"));
  EXPECT_EQ(probe.renders, 3);
}

TEST(ProbeNote, InAFolderThatCannotBeMadeIsNotMissed) {
  CountedProbe probe;
  EXPECT_EQ(probe.In("/proc/nothing/n", Sha256("here")), Expected());
  EXPECT_EQ(probe.In("", Sha256("here")), Expected());
  EXPECT_EQ(probe.renders, 2);
}

TEST(ProbeNote, CircumstancesAreTheSameInOneProcessAndDependOnTheCLibrarysSettings) {
  EXPECT_GE(LoadedBuildIds().size(), BuildId().size());
  const auto first = ProbeCircumstances();
  if (!first) GTEST_SKIP() << "this system does not tell them";
  EXPECT_EQ(*ProbeCircumstances(), *first);
  ::setenv("GLIBC_TUNABLES", "glibc.cpu.hwcaps=-AVX2", 1);
  EXPECT_NE(*ProbeCircumstances(), *first);
  ::unsetenv("GLIBC_TUNABLES");
}

}  // namespace
}  // namespace tessera
