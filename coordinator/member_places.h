// Places for what runs at the same time, of which one member takes no more than a part: others always find
// one.
#pragma once

#include <map>
#include <mutex>
#include <string>
#include <utility>

#include "coordinator/access.h"
#include "renderer/util/result.h"

namespace tessera {

// Thread safe. Must outlive the places that were taken.
class MemberPlaces {
 public:
  struct Limits {
    int all = 0;
    int own = 0;  // of one member, or of all who are none, as operators on the coordinator's machine are
  };
  // Gives the place back when it is destroyed. Empty if it was moved from or made without one.
  class Place {
   public:
    Place() = default;
    ~Place();
    Place(Place&& other) noexcept : places_(std::exchange(other.places_, nullptr)), member_(other.member_) {}
    Place& operator=(Place&& other) noexcept {
      std::swap(places_, other.places_);
      std::swap(member_, other.member_);
      return *this;
    }

   private:
    friend class MemberPlaces;
    Place(MemberPlaces* places, MemberId member) : places_(places), member_(member) {}
    MemberPlaces* places_ = nullptr;
    MemberId member_{};
  };

  // `what` is limited, for messages: "transfers are running".
  MemberPlaces(const Limits& limits, std::string what) : limits_(limits), what_(std::move(what)) {}
  // An error, kInterrupted, if all places are taken or the caller has taken as many as a member may.
  Result<Place> Take(const Principal& caller);

 private:
  void GiveBack(MemberId member);

  const Limits limits_;
  const std::string what_;
  std::mutex mutex_;
  // Guarded by mutex_.
  int taken_ = 0;
  std::map<MemberId, int> own_;  // of members who have some
};

}  // namespace tessera
