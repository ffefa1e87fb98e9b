// Lets members of the farm look at its web pages.
#pragma once

#include "coordinator/access.h"
#include "coordinator/call_gate.h"
#include "coordinator/web/web_gate.h"

namespace tessera {

// The pages show what Permission::kView shows, so they follow that rule of the table (access.h).
constexpr CallRule kWebPageRule{"the web pages", Permission::kView, Effect::kReads};
// For the audit log.
constexpr CallRule kWebLoginRule{"Web.Login", Permission::kJoin, Effect::kChanges};
constexpr CallRule kWebLogoutRule{"Web.Logout", Permission::kRenew, Effect::kChanges};

// `gate` and the parts of `path` must outlive it.
WebGate MakeWebGate(const CallGate& gate, const ChangePath& path, AccessPolicy policy);

}  // namespace tessera
