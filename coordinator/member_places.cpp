#include "coordinator/member_places.h"

#include <fmt/format.h>

namespace tessera {

MemberPlaces::Place::~Place() {
  if (places_ != nullptr) places_->GiveBack(member_);
}

Result<MemberPlaces::Place> MemberPlaces::Take(const Principal& caller) {
  const std::lock_guard lock(mutex_);
  if (taken_ >= limits_.all) return Error{ErrorKind::kInterrupted, "too many " + what_};
  const auto own = own_.find(caller.member);
  if (own != own_.end() && own->second >= limits_.own)
    return Error{ErrorKind::kInterrupted, fmt::format("too many {} for {}", what_, caller.Text())};
  ++own_[caller.member];
  ++taken_;
  return Place(this, caller.member);
}

void MemberPlaces::GiveBack(MemberId member) {
  const std::lock_guard lock(mutex_);
  const auto own = own_.find(member);
  if (--own->second == 0) own_.erase(own);
  --taken_;
}

}  // namespace tessera
