#include "coordinator/web/api/job_order.h"

#include <fmt/format.h>

#include <charconv>
#include <nlohmann/json.hpp>
#include <set>

#include "proto/frame_range.h"
#include "renderer/film/frame_spec.h"

namespace tessera {
namespace {

using nlohmann::json;

// Reads the members of an object. The first one that is wrong decides the error.
class Members {
 public:
  Members(const json& object, std::string prefix) : object_(object), prefix_(std::move(prefix)) {}

  std::optional<int64_t> Whole(const char* name, int64_t min, int64_t max) {
    const json* const member = Find(name);
    if (member == nullptr) return std::nullopt;
    const bool is_right = member->is_number_integer() &&
                          (!member->is_number_unsigned() || member->get<uint64_t>() <= uint64_t{INT64_MAX}) &&
                          member->get<int64_t>() >= min && member->get<int64_t>() <= max;
    if (is_right) return member->get<int64_t>();
    Fail(name, fmt::format("expected a whole number from {} to {}", min, max));
    return std::nullopt;
  }
  std::optional<double> Number(const char* name, double min, double max) {
    const json* const member = Find(name);
    if (member == nullptr) return std::nullopt;
    if (member->is_number() && member->get<double>() >= min && member->get<double>() <= max)
      return member->get<double>();
    Fail(name, fmt::format("expected a number from {} to {}", min, max));
    return std::nullopt;
  }
  std::optional<std::string> Text(const char* name, size_t bytes_max) {
    const json* const member = Find(name);
    if (member == nullptr) return std::nullopt;
    if (member->is_string() && member->get_ref<const std::string&>().size() <= bytes_max)
      return member->get<std::string>();
    Fail(name, fmt::format("expected a text of at most {} bytes", bytes_max));
    return std::nullopt;
  }
  std::optional<bool> Flag(const char* name) {
    const json* const member = Find(name);
    if (member == nullptr) return std::nullopt;
    if (member->is_boolean()) return member->get<bool>();
    Fail(name, "expected true or false");
    return std::nullopt;
  }
  const json* Object(const char* name) {
    const json* const member = Find(name);
    if (member == nullptr || member->is_object()) return member;
    Fail(name, "expected an object");
    return nullptr;
  }
  void Fail(const std::string& name, const std::string& what) {
    if (error_.empty()) error_ = fmt::format("{}{}: {}", prefix_, name, what);
  }
  // Call it last: what was not asked for is unknown.
  const std::string& Finish() {
    for (const auto& [name, value] : object_.items()) {
      if (!asked_.contains(name)) Fail("", "unknown member; see /api/v1/openapi.json");
    }
    return error_;
  }

 private:
  const json* Find(const char* name) {
    asked_.insert(name);
    const auto member = object_.find(name);
    return member == object_.end() ? nullptr : &*member;
  }
  const json& object_;
  const std::string prefix_;
  std::set<std::string> asked_;
  std::string error_;
};

std::string ShortestText(double value) {
  char text[64];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

// Names separated by commas, each once and in order.
std::string Sorted(const std::string& list) {
  std::set<std::string> names;
  for (size_t start = 0; start <= list.size();) {
    const size_t end = std::min(list.find(',', start), list.size());
    names.insert(list.substr(start, end - start));
    start = end + 1;
  }
  std::string sorted;
  for (const std::string& name : names) sorted += (sorted.empty() ? "" : ",") + name;
  return sorted;
}

bool IsListOfNames(const std::string& text) {
  return text.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-_,") == std::string::npos;
}

// The lines that EncodeRenderOptions makes of the same options, which are in the order of their keys.
WebResult<std::string> ReadOptions(const json& object) {
  Members members(object, "options.");
  std::string lines;
  const auto add = [&](const char* key, const std::string& value) {
    lines += fmt::format("{}={}\n", key, value);
  };
  if (const auto aov = members.Text("aov", kNameBytesMax); aov && !aov->empty()) {
    if (!IsListOfNames(*aov)) members.Fail("aov", "expected names of layers, separated by commas");
    add("aov", Sorted(*aov));
  }
  if (members.Flag("denoise").value_or(false)) add("denoise", "true");
  const auto height = members.Whole("height", 1, kResolutionMax);
  if (height) add("height", std::to_string(*height));
  const auto noise = members.Number("noise_threshold", 0, kNoiseThresholdMax);
  if (noise && *noise > 0) add("noise-threshold", ShortestText(*noise));
  if (const auto seed = members.Whole("seed", 0, INT64_MAX)) add("seed", std::to_string(*seed));
  if (const auto spp = members.Whole("samples_per_pixel", 1, kSamplesPerPixelMax))
    add("spp", std::to_string(*spp));
  const auto width = members.Whole("width", 1, kResolutionMax);
  if (width) add("width", std::to_string(*width));
  if (width.has_value() != height.has_value()) members.Fail("width", "needs a height, and the reverse");
  if (const std::string& error = members.Finish(); !error.empty()) return WebError{400, error};
  return lines;
}

}  // namespace

WebResult<JobOrder> ReadJobOrder(const json& body) {
  Members members(body, "");
  JobOrder order;
  order.submission = static_cast<uint64_t>(members.Whole("submission", 1, INT64_MAX).value_or(0));
  order.name = members.Text("name", kNameBytesMax).value_or("");
  order.priority = static_cast<int32_t>(members.Whole("priority", -kPriorityMax, kPriorityMax).value_or(0));
  SceneOrder& scene = order.scene;
  const auto package = Digest::FromHex(members.Text("package", 64).value_or(""));
  if (!package) members.Fail("package", "expected 64 hexadecimal digits");
  scene.package = package.value_or(Digest{});
  scene.scene_file = members.Text("scene_file", kPathBytesMax).value_or("");
  if (const auto text = members.Text("frames", kNameBytesMax); text && !text->empty()) {
    const auto frames = ParseFrameRange("frames", *text);
    if (!frames) return WebError{400, frames.error().message};
    scene.frames = *frames;
  }
  scene.frames_per_second =
      members.Number("frames_per_second", kOrderedRateMin, kOrderedRateMax).value_or(scene.frames_per_second);
  if (const json* const options = members.Object("options")) {
    auto lines = ReadOptions(*options);
    if (const auto* const error = std::get_if<WebError>(&lines)) return *error;
    scene.options = std::get<std::string>(std::move(lines));
  }
  if (const std::string& error = members.Finish(); !error.empty()) return WebError{400, error};
  if (const auto checked = CheckSceneOrder(scene); !checked) return WebError{400, checked.error().message};
  return order;
}

}  // namespace tessera
