#include "client/commands/live_options.h"

#include "client/commands/option_values.h"
#include "client/live/preview_file.h"
#include "proto/shell/flags.h"

namespace tessera {

void AddLiveFlags(CLI::App& app, LiveOptions& options) {
  AddText(app, "--preview", "FILE",
          "Keep a .png or .jpg file of the picture while it is rendered, for viewers that read files again",
          options.preview);
  AddValue(app, "--display", "tev://HOST:PORT",
           "Show the picture in a running tev while it is rendered, with all of its layers", options.display,
           ParseTevAddress);
}

Result<void> CheckLive(const LiveOptions& options, const std::set<std::string>& inputs,
                       const std::vector<std::string>& outputs) {
  return options.preview.empty() ? Result<void>() : CheckPreview(options.preview, inputs, outputs);
}

Result<void> AddViews(LiveViews& views, const LiveOptions& options, const LiveTitle& title,
                      const std::function<std::unique_ptr<PictureSource>()>& make_source) {
  if (!options.preview.empty()) {
    auto added = views.Add(make_source(), std::make_unique<PreviewFile>(options.preview));
    if (!added) return added;
  }
  if (!options.display) return {};
  return views.Add(make_source(),
                   std::make_unique<TevDisplay>(*options.display, title.name, title.is_sequence));
}

}  // namespace tessera
