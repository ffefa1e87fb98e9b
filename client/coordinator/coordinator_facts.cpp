#include "client/coordinator/coordinator_facts.h"

#include <chrono>

#include "client/coordinator/coordinator_connection.h"
#include "proto/wire/convert.h"
#include "renderer/text/unicode.h"

namespace tessera {
namespace {

constexpr std::chrono::seconds kFactsPatience{10};

double UnixSeconds() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

// A version that differs may not be able to answer, and some members may not ask.
std::optional<std::vector<WorkerStatus>> AskForWorkers(proto::Jobs::Stub& jobs, std::stop_token stop) {
  CallContext context(std::move(stop), {}, kFactsPatience);
  proto::WorkersAnswer answer;
  if (!jobs.Workers(context.get(), {}, &answer).ok()) return std::nullopt;
  std::vector<WorkerStatus> workers;
  for (const proto::WorkerStatus& message : answer.workers()) {
    if (auto status = ReadWorkerStatus(message)) workers.push_back(std::move(*status));
  }
  return workers;
}

}  // namespace

Result<CoordinatorFacts> AskForFacts(const Endpoint& endpoint, std::stop_token stop) {
  if (auto started = StartGrpc(); !started) return started.error();
  const auto jobs = proto::Jobs::NewStub(OpenChannel(endpoint));
  proto::HealthAnswer answer;
  {
    // Connects, so that the time of the second call is that of an answer.
    CallContext context(stop, {}, kFactsPatience);
    if (const grpc::Status status = jobs->Health(context.get(), {}, &answer); !status.ok())
      return ToError(status, "ask the coordinator for its version");
  }
  const double before = UnixSeconds();
  CallContext context(stop, {}, kFactsPatience);
  if (const grpc::Status status = jobs->Health(context.get(), {}, &answer); !status.ok())
    return ToError(status, "ask the coordinator for its version");
  CoordinatorFacts facts;
  facts.answer_s = UnixSeconds() - before;
  facts.software_version = CleanName(answer.software_version());
  facts.protocol = answer.protocol();
  facts.has_clock = answer.unix_time_ms() != 0;
  facts.clock_ahead_s = static_cast<double>(answer.unix_time_ms()) / 1e3 - (before + facts.answer_s / 2);
  facts.workers = AskForWorkers(*jobs, stop);
  return facts;
}

}  // namespace tessera
