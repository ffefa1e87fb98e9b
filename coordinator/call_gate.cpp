#include "coordinator/call_gate.h"

#include <fmt/format.h>
#include <grpc/grpc_security_constants.h>
#include <grpcpp/security/auth_context.h>
#include <spdlog/spdlog.h>

#include "coordinator/membership/member_board.h"
#include "proto/identity/certificate.h"
#include "proto/identity/subject.h"
#include "proto/shell/log.h"
#include "renderer/text/unicode.h"

namespace tessera {
namespace {

// Who makes a call, and from where. A caller that could not be identified is none.
std::string LogFieldsOf(const Principal& caller) {
  std::string id;
  if (caller.member != MemberId{}) id = fmt::format(" member={}", MemberIdText(caller.member));
  if (caller.token_key != Digest{}) id = fmt::format(" token={}", TokenIdText(caller.token_key));
  return fmt::format("by={}{} peer={}", LogText(caller.Text()), id, LogText(caller.peer));
}

grpc::Status Unauthenticated(const std::string& reason) {
  return {grpc::StatusCode::UNAUTHENTICATED,
          reason + "; ask an operator of the farm for a token and join again"};
}

}  // namespace

const ChangePath& UnaryCall::path() const {
  return gate_->path();
}

CoreThread& UnaryCall::core() const {
  return gate_->core();
}

grpc::Status UnaryCall::AdmitToJob(const CoreContext& core, JobId job) const {
  return gate_->AdmitToJob(caller_, *rule_, core, job);
}

grpc::Status UnaryCall::AdmitToWorker(const CoreContext& core, WorkerId worker) const {
  return gate_->AdmitToWorker(caller_, *rule_, core, worker);
}

void UnaryCall::Finish(const grpc::Status& status) const {
  if (details_) CallGate::Audit(caller_, *rule_, *details_, status, gate_->failed());
  finish_(status);
}

grpc::Status UnaryCall::DiskFails(const std::string& reason) {
  return {grpc::StatusCode::RESOURCE_EXHAUSTED, "the coordinator cannot write its data: " + reason};
}

grpc::Status UnaryCall::Stored(const Result<void>& synced) {
  if (synced) return grpc::Status::OK;
  if (synced.error().kind == ErrorKind::kInterrupted) return CoordinatorEnds();
  return DiskFails(synced.error().message + "; the change takes effect when it can be written");
}

grpc::Status CallGate::IdentifyMember(MemberId id, Principal& caller) const {
  caller.member = id;
  const auto member = core().members().FindMember(id);
  if (!member) {
    return Unauthenticated(
        "this farm does not know the certificate: it was forgotten, or the data of the coordinator is older");
  }
  caller.name = member->name;
  caller.role = member->role;
  if (member->revoked)
    return Unauthenticated(fmt::format("the certificate of {} was revoked", caller.Text()));
  if (member->expires <= UnixNow()) {
    return Unauthenticated(
        fmt::format("the certificate of {} expired on {}", caller.Text(), UnixTimeText(member->expires)));
  }
  return grpc::Status::OK;
}

grpc::Status CallGate::IdentifyOfOrganisation(const Subject& subject, std::string_view pem,
                                              Principal& caller) const {
  const UnixTime now = UnixNow();
  const auto known = core().members().FindMember(subject.id);
  if (known && (known->revoked || known->expires > now)) return IdentifyMember(subject.id, caller);
  const auto certificate = Certificate::FromPem(pem, "the certificate");
  if (!certificate) return ToStatus(certificate.error());
  caller.member = subject.id;
  caller.name = subject.name;
  caller.role = subject.role;
  if (certificate->NotAfter() <= now) {
    return {grpc::StatusCode::UNAUTHENTICATED,
            fmt::format("the certificate of {} expired on {}; get a new one from the organisation",
                        caller.Text(), UnixTimeText(certificate->NotAfter()))};
  }
  const MemberStatus member{subject.id, *subject.role, subject.name, now, certificate->NotAfter(), {}, false};
  core().Post([member, peer = caller.peer](CoreContext& context) {
    const auto listed = context.farm.membership().Enrol(member.joined, member);
    if (!listed) return spdlog::warn("member_not_listed reason={}", LogText(listed.error().message));
    spdlog::info("member_seen member={} role={} name={} peer={}", MemberIdText(member.id),
                 RoleName(member.role), LogText(member.name), LogText(peer));
  });
  return grpc::Status::OK;
}

// A caller who was admitted and is not listed will be as soon as the disk takes it.
grpc::Status CallGate::Recheck(const Principal& caller) const {
  if (!core().members().FindMember(caller.member)) return grpc::Status::OK;
  Principal now;
  return IdentifyMember(caller.member, now);
}

// A plain connection is one to a Unix socket, or the user wants no security. On others, the handshake has
// checked the certificate and that it has one URI.
grpc::Status CallGate::Identify(const grpc::CallbackServerContext& context, Principal& caller) const {
  caller.peer = context.peer();
  const auto connection = context.auth_context();
  const auto pems = connection->FindPropertyValues(GRPC_X509_PEM_CERT_PROPERTY_NAME);
  if (pems.empty()) {
    caller.role = Role::kOperator;
    caller.name = kLocalOwner;
    return grpc::Status::OK;
  }
  const std::vector<grpc::string_ref> uris = connection->FindPropertyValues(GRPC_PEER_URI_PROPERTY_NAME);
  const auto text = [](const grpc::string_ref& value) {
    return std::string_view(value.data(), value.size());
  };
  return IdentifyHolder(uris.size() == 1 ? text(uris.front()) : "", text(pems.front()), caller);
}

grpc::Status CallGate::IdentifyHolder(std::string_view uri, std::string_view pem, Principal& caller) const {
  const auto subject = Subject::Parse(uri);
  if (!subject) return Unauthenticated("the certificate names no member");
  if (subject->IsOfOrganisation()) return IdentifyOfOrganisation(*subject, pem, caller);
  if (subject->IsMember()) return IdentifyMember(subject->id, caller);
  caller.token_key = subject->token_key;
  return grpc::Status::OK;
}

grpc::Status CallGate::Admit(const grpc::CallbackServerContext& context, const CallRule& rule,
                             Principal& caller) const {
  grpc::Status status = Identify(context, caller);
  if (status.ok()) {
    if (on_identified_) on_identified_(caller.peer);
    const auto admitted = policy_(caller, rule);
    if (admitted) return CheckFarm(context, farm_);
    status = {grpc::StatusCode::PERMISSION_DENIED, admitted.error().message};
  }
  LogDenial(caller, rule, status);
  return status;
}

grpc::Status CallGate::AdmitToJob(const Principal& caller, const CallRule& rule, const CoreContext& core,
                                  JobId job) const {
  const JobOwner* const owner = core.farm.OwnerOf(job);
  if (owner == nullptr) return {grpc::StatusCode::NOT_FOUND, fmt::format("there is no job {}", Number(job))};
  const auto admitted = AdmitByOwner(caller, rule, job, *owner);
  if (admitted) return grpc::Status::OK;
  return Deny(caller, rule, admitted.error().message);
}

grpc::Status CallGate::AdmitToWorker(const Principal& caller, const CallRule& rule, const CoreContext& core,
                                     WorkerId worker) const {
  return core.farm.HasJoined(worker) ? AdmitJoin(caller, rule, core, worker) : HasNotJoined();
}

grpc::Status CallGate::AdmitJoin(const Principal& caller, const CallRule& rule, const CoreContext& core,
                                 WorkerId worker) const {
  const auto member = core.farm.MemberOf(worker);
  const bool is_others = member && *member != caller.member;
  if (!is_others || ReachOf(caller.role, rule.permission) == Reach::kEverything) return grpc::Status::OK;
  return Deny(caller, rule,
              fmt::format("{} may not call {} for worker {:016x}, which is not its own", caller.Text(),
                          rule.method, Number(worker)));
}

grpc::Status CallGate::Deny(const Principal& caller, const CallRule& rule, const std::string& reason) const {
  const grpc::Status status(grpc::StatusCode::PERMISSION_DENIED, reason);
  LogDenial(caller, rule, status);
  return status;
}

void CallGate::LogDenial(const Principal& caller, const CallRule& rule, const grpc::Status& status) const {
  denied_.Warn("call_denied", fmt::format("call={} {} reason={}", rule.method, LogFieldsOf(caller),
                                          LogText(status.error_message())));
}

void CallGate::Audit(const Principal& caller, const CallRule& rule, const std::string& details,
                     const grpc::Status& status, RareLog& failed) {
  if (status.ok()) return Audit(caller, rule, details, status);
  if (status.error_code() == grpc::StatusCode::PERMISSION_DENIED) return;
  const auto count = failed.Count();
  if (!count) return;
  const std::string counted =
      *count == 1 ? "" : fmt::format("count={}{}", *count, details.empty() ? "" : " ");
  Audit(caller, rule, counted + details, status);
}

void CallGate::Audit(const Principal& caller, const CallRule& rule, const std::string& details,
                     const grpc::Status& status) {
  if (status.error_code() == grpc::StatusCode::PERMISSION_DENIED) return;
  WriteAuditEntry(fmt::format(
      "call={} {}{}{} result={}", rule.method, LogFieldsOf(caller), details.empty() ? "" : " ", details,
      status.ok() ? "done" : fmt::format("failed reason={}", LogText(status.error_message()))));
}

}  // namespace tessera
