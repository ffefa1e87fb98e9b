// Diffusion profiles by their parameters, each computed once.
#pragma once

#include <map>
#include <memory>
#include <utility>

#include "renderer/bssrdf/diffusion_profile.h"

namespace tessera {

class ProfileCache {
 public:
  std::shared_ptr<const DiffusionProfile> Get(float g, float eta) {
    std::shared_ptr<const DiffusionProfile>& profile = profiles_[{g, eta}];
    if (!profile) profile = std::make_shared<const DiffusionProfile>(g, eta);
    return profile;
  }

 private:
  std::map<std::pair<float, float>, std::shared_ptr<const DiffusionProfile>> profiles_;
};

}  // namespace tessera
