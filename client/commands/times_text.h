// Where a farm's time went, in words for people.
#pragma once

#include <string>

#include "proto/terms.h"

namespace tessera {

// Some lines: each part of the slots' time with its share, the largest first, and what the coordinator took.
// Empty if the farm has had no slots.
std::string TimesTable(const JobTimes& times);
// The same in one line: the parts that matter. Empty if the farm has had no slots.
std::string TimesLine(const JobTimes& times);

}  // namespace tessera
