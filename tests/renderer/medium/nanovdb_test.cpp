// NanoVDB files, intact and hostile.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>

#include "renderer/medium/nanovdb_file.h"
#include "renderer/medium/openvdb_file.h"
#include "tests/build_paths.h"
#include "tests/renderer/medium/built_media.h"
#include "tests/renderer/medium/nanovdb_bytes.h"

namespace tessera {
namespace {

using testing::HasSubstr;

const VoxelIndex kFirst{-5, 3, 120}, kLast{9, 11, 133};

float SlopeAt(const VoxelIndex& v) {
  return static_cast<float>((v[0] + 6) * 100 + v[1] * 10 + (v[2] - 119));
}

NanoVdbGridWriter Slope(double voxel_size = 1) {
  return {"density", kFirst, kLast, SlopeAt, voxel_size};
}

std::string NanoVdbError(const std::string& bytes) {
  const auto grid = ReadNanoVdb(bytes, "a.nvdb", "density", std::nullopt, false);
  return grid ? "no error" : grid.error().message;
}
std::string ErrorOfGrid(const std::string& grid) {
  return NanoVdbError(NanoVdbFileBytes({{"density", grid}}, false));
}

TEST(NanoVdb, EveryVoxelIsReadFromPackedAndUnpackedFiles) {
  for (const bool is_zipped : {false, true}) {
    const std::string file =
        NanoVdbFileBytes({{"other", Slope(7).bytes}, {"density", Slope(0.5).bytes}}, is_zipped);
    const auto read = ReadNanoVdb(file, "a.nvdb", "density", std::nullopt, false);
    ASSERT_TRUE(read) << read.error().message;
    ASSERT_TRUE(*read);
    const VdbGrid& grid = **read;
    EXPECT_EQ(grid.box.min, kFirst);
    EXPECT_EQ(grid.box.max, kLast);
    EXPECT_EQ(grid.world_from_index.ToPoint({2, 4, 6}), (Point3{1, 2, 3}));
    for (int x = kFirst[0]; x <= kLast[0]; ++x) {
      for (int y = kFirst[1]; y <= kLast[1]; ++y) {
        for (int z = kFirst[2]; z <= kLast[2]; ++z) {
          const Point3 position{static_cast<float>(x - kFirst[0] + 1), static_cast<float>(y - kFirst[1] + 1),
                                static_cast<float>(z - kFirst[2] + 1)};
          ASSERT_EQ(grid.voxels.Lookup(position), SlopeAt({x, y, z}));
        }
      }
    }
  }
}

// Written by NanoVDB and OpenVDB themselves, the latter compressed by Blosc: two grids of 12 x 8 x 14 voxels
// of 0.25.
TEST(NanoVdb, FilesOfTheLibrariesAreRead) {
  const std::pair<std::string, decltype(&ReadNanoVdb)> files[] = {{"nanovdb/two_grids.nvdb", ReadNanoVdb},
                                                                  {"openvdb/two_grids.vdb", ReadOpenVdb}};
  for (const auto& [path, read_grid] : files) {
    std::ifstream file(SourceDir() + "/tests/fuzz/corpus/" + path, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    for (const auto& [name, factor] : {std::pair("density", 1.0f), std::pair("temperature", 1024.0f)}) {
      const auto read = read_grid(bytes, path, name, std::nullopt, false);
      ASSERT_TRUE(read) << read.error().message;
      ASSERT_TRUE(*read);
      const VdbGrid& grid = **read;
      EXPECT_EQ(grid.box.min, (VoxelIndex{1, 2, 100}));
      EXPECT_EQ(grid.box.max, (VoxelIndex{12, 9, 113}));
      EXPECT_EQ(grid.world_from_index.ToPoint({4, 8, 12}), (Point3{2, 4, 6}));
      for (int x = 1; x <= 12; ++x) {
        for (int y = 2; y <= 9; ++y) {
          for (int z = 100; z <= 113; ++z) {
            const Point3 position{static_cast<float>(x), static_cast<float>(y - 1),
                                  static_cast<float>(z - 99)};
            ASSERT_EQ(grid.voxels.Lookup(position), factor * static_cast<float>(x * y * (z - 99)) / 128.0f);
          }
        }
      }
    }
  }
}

// A tile stands for all its voxels; here those of a lower node, 8 x 8 x 8 each, and of the root.
TEST(NanoVdb, TilesFillTheirVoxelsWithinTheBox) {
  NanoVdbGridWriter grid("density", {0, 0, 0}, {0, 0, 0}, [](VoxelIndex) { return 1.0f; });
  const uint64_t lower = NanoVdbGridWriter::kNodesAt + 270400;
  grid.Put(lower + 1088 + 8 * 1, 2.0f);  // z from 8 to 15
  for (int i = 0; i < 3; ++i) grid.Put(NanoVdbGridWriter::kRootAt + 12 + 4 * i, 11);
  const auto read = ReadNanoVdb(NanoVdbFileBytes({{"density", grid.bytes}}, true), "a.nvdb", "density",
                                std::nullopt, false);
  ASSERT_TRUE(read) << read.error().message;
  const FloatGrid& voxels = (*read)->voxels;
  EXPECT_EQ(voxels.Lookup({1, 1, 1}), 1);
  EXPECT_EQ(voxels.Lookup({1, 1, 9}), 2);
  EXPECT_EQ(voxels.Lookup({8, 8, 12}), 2);
  EXPECT_EQ(voxels.Lookup({9, 1, 9}), 0);
  EXPECT_EQ(voxels.Lookup({1, 1, 13}), 0);
}

TEST(NanoVdb, HostileGridsAreRefused) {
  using Writer = NanoVdbGridWriter;
  const auto with = [](uint64_t at, auto value) {
    Writer grid = Slope();
    grid.Put(at, value);
    return ErrorOfGrid(grid.bytes);
  };
  const uint64_t upper = Writer::kNodesAt, lower = upper + 270400;
  for (const uint64_t offset : {uint64_t{1} << 40, ~uint64_t{0}, uint64_t{1} << 30})
    EXPECT_THAT(with(672 + 24, offset), HasSubstr("an offset leads beyond its end")) << offset;
  EXPECT_THAT(with(Writer::kRootAt + 24, ~uint32_t{0}), HasSubstr("an offset leads beyond its end"));
  for (const int64_t child : {int64_t{1} << 40, int64_t{-1} << 40, int64_t{1} << 62, int64_t{-100000}})
    EXPECT_THAT(with(Writer::kRootAt + 64 + 8, child), HasSubstr("grid \"density\" cannot be read")) << child;
  // A node among its own children.
  for (const int64_t child : {int64_t{0}, -static_cast<int64_t>(270400)}) {
    Writer grid = Slope();
    for (uint64_t n = 0; n < 4096; ++n) grid.Put(lower + 1088 + 8 * n, child);
    std::memset(grid.bytes.data() + lower + 544, 0xff, 512);
    EXPECT_THAT(ErrorOfGrid(grid.bytes), HasSubstr("nodes occur more than once"));
  }
  EXPECT_THAT(with(636, uint32_t{6}), HasSubstr("its values are not 32-bit floats"));
  EXPECT_THAT(with(632, uint32_t{1}), HasSubstr("it is not a fog volume"));
  EXPECT_THAT(with(384, std::nan("")), HasSubstr("without an inverse"));
  EXPECT_THAT(with(384, 0.0), HasSubstr("without an inverse"));
  EXPECT_THAT(with(Writer::kRootAt + 12, 1 << 20), HasSubstr("voxels long, at most 16384 are read"));
  EXPECT_THAT(with(Writer::kRootAt + 12, -6), HasSubstr("has no active voxels"));
  EXPECT_THAT(with(0, uint64_t{1}), HasSubstr("does not start with the mark"));
  for (const float value : {-1.0f, NAN, INFINITY}) {
    const Writer grid("density", kFirst, kLast, [&](VoxelIndex) { return value; });
    EXPECT_THAT(ErrorOfGrid(grid.bytes), HasSubstr("it has the value"));
  }
}

TEST(NanoVdb, AGridOfManyVoxelsIsRefusedBeforeItTakesMemory) {
  NanoVdbGridWriter grid("density", {0, 0, 0}, {0, 0, 0}, [](VoxelIndex) { return 1.0f; });
  for (int i = 0; i < 3; ++i) grid.Put(NanoVdbGridWriter::kRootAt + 12 + 4 * i, 16383);
  EXPECT_THAT(ErrorOfGrid(grid.bytes), HasSubstr("is too large: 16384 x 16384 x 16384 voxels"));
}

TEST(NanoVdb, HostileFilesAreRefused) {
  const std::string plain = NanoVdbFileBytes({{"density", Slope().bytes}}, false);
  const std::string zipped = NanoVdbFileBytes({{"density", Slope().bytes}}, true);
  EXPECT_THAT(NanoVdbError("v"), HasSubstr("a.nvdb: damaged NanoVDB file: it is not a NanoVDB file"));
  for (size_t size = 1; size < zipped.size(); size += 37)
    EXPECT_THAT(NanoVdbError(zipped.substr(0, size)), HasSubstr("damaged NanoVDB file")) << size;
  std::string file = plain;
  file[14] = 2;
  EXPECT_THAT(NanoVdbError(file), HasSubstr("its compression is not supported"));
  file = plain;
  file[8] = 19;
  file[11] = 0;
  EXPECT_THAT(NanoVdbError(file), HasSubstr("files of version 0 are not supported, only version 32"));
  file = zipped;
  for (size_t i = 16; i < 24; ++i) file[i] = '\x7f';  // the size of the grid
  EXPECT_THAT(NanoVdbError(file), HasSubstr("cannot hold a grid of"));
  file = zipped;
  file[file.size() / 2] ^= 1;
  EXPECT_THAT(NanoVdbError(file), HasSubstr("a grid cannot be unpacked"));
  EXPECT_FALSE(*ReadNanoVdb(plain, "a.nvdb", "Density", std::nullopt, false));
}

BuiltMedia BuildNanoVdb(const std::string& parameters, const std::string& file) {
  return BuildMedia("MakeNamedMedium \"m\" \"string type\" \"nanovdb\" " + parameters, {{{"a.nvdb", file}}});
}

TEST(NanoVdbMedium, DensityAndTemperatureAreThoseOfTheFile) {
  const NanoVdbGridWriter density(
      "density", {0, 0, 0}, {3, 3, 3}, [](VoxelIndex) { return 2.0f; }, 0.5);
  const NanoVdbGridWriter heat(
      "temperature", {-2, 0, 0}, {5, 3, 3}, [](VoxelIndex) { return 1900.0f; }, 0.5);
  const std::string file = NanoVdbFileBytes({{"temperature", heat.bytes}, {"density", density.bytes}}, true);
  const BuiltMedia built = BuildNanoVdb(
      "\"string filename\" \"a.nvdb\" \"float temperatureoffset\" 100 \"float temperaturescale\" 2 "
      "\"float Lescale\" 3 \"spectrum sigma_a\" [ 300 0.5 900 0.5 ] \"float scale\" 4",
      file);
  ASSERT_EQ(built.error, "");
  EXPECT_TRUE(built.table[0].is_emissive());
  const SampledWavelengths wavelengths = SampledWavelengths::SampleVisible(0.3f);
  const auto coefficients = std::get<GridCoefficients>(built.table[0].At(wavelengths));
  const Ray ray{{-1, 0.6f, 0.7f}, {1, 0, 0}};
  auto medium = coefficients.RayAlong(ray);
  const MediumPoint point = medium.At(2);
  EXPECT_NEAR(point.sigma_a[0], 4, 1e-5);
  EXPECT_NEAR(point.emission[0] / point.sigma_a[0], 3 * BlackbodyValue(3600, wavelengths.lambda[0]), 1e-3);
  // One voxel after the last the density is zero, and the medium ends.
  EXPECT_NEAR(medium.At(2.75f).sigma_a[0], 2, 1e-4);
  MajorantSegment segment;
  ASSERT_TRUE(medium.Next(&segment));
  EXPECT_NEAR(segment.t_end, 1, 1e-5);
  float end = 0;
  while (medium.Next(&segment)) end = segment.t_end;
  EXPECT_NEAR(end, 3, 1e-5);
  EXPECT_FALSE(BuildNanoVdb("\"string filename\" \"a.nvdb\" \"string temperaturename\" \"none\"", file)
                   .table[0]
                   .is_emissive());
}

TEST(NanoVdbMedium, ErrorsNameTheirPlaceAndTheFile) {
  EXPECT_EQ(BuildNanoVdb("", "").error, "m.pbrt:3:1: nanovdb needs a filename");
  EXPECT_THAT(BuildNanoVdb("\"string filename\" \"b.nvdb\"", "").error,
              HasSubstr("m.pbrt:3:45: b.nvdb: cannot be opened"));
  EXPECT_THAT(BuildNanoVdb("\"string filename\" \"a.nvdb\"", "x").error,
              HasSubstr("m.pbrt:3:45: a.nvdb: damaged NanoVDB file"));
  const std::string file =
      NanoVdbFileBytes({{"density", Slope().bytes}, {"temperature", Slope(2).bytes}}, true);
  EXPECT_THAT(BuildNanoVdb("\"string filename\" \"a.nvdb\" \"string gridname\" \"smoke\"", file).error,
              HasSubstr("a.nvdb: there is no grid \"smoke\""));
  EXPECT_THAT(BuildNanoVdb("\"string filename\" \"a.nvdb\"", file).error,
              HasSubstr("do not have the same voxels"));
}

}  // namespace
}  // namespace tessera
