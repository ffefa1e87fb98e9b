// Diffusion profiles by their parameters, each computed once for a scene, and once for all scenes that share
// a cache, since one takes some 10 ms.
#pragma once

#include <bit>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "renderer/bssrdf/diffusion_profile.h"
#include "renderer/util/shared_cache.h"

namespace tessera {

class ProfileCache {
 public:
  // `shared` outlives scenes; null: none does.
  explicit ProfileCache(std::shared_ptr<SharedCache> shared) : shared_(std::move(shared)) {}

  std::shared_ptr<const DiffusionProfile> Get(float g, float eta) {
    std::shared_ptr<const DiffusionProfile>& profile = profiles_[{g, eta}];
    if (profile) return profile;
    const std::string key = Key(g, eta);
    if (shared_) profile = shared_->Find<DiffusionProfile>(key);
    if (profile) return profile;
    profile = std::make_shared<const DiffusionProfile>(g, eta);
    if (shared_) shared_->Keep(key, profile, profile->bytes());
    return profile;
  }

 private:
  static std::string Key(float g, float eta) {
    return "diffusion profile " + std::to_string(std::bit_cast<uint32_t>(g)) + " " +
           std::to_string(std::bit_cast<uint32_t>(eta));
  }

  std::shared_ptr<SharedCache> shared_;
  std::map<std::pair<float, float>, std::shared_ptr<const DiffusionProfile>> profiles_;
};

}  // namespace tessera
