#include "renderer/material/measured_brdf_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "renderer/material/tensor_file.h"

namespace tessera {
namespace {

using Type = TensorField::Type;

constexpr uint64_t kResolutionMax = 1 << 14;  // of a grid: measurements have less than a hundred
constexpr float kTurnTolerance = 0.05f;       // radians by which azimuths may miss a full turn

// The arrays of one file. Remembers the first error, so that all are read and checked once.
class BrdfArrays {
 public:
  explicit BrdfArrays(const TensorFile& file) : file_(file) {}

  // Null after an error.
  const TensorField* Find(const std::string& name, Type type, size_t dimensions) {
    const Result<const TensorField*> field = file_.Find(name, type, dimensions);
    if (!field) {
      Fail(field.error());
      return nullptr;
    }
    return *field;
  }

  // The values of a parameter of the tables.
  std::vector<float> Rising(const std::string& name) {
    const std::vector<float> values = Floats(name, Find(name, Type::kFloat32, 1));
    if (values.empty()) Fail(name, "is empty");
    for (size_t i = 1; i < values.size(); ++i) {
      if (!(values[i] > values[i - 1])) Fail(name, "does not rise");
    }
    return values;
  }

  // A table of grids over `parameters`. It may not be used after an error.
  template <int kParameters>
  typename Warp2D<kParameters>::Table Table(const std::string& name,
                                            std::array<std::vector<float>, kParameters> parameters,
                                            bool may_be_negative = false) {
    typename Warp2D<kParameters>::Table table;
    const TensorField* const field = Find(name, Type::kFloat32, kParameters + 2);
    table.values = Floats(name, field);
    if (field == nullptr) return table;
    for (size_t i = 0; i < kParameters; ++i) {
      if (field->shape[i] != parameters[i].size()) Fail(name, "has another shape than its parameters");
    }
    for (size_t i = kParameters; i < kParameters + 2; ++i) {
      if (field->shape[i] < 2 || field->shape[i] > kResolutionMax) {
        Fail(name, fmt::format("must have a resolution from 2 to {}", kResolutionMax));
        return table;
      }
    }
    if (!may_be_negative &&
        std::any_of(table.values.begin(), table.values.end(), [](float v) { return v < 0; })) {
      Fail(name, "has a negative value");
    }
    table.rows = static_cast<int>(field->shape[kParameters]);
    table.columns = static_cast<int>(field->shape[kParameters + 1]);
    table.parameter_values = std::move(parameters);
    return table;
  }

  void Fail(const std::string& name, const std::string& problem) {
    Fail(BadInput(fmt::format("array \"{}\" {}", name, problem)));
  }
  const std::optional<Error>& error() const { return error_; }

 private:
  std::vector<float> Floats(const std::string& name, const TensorField* field) {
    if (field == nullptr) return {};
    Result<std::vector<float>> values = TensorFile::Floats(name, *field);
    if (values) return std::move(*values);
    Fail(values.error());
    return {};
  }
  void Fail(const Error& error) {
    if (!error_) error_ = error;
  }

  const TensorFile& file_;
  std::optional<Error> error_;
};

}  // namespace

Result<MeasuredBrdf> ReadMeasuredBrdf(std::string_view bytes) {
  const Result<TensorFile> file = TensorFile::Parse(bytes);
  if (!file) return file.error();
  BrdfArrays arrays(*file);
  const std::vector<float> phi = arrays.Rising("phi_i"), theta = arrays.Rising("theta_i");
  const std::vector<float> wavelengths = arrays.Rising("wavelengths");
  // Of no influence, but files without them are of another kind.
  arrays.Find("description", Type::kUint8, 1);
  arrays.Find("jacobian", Type::kUint8, 1);
  auto ndf = arrays.Table<0>("ndf", {});
  auto sigma = arrays.Table<0>("sigma", {});
  auto vndf = arrays.Table<2>("vndf", {phi, theta});
  auto luminance = arrays.Table<2>("luminance", {phi, theta});
  auto spectra = arrays.Table<3>("spectra", {phi, theta, wavelengths}, true);
  const bool is_isotropic = phi.size() <= 2;
  if (!arrays.error() && !is_isotropic && std::abs(phi.back() - phi.front() - 2 * kPi) > kTurnTolerance) {
    arrays.Fail("phi_i", "does not cover all azimuths, which is not supported");
  }
  if (arrays.error()) return *arrays.error();
  return MeasuredBrdf{
      Warp2D<0>::ForEvaluation(std::move(ndf)),     Warp2D<0>::ForEvaluation(std::move(sigma)),
      Warp2D<2>::ForSampling(std::move(vndf)),      Warp2D<2>::ForSampling(std::move(luminance)),
      Warp2D<3>::ForEvaluation(std::move(spectra)), is_isotropic};
}

}  // namespace tessera
