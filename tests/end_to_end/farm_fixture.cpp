#include "tests/end_to_end/farm_fixture.h"

#include <signal.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace tessera {
namespace {

// Ends the test: gtest reports the exception.
void Require(bool condition, const std::string& what) {
  if (!condition) throw std::runtime_error(what);
}

}  // namespace

EndToEnd::EndToEnd() {
  folder_ = testing::TempDir() + "tessera-e2e-XXXXXX";
  EXPECT_NE(::mkdtemp(folder_.data()), nullptr);
  std::filesystem::create_directory(Path("tmp"));
}

EndToEnd::~EndToEnd() {
  workers_.clear();
  coordinator_.reset();
  if (HasFailure()) {
    std::cerr << "left for inspection: " << folder_ << '\n';
    return;
  }
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

std::string EndToEnd::Write(const std::string& name, const std::string& text) const {
  std::filesystem::create_directories(std::filesystem::path(Path(name)).parent_path());
  std::ofstream(Path(name), std::ios::binary) << text;
  return Path(name);
}

std::string EndToEnd::Bytes(const std::string& name) const {
  std::ifstream file(Path(name), std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

bool EndToEnd::Exists(const std::string& name) const {
  return std::filesystem::exists(Path(name));
}

uint64_t EndToEnd::BytesBelow(const std::string& name) const {
  uint64_t bytes = 0;
  std::error_code error;
  for (std::filesystem::recursive_directory_iterator it(Path(name), error), end; !error && it != end;
       it.increment(error)) {
    std::error_code gone;
    const uint64_t size = it->is_regular_file(gone) ? it->file_size(gone) : 0;
    bytes += gone ? 0 : size;
  }
  return bytes;
}

std::string EndToEnd::Oracle(const std::string& scene, std::vector<std::string> options) {
  options.insert(options.begin(), {"render", scene, "--in-process", "-o", "oracle.exr"});
  const Outcome outcome = Tessera(options);
  Require(outcome.code == 0, "the oracle failed: " + outcome.errors);
  return Bytes("oracle.exr");
}

void EndToEnd::StartCoordinator(const std::vector<std::string>& options) {
  coordinator_.reset();
  std::vector<std::string> arguments{"--listen", address_, "--data-dir", Path("data")};
  arguments.insert(arguments.end(), options.begin(), options.end());
  coordinator_.emplace(folder_, "tessera-coordinator", arguments);
  const std::string words = "listening on ";
  Require(coordinator_->AwaitErrors(words), "the coordinator does not listen: " + coordinator_->Errors());
  const std::string log = coordinator_->Errors();
  const size_t begin = log.find(words) + words.size();
  address_ = log.substr(begin, log.find('\n', begin) - begin);
}

Process& EndToEnd::StartWorker(const std::string& name, int threads, std::vector<std::string> options) {
  options.insert(options.end(), {"--coordinator", address_, "--threads", std::to_string(threads)});
  return StartUnaddressedWorker(name, std::move(options));
}

Process& EndToEnd::StartUnaddressedWorker(const std::string& name, std::vector<std::string> options) {
  options.insert(options.end(), {"--cache-dir", Path("cache-" + name), "--name", name});
  workers_.emplace_back(folder_, "tessera-worker", std::move(options));
  return workers_.back();
}

Outcome EndToEnd::Ask(std::vector<std::string> arguments) const {
  arguments.insert(arguments.end(), {"--coordinator", address_});
  return Tessera(arguments);
}

std::string EndToEnd::Submit(const std::string& scene, std::vector<std::string> options) {
  options.insert(options.begin(), {"submit", scene});
  const Outcome outcome = Ask(options);
  Require(outcome.code == 0, "submit failed: " + outcome.errors);
  EXPECT_EQ(outcome.output.find_first_not_of("0123456789"), outcome.output.size() - 1) << outcome.output;
  return outcome.output.substr(0, outcome.output.find('\n'));
}

double EndToEnd::Figure(const std::string& job, const std::string& key) const {
  const Outcome outcome = Ask({"status", job, "--json"});
  const size_t place = outcome.output.find("\"" + key + "\":");
  Require(place != std::string::npos, "no " + key + " in: " + outcome.output + outcome.errors);
  return std::stod(outcome.output.substr(place + key.size() + 3));
}

void EndToEnd::AwaitShare(const std::string& job, double share) const {
  const double awaited = share * Figure(job, "samples_total");
  Require(Eventually([&] { return Figure(job, "samples_done") > awaited; }), "the job makes no progress");
}

std::string EndToEnd::ExpectSurvival(const std::vector<std::string>& options) {
  const std::string oracle = Oracle(BoxScene(), options);
  StartCoordinator();
  Process& doomed = StartWorker("doomed");
  StartWorker("steady");
  const std::string job = Submit(BoxScene(), options);
  AwaitShare(job, 0.05);
  doomed.Signal(SIGKILL);
  coordinator().Signal(SIGKILL);
  EXPECT_EQ(coordinator().Wait(), -SIGKILL);
  StartCoordinator();
  EXPECT_EQ(Ask({"watch", job}).code, 0);
  EXPECT_EQ(Ask({"fetch", job, "-o", "picture.exr"}).code, 0);
  EXPECT_TRUE(Bytes("picture.exr") == oracle);
  return job;
}

}  // namespace tessera
