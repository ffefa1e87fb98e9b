// The module: OpenImageIO behind the functions of module_interface.h.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/formats/module_interface.h"
#include "renderer/formats/openimageio/webp_frame.h"

namespace tessera::image_module {

// Reads at positions of the file only: they come from the file itself, and the library's class takes any.
class BoundedReader final : public OIIO::Filesystem::IOMemReader {
 public:
  using IOMemReader::IOMemReader;
  bool seek(int64_t offset) override { return offset >= 0 && IOMemReader::seek(offset); }
  size_t read(void* values, size_t size) override {
    const size_t count = pread(values, size, m_pos);
    m_pos += static_cast<int64_t>(count);
    return count;
  }
  size_t pread(void* values, size_t size, int64_t offset) override {
    const size_t whole = this->size();
    if (offset < 0 || static_cast<uint64_t>(offset) >= whole) return 0;
    const size_t count = std::min(size, whole - static_cast<size_t>(offset));
    std::memcpy(values, buffer().data() + offset, count);
    return count;
  }
};

struct OpenPicture {
  explicit OpenPicture(const PictureFile& file)
      : memory(file.bytes, file.size), bytes(static_cast<const char*>(file.bytes), file.size) {}

  BoundedReader memory;
  std::string_view bytes;
  std::unique_ptr<OIIO::ImageInput> input;  // reads from `memory`
  OIIO::TypeDesc type;
  std::vector<const char*> channel_names;
};

namespace {

void Explain(std::string_view text, Reason& reason) noexcept {
  const size_t size = std::min(text.size(), sizeof reason.text - 1);
  std::copy_n(text.data(), size, reason.text);
  reason.text[size] = '\0';
}

// Calls `body`, which returns whether it succeeded, and turns what it throws into a reason.
template <typename Body>
bool CatchAll(Reason& reason, const Body& body) noexcept {
  try {
    return body();
  } catch (const std::exception& e) {
    Explain(e.what(), reason);
  } catch (...) {
    Explain("", reason);
  }
  return false;
}

// Keeps the library from starting threads: the process decides how many there are.
void SetThreads() {
  static std::once_flag once;
  std::call_once(once, [] {
    OIIO::attribute("threads", 1);
    OIIO::attribute("exr_threads", -1);
  });
}

void SetLimits(const PictureFile& file) {
  static std::once_flag once;
  std::call_once(once, [&file] {
    OIIO::attribute("limits:channels", file.channels_max);
    OIIO::attribute("limits:imagesize_MB", file.megabytes_max);
  });
}

// What the values are read as.
ValueType ReadType(const OIIO::TypeDesc& stored) {
  switch (stored.basetype) {
    case OIIO::TypeDesc::UINT8: return ValueType::kUint8;
    case OIIO::TypeDesc::UINT16: return ValueType::kUint16;
    case OIIO::TypeDesc::HALF: return ValueType::kHalf;
    default: return ValueType::kFloat;
  }
}

OIIO::TypeDesc TypeDescOf(ValueType type) {
  switch (type) {
    case ValueType::kUint8: return OIIO::TypeDesc::UINT8;
    case ValueType::kUint16: return OIIO::TypeDesc::UINT16;
    case ValueType::kHalf: return OIIO::TypeDesc::HALF;
    case ValueType::kFloat: break;
  }
  return OIIO::TypeDesc::FLOAT;
}

// Whether the library can count the rows and columns: TIFF and PNG files may begin anywhere. To the number of
// a row it adds up to 2^26 more.
bool CanBeCounted(const OIIO::ImageSpec& spec) {
  constexpr int64_t kMax = int64_t{1} << 30;
  return std::min(spec.x, spec.y) >= -kMax && int64_t{spec.x} + spec.width <= kMax &&
         int64_t{spec.y} + spec.height <= kMax;
}

// Whether the tiles, if there are any, are at most a little larger than the picture. The library allocates
// whole tiles, and counts the bytes of a tile with integers that overflow.
bool HasUsualTiles(const OIIO::ImageSpec& spec) {
  constexpr int64_t kBeyondPicture = 1024;  // in pixels
  return spec.tile_width <= spec.width + kBeyondPicture && spec.tile_height <= spec.height + kBeyondPicture &&
         spec.tile_depth <= 1 && std::min({spec.tile_width, spec.tile_height, spec.tile_depth}) >= 0;
}

void Describe(OpenPicture& picture, PictureInfo& info) {
  const OIIO::ImageSpec& spec = picture.input->spec();
  info.width = spec.width;
  info.height = spec.height;
  info.channels = spec.nchannels;
  info.type = ReadType(spec.format);
  info.is_deep_or_volume = spec.deep || spec.depth > 1 ? 1 : 0;
  info.orientation = spec.get_int_attribute("Orientation", 1);
  const OIIO::TypeDesc eight_floats(OIIO::TypeDesc::FLOAT, 8);
  info.has_chromaticities = spec.getattribute("chromaticities", eight_floats, info.chromaticities) ? 1 : 0;
  for (const std::string& name : spec.channelnames) picture.channel_names.push_back(name.c_str());
  info.channel_names = picture.channel_names.data();
  picture.type = TypeDescOf(info.type);
}

OpenPicture* Open(const PictureFile& file, PictureInfo& info, Reason& reason) {
  std::unique_ptr<OpenPicture> picture;
  const bool opened = CatchAll(reason, [&] {
    SetThreads();
    SetLimits(file);
    picture = std::make_unique<OpenPicture>(file);
    picture->input = OIIO::ImageInput::create(file.format);
    if (!picture->input || !picture->input->supports("ioproxy")) {
      static_cast<void>(OIIO::geterror());
      reason.is_unsupported_format = 1;
      return false;
    }
    picture->input->set_ioproxy(&picture->memory);
    OIIO::ImageSpec spec, configuration;
    configuration.attribute("oiio:UnassociatedAlpha", 1);
    if (!picture->input->open(file.name, spec, configuration)) {
      Explain(picture->input->geterror(), reason);
      return false;
    }
    if (!CanBeCounted(picture->input->spec())) {
      Explain("its position is out of range", reason);
      return false;
    }
    if (!HasUsualTiles(picture->input->spec())) {
      Explain("its tiles are far larger than the picture", reason);
      return false;
    }
    Describe(*picture, info);
    return true;
  });
  return opened ? picture.release() : nullptr;
}

// Whether the library must read a TIFF picture row by row, with libtiff. Otherwise it unpacks many strips by
// itself, and reports success for those that are too short. It overruns strips of more rows than the picture
// has, such as 2^32 - 1. Rows of separate planes it reads slowly, since each unpacks its strips from the
// start.
bool IsReadByRows(const OIIO::ImageInput& input) {
  if (std::strcmp(input.format_name(), "tiff") != 0) return false;
  const OIIO::ImageSpec& spec = input.spec();
  const int rows_per_strip = spec.get_int_attribute("tiff:RowsPerStrip", 0);
  const bool has_usual_strips = rows_per_strip > 0 && rows_per_strip <= spec.height;
  return spec.get_string_attribute("planarconfig") != "separate" || !has_usual_strips;
}

// Reads all rows and stops at the first that are damaged. The library collects an error for each row of each
// channel that it is asked for, and aborts the process when it has 16 MB of them. Of TIFF files it reports
// success in spite of errors. Rows of tiles it reads one by one.
bool ReadRows(OIIO::ImageInput& input, const OIIO::TypeDesc& type, void* values) {
  constexpr int kErrorsMax = 8192;  // of some hundred bytes each
  constexpr int kBlock = 256;       // no format compresses more rows together, so none is decoded twice
  const OIIO::ImageSpec spec = input.spec();
  if (spec.tile_width != 0)
    return input.read_image(0, 0, 0, spec.nchannels, type, values) && !input.has_error();
  const bool is_read_by_rows = IsReadByRows(input);
  const int rows = is_read_by_rows ? 1 : std::max(kBlock, kErrorsMax / spec.nchannels / kBlock * kBlock);
  const size_t row_bytes =
      static_cast<size_t>(spec.width) * static_cast<size_t>(spec.nchannels) * type.size();
  for (int y = 0; y < spec.height; y += rows) {
    const int end = std::min(y + rows, spec.height);
    char* const at = static_cast<char*>(values) + static_cast<size_t>(y) * row_bytes;
    const bool is_read = is_read_by_rows ? input.read_scanline(spec.y + y, spec.z, type, at)
                                         : input.read_scanlines(0, 0, spec.y + y, spec.y + end, spec.z, 0,
                                                                spec.nchannels, type, at);
    if (!is_read || input.has_error()) return false;
  }
  return true;
}

// Decodes with libwebp, because OpenImageIO multiplies alpha into the colours of this format, whatever the
// configuration says, and leaves values undefined where the first frame of an animation does not reach.
bool ReadWebp(OpenPicture& picture, void* values, Reason& reason) {
  const OIIO::ImageSpec& spec = picture.input->spec();
  const WebpCanvas canvas{spec.width, spec.height, spec.nchannels};
  if (DecodeWebpFrame(picture.bytes, canvas, static_cast<uint8_t*>(values))) return true;
  Explain("the pixels cannot be decoded", reason);
  return false;
}

bool Read(OpenPicture* picture, void* values, Reason& reason) {
  return CatchAll(reason, [&] {
    if (std::strcmp(picture->input->format_name(), "webp") == 0) return ReadWebp(*picture, values, reason);
    if (ReadRows(*picture->input, picture->type, values)) return true;
    Explain(picture->input->geterror(), reason);
    return false;
  });
}

void Close(OpenPicture* picture) {
  Reason ignored;
  CatchAll(ignored, [&] {
    picture->input->close();
    return true;
  });
  delete picture;
}

using Bytes = std::vector<unsigned char>;

bool Encode(const RgbPicture& picture, EncodedFile& file, Reason& reason) {
  return CatchAll(reason, [&] {
    SetThreads();
    auto encoded = std::make_unique<Bytes>();
    OIIO::Filesystem::IOVecOutput memory(*encoded);
    const std::string_view format = picture.format;
    const std::string name = "memory." + std::string(format);
    const auto output = OIIO::ImageOutput::create(name, &memory);
    if (!output) {
      Explain(OIIO::geterror(), reason);
      return false;
    }
    const OIIO::TypeDesc type = TypeDescOf(picture.type);
    OIIO::ImageSpec spec(picture.width, picture.height, 3, type);
    spec.attribute("oiio:ColorSpace", picture.type == ValueType::kUint8 ? "sRGB" : "Linear");
    if (format == "jpg") spec.attribute("Compression", "jpeg:95");
    // The library would write the current time, and equal pictures would be different files. This is how Exif
    // writes an unknown time.
    if (format == "tif") spec.attribute("DateTime", "    :  :     :  :  ");
    output->set_ioproxy(&memory);
    if (!output->open(name, spec) || !output->write_image(type, picture.values) || !output->close()) {
      Explain(output->geterror(), reason);
      return false;
    }
    file = {encoded->data(), encoded->size(), encoded.get()};
    static_cast<void>(encoded.release());
    return true;
  });
}

void Release(EncodedFile& file) {
  delete static_cast<Bytes*>(file.owner);
  file = {};
}

}  // namespace
}  // namespace tessera::image_module

extern "C" __attribute__((visibility("default"))) const tessera::image_module::Functions*
TesseraImageFormats() {
  using namespace tessera::image_module;
  static constexpr Functions kFunctions{kVersion, Open, Read, Close, Encode, Release};
  return &kFunctions;
}
