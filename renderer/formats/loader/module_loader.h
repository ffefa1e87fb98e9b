// Access to OpenImageIO, which brings 300 shared libraries. It is in a module, a shared library of ours that
// lies beside the program and is loaded when the first picture needs it.
#pragma once

#include <memory>
#include <string>

#include "renderer/formats/module_interface.h"
#include "renderer/util/result.h"

namespace tessera::image_module {

// The functions of the module, which is loaded by the first call that succeeds and stays loaded. A program
// that is linked with renderer/formats/openimageio has them without a file. The error names the file. Thread
// safe.
Result<const Functions*> Load();

// Whether Load would find the file. Does not load it.
Result<void> CheckInstalled();

// The functions of the module in this file. dlopen searches no other folder.
Result<const Functions*> LoadFrom(const std::string& path);

// Owns an open picture.
struct Closer {
  void (*close)(OpenPicture* picture);
  void operator()(OpenPicture* picture) const { close(picture); }
};
using PictureHandle = std::unique_ptr<OpenPicture, Closer>;

// Returns the bytes of the file. Errors are the reasons, with no name.
Result<std::string> Encode(const RgbPicture& picture);

}  // namespace tessera::image_module
