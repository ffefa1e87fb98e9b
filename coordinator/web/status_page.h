// The pages for browsers.
#pragma once

#include <string>

#include "coordinator/web/farm_view.h"

namespace tessera {

// Whoever looks at a page.
struct PageReader {
  std::string name, role;
  std::string logout_proof;  // for the form that logs out; empty: there is nothing to end
};

// The farm at a glance, the same for all readers.
std::string StatusContent(const FarmView& view);
// A complete page that loads nothing else and reloads itself every few seconds.
std::string StatusPage(const std::string& content, const PageReader& reader);
// Asks for a token. Shows nothing about the farm. `proof` comes back with the form.
std::string LoginPage(const std::string& proof, const std::string& problem);

}  // namespace tessera
