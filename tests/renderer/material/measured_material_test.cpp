// Measured BRDFs from files: what is read, and what is refused.
#include "renderer/material/measured_brdf_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "renderer/material/tensor_file.h"
#include "tests/chi_square.h"
#include "tests/renderer/bxdf/bxdf_examples.h"
#include "tests/renderer/bxdf/measured_tables.h"
#include "tests/renderer/material/material_scene.h"

namespace tessera {
namespace {

using testing::HasSubstr;

struct TestField {
  std::string name;
  TensorField::Type type;
  std::vector<uint64_t> shape;
  std::string bytes;
};

std::string LittleEndian(uint64_t value, int size) {
  std::string bytes;
  for (int i = 0; i < size; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xff);
  return bytes;
}

std::string TensorBytes(const std::vector<TestField>& fields) {
  size_t header = 18;
  for (const TestField& field : fields) header += 13 + field.name.size() + 8 * field.shape.size();
  std::string bytes("tensor_file\0\1\0", 14);
  bytes += LittleEndian(fields.size(), 4);
  std::string data;
  for (const TestField& field : fields) {
    bytes += LittleEndian(field.name.size(), 2) + field.name + LittleEndian(field.shape.size(), 2);
    bytes += LittleEndian(static_cast<uint64_t>(field.type), 1) + LittleEndian(header + data.size(), 8);
    for (const uint64_t size : field.shape) bytes += LittleEndian(size, 8);
    data += field.bytes;
  }
  return bytes + data;
}

TestField FloatField(const std::string& name, const std::vector<float>& values, std::vector<uint64_t> shape) {
  std::string bytes(values.size() * sizeof(float), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return {name, TensorField::Type::kFloat32, std::move(shape), bytes};
}

std::vector<TestField> FieldsOf(const MeasuredTables& t) {
  const auto n = static_cast<uint64_t>(t.resolution);
  const uint64_t phi = t.phi.size(), theta = t.theta.size(), wavelengths = t.wavelengths.size();
  return {FloatField("phi_i", t.phi, {phi}),
          FloatField("theta_i", t.theta, {theta}),
          FloatField("wavelengths", t.wavelengths, {wavelengths}),
          FloatField("ndf", t.ndf, {n, n}),
          FloatField("sigma", t.sigma, {n, n}),
          FloatField("vndf", t.vndf, {phi, theta, n, n}),
          FloatField("luminance", t.luminance, {phi, theta, n, n}),
          FloatField("spectra", t.spectra, {phi, theta, wavelengths, n, n}),
          {"description", TensorField::Type::kUint8, {4}, "test"},
          {"jacobian", TensorField::Type::kUint8, {1}, "\1"}};
}

std::vector<TestField> SmallMeasurement() {
  return FieldsOf(MeasureMetal({0.4f, 0.4f}, true, 4));
}

TEST(MeasuredMaterial, ReadsTheTablesOfItsFile) {
  const MeasuredTables tables = MeasureMetal({0.3f, 0.5f}, false, 8);
  const Result<MeasuredBrdf> read = ReadMeasuredBrdf(TensorBytes(FieldsOf(tables)));
  ASSERT_TRUE(read) << read.error().message;
  const MeasuredBrdf made = MakeMeasuredBrdf(tables);
  EXPECT_FALSE(read->is_isotropic);
  for (const float cosine : {0.9f, 0.4f}) {
    const Vec3 wo = DirectionAt(cosine, 1), wi = DirectionAt(0.7f, 3.5f);
    const BsdfEvaluation a = MeasuredBxdf(*read, {410, 500, 600, 690}).Evaluate(wo, wi);
    const BsdfEvaluation b = MeasuredBxdf(made, {410, 500, 600, 690}).Evaluate(wo, wi);
    EXPECT_EQ(a.pdf, b.pdf);
    for (int i = 0; i < 4; ++i) EXPECT_EQ(a.f[i], b.f[i]);
  }
}

TEST(MeasuredMaterial, IsBuiltFromAScene) {
  Materials m(R"(Material "measured" "string filename" "metal.bsdf")",
              {{"metal.bsdf", TensorBytes(SmallMeasurement())}});
  ASSERT_EQ(m.error, "");
  const Bsdf bsdf = m.Evaluate();
  EXPECT_TRUE(bsdf.Sample(m.interaction.wo, 0.5f, {0.4f, 0.6f}));
  EXPECT_FALSE(m.table.NeedsFootprint(m.last));
  EXPECT_FALSE(m.wavelengths.SecondaryTerminated());
}

TEST(MeasuredMaterial, MaterialsOfOneFileReadItOnce) {
  Materials m(R"(MakeNamedMaterial "a" "string type" "measured" "string filename" "metal.bsdf"
                 MakeNamedMaterial "b" "string type" "measured" "string filename" "metal.bsdf")",
              {{"metal.bsdf", TensorBytes(SmallMeasurement())}});
  ASSERT_EQ(m.error, "");
  EXPECT_EQ(m.FileReads(), 1);
}

TEST(MeasuredMaterial, ErrorsNameTheFileAndItsPlace) {
  Materials without(R"(Material "measured")");
  EXPECT_THAT(without.error,
              HasSubstr("test.pbrt:2:1: material \"measured\" needs a parameter \"string filename\""));
  Materials missing(R"(Material "measured" "string filename" "no.bsdf")");
  EXPECT_THAT(missing.error, HasSubstr("test.pbrt:2:21: measured BRDF \"no.bsdf\": "));
  Materials text(R"(Material "measured" "string filename" "text.bsdf")", {{"text.bsdf", "not a tensor"}});
  EXPECT_EQ(text.error, "test.pbrt:2:21: measured BRDF \"text.bsdf\": not a tensor file");
}

// The error of a measurement of which one array is changed.
template <typename Change>
std::string ErrorAfter(const std::string& name, const Change& change) {
  std::vector<TestField> fields = SmallMeasurement();
  for (TestField& field : fields) {
    if (field.name == name) change(field);
  }
  const Result<MeasuredBrdf> read = ReadMeasuredBrdf(TensorBytes(fields));
  return read ? "" : read.error().message;
}

void SetFloat(TestField& field, size_t index, float value) {
  std::memcpy(field.bytes.data() + index * sizeof value, &value, sizeof value);
}

TEST(MeasuredMaterial, ArraysThatDoNotBelongTogetherAreRefused) {
  EXPECT_EQ(ErrorAfter("ndf", [](TestField&) {}), "");
  EXPECT_THAT(ErrorAfter("ndf", [](TestField& f) { f.name = "mdf"; }), HasSubstr("no array \"ndf\""));
  EXPECT_THAT(ErrorAfter("phi_i", [](TestField& f) { f.name = "ndf"; }), HasSubstr("two arrays \"ndf\""));
  EXPECT_THAT(ErrorAfter("ndf", [](TestField& f) { f.shape = {16}; }), HasSubstr("2 dimensions"));
  EXPECT_THAT(ErrorAfter("jacobian", [](TestField& f) { f.type = TensorField::Type::kFloat32; }),
              HasSubstr("reaches beyond"));
  EXPECT_THAT(ErrorAfter("vndf", [](TestField& f) { f.shape[1] = 13; }), HasSubstr("another shape"));
  EXPECT_THAT(ErrorAfter("ndf", [](TestField& f) { f.shape = {1, 16}; }), HasSubstr("resolution"));
  EXPECT_THAT(ErrorAfter("theta_i", [](TestField& f) { SetFloat(f, 3, 0); }), HasSubstr("does not rise"));
  EXPECT_THAT(ErrorAfter("sigma", [](TestField& f) { SetFloat(f, 3, -1); }), HasSubstr("negative"));
  EXPECT_THAT(ErrorAfter("spectra", [](TestField& f) { SetFloat(f, 3, NAN); }), HasSubstr("not finite"));
  EXPECT_EQ(ErrorAfter("spectra", [](TestField& f) { SetFloat(f, 3, -0.01f); }), "")
      << "noise of measurements";
  std::vector<TestField> half = FieldsOf(MeasureMetal({0.4f, 0.4f}, false, 2));
  SetFloat(half[0], 0, -4);
  const Result<MeasuredBrdf> read = ReadMeasuredBrdf(TensorBytes(half));
  ASSERT_FALSE(read);
  EXPECT_THAT(read.error().message, HasSubstr("all azimuths"));
}

TEST(MeasuredMaterial, HugeShapesAndOffsetsAreRefused) {
  for (const uint64_t size : {uint64_t{1} << 20, uint64_t{1} << 40, ~uint64_t{0}}) {
    EXPECT_THAT(ErrorAfter("spectra", [&](TestField& f) { f.shape[4] = size; }), HasSubstr("reaches beyond"));
    EXPECT_THAT(ErrorAfter("spectra",
                           [&](TestField& f) {
                             f.shape = {size, size, size, size, size};
                           }),
                HasSubstr("reaches beyond"));
  }
  EXPECT_THAT(ErrorAfter("ndf", [](TestField& f) { f.shape.assign(60000, 1); }), HasSubstr("dimensions"));
}

// Whatever a file holds: it is read or refused, and what was read gives finite values.
void ReadAndUse(const std::string& bytes) {
  const Result<MeasuredBrdf> read = ReadMeasuredBrdf(bytes);
  if (!read) return;
  const MeasuredBxdf bxdf(*read, {400, 500, 600, 700});
  const auto s = bxdf.Sample(DirectionAt(0.5f, 1), 0.5f, {0.3f, 0.6f});
  if (!s) return;
  EXPECT_TRUE(std::isfinite(s->pdf) && AllFinite(s->f));
}

TEST(MeasuredMaterial, CutAndDamagedFilesAreHarmless) {
  const std::string whole = TensorBytes(SmallMeasurement());
  for (size_t length = 0; length < whole.size(); length += length < 600 ? 1 : 997) {
    EXPECT_FALSE(ReadMeasuredBrdf(whole.substr(0, length))) << length;
  }
  TestRandom random(41);
  for (int n = 0; n < 3000; ++n) {
    std::string damaged = whole;
    const size_t range = n % 2 == 0 ? 600 : whole.size();
    damaged[static_cast<size_t>(random.Next() * static_cast<float>(range))] ^= static_cast<char>(1 << n % 8);
    ReadAndUse(damaged);
  }
}

}  // namespace
}  // namespace tessera
