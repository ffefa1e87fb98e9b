// Checks of files, folders, certificates and disks.
#pragma once

#include <cstdint>
#include <string>

#include "client/doctor/finding.h"
#include "proto/identity/certificate.h"

namespace tessera {

// Whether others may read a folder with keys and everything in it. No finding if all is well.
Findings CheckPrivacy(const std::string& where, const std::string& folder);

// The certificate: when it expires, and whether that is soon. `renewal`: what renews it.
Finding CheckTimes(const std::string& where, const std::string& what, const Certificate& certificate,
                   UnixTime now, const std::string& renewal);

// Of a disk with `free` of `all` bytes free.
Severity SeverityOfSpace(uint64_t free, uint64_t all);
// The disk of an existing folder.
Finding CheckSpace(const std::string& where, const std::string& folder);

}  // namespace tessera
