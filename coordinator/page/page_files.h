// The files of the web page, which are part of this program.
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace tessera {

struct PageFile {
  std::string type;
  std::string etag;      // of these bytes, with quotes
  bool is_page = false;  // a document that loads the others
  std::shared_ptr<const std::string> bytes;
};

// The file at `path` of the server: the document at "/", others at "/page/NAME". Returns nullptr if there is
// none. Thread safe.
const PageFile* FindPageFile(std::string_view path);

}  // namespace tessera
