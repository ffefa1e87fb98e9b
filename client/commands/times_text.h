// How a farm spent its time, as text for people.
#pragma once

#include <string>

#include "proto/terms.h"

namespace tessera {

// A line for each part of the slots' time with its share, the largest first, and a line with the time of the
// coordinator. Empty if the farm has had no slots.
std::string TimesTable(const JobTimes& times);
// The parts of at least one per cent in one line. Empty if the farm has had no slots.
std::string TimesLine(const JobTimes& times);

}  // namespace tessera
