// Flags with which a picture is shown while it is rendered.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "client/live/live_views.h"
#include "client/live/tev_display.h"

namespace CLI {
class App;
}

namespace tessera {

struct LiveOptions {
  std::string preview;                // path; empty: none
  std::optional<TevAddress> display;  // a running tev
  bool any() const { return !preview.empty() || display.has_value(); }
};
void AddLiveFlags(CLI::App& app, LiveOptions& options);

// Fails if the preview cannot be what the options ask for (CheckPreview).
Result<void> CheckLive(const LiveOptions& options, const std::set<std::string>& inputs = {},
                       const std::vector<std::string>& outputs = {});

// What is shown, as its viewers call it.
struct LiveTitle {
  std::string name;
  bool is_sequence = false;
};

// Starts the views that the options ask for, each with a source of its own.
Result<void> AddViews(LiveViews& views, const LiveOptions& options, const LiveTitle& title,
                      const std::function<std::unique_ptr<PictureSource>()>& make_source);

}  // namespace tessera
