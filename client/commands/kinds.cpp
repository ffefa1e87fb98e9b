// tessera kinds
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "client/commands/commands.h"
#include "client/commands/option_groups.h"
#include "renderer/scene/scene_language.h"

namespace tessera {
namespace {

struct KindsOptions {
  bool json = false;
};

void AddKindsFlags(CLI::App& app, KindsOptions& options) {
  AddJsonFlag(app, options.json);
}

// The same words in text and JSON.
std::string_view Word(Support support) {
  switch (support) {
    case Support::kSupported: return "supported";
    case Support::kMapped: return "replaced";
    case Support::kNotSupported: return "not supported";
  }
  return {};
}

void PrintText(const KindList& list) {
  fmt::print("{}\n", list.family);
  for (const Support support : {Support::kSupported, Support::kMapped, Support::kNotSupported}) {
    std::vector<std::string> names;
    for (const KindInfo& kind : list.kinds) {
      if (kind.support != support) continue;
      names.push_back(kind.instead.empty() ? std::string(kind.name)
                                           : fmt::format("{} ({})", kind.name, kind.instead));
    }
    if (!names.empty()) fmt::print("  {:<15}{}\n", Word(support), fmt::join(names, ", "));
  }
}

nlohmann::ordered_json ToJson(const KindList& list) {
  auto kinds = nlohmann::ordered_json::array();
  for (const KindInfo& kind : list.kinds) {
    nlohmann::ordered_json json{{"name", kind.name}, {"support", Word(kind.support)}};
    if (!kind.instead.empty()) json["instead"] = kind.instead;
    kinds.push_back(std::move(json));
  }
  return kinds;
}

Result<int> RunKinds(const KindsOptions& options, Cancellation&) {
  nlohmann::ordered_json json;
  for (const KindList& list : SceneLanguageKinds()) {
    if (options.json) {
      json[std::string(list.family)] = ToJson(list);
    } else {
      PrintText(list);
    }
  }
  if (options.json) fmt::print("{}\n", json.dump());
  return 0;
}

}  // namespace

Command KindsCommand() {
  return MakeCommand<KindsOptions>({
      .name = "kinds",
      .summary = "List the kinds of cameras, shapes, lights, ... that scenes may use",
      .examples = {{"List the kinds as JSON", "tessera kinds --json"}},
      .add_flags = AddKindsFlags,
      .run = RunKinds,
  });
}

}  // namespace tessera
