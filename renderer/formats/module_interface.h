// The border between the programs and the module that wraps OpenImageIO. Both include this header. Only plain
// values and functions that throw nothing cross it, so that neither side depends on how the other was
// compiled.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tessera::image_module {

// Raised with every change of this header or of what the functions do.
constexpr uint32_t kVersion = 2;

enum class ValueType : uint32_t { kUint8, kUint16, kHalf, kFloat };

// Why a function failed; zero-terminated, perhaps several lines or empty.
struct Reason {
  char text[1024];
  uint32_t is_unsupported_format;  // OpenImageIO was built without it
};

// A file in memory, which must outlive the picture that is opened from it.
struct PictureFile {
  const char* format;  // as OpenImageIO calls it: "tiff"
  const char* name;    // for messages
  const void* bytes;
  size_t size;
  // OpenImageIO refuses larger pictures. Those of the first call are those of the process.
  int32_t channels_max;
  int32_t megabytes_max;
};

struct PictureInfo {
  int32_t width, height, channels;
  ValueType type;                    // of the values that `read` stores
  uint32_t is_deep_or_volume;        // such pictures cannot be read
  int32_t orientation;               // value of the tag of Exif and TIFF; 1 if there is none
  uint32_t has_chromaticities;       // the following are set
  float chromaticities[8];           // CIE xy of red, green, blue and white
  const char* const* channel_names;  // as many as channels, valid until `close`
};

// Pixels to encode: three values each, rows from top to bottom.
struct RgbPicture {
  const char* format;  // the ending that names it to OpenImageIO: "jpg"
  int32_t width, height;
  ValueType type;  // kUint8: sRGB; kFloat: linear
  const void* values;
};

struct EncodedFile {
  const void* bytes;
  size_t size;
  void* owner;  // of the bytes, until `release`
};

struct OpenPicture;

// Thread safe, but a picture is used by one thread at a time. Those that return a pointer or bool return null
// or false on failure and fill the reason.
struct Functions {
  uint32_t version;  // kVersion; the first member in all versions
  OpenPicture* (*open)(const PictureFile& file, PictureInfo& info, Reason& reason);
  // Stores width * height * channels values, rows from top to bottom as the file counts them, channels
  // interleaved. Alpha is not multiplied into the colours.
  bool (*read)(OpenPicture* picture, void* values, Reason& reason);
  void (*close)(OpenPicture* picture);
  bool (*encode)(const RgbPicture& picture, EncodedFile& file, Reason& reason);
  void (*release)(EncodedFile& file);
};

}  // namespace tessera::image_module

// The only symbol of the module that programs look for.
extern "C" const tessera::image_module::Functions* TesseraImageFormats();
