#include "renderer/image/library_formats.h"

#include <cstring>
#include <exception>
#include <mutex>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <immintrin.h>

#include "renderer/description/source_location.h"
#include "renderer/image/container_check.h"
#include "renderer/image/declared_size.h"
#include "renderer/image/exr_header.h"
#include "renderer/image/image_limits.h"
#include "renderer/image/orientation.h"

namespace tessera {
namespace {

const char* PluginName(ImageFormat format) {
  switch (format) {
    case ImageFormat::kExr: return "openexr";
    case ImageFormat::kPng: return "png";
    case ImageFormat::kJpeg: return "jpeg";
    case ImageFormat::kTga: return "targa";
    case ImageFormat::kHdr: return "hdr";
    case ImageFormat::kTiff: return "tiff";
    case ImageFormat::kBmp: return "bmp";
    default: return "webp";
  }
}

// Keeps the library from starting threads: the process decides how many there are.
void SetUpLibrary() {
  static std::once_flag once;
  std::call_once(once, [] {
    OIIO::attribute("threads", 1);
    OIIO::attribute("exr_threads", -1);
    OIIO::attribute("limits:channels", static_cast<int>(kImageChannelsMax));
    OIIO::attribute("limits:imagesize_MB", static_cast<int>(kImageBytesMax >> 20));
  });
}

Error Damaged(const std::string& name, ImageFormat format, std::string reason) {
  while (!reason.empty() && (reason.back() == '\n' || reason.back() == ' ')) reason.pop_back();
  const std::string why = OneLine(reason);
  return BadInput(
      fmt::format("{}: damaged {} picture{}{}", name, FormatName(format), why.empty() ? "" : ": ", why));
}

// What the values are read as.
OIIO::TypeDesc ReadType(const OIIO::TypeDesc& stored) {
  switch (stored.basetype) {
    case OIIO::TypeDesc::UINT8: return OIIO::TypeDesc::UINT8;
    case OIIO::TypeDesc::UINT16: return OIIO::TypeDesc::UINT16;
    case OIIO::TypeDesc::HALF: return OIIO::TypeDesc::HALF;
    default: return OIIO::TypeDesc::FLOAT;
  }
}

// Turns 16-bit integers into linear halves, in place.
void DecodeUint16(std::vector<uint8_t>& bytes, const ColorEncoding& encoding) {
  for (size_t i = 0; i + 1 < bytes.size(); i += 2) {
    uint16_t value;
    std::memcpy(&value, &bytes[i], sizeof value);
    const uint16_t half =
        _cvtss_sh(encoding.ToLinear(static_cast<float>(value) / 65535.0f), _MM_FROUND_TO_NEAREST_INT);
    std::memcpy(&bytes[i], &half, sizeof half);
  }
}

// Keeps the first `kept` channels of every pixel.
void DropChannels(Image& image, int kept) {
  const size_t value_size = image.format == PixelFormat::kUint8  ? 1
                            : image.format == PixelFormat::kHalf ? 2
                                                                 : 4;
  const size_t pixels = static_cast<size_t>(image.width) * image.height;
  for (size_t i = 0; i < pixels; ++i) {
    std::memmove(&image.bytes[i * kept * value_size], &image.bytes[i * image.channels * value_size],
                 kept * value_size);
  }
  image.bytes.resize(pixels * kept * value_size);
  image.channels = kept;
  image.channel_names.resize(kept);
}

// Whether a PNG, already checked, stores alpha in each pixel. The library also makes an alpha channel of a
// transparent colour and of transparent entries of a palette.
bool StoresAlpha(const std::string& png) {
  constexpr size_t kColorTypeAt = 25;
  constexpr char kAlphaUsed = 4;  // one bit of the colour type
  return (png[kColorTypeAt] & kAlphaUsed) != 0;
}

// Whether pbrt reads the alpha of such a file: it has none of what it reads with stb_image, and only the one
// that a PNG stores in its pixels.
bool HasAlphaInPbrt(ImageFormat format, const std::string& bytes) {
  if (format == ImageFormat::kPng) return StoresAlpha(bytes);
  return format != ImageFormat::kTga && format != ImageFormat::kBmp;
}

void DropAlphaAsPbrt(ImageFormat format, const std::string& bytes, Image& image) {
  if (HasAlphaInPbrt(format, bytes)) return;
  if (image.channels == 2 || image.channels == 4) DropChannels(image, image.channels - 1);
  if (image.channels == 1) image.channel_names = {"Y"};
}

// Of the pixels as the library returns them.
Orientation OrientationOf(const OIIO::ImageSpec& spec, ImageFormat format, const std::string& bytes) {
  std::optional<Orientation> orientation;
  // The library confuses two of the eight.
  if (format == ImageFormat::kHdr) orientation = OrientationOfRadiance(bytes);
  if (format == ImageFormat::kTiff) orientation = OrientationOfTag(spec.get_int_attribute("Orientation", 1));
  return orientation.value_or(Orientation{});
}

std::optional<Chromaticities> ChromaticitiesOf(const OIIO::ImageSpec& spec, ImageFormat format) {
  if (format != ImageFormat::kExr) return std::nullopt;
  std::array<float, 8> xy;
  if (!spec.getattribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), xy.data()))
    return std::nullopt;
  return Chromaticities{{xy[0], xy[1]}, {xy[2], xy[3]}, {xy[4], xy[5]}, {xy[6], xy[7]}};
}

Result<Image> ReadPixels(OIIO::ImageInput& input, ImageFormat format, const std::string& name,
                         const std::string& bytes, std::optional<ColorEncoding> encoding) {
  const OIIO::ImageSpec& spec = input.spec();
  if (spec.deep || spec.depth > 1)
    return BadInput(fmt::format("{}: deep and volume pictures are not supported", name));
  const OIIO::TypeDesc type = ReadType(spec.format);
  const Result<void> size =
      CheckImageSize(name, spec.width, spec.height, spec.nchannels, type.size(), bytes.size());
  if (!size) return size.error();

  Image image;
  image.width = spec.width;
  image.height = spec.height;
  image.channels = spec.nchannels;
  image.encoding = encoding.value_or(ColorEncoding{ColorEncoding::Kind::kSrgb, 1});
  image.channel_names = spec.channelnames;
  image.bytes.resize(static_cast<size_t>(spec.width) * spec.height * spec.nchannels * type.size());
  if (!input.read_image(0, 0, 0, spec.nchannels, type, image.bytes.data())) {
    return Damaged(name, format, input.geterror());
  }
  image.format = type == OIIO::TypeDesc::UINT8 ? PixelFormat::kUint8 : PixelFormat::kHalf;
  if (type == OIIO::TypeDesc::FLOAT) image.format = PixelFormat::kFloat;
  if (type == OIIO::TypeDesc::UINT16) DecodeUint16(image.bytes, image.encoding);
  if (image.channels == 1) image.channel_names = {"Y"};
  image.chromaticities = ChromaticitiesOf(spec, format);
  DropAlphaAsPbrt(format, bytes, image);
  MakeUpright(image, OrientationOf(spec, format, bytes));
  return image;
}

Result<Image> Decode(ImageFormat format, const std::string& bytes, const std::string& name,
                     std::optional<ColorEncoding> encoding) {
  const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::create(PluginName(format));
  if (!input || !input->supports("ioproxy")) {
    static_cast<void>(OIIO::geterror());
    return BadInput(fmt::format("{}: this build cannot read {} pictures", name, FormatName(format)));
  }
  OIIO::Filesystem::IOMemReader reader(bytes.data(), bytes.size());
  input->set_ioproxy(&reader);
  OIIO::ImageSpec spec, configuration;
  configuration.attribute("oiio:UnassociatedAlpha", 1);
  if (!input->open(name, spec, configuration)) return Damaged(name, format, input->geterror());
  Result<Image> image = ReadPixels(*input, format, name, bytes, encoding);
  input->close();
  return image;
}

}  // namespace

Result<Image> DecodeWithLibrary(ImageFormat format, const std::string& bytes, const std::string& name,
                                std::optional<ColorEncoding> encoding) {
  SetUpLibrary();
  Result<void> checked = CheckDeclaredSize(format, bytes, name);
  if (!checked) return checked.error();
  if (format == ImageFormat::kExr) checked = CheckExr(bytes, name);
  if (format == ImageFormat::kPng) checked = CheckPng(bytes, name);
  if (format == ImageFormat::kJpeg) checked = CheckJpeg(bytes, name);
  if (!checked) return checked.error();
  try {
    return Decode(format, bytes, name, encoding);
  } catch (const std::exception& exception) {
    return Damaged(name, format, exception.what());
  } catch (...) {
    return Damaged(name, format, "");
  }
}

}  // namespace tessera
