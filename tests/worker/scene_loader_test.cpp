#include "worker/scene_loader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/scene/version.h"
#include "renderer/text/unicode.h"
#include "tests/worker/tiny_scene.h"

namespace tessera {
namespace {

using testing::HasSubstr;

TEST(SceneLoader, BuildsTheSceneThatWasOrdered) {
  BlobMap blobs;
  const auto scene = LoadOrderedScene(MakeOrder(blobs, kTinyScene), blobs.Fetcher());
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ((*scene)->frame().samples_per_pixel, 4u);
  const std::atomic<bool> stop = false;
  EXPECT_TRUE((*scene)->Render({0, 0, 8, 8}, {}, {0, 4}, &stop));
}

TEST(SceneLoader, RefusesAFrameOtherThanTheOneOrdered) {
  BlobMap blobs;
  SceneRequest order = MakeOrder(blobs, kTinyScene);
  order.frame.samples_per_pixel = 5;
  const auto scene = LoadOrderedScene(order, blobs.Fetcher());
  ASSERT_FALSE(scene);
  EXPECT_THAT(scene.error().message, HasSubstr("differs from the one submitted"));
}

// The coordinator writes the names of mattes as the submitting client sent them, without reading the scene.
TEST(SceneLoader, RefusesNamesOfMattesOtherThanThoseOfTheScene) {
  BlobMap blobs;
  RenderOptions options;
  options.aovs = {"crypto_object"};
  SceneRequest order = MakeOrder(blobs, kTinyScene, options);
  EXPECT_TRUE(LoadOrderedScene(order, blobs.Fetcher()));
  int manifests = 0;
  for (auto& [name, value] : order.frame.attributes) {
    if (!name.ends_with("/manifest")) continue;
    value.insert(1, R"("forged":"00800000",)");
    ++manifests;
  }
  EXPECT_EQ(manifests, 1);
  const auto scene = LoadOrderedScene(order, blobs.Fetcher());
  ASSERT_FALSE(scene);
  EXPECT_THAT(scene.error().message, HasSubstr("differs from the one submitted"));
}

TEST(SceneLoader, LoadsAFrameOfAnEarlierReleaseThatLacksAttributes) {
  BlobMap blobs;
  SceneRequest order = MakeOrder(blobs, kTinyScene);
  EXPECT_EQ(order.frame.attributes.erase(kSoftwareAttribute), 1u);
  EXPECT_EQ(order.frame.attributes.erase("worldToCamera"), 1u);
  order.frame.attributes.at(kVersionAttribute) = "0.0.1";
  EXPECT_TRUE(LoadOrderedScene(order, blobs.Fetcher()));
  order.frame.attributes.erase(kSceneDigestAttribute);
  EXPECT_FALSE(LoadOrderedScene(order, blobs.Fetcher())) << "no release omits the digest of the scene";
}

TEST(SceneLoader, RefusesAttributesOtherThanThoseOfTheScene) {
  BlobMap blobs;
  const SceneRequest order = MakeOrder(blobs, kTinyScene);
  SceneRequest other = order;
  other.frame.attributes.at("tessera:seed") = "1234";
  EXPECT_FALSE(LoadOrderedScene(other, blobs.Fetcher()));
  other = order;
  other.frame.attributes["more"] = "";
  EXPECT_FALSE(LoadOrderedScene(other, blobs.Fetcher()));
}

TEST(SceneLoader, APackageThatLacksAFileFailsByName) {
  BlobMap blobs;
  const SceneRequest order = MakeOrder(blobs, std::string(kTinyScene) + "Include \"more.pbrt\"\n");
  const auto scene = LoadOrderedScene(order, blobs.Fetcher());
  ASSERT_FALSE(scene);
  EXPECT_THAT(scene.error().message, HasSubstr("more.pbrt"));
}

TEST(SceneLoader, ABlobThatCannotBeFetchedFailsTheScene) {
  BlobMap blobs;
  const SceneRequest order = MakeOrder(blobs, kTinyScene);
  const BlobMap nothing;
  EXPECT_FALSE(LoadOrderedScene(order, nothing.Fetcher()));
}

TEST(PackageFileSource, ReadsNothingOutsideThePackage) {
  BlobMap blobs;
  ScenePackage package;
  package.files["a.txt"] = {blobs.Add("inside"), 6};
  PackageFileSource files(package, "", blobs.Fetcher());
  EXPECT_EQ(*files.Read("a.txt"), "inside");
  for (const char* name : {"/etc/passwd", "../a.txt", "./a.txt", "b.txt", ""})
    EXPECT_FALSE(files.Read(name)) << name;
}

TEST(PackageFileSource, FindsNamesThatAreNotPathsOfAPackage) {
  BlobMap blobs;
  ScenePackage package;
  package.files[PackagePath("../up/x y.txt")] = {blobs.Add("up"), 2};
  package.files[PackagePath("/abs.txt")] = {blobs.Add("abs"), 3};
  PackageFileSource files(package, "", blobs.Fetcher());
  EXPECT_EQ(*files.Read("../up/x y.txt"), "up");
  EXPECT_EQ(*files.Read("/abs.txt"), "abs");
}

TEST(PackageFileSource, RefusesABlobWhoseSizeDiffersFromTheManifest) {
  BlobMap blobs;
  ScenePackage package;
  package.files["a.txt"] = {blobs.Add("inside"), 7};
  PackageFileSource files(package, "", blobs.Fetcher());
  EXPECT_FALSE(files.Read("a.txt"));
}

TEST(SceneLoader, AFrameInAFolderOfItsPackageEqualsTheFrameAlone) {
  BlobMap blobs;
  const std::string scene = std::string(kTinyScene) + "Include \"more.pbrt\"";
  ScenePackage alone, job;
  alone.files[PackagePath("my scene.pbrt")] = {blobs.Add(scene), scene.size()};
  alone.files["more.pbrt"] = {blobs.Add("# a\n"), 4};
  job.files["folder-1/" + PackagePath("my scene.pbrt")] = {blobs.Add(scene), scene.size()};
  job.files["folder-1/more.pbrt"] = {blobs.Add("# a\n"), 4};
  job.files["folder-2/more.pbrt"] = {blobs.Add("Wrong\n"), 6};
  SceneRequest order = MakeOrder(blobs, kTinyScene);  // with the same frame
  order.package = blobs.Add(EncodeScenePackage(job));
  order.scene_file = "folder-1/" + PackagePath("my scene.pbrt");
  order.frame.attributes[kSceneDigestAttribute] = Sha256(EncodeScenePackage(alone)).Hex();
  const auto loaded = LoadOrderedScene(order, blobs.Fetcher());
  EXPECT_TRUE(loaded) << loaded.error().message;
  order.frame.attributes[kSceneDigestAttribute] = Sha256(EncodeScenePackage(job)).Hex();
  EXPECT_FALSE(LoadOrderedScene(order, blobs.Fetcher()));
}

TEST(PackagePath, TheFolderIsWhatPrecedesThePathOfTheSceneFile) {
  EXPECT_EQ(PackageFolder("scene.pbrt"), "");
  EXPECT_EQ(PackageFolder(PackagePath("my scene.pbrt")), "");
  EXPECT_EQ(PackageFolder("folder-7/scene.pbrt"), "folder-7/");
  EXPECT_EQ(PackageFolder("folder-7/" + PackagePath("my scene.pbrt")), "folder-7/");
}

TEST(PackagePath, TheNameIsRecovered) {
  for (const char* name : {"a.pbrt", "my scene.pbrt", "../a", "/b", "names/c", "\xff%2"})
    EXPECT_EQ(NameOfPackagePath(PackagePath(name)), name);
  for (const char* path : {"names/%zz", "names/%2", "names/%"}) EXPECT_EQ(NameOfPackagePath(path), path);
}

TEST(PackagePath, IsUtf8WhateverTheName) {
  for (const char* name : {"caf\xe9.pbrt", "\xff", "a/\xed\xa0\x80", "caf\xc3\xa9.pbrt"}) {
    EXPECT_TRUE(IsUtf8(PackagePath(name))) << name;
    EXPECT_EQ(NameOfPackagePath(PackagePath(name)), name);
  }
  EXPECT_EQ(PackagePath("caf\xc3\xa9.pbrt"), "caf\xc3\xa9.pbrt");
}

TEST(PackagePath, DifferentNamesHaveDifferentPathsInsideThePackage) {
  const std::string names[] = {"a",    "./a", "../a", "/a",  "names/a", "names/%2Fa",
                               "a%2F", "a b", "a\nb", "\\a", "a//b"};
  std::set<std::string> paths;
  for (const std::string& name : names) {
    const std::string path = PackagePath(name);
    EXPECT_TRUE(IsPackagePath(path)) << name;
    EXPECT_TRUE(paths.insert(path).second) << name;
  }
  EXPECT_EQ(PackagePath("textures/wood.png"), "textures/wood.png");
  EXPECT_EQ(PackagePath(std::string(5000, 'x')), "");
}

}  // namespace
}  // namespace tessera
