// Scenes of several files, and where files come from.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "tests/renderer/pbrt/parse_helpers.h"

namespace tessera {
namespace {

using testing::ElementsAre;

// "Shape \"sphere\" \"float radius\" 7\n" packed by gzip.
constexpr unsigned char kPackedShape[] = {
    0x1f, 0x8b, 0x08, 0x00, 0x00, 0x00, 0x00, 0x00, 0x02, 0x03, 0x0b, 0xce, 0x48,
    0x2c, 0x48, 0x55, 0x50, 0x2a, 0x2e, 0xc8, 0x48, 0x2d, 0x4a, 0x55, 0x52, 0x50,
    0x4a, 0xcb, 0xc9, 0x4f, 0x2c, 0x51, 0x28, 0x4a, 0x4c, 0xc9, 0x2c, 0x2d, 0x56,
    0x52, 0x30, 0xe7, 0x02, 0x00, 0xbc, 0x7a, 0x7b, 0x3d, 0x20, 0x00, 0x00, 0x00,
};

Result<SceneDescription> ParseFiles(const std::string& top,
                                    const std::map<std::string, std::string>& others) {
  MemoryFiles files;
  files.files = others;
  files.files["a.pbrt"] = top;
  return ParseScene(files, "a.pbrt");
}

TEST(Files, IncludeContinuesTheStateAndImportKeepsItsOwn) {
  const Result<SceneDescription> scene =
      ParseFiles("WorldBegin Include \"b\" Shape \"disk\" Import \"c\" Shape \"cylinder\"",
                 {{"b", "Translate 1 0 0 Material \"conductor\""},
                  {"c", "Translate 0 1 0 Material \"dielectric\" Shape \"sphere\""}});
  ASSERT_TRUE(scene.has_value()) << ErrorOf(scene);
  ASSERT_EQ(scene->shapes.size(), 3u);
  EXPECT_EQ(scene->shapes[0].world_from_object.First().ToPoint({0, 0, 0}), (Point3{1, 0, 0}));
  EXPECT_EQ(scene->shapes[1].entity.kind, "sphere");
  EXPECT_EQ(scene->shapes[1].world_from_object.First().ToPoint({0, 0, 0}), (Point3{1, 1, 0}));
  EXPECT_EQ(scene->shapes[1].material.index, 2);
  EXPECT_EQ(scene->shapes[2].world_from_object.First().ToPoint({0, 0, 0}), (Point3{1, 0, 0}));
  EXPECT_EQ(scene->shapes[2].material.index, 1);
  EXPECT_EQ(scene->shapes[1].entity.location.Text(), "c:1:39");
}

TEST(Files, WhatAnImportDefinesIsGlobal) {
  const Result<SceneDescription> scene = ParseFiles(
      "WorldBegin Import \"b\" NamedMaterial \"m\" Shape \"sphere\" ObjectInstance \"o\"",
      {{"b",
        "MakeNamedMaterial \"m\" \"string type\" \"mix\" Texture \"t\" \"float\" \"constant\" ObjectBegin "
        "\"o\" Shape \"disk\" ObjectEnd"}});
  ASSERT_TRUE(scene.has_value()) << ErrorOf(scene);
  EXPECT_EQ(scene->shapes[0].material.index, 1);
  EXPECT_EQ(scene->textures.size(), 1u);
  EXPECT_EQ(ErrorOf(ParseFiles("WorldBegin Import \"b\"\nTexture \"t\" \"float\" \"constant\"",
                               {{"b", "Texture \"t\" \"float\" \"constant\""}})),
            "a.pbrt:2:1: float texture \"t\" is defined twice, first at b:1:1");
}

TEST(Files, ImportInsideAnObjectAddsToTheObject) {
  const Result<SceneDescription> scene =
      ParseFiles("WorldBegin ObjectBegin \"o\" Import \"b\" ObjectEnd", {{"b", "Shape \"disk\""}});
  ASSERT_TRUE(scene.has_value()) << ErrorOf(scene);
  EXPECT_EQ(scene->objects[0].shapes.size(), 1u);
  EXPECT_EQ(
      ErrorOf(ParseFiles("WorldBegin ObjectBegin \"o\" Import \"b\"", {{"b", "Shape \"disk\" ObjectEnd"}})),
      "b:1:14: ObjectEnd without ObjectBegin before it");
  EXPECT_EQ(
      ErrorOf(ParseFiles("WorldBegin AttributeBegin Import \"b\" AttributeEnd", {{"b", "\nAttributeBegin"}})),
      "b:2:1: AttributeBegin without AttributeEnd before the end of the file");
}

TEST(Files, AttributesMayBeginAndEndInDifferentIncludedFiles) {
  EXPECT_TRUE(
      ParseFiles("WorldBegin Include \"b\" Include \"c\"", {{"b", "AttributeBegin"}, {"c", "AttributeEnd"}}));
}

TEST(Files, AStatementGoesOnBehindTheEndOfAnIncludedFile) {
  const Result<SceneDescription> scene =
      ParseFiles("WorldBegin Include \"b\" \"float radius\" 3", {{"b", "Shape \"sphere\""}});
  ASSERT_TRUE(scene.has_value()) << ErrorOf(scene);
  EXPECT_EQ(scene->shapes[0].entity.parameters.size(), 1u);
}

TEST(Files, ErrorsInIncludedFilesNameThem) {
  EXPECT_EQ(ErrorOf(ParseFiles("WorldBegin\nInclude \"geometry/b.pbrt\"",
                               {{"geometry/b.pbrt", "\n\n  Shpe \"a\""}})),
            "geometry/b.pbrt:3:3: unknown directive \"Shpe\" (did you mean \"Shape\"?)");
}

TEST(Files, MissingFilesAreToldAtTheirPlace) {
  EXPECT_EQ(ErrorOf(ParseFiles("WorldBegin\nInclude \"b.pbrt\"", {})),
            "a.pbrt:2:9: Include \"b.pbrt\": b.pbrt: cannot be opened: No such file or directory");
  MemoryFiles none;
  EXPECT_EQ(ErrorOf(ParseScene(none, "x.pbrt")), "x.pbrt: cannot be opened: No such file or directory");
}

TEST(Files, FilesThatIncludeThemselvesAreRefused) {
  EXPECT_EQ(ErrorOf(ParseFiles("Include \"a.pbrt\"", {})),
            "a.pbrt:1:9: Include \"a.pbrt\": files nested deeper than 64, does one include itself?");
  EXPECT_EQ(ErrorOf(ParseFiles("WorldBegin Import \"b\"", {{"b", "Import \"b\""}})),
            "b:1:8: Import \"b\": files nested deeper than 64, does one include itself?");
}

TEST(Files, FilesThatIncludeEachOtherManyTimesAreRefused) {
  std::map<std::string, std::string> files;
  for (int i = 0; i < 20; ++i) {
    const std::string next = "Include \"f" + std::to_string(i + 1) + "\" ";
    files["f" + std::to_string(i)] = next + next;
  }
  files["f20"] = "";
  EXPECT_THAT(ErrorOf(ParseFiles("Include \"f0\"", files)),
              testing::EndsWith("Include opens more than 65536 files"));
}

TEST(Files, PackedFilesAreUnpacked) {
  const std::string packed(reinterpret_cast<const char*>(kPackedShape), sizeof kPackedShape);
  const Result<SceneDescription> scene =
      ParseFiles("WorldBegin Include \"b.pbrt.gz\"", {{"b.pbrt.gz", packed}});
  ASSERT_TRUE(scene.has_value()) << ErrorOf(scene);
  EXPECT_THAT(scene->shapes[0].entity.parameters[0].floats, ElementsAre(7));
  EXPECT_EQ(
      ErrorOf(ParseFiles("WorldBegin Include \"b.gz\"", {{"b.gz", packed.substr(0, packed.size() / 2)}})),
      "a.pbrt:1:20: Include \"b.gz\": b.gz: the compressed data is damaged or cut short");
}

TEST(Files, PackedFilesAreRecognisedByTheirContentUnderAnyName) {
  const std::string packed(reinterpret_cast<const char*>(kPackedShape), sizeof kPackedShape);
  for (const std::string name : {"b.pbrt", "b.GZ", "b"}) {
    const Result<SceneDescription> scene =
        ParseFiles("WorldBegin Include \"" + name + "\"", {{name, packed}});
    ASSERT_TRUE(scene.has_value()) << ErrorOf(scene);
    EXPECT_THAT(scene->shapes[0].entity.parameters[0].floats, ElementsAre(7));
  }
}

class DiskFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("tessera_files_test_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_ / "sub");
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  void Write(const std::string& name, const std::string& text) { std::ofstream(folder_ / name) << text; }

  std::filesystem::path folder_;
};

TEST_F(DiskFiles, AreFoundBesideTheTopLevelFileOrAsGiven) {
  Write("sub/scene.pbrt", "WorldBegin Include \"part.pbrt\"");
  Write("sub/part.pbrt", "Shape \"sphere\"");
  Write("other", "x");
  DiskFileSource files((folder_ / "sub").string());
  ASSERT_TRUE(ParseScene(files, "scene.pbrt").has_value());
  EXPECT_TRUE(files.Read("../other").has_value());
  EXPECT_TRUE(files.Read((folder_ / "other").string()).has_value());
  const auto read = files.FilesRead();
  ASSERT_EQ(read.size(), 4u);
  EXPECT_EQ(read.at("part.pbrt").path, (folder_ / "sub/part.pbrt").string());
  EXPECT_EQ(read.at("part.pbrt").size, 14u);
  EXPECT_EQ(read.at("part.pbrt").digest, Sha256("Shape \"sphere\""));
}

TEST_F(DiskFiles, ThatAreAbsentAreToldByTheirPlaceBesideTheScene) {
  DiskFileSource files(folder_.string());
  EXPECT_EQ(files.Read("none.png").error().message,
            folder_.string() + "/none.png: cannot be opened: No such file or directory");
  EXPECT_EQ(files.Read("").error().message, "a file name is empty");
  EXPECT_TRUE(files.FilesRead().empty());
}

TEST_F(DiskFiles, ThatChangeBetweenTwoReadsAreRefused) {
  Write("f", "one");
  DiskFileSource files(folder_.string());
  EXPECT_TRUE(files.Read("f").has_value());
  EXPECT_TRUE(files.Read("f").has_value());
  Write("f", "two");
  EXPECT_EQ(files.Read("f").error().message,
            folder_.string() + "/f: changed while the scene was being read; run the command again");
}

}  // namespace
}  // namespace tessera
