// Preloaded into a program to make its time of day wrong by $TESSERA_TEST_CLOCK_SHIFT_S seconds.
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <cstdlib>

extern "C" int clock_gettime(clockid_t clock, timespec* time) noexcept {
  const long result = ::syscall(SYS_clock_gettime, clock, time);
  const char* const shift = std::getenv("TESSERA_TEST_CLOCK_SHIFT_S");
  if (result == 0 && clock == CLOCK_REALTIME && shift != nullptr) time->tv_sec += std::atol(shift);
  return static_cast<int>(result);
}
