// The picture of a job on a farm, while it is rendered.
#pragma once

#include <memory>
#include <optional>

#include "client/coordinator/coordinator_client.h"
#include "client/live/picture_view.h"

namespace tessera {

// The frame that is being rendered, or the last one when all are finished. Has a connection of its own.
class FarmPictures : public PictureSource {
 public:
  FarmPictures(Endpoint endpoint, JobId job) : endpoint_(std::move(endpoint)), job_(job) {}
  Result<std::optional<LivePicture>> Next(const std::stop_token& stop) override;

 private:
  struct State {
    uint64_t samples = 0;  // of all frames
    uint32_t finished = 0;
    bool operator==(const State&) const = default;
  };

  const Endpoint endpoint_;
  const JobId job_;
  std::unique_ptr<CoordinatorClient> client_;
  State shown_;
};

}  // namespace tessera
