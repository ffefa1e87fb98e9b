#include "tests/chaos/acknowledged.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <sstream>

namespace tessera {
namespace {

constexpr const char* kEvent = " result_answered farm=";
constexpr const char* kAccepted = " verdict=accepted";

bool ReadLine(const std::string& line, Acknowledgement* read) {
  const size_t event = line.find(kEvent);
  if (event == std::string::npos || !line.ends_with(kAccepted)) return false;
  unsigned long long job = 0;
  unsigned frame = 0, tile = 0, begin = 0, end = 0;
  const size_t farm = event + std::strlen(kEvent);
  const size_t unit = line.find(' ', farm);
  if (unit == std::string::npos ||
      std::sscanf(line.c_str() + unit, " unit=\"job %llu frame %u tile %u samples [%u,%u)\"", &job, &frame,
                  &tile, &begin, &end) != 5) {
    return false;
  }
  *read = {line.substr(farm, unit - farm), job, frame, tile, {begin, end - begin},
           line.substr(0, line.find(' ')), 0};
  return true;
}

// Whether every sample of the range is in another range.
bool IsCovered(SampleRange range, const std::vector<SampleRange>& others) {
  uint64_t covered = 0;  // dyadic ranges are nested or disjoint
  for (const SampleRange& other : others) {
    if (other.Contains(range)) return true;
    const bool is_inside_another = std::any_of(others.begin(), others.end(), [&](const SampleRange& third) {
      return third != other && third.Contains(other) && range.Contains(third);
    });
    if (range.Contains(other) && !is_inside_another) covered += other.size;
  }
  return covered >= range.size;
}

}  // namespace

std::vector<Acknowledgement> ReadAcknowledgements(const std::string& log) {
  std::vector<Acknowledgement> all;
  std::istringstream lines(log);
  for (std::string line; std::getline(lines, line);) {
    Acknowledgement read;
    if (!lines.eof() && ReadLine(line, &read)) all.push_back(std::move(read));
  }
  return all;
}

std::vector<Acknowledgement> RenderedAgain(std::vector<Acknowledgement> all) {
  std::ranges::stable_sort(all, {}, [](const Acknowledgement& each) { return each.range.size; });
  using Tile = std::tuple<std::string, int, uint64_t, uint32_t, uint32_t>;
  std::map<Tile, std::vector<SampleRange>> tiles;
  std::vector<Acknowledgement> again;
  for (const Acknowledgement& each : all) {
    std::vector<SampleRange>& smaller = tiles[{each.farm, each.restores, each.job, each.frame, each.tile}];
    if (IsCovered(each.range, smaller)) again.push_back(each);
    if (std::ranges::find(smaller, each.range) == smaller.end()) smaller.push_back(each.range);
  }
  return again;
}

}  // namespace tessera
