#include "coordinator/call_gate.h"

namespace tessera {

grpc::Status UnaryCall::DiskFails(const std::string& reason) {
  return {grpc::StatusCode::RESOURCE_EXHAUSTED, "the coordinator cannot write its data: " + reason};
}

grpc::Status UnaryCall::Stored(const Result<void>& synced) {
  if (synced) return grpc::Status::OK;
  if (synced.error().kind == ErrorKind::kInterrupted) return CoordinatorEnds();
  return DiskFails(synced.error().message + "; the change takes effect when it can be written");
}

Principal CallGate::CallerOf(const grpc::CallbackServerContext& context) {
  Principal caller;
  caller.peer = context.peer();
  return caller;
}

grpc::Status CallGate::Check(const grpc::CallbackServerContext& context, const Principal& caller,
                             const CallRule& rule) const {
  const auto admitted = policy_(caller, rule);
  return admitted ? CheckFarm(context, farm_)
                  : grpc::Status(grpc::StatusCode::PERMISSION_DENIED, admitted.error().message);
}

}  // namespace tessera
