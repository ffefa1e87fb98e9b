#include "coordinator/core/schedule/job_message.h"

#include <fmt/format.h>

namespace tessera {

std::string UnitText(const JobSpec& spec, const WorkUnit& unit) {
  return fmt::format("tile {} of frame {}, samples {}", unit.tile, spec.frames[unit.frame].number,
                     unit.range.Text());
}

}  // namespace tessera
