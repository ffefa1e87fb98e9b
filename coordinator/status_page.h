// The farm at a glance, for a browser.
#pragma once

#include <string>
#include <string_view>

#include "coordinator/farm_view.h"

namespace tessera {

// Text as it is written into HTML, between tags or in quotes.
std::string EscapeHtml(std::string_view text);
// A whole page that needs nothing else and asks for itself again every few seconds.
std::string StatusPage(const FarmView& view);

}  // namespace tessera
