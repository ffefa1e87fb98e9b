#include "client/doctor/file_checks.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <optional>

namespace tessera {
namespace {

constexpr mode_t kOthers = 0077;
constexpr size_t kFilesMax = 1000;  // that are looked at in one folder
// A certificate that renews itself does so when two thirds of its life are left, so this close to its end
// something is wrong. Those of a few days have less.
constexpr UnixTime kSoon_s = 14 * 24 * 3600;
constexpr int kSoonPart = 4;
// What a coordinator keeps free of scene files, and what its journal needs at least.
constexpr uint64_t kSpaceLow = uint64_t{1} << 30, kSpaceLowPart = 20;
constexpr uint64_t kSpaceMin = uint64_t{64} << 20;

std::optional<Finding> CheckMode(const std::string& where, const std::string& path) {
  struct stat status {};
  if (::lstat(path.c_str(), &status) != 0) {
    return Finding{Severity::kProblem, where, fmt::format("{}: {}", path, std::strerror(errno)),
                   "run this command as the user that the folder belongs to"};
  }
  // Root may look at the folders of others.
  if (status.st_uid != ::geteuid() && ::geteuid() != 0) {
    return Finding{Severity::kProblem, where,
                   fmt::format("{} belongs to another user (uid {})", path, status.st_uid),
                   "programs of this user do not use it: give it to this user or remove it"};
  }
  if (S_ISLNK(status.st_mode) || (status.st_mode & kOthers) == 0) return std::nullopt;
  return Finding{
      Severity::kProblem, where,
      fmt::format("others may read or change {} (mode {:o})", path, status.st_mode & 07777),
      fmt::format("run: chmod go= {}; if others have used this machine, revoke and join again", path)};
}

}  // namespace

Findings CheckPrivacy(const std::string& where, const std::string& folder) {
  Findings findings;
  const auto check = [&](const std::string& path) {
    if (auto found = CheckMode(where, path)) findings.push_back(std::move(*found));
  };
  check(folder);
  std::vector<std::string> paths;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (paths.size() < kFilesMax) paths.push_back(entry.path());
  }
  std::ranges::sort(paths);
  for (const std::string& each : paths) check(each);
  return findings;
}

Finding CheckTimes(const std::string& where, const std::string& what, const Certificate& certificate,
                   UnixTime now, const std::string& renewal) {
  const UnixTime begin = certificate.NotBefore(), end = certificate.NotAfter();
  const UnixTime soon = std::min(kSoon_s, (end - begin) / kSoonPart);
  if (end <= now) {
    return {Severity::kProblem, where, fmt::format("{} expired on {}", what, UnixTimeText(end)), renewal};
  }
  if (begin > now) {
    return {Severity::kProblem, where,
            fmt::format("{} is valid from {} on, which is later than now", what, UnixTimeText(begin)),
            "correct the clock of this machine or of the one that issued it"};
  }
  if (end - now < soon) {
    return {Severity::kWarning, where, fmt::format("{} expires soon, on {}", what, UnixTimeText(end)),
            renewal};
  }
  return {Severity::kGood, where, fmt::format("{} is valid until {}", what, UnixTimeText(end)), {}};
}

Severity SeverityOfSpace(uint64_t free, uint64_t all) {
  if (free >= std::min(kSpaceLow, all / kSpaceLowPart)) return Severity::kGood;
  return free < kSpaceMin ? Severity::kProblem : Severity::kWarning;
}

Finding CheckSpace(const std::string& where, const std::string& folder) {
  struct statvfs disk {};
  if (::statvfs(folder.c_str(), &disk) != 0)
    return {Severity::kProblem, where, fmt::format("{}: {}", folder, std::strerror(errno)),
            "make the folder available"};
  const uint64_t free = uint64_t{disk.f_bavail} * disk.f_frsize,
                 all = uint64_t{disk.f_blocks} * disk.f_frsize;
  const std::string what =
      fmt::format("{:.1f} of {:.1f} GB are free on the disk of {}", static_cast<double>(free) / 1e9,
                  static_cast<double>(all) / 1e9, folder);
  const Severity severity = SeverityOfSpace(free, all);
  return {severity, where, what,
          severity == Severity::kGood ? "" : "make room: jobs pause while the disk is full"};
}

}  // namespace tessera
