#include "tests/bench/bench_farm.h"

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "proto/identity/login.h"
#include "proto/wire/membership_calls.h"

namespace tessera {
namespace {

// What a step returned, or an exception with its error.
template <typename Value>
Value Get(Result<Value> result) {
  if (!result) throw std::runtime_error(result.error().message);
  return std::move(*result);
}

}  // namespace

Usage UsageOf(pid_t pid) {
  Usage usage;
  std::ifstream status(fmt::format("/proc/{}/status", pid));
  for (std::string word; status >> word;) {
    if (word == "VmRSS:" && status >> usage.megabytes) usage.megabytes /= 1024;
  }
  std::ifstream stat(fmt::format("/proc/{}/stat", pid));
  std::string word;
  double ticks = 0;
  for (int field = 1; stat >> word; ++field) {
    if (field == 14 || field == 15) ticks += std::stod(word);
  }
  usage.cpu_s = ticks / static_cast<double>(::sysconf(_SC_CLK_TCK));
  std::error_code ignored;
  for (std::filesystem::directory_iterator at(fmt::format("/proc/{}/fd", pid), ignored), end; at != end;
       at.increment(ignored))
    ++usage.descriptors;
  return usage;
}

double MegabytesIn(const std::string& folder) {
  uint64_t bytes = 0;
  std::error_code ignored;  // files come and go meanwhile
  for (std::filesystem::recursive_directory_iterator at(folder, ignored), end; at != end;
       at.increment(ignored))
    if (at->is_regular_file(ignored)) bytes += at->file_size(ignored);
  return static_cast<double>(bytes) / 1e6;
}

TemporaryFolder::TemporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "tessera-bench-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder can be made");
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

BenchFarm::BenchFarm(Security security) : security_(security) {
  std::vector<std::string> words{"--listen", "127.0.0.1:0", "--data-dir", folder() + "/data"};
  if (security == Security::kPlain) words.push_back("--insecure");
  coordinator_.emplace(folder(), "tessera-coordinator", words);
  const std::string listening = "listening on ";
  if (!coordinator_->AwaitErrors(listening))
    throw std::runtime_error("no coordinator: " + coordinator_->Errors());
  const std::string log = coordinator_->Errors();
  const size_t begin = log.find(listening) + listening.size();
  address_ = log.substr(begin, log.find('\n', begin) - begin);
}

Endpoint BenchFarm::Join(Role role) const {
  const Address address = Get(ParseAddress(address_, "coordinator"));
  if (security_ == Security::kPlain) return Endpoint(address);
  const Outcome made =
      RunProgram(folder(), "tessera-coordinator",
                 {"token", "--role", std::string(RoleName(role)), "--coordinator", address_});
  if (made.code != 0) throw std::runtime_error("no token: " + made.errors);
  const JoinedFarm joined =
      Get(JoinFarm(Get(JoinToken::Parse(made.output.substr(0, made.output.find('\n')))), "bench"));
  const std::string name(RoleName(role));
  const Login login = Get(LoginStore(folder() + "/logins").Save(name, address_, joined.identity));
  return Endpoint(address, address, login);
}

Outcome BenchFarm::Tessera(std::vector<std::string> words) const {
  words.insert(words.end(), {"--coordinator", address_});
  return RunProgram(folder(), "tessera", words);
}

}  // namespace tessera
