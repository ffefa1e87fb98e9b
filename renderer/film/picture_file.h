// Pictures to and from files.
#pragma once

#include <string>
#include <string_view>

#include "renderer/film/frame_spec.h"
#include "renderer/film/merger.h"
#include "renderer/film/picture_format.h"

namespace tessera {

// Sets on how many threads of this process the functions below compress and decompress pixels. By default
// that of the caller does. Bytes and values are the same for any number. Not while one of them runs.
void UseThreadsForPictures(int threads);

// The bytes of an OpenEXR file: display window from the spec, data window from its crop, attributes from the
// spec. Equal pictures give equal bytes.
Result<std::string> EncodeExr(const FrameSpec& spec, const FramePicture& picture);

// A decoded OpenEXR file: every channel as float.
struct LoadedPicture {
  int width = 0, height = 0;  // display window
  PixelBounds bounds;         // data window
  std::vector<std::string> channels;
  std::vector<float> values;                      // [(y * width + x) * channels + c] over the data window
  std::map<std::string, std::string> attributes;  // of text, and those of FrameSpec::attributes
  std::vector<ExrType> types;                     // of the channels in the file; missing ones count as float
  ExrFormat format;                               // of the file
};
// The bytes of a file that holds the same picture.
Result<std::string> EncodeExr(const LoadedPicture& picture, const ExrFormat& format);
// Floats that are not compressed, headers and tables, of the largest picture that is read.
constexpr uint64_t kExrFileSizeMax = (uint64_t{4} << 30) + (uint64_t{64} << 20);
Result<LoadedPicture> LoadExr(const std::string& path);
// Decodes the bytes of an OpenEXR file. Errors call them `name`.
Result<LoadedPicture> DecodeExr(std::string_view bytes, const std::string& name);

// What a file says of its picture, without the pixels.
struct PictureHeader {
  struct FileChannel {
    std::string name;
    std::string type;  // "half", "float" or "uint"
  };
  struct Attribute {
    std::string name, type;  // the type as OpenEXR calls it
    std::string text;
  };
  int width = 0, height = 0;  // display window
  PixelBounds bounds;         // data window
  ExrFormat format;
  int preview_width = 0, preview_height = 0;  // 0: there is none
  std::vector<FileChannel> channels;
  std::vector<Attribute> attributes;  // of text and numbers, by name
};
// The header of an OpenEXR file whose pixels DecodeExr could read. Errors call the bytes `name`.
Result<PictureHeader> ReadExrHeader(std::string_view bytes, const std::string& name);
// Whether the bytes are the start of an OpenEXR file.
bool IsExr(std::string_view bytes);

}  // namespace tessera
