#include "coordinator/public_addresses.h"

#include <algorithm>

namespace tessera {
namespace {

bool IsIpv4(const std::string& name) {
  return name.find_first_not_of("0123456789.") == std::string::npos;
}

}  // namespace

std::vector<std::string> PublicAddresses(const std::vector<Address>& listen, std::vector<std::string> names,
                                         bool names_are_chosen) {
  if (!names_are_chosen) std::stable_partition(names.begin(), names.end(), IsIpv4);
  std::vector<std::string> found, local;
  for (const Address& address : listen) {
    if (address.kind != Address::Kind::kTcp) continue;
    const bool is_wildcard = address.host == "0.0.0.0" || address.host == "::";
    if (!is_wildcard) (address.IsLocal() ? local : found).push_back(address.Text());
    if (!is_wildcard && !names_are_chosen) continue;
    for (const std::string& name : names) {
      Address named = address;
      named.host = name;
      found.push_back(named.Text());
    }
    if (names_are_chosen)
      std::rotate(found.begin(), found.end() - static_cast<std::ptrdiff_t>(names.size()), found.end());
  }
  found.insert(found.end(), local.begin(), local.end());
  return found;
}

}  // namespace tessera
