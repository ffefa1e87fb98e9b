// OpenVDB files, intact and hostile.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "renderer/medium/blosc.h"
#include "renderer/medium/openvdb_file.h"
#include "tests/chi_square.h"
#include "tests/renderer/medium/built_media.h"
#include "tests/renderer/medium/openvdb_bytes.h"

namespace tessera {
namespace {

using testing::HasSubstr;

// Every third voxel of a leaf is not zero. All values are halves.
std::vector<float> LeafValues() {
  std::vector<float> values(512);
  for (size_t i = 0; i < 512; i += 3) values[i] = static_cast<float>(i + 1) * 0.25f;
  return values;
}

std::string OpenVdbBytes(const OpenVdbOptions& options = {}) {
  return OpenVdbWriter(LeafValues(), options).bytes;
}

std::string OpenVdbError(const std::string& bytes) {
  const auto grid = ReadOpenVdb(bytes, "a.vdb", "density", std::nullopt, false);
  return grid ? "no error" : grid.error().message;
}

TEST(OpenVdb, ValuesAreReadHoweverTheyAreStored) {
  const std::vector<float> values = LeafValues();
  for (int kind = 0; kind < 8; ++kind) {
    SCOPED_TRACE(kind);
    OpenVdbOptions options;
    options.is_zipped = (kind & 1) != 0;
    options.is_half = (kind & 2) != 0;
    options.stores_active_alone = (kind & 4) != 0;
    const auto read = ReadOpenVdb(OpenVdbBytes(options), "a.vdb", "density", std::nullopt, false);
    ASSERT_TRUE(read) << read.error().message;
    ASSERT_TRUE(*read);
    const VdbGrid& grid = **read;
    EXPECT_EQ(grid.box.min, (std::array<int, 3>{0, 0, 0}));
    EXPECT_EQ(grid.box.max, (std::array<int, 3>{7, 7, 7}));
    EXPECT_EQ(grid.world_from_index.ToPoint({2, 4, 6}), (Point3{1, 2, 3}));
    for (size_t i = 0; i < 512; ++i) {
      const Point3 position{static_cast<float>(i / 64 + 1), static_cast<float>(i / 8 % 8 + 1),
                            static_cast<float>(i % 8 + 1)};
      ASSERT_EQ(grid.voxels.Lookup(position), values[i]);
    }
  }
}

TEST(OpenVdb, CubesOfOneValueFillTheirVoxelsButNotMoreThanTheLimit) {
  const IndexBox box{{-3, 0, 0}, {252, 255, 255}};
  const auto read = [&](uint32_t tiles) {
    const std::string bytes = OpenVdbWriter(std::vector<float>(512), {.root_tiles = tiles}).bytes;
    return ReadOpenVdb(bytes, "a.vdb", "density", box, false);
  };
  const auto grid = read(1);
  ASSERT_TRUE(grid && *grid);
  const auto value_at = [&](float x, float y, float z) {
    return (*grid)->voxels.Lookup({x - -3 + 1, y + 1, z + 1});
  };
  EXPECT_EQ(value_at(-1, 100, 100), 0);
  EXPECT_EQ(value_at(-0.25f, 100, 100), 0.75f);
  for (const float at : {8.0f, 100.25f, 252.0f}) EXPECT_EQ(value_at(at, at, at), 1) << at;
  const auto refused = read(17);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("voxels are not zero")) << "each cube counts again";
}

TEST(OpenVdb, MapsGiveThePlacesOfVoxels) {
  const auto point = [](const std::string& map) {
    OpenVdbOptions options;
    options.map = map;
    const auto read = ReadOpenVdb(OpenVdbBytes(options), "a.vdb", "density", std::nullopt, false);
    return read ? (*read)->world_from_index.ToPoint({2, 4, 6}) : Point3{};
  };
  EXPECT_EQ(point("ScaleMap"), (Point3{1, 2, 3}));
  OpenVdbOptions unknown;
  unknown.map = "NonlinearFrustumMap";
  EXPECT_THAT(OpenVdbError(OpenVdbBytes(unknown)),
              HasSubstr("its map \"NonlinearFrustumMap\" is not supported"));
}

TEST(OpenVdb, HostileFilesAreRefused) {
  const std::string file = OpenVdbBytes({.is_zipped = true});
  for (size_t size = 8; size < file.size(); size += size < 200 ? 1 : 13)
    EXPECT_NE(OpenVdbError(file.substr(0, size)), "no error") << size;
  for (size_t at = 8; at < file.size(); at += at < 400 ? 1 : 7) {
    std::string damaged = file;
    damaged[at] = static_cast<char>(damaged[at] ^ 0xff);
    (void)ReadOpenVdb(damaged, "a.vdb", "density", std::nullopt, true);
  }
  EXPECT_THAT(OpenVdbError(OpenVdbBytes({.version = 221})),
              HasSubstr("OpenVDB files of version 221 are not supported"));
  EXPECT_THAT(OpenVdbError(OpenVdbBytes({.grid_class = "level set"})), HasSubstr("is not a fog volume"));
  for (const float value : {-1.0f, NAN, INFINITY}) {
    EXPECT_THAT(OpenVdbError(OpenVdbWriter(std::vector<float>(512, value), {}).bytes),
                HasSubstr("it has the value"));
  }
  EXPECT_THAT(OpenVdbError(OpenVdbWriter(std::vector<float>(512), {}).bytes),
              HasSubstr("has no active voxels"));
  EXPECT_FALSE(*ReadOpenVdb(file, "a.vdb", "Density", std::nullopt, false));
}

TEST(OpenVdb, IsReadByTheMediumNanoVdbToo) {
  const BuiltMedia built =
      BuildMedia("MakeNamedMedium \"m\" \"string type\" \"nanovdb\" \"string filename\" \"a.vdb\"",
                 {{"a.vdb", OpenVdbBytes()}});
  ASSERT_EQ(built.error, "");
  const auto coefficients =
      std::get<GridCoefficients>(built.table[0].At(SampledWavelengths::SampleVisible(0.3f)));
  const Ray ray{{0, 0, 0}, {0, 0, 1}};
  EXPECT_FLOAT_EQ(coefficients.RayAlong(ray).At(1.5f).sigma_a[0], LeafValues()[3]);
}

TEST(Lz4, SequencesOfLiteralsAndCopiesAreUnpacked) {
  std::string out = "kept";
  // "ab", then 5 bytes from 2 back, then "c".
  ASSERT_TRUE(UnpackLz4(std::string("\x21"
                                    "ab\x02\x00\x10"
                                    "c",
                                    7),
                        12, out));
  EXPECT_EQ(out, "keptabababac");
  // 20 literals take a second byte of length.
  out.clear();
  ASSERT_TRUE(UnpackLz4("\xf0\x05" + std::string(20, 'x'), 20, out));
  EXPECT_EQ(out, std::string(20, 'x'));
}

TEST(Lz4, DamagedBlocksAreRefused) {
  const std::string block(
      "\x21"
      "ab\x02\x00\x10"
      "c",
      7);
  const auto unpacks = [](const std::string& packed, size_t size) {
    std::string out;
    return UnpackLz4(packed, size, out);
  };
  ASSERT_TRUE(unpacks(block, 8));
  for (size_t size = 0; size < 7; ++size) EXPECT_FALSE(unpacks(block.substr(0, size), 8)) << size;
  EXPECT_FALSE(unpacks(block, 7));
  EXPECT_FALSE(unpacks(block, 9));
  for (const char offset : {'\x00', '\x03', '\x7f'}) {
    std::string wrong = block;
    wrong[3] = offset;
    EXPECT_FALSE(unpacks(wrong, 8)) << int{offset};
  }
  EXPECT_FALSE(unpacks("\xf0" + std::string(100, '\xff'), 100));
}

// Random bytes are no buffer, and must not be read beyond their end.
TEST(Blosc, DamagedBuffersAreRefused) {
  TestRandom random(9);
  for (int i = 0; i < 3000; ++i) {
    std::string bytes("\x02\x01\x21\x04\x00\x08\x00\x00\x00\x01\x00\x00\x40\x00\x00\x00", 16);
    for (int b = 0; b < 100; ++b) bytes += static_cast<char>(random.Next() * 256);
    if (i % 2 == 0) bytes[static_cast<size_t>(random.Next() * 16)] ^= static_cast<char>(random.Next() * 256);
    const auto unpacked = UnpackBlosc(bytes, 2048);
    EXPECT_EQ(unpacked ? unpacked->size() : 2048u, 2048u);
  }
}

}  // namespace
}  // namespace tessera
