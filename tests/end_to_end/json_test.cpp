// What commands print with --json is what the guide promises.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "renderer/util/file.h"
#include "tests/build_paths.h"
#include "tests/end_to_end/farm_fixture.h"

namespace tessera {
namespace {

using nlohmann::json;

// Types by the path of a member: "text or null, optional".
using Members = std::map<std::string, std::string>;

// The tables of the guide by their headings.
std::map<std::string, Members> Guide() {
  std::map<std::string, Members> sections;
  const auto text = ReadFile(SourceDir() + "/client/guide/json.md", 1 << 20);
  std::istringstream lines(text ? *text : "");
  std::string section;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("## ")) section = line.substr(3);
    if (!line.starts_with("| `")) continue;
    const size_t name_end = line.find("` | ");
    const size_t type_end = line.find(" |", name_end + 4);
    sections[section][line.substr(3, name_end - 3)] = line.substr(name_end + 4, type_end - name_end - 4);
  }
  return sections;
}

std::string TypeOf(const json& value) {
  if (value.is_null()) return "null";
  if (value.is_boolean()) return "boolean";
  return value.is_number() ? "number" : "text";
}

class Json : public EndToEnd {
 protected:
  // Every member has a row in the section, which permits its type. Notes those that were seen.
  void ExpectRows(const std::string& section, const json& value, const std::string& path = "") {
    const Members& rows = guide_[section];
    const auto row = rows.find(path);
    if (row != rows.end() && (row->second == "job" || row->second == "worker")) {
      seen_[section].insert(path);
      return ExpectRows(row->second, value);
    }
    if (value.is_object()) {
      for (const auto& [key, member] : value.items())
        ExpectRows(section, member, path.empty() ? key : path + "." + key);
    } else if (value.is_array()) {
      for (const json& each : value) ExpectRows(section, each, path + "[]");
    } else {
      seen_[section].insert(path);
      ASSERT_NE(row, rows.end()) << section << ": " << path << " is not in the guide";
      EXPECT_NE(row->second.find(TypeOf(value)), std::string::npos)
          << section << ": " << path << " is " << value.dump() << ", in the guide " << row->second;
    }
  }
  // The members of each section that was used are all there, but for optional ones.
  void ExpectMembers() {
    for (const auto& [section, paths] : seen_) {
      for (const auto& [path, type] : guide_[section]) {
        const bool is_optional = type.find("optional") != std::string::npos;
        EXPECT_TRUE(is_optional || paths.contains(path)) << section << ": " << path;
      }
    }
  }
  json Answer(const Outcome& outcome) {
    EXPECT_EQ(outcome.code, 0) << outcome.errors;
    EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
    json answer = json::parse(outcome.output, nullptr, false);
    EXPECT_FALSE(answer.is_discarded()) << outcome.output;
    return answer;
  }
  json Farm(std::vector<std::string> words) {
    words.push_back("--json");
    return Answer(Ask(words));
  }
  void ExpectLogRows(const std::string& job) {
    std::istringstream lines(Ask({"logs", job, "--json"}).output);
    size_t count = 0;
    for (std::string line; std::getline(lines, line); ++count)
      ExpectRows("logs", json::parse(line, nullptr, false));
    EXPECT_GT(count, 0u);
  }
  json Here(std::vector<std::string> words) {
    words.push_back("--json");
    return Answer(Tessera(words));
  }

 private:
  std::map<std::string, Members> guide_ = Guide();
  std::map<std::string, std::set<std::string>> seen_;
};

TEST_F(Json, AnswersOfAFarmAreThoseOfTheGuide) {
  StartCoordinator();
  StartWorker("blade", 1, {"--tag", "gpu"});
  const json submitted = Farm({"submit", BoxScene(), "--spp", "16", "--verify", "100%", "--frames", "1-2"});
  ExpectRows("submit", submitted);
  const std::string job = submitted["job"].dump();
  ExpectRows("job", Farm({"status", job}));
  ExpectRows("job", Farm({"pause", job}));
  ExpectRows("job", Farm({"resume", job}));
  ExpectRows("job", Farm({"priority", job, "3"}));
  StartWorker("second", 1, {"--tag", "gpu"});
  ExpectRows("job", Farm({"watch", job}));
  ExpectLogRows(job);
  ExpectRows("pictures", Farm({"fetch", job, "-o", "a.####.exr"}));
  for (const json& each : Farm({"jobs"})) ExpectRows("job", each);
  for (const char* command : {"drain", "release"}) {
    for (const json& each : Farm({command, "blade"})) ExpectRows("worker", each);
  }
  // Its scene stays in the memory of the workers while it is open.
  const std::string open = Submit(BoxScene(), {"--spp", "100000"});
  EXPECT_TRUE(Eventually([&] { return !Farm({"workers"})[0]["scenes"].empty(); }));
  for (const json& each : Farm({"workers"})) ExpectRows("worker", each);
  ExpectRows("top", Farm({"top"}));
  ExpectRows("job", Farm({"cancel", open}));
  ExpectRows("access", Farm({"access"}));
  const json forecast = Farm({"submit", BoxScene(), "--spp", "16", "--dry-run", "--require", "gpu"});
  ExpectRows("dry-run", forecast);
  EXPECT_EQ(forecast["farm"]["workers"], 2);
  EXPECT_EQ(forecast["farm"]["threads"], 2);
  EXPECT_GT(forecast["farm"]["seconds"], 0);
  const json nobody = Farm({"submit", BoxScene(), "--spp", "16", "--dry-run", "--require", "big"});
  EXPECT_EQ(nobody["farm"]["workers"], 0);
  EXPECT_TRUE(nobody["farm"]["seconds"].is_null());
  EXPECT_EQ(Farm({"jobs"}).size(), 2u) << "a dry run submits nothing";
  const Outcome token = RunProgram(folder(), "tessera-coordinator",
                                   {"token", "--role", "operator", "--coordinator", address()});
  ASSERT_EQ(token.code, 0) << token.errors;
  ExpectRows("access", Farm({"access"}));
  ExpectRows("login", Here({"login", token.output.substr(0, token.output.find('\n')), "--farm", "studio"}));
  ExpectRows("logout", Here({"logout", "studio"}));
  ExpectRows("access", Farm({"access"}));
  ExpectMembers();
}

TEST_F(Json, AnswersOfThisMachineAreThoseOfTheGuide) {
  ExpectRows("pictures", Here({"render", BoxScene(), "--spp", "8", "--in-process", "-o", "a.exr"}));
  ExpectRows("dry-run", Here({"render", BoxScene(), "--spp", "8", "--dry-run"}));
  ExpectRows("compare", Here({"compare", "a.exr", "a.exr"}));
  ExpectRows("bench", Here({"bench", "--seconds", "1"}));
  ExpectRows("info of a picture", Here({"info", "a.exr"}));
  const Outcome doctor = Tessera({"doctor", "--json"});
  ExpectRows("doctor", json::parse(doctor.output, nullptr, false));
  EXPECT_TRUE(Here({"kinds"})["Shape"][0].contains("support") || Here({"kinds"}).size() > 5);
  json scene = Here({"info", BoxScene()});
  std::erase_if(*scene.get_ptr<json::object_t*>(), [](const auto& member) {
    return member.first == "triangles" || member.first == "quadrics" || member.first == "patches" ||
           member.first == "curve pieces";
  });
  ExpectRows("info of a scene", scene);
  ExpectMembers();
}

TEST_F(Json, ADryRunWithoutAFarmStillTellsAboutThisMachine) {
  const Outcome outcome = RunProgram(
      folder(), "tessera",
      {"submit", BoxScene(), "--spp", "8", "--dry-run", "--json", "--coordinator", "unix:" + Path("nobody")});
  EXPECT_EQ(outcome.code, 0) << outcome.errors;
  EXPECT_THAT(outcome.errors, testing::HasSubstr("there is no estimate for the farm"));
  const json forecast = json::parse(outcome.output, nullptr, false);
  EXPECT_GT(forecast["seconds"], 0);
  EXPECT_FALSE(forecast.contains("farm"));
}

}  // namespace
}  // namespace tessera
