// The farm at a glance, for a browser.
#pragma once

#include <string>
#include <string_view>

#include "coordinator/farm_view.h"

namespace tessera {

// Escapes text for HTML, between tags or in quotes.
std::string EscapeHtml(std::string_view text);
// A complete page that loads nothing else and reloads itself every few seconds.
std::string StatusPage(const FarmView& view);

}  // namespace tessera
