// A picture file that is replaced while the picture is rendered: --preview.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "client/live/picture_view.h"

namespace tessera {

// The file appears whole and is replaced by whole ones.
class PreviewFile : public PictureView {
 public:
  // `path` has passed CheckPreview.
  explicit PreviewFile(std::string path) : path_(std::move(path)) {}
  Result<void> Show(const LivePicture& picture, const std::stop_token& stop) override;

 private:
  const std::string path_;
};

// Fails if the name is not that of a picture to look at, if the module that encodes its format is not
// installed, or if it is one of the files that the command reads (`inputs`) or writes (`outputs`). A folder
// that does not exist or permits no writing is no error: the preview is a convenience.
Result<void> CheckPreview(const std::string& path, const std::set<std::string>& inputs,
                          const std::vector<std::string>& outputs);

}  // namespace tessera
