// Who may complete a TLS handshake with the coordinator. What the peer may do then is decided call by call.
#pragma once

#include <vector>

#include "coordinator/membership/member_board.h"
#include "proto/identity/certificate.h"
#include "proto/identity/subject.h"
#include "renderer/util/result.h"

namespace tessera {

// Accepts certificates that the authority issued to members, certificates of members that one of the
// authorities of an organisation issued, and certificates of the keys of tokens that the
// farm knows. Also those that have expired, were revoked or used up: their holders belonged to the farm, and
// each of their calls is answered with the reason. Everybody else learns nothing. The error is for the log.
Result<void> CheckPeer(const std::vector<Certificate>& chain, const Certificate& authority,
                       const std::vector<Certificate>& organisation, const MemberBoard& board, UnixTime now);

}  // namespace tessera
