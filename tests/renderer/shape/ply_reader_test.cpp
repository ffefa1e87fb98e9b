// PLY files in every encoding, and everything that can be wrong with them.
#include "renderer/shape/ply_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "tests/chi_square.h"

namespace tessera {
namespace {

using testing::HasSubstr;

// Writes numbers as a PLY body of one of the three formats.
class Body {
 public:
  explicit Body(std::string format) : format_(std::move(format)) {}

  template <typename T>
  Body& Add(T value) {
    if (format_ == "ascii") {
      text += std::to_string(value) + " ";
      return *this;
    }
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof value);
    if (format_ == "binary_big_endian") std::reverse(bytes, bytes + sizeof value);
    text.append(bytes, sizeof value);
    return *this;
  }
  std::string text;

 private:
  std::string format_;
};

// Two triangles, a quad and a pentagon on five vertices, with unused properties in between.
std::string Example(const std::string& format) {
  std::string header =
      "ply\nformat " + format +
      " 1.0\ncomment made by hand\nelement material 1\nproperty list uchar short ignored\n"
      "element vertex 5\nproperty double y\nproperty uchar red\nproperty float x\nproperty short z\n"
      "property float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\n"
      "element face 4\nproperty uchar flags\nproperty list uchar int vertex_indices\n"
      "property list int float weights\nend_header\n";
  Body body(format);
  body.Add<uint8_t>(2).Add<int16_t>(-5).Add<int16_t>(6);
  for (int i = 0; i < 5; ++i) {
    body.Add<double>(i + 0.5).Add<uint8_t>(200).Add<float>(i * 2.f).Add<int16_t>(static_cast<int16_t>(-i));
    body.Add<float>(0).Add<float>(0).Add<float>(1).Add<float>(i * 0.25f).Add<float>(1);
  }
  const std::vector<std::vector<int32_t>> faces{{0, 1, 2}, {0, 1, 2, 3}, {0, 1, 2, 3, 4}, {4, 3, 2}};
  for (const auto& face : faces) {
    body.Add<uint8_t>(1).Add<uint8_t>(static_cast<uint8_t>(face.size()));
    for (const int32_t i : face) body.Add<int32_t>(i);
    body.Add<int32_t>(1).Add<float>(0.5f);
  }
  return header + body.text;
}

TEST(PlyReader, EveryEncodingHoldsTheSameMesh) {
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    const Result<PlyMesh> mesh = ReadPly(Example(format), "a.ply");
    ASSERT_TRUE(mesh.has_value()) << format << mesh.error().message;
    ASSERT_EQ(mesh->P.size(), 5u);
    EXPECT_EQ(mesh->P[3], (Point3{6, 3.5f, -3}));
    EXPECT_EQ(mesh->N[3], (Normal3{0, 0, 1}));
    EXPECT_EQ(mesh->uv[3], (Point2{0.75f, 1}));
    EXPECT_EQ(mesh->triangles, (std::vector<uint32_t>{0, 1, 2, 4, 3, 2}));
    EXPECT_EQ(mesh->quads, (std::vector<uint32_t>{0, 1, 3, 2}));  // in the order of a patch
    EXPECT_EQ(mesh->skipped_faces, 1u);
  }
}

const std::string kTriangleHeader =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n";

TEST(PlyReader, LinesMayEndInCarriageReturns) {
  std::string text = kTriangleHeader + "0 0 0\n1 0 0\n+0 1e0 0\n3 0 1 2\n";
  for (size_t at = 0; (at = text.find('\n', at)) != text.npos; at += 2) text.insert(at, "\r");
  const Result<PlyMesh> mesh = ReadPly(text, "a.ply");
  ASSERT_TRUE(mesh.has_value()) << mesh.error().message;
  EXPECT_EQ(mesh->P[2], (Point3{0, 1, 0}));
}

TEST(PlyReader, LinesMayEndInCarriageReturnsAlone) {
  std::string text = kTriangleHeader + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  text.insert(text.find("element"), "comment by a Macintosh\n");
  std::ranges::replace(text, '\n', '\r');
  const Result<PlyMesh> mesh = ReadPly(text, "a.ply");
  ASSERT_TRUE(mesh.has_value()) << mesh.error().message;
  EXPECT_EQ(mesh->P[2], (Point3{0, 1, 0}));
  // In binary the first byte after the header may be a line feed.
  std::string binary =
      "ply\rformat binary_little_endian 1.0\relement vertex 1\rproperty uchar a\rproperty float x\r"
      "property float y\rproperty float z\relement face 1\rproperty list uchar uchar "
      "vertex_indices\rend_header\r";
  binary += '\n' + std::string(12, '\0') + std::string("\3\0\0\0", 4);
  const Result<PlyMesh> point = ReadPly(binary, "a.ply");
  ASSERT_TRUE(point.has_value()) << point.error().message;
  EXPECT_EQ(point->P[0], (Point3{0, 0, 0}));
}

TEST(PlyReader, TinyNumbersAreZeroAndDoublesAreReadAsDoubles) {
  std::string text =
      kTriangleHeader + "2.2958450216584675e-49 -1.07797e-046 1e-400\n1 4.9e-324 0\n0 1 0\n3 0 1 2\n";
  for (const std::string type : {"float", "double"}) {
    for (size_t at = 0; type == "double" && (at = text.find("float", at)) != text.npos;)
      text.replace(at, 5, type);
    const Result<PlyMesh> mesh = ReadPly(text, "a.ply");
    ASSERT_TRUE(mesh.has_value()) << mesh.error().message;
    EXPECT_EQ(mesh->P[0], (Point3{0, 0, 0}));
    EXPECT_EQ(mesh->P[1], (Point3{1, 0, 0}));
  }
  // A double next to the middle between two floats: rounded once, it goes up, rounded twice, down.
  text.replace(text.find("0 1 0"), 5, "0 1.00000005960464477540 0");
  EXPECT_EQ(ReadPly(text, "a.ply")->P[2].y, static_cast<float>(1.00000005960464477540));
}

TEST(PlyReader, PositionsThatNoFaceUsesMayBeAnything) {
  const std::string body = "0 0 0\n1 0 0\n0 1 0\n";
  for (const std::string unused : {"nan nan nan", "0 inf 0", "1e400 0 0"}) {
    std::string text = kTriangleHeader + body + unused + "\n3 0 1 2\n";
    text.replace(text.find("vertex 3"), 8, "vertex 4");
    const Result<PlyMesh> mesh = ReadPly(text, "a.ply");
    ASSERT_TRUE(mesh.has_value()) << mesh.error().message;
    EXPECT_EQ(mesh->triangles, (std::vector<uint32_t>{0, 1, 2}));
    for (const Point3 p : mesh->P) EXPECT_TRUE(IsFinite(p));
    text.replace(text.find("3 0 1 2"), 7, "3 0 1 3");
    EXPECT_EQ(ReadPly(text, "a.ply").error().message, "a.ply: the position of vertex 3 is not finite");
  }
}

std::string ErrorOf(const std::string& bytes) {
  const Result<PlyMesh> mesh = ReadPly(bytes, "models/x.ply");
  return mesh ? "no error" : mesh.error().message;
}

TEST(PlyReader, EveryTruncationIsAnError) {
  for (const char* format : {"binary_little_endian", "binary_big_endian"}) {
    const std::string whole = Example(format);
    for (size_t size = 0; size < whole.size(); ++size) {
      const std::string error = ErrorOf(whole.substr(0, size));
      ASSERT_THAT(error, HasSubstr("models/x.ply")) << size;
      if (size >= whole.find("end_header\n") + 11) {
        ASSERT_THAT(error, HasSubstr("truncated")) << size;
      }
    }
  }
  EXPECT_EQ(ErrorOf(kTriangleHeader + "0 0 0\n1 0 0\n0 1 0\n3 0 1"),
            "models/x.ply: truncated: face 0 of 1 is cut off");
  EXPECT_EQ(ErrorOf(kTriangleHeader + "0 0 0\n1 0"), "models/x.ply: truncated: vertex 1 of 3 is cut off");
}

TEST(PlyReader, FalseCountsAllocateNoMemory) {
  for (const char* count : {"4000000000", "1000000000000000", "18446744073709551615"}) {
    std::string text = kTriangleHeader + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    text.replace(text.find("vertex 3") + 7, 1, count);
    EXPECT_THAT(ErrorOf(text), HasSubstr("truncated: the header announces"));
    text = Example("binary_little_endian");
    text.replace(text.find("face 4") + 5, 1, count);
    EXPECT_THAT(ErrorOf(text), HasSubstr("truncated: the header announces"));
  }
}

TEST(PlyReader, ErrorsNameTheProblem) {
  const std::string body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = kTriangleHeader + body;
    text.replace(text.find(from), from.size(), to);
    return ErrorOf(text);
  };
  EXPECT_EQ(ErrorOf(""), "models/x.ply: not a PLY file: it does not start with \"ply\"");
  EXPECT_EQ(with("ply", "PNG"), "models/x.ply: not a PLY file: it does not start with \"ply\"");
  EXPECT_EQ(with("end_header\n", ""), "models/x.ply:9: unknown header line \"0\"");
  EXPECT_EQ(with("format ascii 1.0\n", ""), "models/x.ply:8: the header names no format");
  EXPECT_EQ(with("ascii", "morse"), "models/x.ply:2: unknown format \"morse\"");
  EXPECT_EQ(with("vertex 3", "vertex -3"), "models/x.ply:3: \"-3\" is not a number of elements");
  EXPECT_EQ(with("float x", "quad x"), "models/x.ply:4: unknown property type");
  EXPECT_EQ(with("float x", "float w"), "models/x.ply: vertices have no properties x, y and z");
  EXPECT_EQ(with("vertex_indices", "corners"), "models/x.ply: faces have no list \"vertex_indices\"");
  EXPECT_EQ(with("uchar int", "float int"),
            "models/x.ply:8: the length of a list must be of an integer type");
  EXPECT_EQ(with("uchar int", "uchar float"), "models/x.ply: vertex indices are not of an integer type");
  EXPECT_EQ(with("element face 1", "element face 0"), "models/x.ply: holds no faces");
  EXPECT_EQ(with("1 0 0", "1 x 0"), "models/x.ply: vertex 1 of 3 is not written in numbers");
  EXPECT_EQ(with("1 0 0", "1 nan 0"), "models/x.ply: the position of vertex 1 is not finite");
  EXPECT_EQ(with("3 0 1 2", "3 0 1 7"), "models/x.ply: a face refers to vertex 7, but there are 3");
  EXPECT_EQ(with("3 0 1 2", "3 0 -1 2"), "models/x.ply: a face refers to vertex -1, but there are 3");
  EXPECT_EQ(with("3 0 1 2", "2 0 1"), "models/x.ply: holds no triangles or quads");
  EXPECT_EQ(with("3 0 1 2", "5 0 1 2 0 1"), "models/x.ply: holds no triangles or quads");
}

// Any bytes give a valid mesh or an error.
TEST(PlyReader, DamagedFilesGiveAValidMeshOrAnError) {
  TestRandom random(1);
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    const std::string whole = Example(format);
    for (int i = 0; i < 20000; ++i) {
      std::string damaged = whole;
      const int count = 1 + static_cast<int>(random.Next() * 4);
      for (int j = 0; j < count; ++j) {
        const size_t at = static_cast<size_t>(random.Next() * damaged.size());
        damaged[at] = static_cast<char>(random.Next() * 256);
      }
      const Result<PlyMesh> mesh = ReadPly(damaged, "x.ply");
      if (!mesh) continue;
      for (const uint32_t index : mesh->triangles) ASSERT_LT(index, mesh->P.size());
      for (const uint32_t index : mesh->quads) ASSERT_LT(index, mesh->P.size());
      for (const Point3 p : mesh->P) ASSERT_TRUE(IsFinite(p));
    }
  }
}

}  // namespace
}  // namespace tessera
