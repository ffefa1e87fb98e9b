// Reads the parameters of one Entity, each by exact type and name. Remembers the first error and which
// parameters were read, so that a kind reads all that it knows and checks once, with Finish(), whether all
// was well.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/description/scene_description.h"
#include "renderer/math/vec.h"
#include "renderer/util/result.h"

namespace tessera {

class Diagnostics;

// A parameter of type rgb, spectrum or blackbody, not yet a Spectrum (color/ makes it one).
struct SpectrumValue {
  enum class Form { kRgb, kBlackbody, kSamples, kNamed };
  Form form = Form::kRgb;
  Vec3 rgb;
  std::string color_space;         // of kRgb
  float kelvin = 0;                // of kBlackbody
  std::vector<float> wavelengths;  // of kSamples: nm, strictly rising
  std::vector<float> values;
  std::string name;  // of kNamed: a named spectrum or a file of pairs
  SourceLocation location;
};

// The colours of an rgb parameter with any number of them.
struct RgbList {
  std::vector<Vec3> values;
  std::string color_space;
};

class ParameterReader {
 public:
  // `entity` must outlive the reader.
  explicit ParameterReader(const Entity& entity);

  const Entity& entity() const { return *entity_; }

  // Single values: the default where there is none; a wrong count or a bad value is remembered as an error
  // and gives the default. Numbers are finite.
  float Float(std::string_view name, float default_value);
  int Integer(std::string_view name, int default_value);
  bool Bool(std::string_view name, bool default_value);
  std::string String(std::string_view name, std::string_view default_value);
  Point2 Point2Value(std::string_view name, Point2 default_value);
  Point3 Point3Value(std::string_view name, Point3 default_value);
  Vec3 Vector3Value(std::string_view name, Vec3 default_value);
  std::optional<float> FindFloat(std::string_view name);
  std::optional<int> FindInteger(std::string_view name);
  std::optional<std::string> FindString(std::string_view name);
  // One of `allowed`; any other value is an error that lists them and suggests the nearest.
  std::string Choice(std::string_view name, std::string_view default_value,
                     std::span<const std::string_view> allowed);
  // The same, but any other value is a warning, and gives the default.
  std::string ChoiceOrDefault(std::string_view name, std::string_view default_value,
                              std::span<const std::string_view> allowed, Diagnostics& diagnostics);
  // The texture that `texture name` refers to.
  std::optional<std::string> FindTexture(std::string_view name);
  // An rgb, spectrum or blackbody parameter.
  std::optional<SpectrumValue> FindSpectrum(std::string_view name);

  // Lists; empty where there is none.
  std::vector<float> Floats(std::string_view name);
  std::vector<int> Integers(std::string_view name);
  std::vector<std::string> Strings(std::string_view name);
  std::vector<Point2> Point2s(std::string_view name);
  std::vector<Point3> Point3s(std::string_view name);
  std::vector<Vec3> Vector3s(std::string_view name);
  std::vector<Normal3> Normals(std::string_view name);
  RgbList Rgbs(std::string_view name);

  // Whether a parameter of this name, of any type, was written.
  bool Has(std::string_view name) const;
  // Where the parameter of this name was written, or the entity if there is none.
  SourceLocation LocationOf(std::string_view name) const;

  // Remembers an error at the entity, or at one of its parameters. Only the first is kept.
  void Fail(const std::string& message);
  void FailAt(std::string_view name, const std::string& message);
  void Fail(const Error& error);  // already has its place
  bool failed() const { return error_.has_value(); }
  // Counts every parameter as read: for kinds that ignore their parameters.
  void IgnoreRest();
  // The first error: one remembered, or a parameter that was not read ("unknown parameter ... of Camera").
  Result<void> Finish();

 private:
  struct Asked {
    std::string type, name;
  };

  // The message for a value that is none of `allowed`.
  std::string OtherChoice(std::string_view name, const std::string& value,
                          std::span<const std::string_view> allowed) const;
  // The last parameter of this type and name, marked as read; written ones before defaults.
  const Parameter* Find(std::string_view type, std::string_view name);
  // The same for several types, not marked.
  const Parameter* FindAny(std::span<const std::string_view> types, std::string_view name) const;
  void MarkUsed(const Parameter& parameter);

  // The values of a parameter with exactly `count` numbers; null if there is none or it was wrong.
  const float* FindNumbers(std::string_view type, std::string_view name, size_t count);
  // A multiple of `size` numbers.
  std::vector<float> FindTuples(std::string_view type, std::string_view name, size_t size);
  std::optional<std::string> FindStringOf(std::string_view type, std::string_view name);
  bool ReadRgb(const Parameter& p, SpectrumValue* value);
  bool ReadBlackbody(const Parameter& p, SpectrumValue* value);
  bool ReadNamed(const Parameter& p, SpectrumValue* value);
  bool ReadSamples(const Parameter& p, SpectrumValue* value);

  // Always returns false, for use as a return value.
  bool FailCount(const Parameter& p, size_t found, const std::string& expected);
  // Whether a parameter of the same type and name was read instead.
  bool IsShadowed(const Parameter& unused) const;
  Error UnknownParameter(const Parameter& p) const;

  const Entity* entity_;
  std::vector<bool> used_;
  std::vector<Asked> asked_;  // what the kind asked for, for suggestions
  std::optional<Error> error_;
};

}  // namespace tessera
