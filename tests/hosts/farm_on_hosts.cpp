#include "tests/hosts/farm_on_hosts.h"

#include <filesystem>
#include <stdexcept>

namespace tessera {
namespace {

std::string FirstLine(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

}  // namespace

void FarmOnHosts::SetUp() {
  if (const std::string reason = WhyNoNetwork(); !reason.empty()) GTEST_SKIP() << reason;
  network_.emplace(kHosts);
  for (int host = 0; host < kHosts; ++host) std::filesystem::create_directories(Home(host) + "/tmp");
}

// Before the network that the programs are in.
void FarmOnHosts::TearDown() {
  processes_.clear();
  network_.reset();
}

std::vector<std::string> FarmOnHosts::ShellWords(int host, const std::string& line) const {
  std::vector<std::string> words = network_->Enter(host);
  words.insert(words.end(), {"/usr/bin/env", "HOME=" + Home(host),
                             "PATH=" + BinaryDir() + "/bin:/usr/bin:/bin", "/bin/bash", "-c", line});
  return words;
}

Process& FarmOnHosts::Type(int host, const std::string& line) {
  std::vector<std::string> words = ShellWords(host, "exec " + line);
  const std::string program = words.front();
  words.erase(words.begin());
  return processes_.emplace_back(Home(host), program, words);
}

Outcome FarmOnHosts::TypeAndWait(int host, const std::string& line) {
  std::vector<std::string> words = ShellWords(host, line);
  const std::string program = words.front();
  words.erase(words.begin());
  return RunProgram(Home(host), program, words);
}

void FarmOnHosts::PutScene(int host) const {
  const std::filesystem::path scenes = SourceDir() + "/tests/scenes";
  std::filesystem::copy_file(scenes / "box.pbrt", Home(host) + "/scene.pbrt");
  std::filesystem::copy_file(scenes / "box-walls.pbrt", Home(host) + "/box-walls.pbrt");
}

std::string FarmOnHosts::Token(const std::string& options) {
  const Outcome made = TypeAndWait(kCoordinatorHost, "tessera-coordinator token " + options);
  if (made.code != 0) throw std::runtime_error("no token: " + made.errors);
  return FirstLine(made.output);
}

void FarmOnHosts::StartFarm() {
  Process& coordinator =
      Type(kCoordinatorHost, "tessera-coordinator --listen 0.0.0.0:7700 --data-dir ~/tessera-data");
  if (!coordinator.AwaitErrors("listening on ")) throw std::runtime_error(coordinator.Errors());
  const std::string token = Token("--role worker --uses 2");
  for (const int host : {kFirstWorker, kSecondWorker}) {
    workers_.push_back(&Type(host, "tessera-worker --threads 1 --name host-" + std::to_string(host) +
                                       " --cache-dir ~/cache --join " + token));
  }
  for (Process* const each : workers_) {
    if (!each->AwaitErrors("connected worker=")) throw std::runtime_error(each->Errors());
  }
  const Outcome login = TypeAndWait(kUserHost, "tessera login " + Token("--role user"));
  if (login.code != 0) throw std::runtime_error(login.errors);
  PutScene(kUserHost);
}

std::string FarmOnHosts::Expected(const std::string& options) {
  const std::string line = "tessera render scene.pbrt --in-process -o expected.exr " + options;
  const Outcome rendered = TypeAndWait(kUserHost, line);
  if (rendered.code != 0) throw std::runtime_error(rendered.errors);
  return Bytes("host-" + std::to_string(kUserHost) + "/expected.exr");
}

std::optional<double> FarmOnHosts::JobFigure(const std::string& key) {
  const Outcome status = TypeAndWait(kUserHost, "tessera status 1 --json --patience 60");
  const size_t place = status.output.find("\"" + key + "\":");
  if (place == std::string::npos) return std::nullopt;
  return std::stod(status.output.substr(place + key.size() + 3));
}

void FarmOnHosts::AwaitShareOfJob(double share) {
  const auto is_reached = [&] {
    const auto all = JobFigure("samples_total"), done = JobFigure("samples_done");
    return all && done && *done >= share * *all;
  };
  if (!Eventually(is_reached)) throw std::runtime_error("the job makes no progress");
}

}  // namespace tessera
