#include "renderer/description/parameter_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "renderer/description/diagnostics.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

constexpr std::array<std::string_view, 3> kSpectrumTypes{"rgb", "spectrum", "blackbody"};
constexpr std::array<std::string_view, 5> kTexturableTypes{"texture", "float", "rgb", "spectrum",
                                                           "blackbody"};

// `Camera "perspective"`, or the directive alone where it has no kind.
std::string Subject(const Entity& entity) {
  if (entity.kind.empty()) return entity.directive;
  return fmt::format("{} {}", entity.directive, Quoted(entity.kind));
}

std::string Declaration(const Parameter& p) {
  return fmt::format("\"{} {}\"", p.type, p.name);
}

std::string Counted(size_t count) {
  return fmt::format("{} value{}", count, count == 1 ? "" : "s");
}

template <typename Value>
std::vector<Value> Triples(const std::vector<float>& v) {
  std::vector<Value> result;
  result.reserve(v.size() / 3);
  for (size_t i = 0; i + 2 < v.size(); i += 3) result.push_back({v[i], v[i + 1], v[i + 2]});
  return result;
}

}  // namespace

ParameterReader::ParameterReader(const Entity& entity)
    : entity_(&entity), used_(entity.parameters.size(), false) {}

const Parameter* ParameterReader::FindAny(std::span<const std::string_view> types,
                                          std::string_view name) const {
  const Parameter* found = nullptr;
  for (const Parameter& p : entity_->parameters) {
    if (p.name != name || std::find(types.begin(), types.end(), p.type) == types.end()) continue;
    if (!found || found->is_default == p.is_default) found = &p;  // written ones stand first
  }
  return found;
}

void ParameterReader::MarkUsed(const Parameter& parameter) {
  used_[static_cast<size_t>(&parameter - entity_->parameters.data())] = true;
}

const Parameter* ParameterReader::Find(std::string_view type, std::string_view name) {
  asked_.push_back({std::string(type), std::string(name)});
  const Parameter* p = FindAny(std::span(&type, 1), name);
  if (p) MarkUsed(*p);
  return p;
}

bool ParameterReader::FailCount(const Parameter& p, size_t found, const std::string& expected) {
  Fail(ErrorAt(p.location, fmt::format("{} of {} has {}, expected {}", Declaration(p), Subject(*entity_),
                                       Counted(found), expected)));
  return false;
}

const float* ParameterReader::FindNumbers(std::string_view type, std::string_view name, size_t count) {
  const Parameter* p = Find(type, name);
  if (!p) return nullptr;
  if (p->floats.size() == count) return p->floats.data();
  FailCount(*p, p->floats.size(), std::to_string(count));
  return nullptr;
}

std::vector<float> ParameterReader::FindTuples(std::string_view type, std::string_view name, size_t size) {
  const Parameter* p = Find(type, name);
  if (!p) return {};
  if (p->floats.size() % size == 0) return p->floats;
  FailCount(*p, p->floats.size(), fmt::format("a multiple of {}", size));
  return {};
}

// ---- Single values

std::optional<float> ParameterReader::FindFloat(std::string_view name) {
  const float* v = FindNumbers("float", name, 1);
  return v ? std::optional(*v) : std::nullopt;
}

std::optional<int> ParameterReader::FindInteger(std::string_view name) {
  const Parameter* p = Find("integer", name);
  if (!p) return std::nullopt;
  if (p->integers.size() == 1) return p->integers[0];
  FailCount(*p, p->integers.size(), "1");
  return std::nullopt;
}

std::optional<std::string> ParameterReader::FindStringOf(std::string_view type, std::string_view name) {
  const Parameter* p = Find(type, name);
  if (!p) return std::nullopt;
  if (p->strings.size() == 1) return p->strings[0];
  FailCount(*p, p->strings.size(), "1");
  return std::nullopt;
}

std::optional<std::string> ParameterReader::FindString(std::string_view name) {
  return FindStringOf("string", name);
}

float ParameterReader::Float(std::string_view name, float default_value) {
  return FindFloat(name).value_or(default_value);
}

int ParameterReader::Integer(std::string_view name, int default_value) {
  return FindInteger(name).value_or(default_value);
}

bool ParameterReader::Bool(std::string_view name, bool default_value) {
  const Parameter* p = Find("bool", name);
  if (!p) return default_value;
  if (p->bools.size() == 1) return p->bools[0];
  FailCount(*p, p->bools.size(), "1");
  return default_value;
}

std::string ParameterReader::String(std::string_view name, std::string_view default_value) {
  std::optional<std::string> value = FindString(name);
  return value ? *std::move(value) : std::string(default_value);
}

Point2 ParameterReader::Point2Value(std::string_view name, Point2 default_value) {
  const float* v = FindNumbers("point2", name, 2);
  return v ? Point2{v[0], v[1]} : default_value;
}

Point3 ParameterReader::Point3Value(std::string_view name, Point3 default_value) {
  const float* v = FindNumbers("point3", name, 3);
  return v ? Point3{v[0], v[1], v[2]} : default_value;
}

Vec3 ParameterReader::Vector3Value(std::string_view name, Vec3 default_value) {
  const float* v = FindNumbers("vector3", name, 3);
  return v ? Vec3{v[0], v[1], v[2]} : default_value;
}

std::string ParameterReader::OtherChoice(std::string_view name, const std::string& value,
                                         std::span<const std::string_view> allowed) const {
  std::string list;
  for (const std::string_view a : allowed) list += fmt::format("{}\"{}\"", list.empty() ? "" : ", ", a);
  return fmt::format("\"string {}\" of {} is {}, expected one of {}{}", name, Subject(*entity_),
                     Quoted(value), list, DidYouMean(value, allowed));
}

std::string ParameterReader::Choice(std::string_view name, std::string_view default_value,
                                    std::span<const std::string_view> allowed) {
  const std::optional<std::string> value = FindString(name);
  if (!value) return std::string(default_value);
  if (std::find(allowed.begin(), allowed.end(), *value) != allowed.end()) return *value;
  FailAt(name, OtherChoice(name, *value, allowed));
  return std::string(default_value);
}

std::string ParameterReader::ChoiceOrDefault(std::string_view name, std::string_view default_value,
                                             std::span<const std::string_view> allowed,
                                             Diagnostics& diagnostics) {
  const std::optional<std::string> value = FindString(name);
  if (!value) return std::string(default_value);
  if (std::find(allowed.begin(), allowed.end(), *value) != allowed.end()) return *value;
  diagnostics.Warn(LocationOf(name), fmt::format("{}; \"{}\" is used, as in pbrt",
                                                 OtherChoice(name, *value, allowed), default_value));
  return std::string(default_value);
}

std::optional<std::string> ParameterReader::FindTexture(std::string_view name) {
  // A value that was written later, or explicitly while the texture is a default, takes the texture's place.
  const Parameter* p = FindAny(kTexturableTypes, name);
  if (p && p->type != "texture") {
    asked_.push_back({"texture", std::string(name)});
    return std::nullopt;
  }
  if (p) {
    for (const std::string_view type : kTexturableTypes)  // which are now not used beside it
      asked_.push_back({std::string(type), std::string(name)});
  }
  return FindStringOf("texture", name);
}

// ---- Spectra

std::optional<SpectrumValue> ParameterReader::FindSpectrum(std::string_view name) {
  for (const std::string_view type : kSpectrumTypes) asked_.push_back({std::string(type), std::string(name)});
  const Parameter* p = FindAny(kSpectrumTypes, name);
  if (!p) return std::nullopt;
  MarkUsed(*p);
  SpectrumValue value;
  value.location = p->location;
  value.color_space = p->color_space;
  const bool valid = p->type == "rgb"         ? ReadRgb(*p, &value)
                     : p->type == "blackbody" ? ReadBlackbody(*p, &value)
                     : p->strings.empty()     ? ReadSamples(*p, &value)
                                              : ReadNamed(*p, &value);
  return valid ? std::optional(std::move(value)) : std::nullopt;
}

bool ParameterReader::ReadRgb(const Parameter& p, SpectrumValue* value) {
  value->form = SpectrumValue::Form::kRgb;
  if (p.floats.size() != 3) return FailCount(p, p.floats.size(), "3");
  value->rgb = {p.floats[0], p.floats[1], p.floats[2]};
  return true;
}

bool ParameterReader::ReadBlackbody(const Parameter& p, SpectrumValue* value) {
  value->form = SpectrumValue::Form::kBlackbody;
  if (p.floats.size() != 1) return FailCount(p, p.floats.size(), "1");
  value->kelvin = p.floats[0];
  if (value->kelvin > 0) return true;
  Fail(ErrorAt(p.location, fmt::format("{} of {} is {} kelvin, expected more than 0", Declaration(p),
                                       Subject(*entity_), value->kelvin)));
  return false;
}

bool ParameterReader::ReadNamed(const Parameter& p, SpectrumValue* value) {
  value->form = SpectrumValue::Form::kNamed;
  if (p.strings.size() != 1) return FailCount(p, p.strings.size(), "1");
  value->name = p.strings[0];
  return true;
}

bool ParameterReader::ReadSamples(const Parameter& p, SpectrumValue* value) {
  value->form = SpectrumValue::Form::kSamples;
  if (p.floats.size() % 2 != 0 || p.floats.empty()) {
    return FailCount(p, p.floats.size(), "pairs of wavelength and value");
  }
  for (size_t i = 0; i < p.floats.size(); i += 2) {
    if (i > 0 && p.floats[i] <= p.floats[i - 2]) {
      Fail(ErrorAt(p.location, fmt::format("{} of {} has wavelength {} after {}, expected rising wavelengths",
                                           Declaration(p), Subject(*entity_), p.floats[i], p.floats[i - 2])));
      return false;
    }
    value->wavelengths.push_back(p.floats[i]);
    value->values.push_back(p.floats[i + 1]);
  }
  return true;
}

// ---- Lists

std::vector<float> ParameterReader::Floats(std::string_view name) {
  return FindTuples("float", name, 1);
}

std::vector<int> ParameterReader::Integers(std::string_view name) {
  const Parameter* p = Find("integer", name);
  return p ? p->integers : std::vector<int>();
}

std::vector<std::string> ParameterReader::Strings(std::string_view name) {
  const Parameter* p = Find("string", name);
  return p ? p->strings : std::vector<std::string>();
}

std::vector<Point2> ParameterReader::Point2s(std::string_view name) {
  const std::vector<float> v = FindTuples("point2", name, 2);
  std::vector<Point2> result;
  result.reserve(v.size() / 2);
  for (size_t i = 0; i + 1 < v.size(); i += 2) result.push_back({v[i], v[i + 1]});
  return result;
}

std::vector<Point3> ParameterReader::Point3s(std::string_view name) {
  return Triples<Point3>(FindTuples("point3", name, 3));
}

std::vector<Vec3> ParameterReader::Vector3s(std::string_view name) {
  return Triples<Vec3>(FindTuples("vector3", name, 3));
}

std::vector<Normal3> ParameterReader::Normals(std::string_view name) {
  return Triples<Normal3>(FindTuples("normal", name, 3));
}

RgbList ParameterReader::Rgbs(std::string_view name) {
  RgbList list{Triples<Vec3>(FindTuples("rgb", name, 3)), "srgb"};
  if (const Parameter* p = Find("rgb", name)) list.color_space = p->color_space;
  return list;
}

// ---- Places and errors

bool ParameterReader::Has(std::string_view name) const {
  const auto& parameters = entity_->parameters;
  return std::any_of(parameters.begin(), parameters.end(),
                     [&](const Parameter& p) { return p.name == name; });
}

SourceLocation ParameterReader::LocationOf(std::string_view name) const {
  const Parameter* found = nullptr;
  for (const Parameter& p : entity_->parameters) {
    if (p.name != name) continue;
    if (!found || found->is_default == p.is_default) found = &p;
  }
  return found ? found->location : entity_->location;
}

void ParameterReader::Fail(const std::string& message) {
  Fail(ErrorAt(entity_->location, message));
}

void ParameterReader::FailAt(std::string_view name, const std::string& message) {
  Fail(ErrorAt(LocationOf(name), message));
}

void ParameterReader::Fail(const Error& error) {
  if (!error_) error_ = error;
}

void ParameterReader::IgnoreRest() {
  used_.assign(used_.size(), true);
}

bool ParameterReader::IsShadowed(const Parameter& unused) const {
  for (size_t i = 0; i < used_.size(); ++i) {
    const Parameter& p = entity_->parameters[i];
    if (used_[i] && p.type == unused.type && p.name == unused.name) return true;
  }
  return false;
}

Error ParameterReader::UnknownParameter(const Parameter& p) const {
  std::string types;
  std::vector<std::string_view> names;
  for (const Asked& asked : asked_) {
    names.push_back(asked.name);
    const std::string type = fmt::format("\"{} {}\"", asked.type, asked.name);
    if (asked.name == p.name && types.find(type) == std::string::npos) {
      types += (types.empty() ? "" : " or ") + type;
    }
  }
  if (types.find(Declaration(p)) != std::string::npos) {
    return ErrorAt(p.location, fmt::format("{} of {} is not used beside its other values", Declaration(p),
                                           Subject(*entity_)));
  }
  if (!types.empty()) {
    return ErrorAt(p.location, fmt::format("{} of {} has the wrong type, expected {}", Declaration(p),
                                           Subject(*entity_), types));
  }
  return ErrorAt(p.location, fmt::format("unknown parameter {} of {}{}", Declaration(p), Subject(*entity_),
                                         DidYouMean(p.name, names)));
}

Result<void> ParameterReader::Finish() {
  if (error_) return *error_;
  // Each name is looked up once, as a file may repeat it a million times.
  std::set<std::pair<std::string_view, std::string_view>> shadowed;
  for (size_t i = 0; i < used_.size(); ++i) {
    const Parameter& p = entity_->parameters[i];
    if (used_[i] || p.is_default || shadowed.contains({p.type, p.name})) continue;
    if (!IsShadowed(p)) return UnknownParameter(p);
    shadowed.emplace(p.type, p.name);
  }
  return {};
}

}  // namespace tessera
