#include "coordinator/web_access.h"

#include <fmt/format.h>
#include <future>
#include <memory>

#include "coordinator/ask_core.h"
#include "coordinator/web/session_table.h"
#include "proto/identity/subject.h"
#include "proto/shell/system.h"
#include "renderer/text/unicode.h"

namespace tessera {
namespace {

// The name of a member whose token has none.
constexpr const char* kBrowserName = "browser";

// The use of the token may be written later.
constexpr const char* kRemedy = "if the token counts as used afterwards, ask for another";

class WebAccess {
 public:
  WebAccess(const CallGate& gate, const ChangePath& path, AccessPolicy policy)
      : gate_(gate), path_(path), policy_(std::move(policy)) {}

  Result<Visitor> Identify(std::string_view uri, std::string_view pem) const {
    Principal caller;
    if (const grpc::Status known = gate_.IdentifyHolder(uri, pem, caller); !known.ok())
      return Failed(known.error_message());
    return Admit(caller);
  }
  Result<Visitor> Recheck(MemberId id) const {
    const auto member = path_.core.members().FindMember(id);
    return Identify(member ? Subject{member->role, id, {}}.Uri() : "", "");
  }
  Result<Visitor> Join(const Digest& key, const std::string& peer) const;
  void Leave(MemberId id, const std::string& peer) const;

 private:
  Result<Visitor> Admit(const Principal& caller) const {
    if (const auto admitted = policy_(caller, kWebPageRule); !admitted) return admitted.error();
    const std::string_view role = caller.role ? RoleName(*caller.role) : "";
    return Visitor{caller.member, caller.name, std::string(role)};
  }
  Result<Visitor> Join(const Digest& key) const;
  Result<void> Store(const MemberStatus& member) const;

  const CallGate& gate_;
  const ChangePath path_;
  const AccessPolicy policy_;
};

Result<Visitor> WebAccess::Join(const Digest& key, const std::string& peer) const {
  Principal caller;
  caller.token_key = key;
  caller.peer = peer;
  auto joined = Join(key);
  if (joined) {
    CallGate::Audit(caller, kWebLoginRule,
                    fmt::format("joined={} role={} name={}", MemberIdText(joined->member), joined->role,
                                LogText(joined->name)),
                    grpc::Status::OK);
  } else {
    gate_.Deny(caller, kWebLoginRule, joined.error().message);
  }
  return joined;
}

// The role is checked first: a token that is of no use here is not used up.
Result<Visitor> WebAccess::Join(const Digest& key) const {
  const auto token = path_.core.members().FindToken(key);
  if (!token) return BadInput("this farm does not know the token");
  const UnixTime now = UnixNow();
  MemberStatus member{MemberId{RandomId()},
                      token->role,
                      token->name,
                      now,
                      now + std::chrono::seconds(kSessionLifetime).count(),
                      key};
  if (member.name.empty()) member.name = kBrowserName;
  Principal caller;
  caller.role = member.role;
  caller.member = member.id;
  caller.name = member.name;
  auto visitor = Admit(caller);
  if (!visitor) return visitor;
  if (const auto stored = Store(member); !stored) return stored.error();
  return visitor;
}

// Waits until the use of the token is on stable storage.
Result<void> WebAccess::Store(const MemberStatus& member) const {
  if (const auto space = path_.directory.CheckSpace(0); !space) return space;
  // Shared: the core thread may answer after this call has stopped waiting.
  const auto promise = std::make_shared<std::promise<Result<void>>>();
  auto answer = promise->get_future();
  CoreThread& core_thread = path_.core;
  core_thread.Post([promise, member, &core_thread](CoreContext& core) {
    if (const std::string& reason = core.farm.storage_reason(); !reason.empty())
      return promise->set_value(Failed("the coordinator cannot write its data: " + reason));
    const auto joined = core.farm.membership().Join(UnixNow(), member);
    if (!joined) return promise->set_value(joined);
    core.answers.AfterSync([promise, member, &core_thread](const Result<void>& synced) {
      if (synced) return promise->set_value({});
      // Nobody uses a membership that is not recorded.
      core_thread.Post([id = member.id](CoreContext& later) { later.farm.membership().UndoJoin(id); });
      promise->set_value(Failed("the coordinator cannot write its data: " + synced.error().message));
    });
  });
  if (answer.wait_for(kCorePatience) != std::future_status::ready)
    return Failed(fmt::format("the coordinator is busy; {}", kRemedy));
  return answer.get();
}

void WebAccess::Leave(MemberId id, const std::string& peer) const {
  path_.core.Post([=](CoreContext& core) {
    MembershipLedger& ledger = core.farm.membership();
    if (!ledger.RevokeMember(id)) return;
    const MemberStatus& member = ledger.members().at(id);
    Principal caller;
    caller.role = member.role;
    caller.member = id;
    caller.name = member.name;
    caller.peer = peer;
    CallGate::Audit(caller, kWebLogoutRule, "", grpc::Status::OK);
  });
}

}  // namespace

WebGate MakeWebGate(const CallGate& gate, const ChangePath& path, AccessPolicy policy) {
  const auto access = std::make_shared<const WebAccess>(gate, path, std::move(policy));
  return {[access](const Certificate& certificate) {
            return access->Identify(certificate.Uri(), certificate.Pem());
          },
          [access](MemberId member) { return access->Recheck(member); },
          [access](const Digest& key, const std::string& peer) { return access->Join(key, peer); },
          [access](MemberId member, const std::string& peer) { access->Leave(member, peer); }};
}

}  // namespace tessera
