#include "renderer/formats/loader/module_loader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/build_paths.h"
#include "tests/sanitizers.h"

namespace tessera::image_module {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

std::string InstalledModule() {
  return BinaryDir() + "/bin/libtessera_image_formats.so";
}

std::string ErrorOf(const std::string& path) {
  const auto functions = LoadFrom(path);
  return functions ? "no error" : functions.error().message;
}

bool IsOpenImageIoLoaded() {
  std::ifstream maps("/proc/self/maps");
  const std::string text(std::istreambuf_iterator<char>(maps), {});
  return text.find("libOpenImageIO") != std::string::npos;
}

[[noreturn]] void LoadAndExit() {
  const bool before = IsOpenImageIoLoaded();
  const bool loads = Load().has_value();
  std::_Exit(!before && loads && IsOpenImageIoLoaded() ? 0 : 1);
}

// The address space of this process, in bytes (proc(5)).
rlim_t AddressSpace() {
  rlim_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE));
}

// Leaves space for the stacks of fewer threads than the libraries of OpenImageIO start.
[[noreturn]] void LoadWithFewThreadsAndExit() {
  pthread_attr_t attributes;
  size_t stack_size = 0;
  ::pthread_getattr_default_np(&attributes);
  ::pthread_attr_getstacksize(&attributes, &stack_size);
  const rlimit space{AddressSpace() + 2 * stack_size, RLIM_INFINITY};
  ::setrlimit(RLIMIT_AS, &space);
  const auto functions = Load();
  std::fputs(functions ? "loaded" : functions.error().message.c_str(), stderr);
  std::_Exit(0);
}

// Runs some tests in a new process, because others of this program load the module.
class ModuleLoading : public testing::Test {
 protected:
  ModuleLoading() { GTEST_FLAG_SET(death_test_style, "threadsafe"); }
};

TEST_F(ModuleLoading, ProgramsDoNotLoadOpenImageIoBeforeTheyNeedIt) {
  EXPECT_EXIT(LoadAndExit(), testing::ExitedWithCode(0), "");
}

// Libraries that the module needs end a process in which they cannot start threads.
TEST_F(ModuleLoading, TooFewThreadsAreAnErrorAndDoNotEndTheProcess) {
  if (kHasSanitizer) GTEST_SKIP() << "cannot limit the address space beside a sanitizer";
  EXPECT_EXIT(LoadWithFewThreadsAndExit(), testing::ExitedWithCode(0),
              "libtessera_image_formats.so: cannot start a thread");
}

TEST(ModuleLoader, TheModuleLiesBesideTheProgramAndIsLoadedOnce) {
  EXPECT_TRUE(CheckInstalled());
  const auto first = Load(), second = Load(), same = LoadFrom(InstalledModule());
  ASSERT_TRUE(first) << first.error().message;
  ASSERT_TRUE(second);
  ASSERT_TRUE(same) << same.error().message;
  EXPECT_EQ(*first, *second);
  EXPECT_EQ(*first, *same);
}

TEST(ModuleLoader, AMissingModuleIsAnErrorThatNamesTheFileAndWhatToDo) {
  const std::string error = ErrorOf("/nowhere/libtessera_image_formats.so");
  EXPECT_THAT(error, StartsWith("/nowhere/libtessera_image_formats.so: "));
  EXPECT_THAT(error, HasSubstr("No such file or directory"));
  EXPECT_THAT(error, HasSubstr("install"));
}

TEST(ModuleLoader, NoFolderIsSearchedForTheModule) {
  EXPECT_THAT(ErrorOf("libtessera_image_formats.so"), HasSubstr("absolute path"));
  EXPECT_THAT(ErrorOf("bin/libtessera_image_formats.so"), HasSubstr("absolute path"));
  EXPECT_THAT(ErrorOf(""), HasSubstr("absolute path"));
}

TEST(ModuleLoader, FilesThatAreNotTheModuleAreRefused) {
  const std::string modules = BinaryDir() + "/tests/modules/";
  EXPECT_THAT(ErrorOf(modules + "libmodule_other_version.so"),
              HasSubstr("has version " + std::to_string(kVersion + 1) + ", this program needs version " +
                        std::to_string(kVersion)));
  EXPECT_THAT(ErrorOf(modules + "libmodule_no_entry.so"),
              HasSubstr("lacks the function TesseraImageFormats"));
  EXPECT_THAT(ErrorOf(SourceDir() + "/README.md"), HasSubstr("cannot be loaded"));
  EXPECT_THAT(ErrorOf(SourceDir()), HasSubstr("cannot be loaded"));
}

std::string BigEndian32(uint32_t v) {
  return {static_cast<char>(v >> 24), static_cast<char>(v >> 16), static_cast<char>(v >> 8),
          static_cast<char>(v)};
}

std::string Chunk(const std::string& type, const std::string& data) {
  const std::string both = type + data;
  const auto checksum = crc32(0, reinterpret_cast<const Bytef*>(both.data()), static_cast<uInt>(both.size()));
  return BigEndian32(static_cast<uint32_t>(data.size())) + both +
         BigEndian32(static_cast<uint32_t>(checksum));
}

// A grey PNG of 4 x 2 pixels with these bytes of pixels, of which the first of each row names its filter.
std::string PngOf(const std::string& rows) {
  uLongf size = compressBound(static_cast<uLong>(rows.size()));
  std::string packed(size, '\0');
  compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(rows.data()),
           static_cast<uLong>(rows.size()));
  packed.resize(size);
  const std::string header = BigEndian32(4) + BigEndian32(2) + std::string("\x08\0\0\0\0", 5);
  return "\x89PNG\r\n\x1a\n" + Chunk("IHDR", header) + Chunk("IDAT", packed) + Chunk("IEND", "");
}

// The reason why the picture cannot be decoded.
std::string ReasonOf(const std::string& png) {
  const auto functions = Load();
  if (!functions) return functions.error().message;
  PictureInfo info{};
  Reason reason{};
  OpenPicture* const picture =
      (*functions)->open({"png", "a.png", png.data(), png.size(), 64, 100}, info, reason);
  if (picture == nullptr) return reason.text;
  std::array<uint8_t, 8> pixels{};
  const bool is_read = (*functions)->read(picture, pixels.data(), reason);
  (*functions)->close(picture);
  return is_read ? "no error" : reason.text;
}

TEST(ModuleLoader, ADamagedPngIsAnErrorAndPrintsNothing) {
  const std::string rows("\0abcd\0efgh", 10);
  EXPECT_EQ(ReasonOf(PngOf(rows)), "no error");
  testing::internal::CaptureStderr();
  EXPECT_THAT(ReasonOf(PngOf("\x09" + rows.substr(1))), HasSubstr("bad adaptive filter value"));
  EXPECT_THAT(ReasonOf(PngOf(rows.substr(0, 5))), HasSubstr("Not enough image data"));
  EXPECT_EQ(ReasonOf(PngOf(rows)), "no error");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(ModuleLoader, WhatCannotBeEncodedIsAnErrorWithAReason) {
  const std::array<uint8_t, 3> pixel{1, 2, 3};
  const auto unknown = Encode({"unknown", 1, 1, ValueType::kUint8, pixel.data()});
  ASSERT_FALSE(unknown);
  EXPECT_NE(unknown.error().message, "");
  EXPECT_TRUE(Encode({"png", 1, 1, ValueType::kUint8, pixel.data()}));
}

}  // namespace
}  // namespace tessera::image_module
