// The numbers that facts begin with in a journal.
#pragma once

#include <cstdint>

namespace tessera {

enum class FactKind : uint32_t {
  kCoordinatorStartedUnnamed = 1,  // before farms had identities
  kJobSubmittedByNames = 2,        // before channels had types
  kJobEnded = 4,
  kJobExtended = 8,
  kJobsForgotten = 10,
  kFrameResumed = 11,
  kJobPaused = 5,
  kJobPriorityChanged = 6,
  kWorkerQuarantined = 9,
  kVoteRecordedWithoutMachine = 20,
  kUnitsCounted = 21,
  kFrameFinishedWithoutSize = 22,  // of its file
  kJobSubmitted = 23,
  kCoordinatorStarted = 24,
  kFrameFinished = 25,
  kVoteRecorded = 26,
  kJobOrdered = 27,
  kJobTimed = 28,
  kFrameFailed = 29,
  kTokenIssued = 40,
  kTokenRevoked = 41,
  kMemberJoined = 42,
  kMemberRenewed = 43,
  kMemberRevoked = 44,
  kJobOwned = 45,
  kAuthorityChosen = 46,
};

}  // namespace tessera
