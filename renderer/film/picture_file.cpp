#include "renderer/film/picture_file.h"

#include <ImathBox.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfThreading.h>
#include <ImfTiledOutputFile.h>
#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <span>

#include "renderer/exr/exr_header.h"
#include "renderer/film/exr_memory.h"
#include "renderer/film/picture_attributes.h"
#include "renderer/film/picture_preview.h"
#include "renderer/util/file.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

constexpr float kHalfMax = 65504.0f;  // the largest finite half
// 4 GB of floats: a 16k x 16k picture of four channels.
constexpr int64_t kLoadedValuesMax = int64_t{1} << 30;
// Values per byte of the file, and values that any file may have. ZIP packs up to 516 halves into a byte.
constexpr int64_t kValuesPerByteMax = 5000;
constexpr int64_t kValuesFloor = int64_t{1} << 22;
static_assert(kExrFileSizeMax >= sizeof(float) * uint64_t{kLoadedValuesMax});

Imath::Box2i ToBox(const PixelBounds& bounds) {
  return {Imath::V2i(bounds.x0, bounds.y0), Imath::V2i(bounds.x1 - 1, bounds.y1 - 1)};
}

// Strides of interleaved values of which each is `size` bytes.
Imf::Slice ValueSlice(Imf::PixelType type, char* first, size_t size, const PixelBounds& bounds,
                      size_t channels) {
  const size_t pixel = channels * size;
  const size_t row = pixel * static_cast<size_t>(bounds.width());
  // OpenEXR wants the address that pixel (0, 0) would have, which is before the first of ours; so it is
  // computed as a number.
  const auto origin = reinterpret_cast<intptr_t>(first) - bounds.x0 * static_cast<intptr_t>(pixel) -
                      bounds.y0 * static_cast<intptr_t>(row);
  return {type, reinterpret_cast<char*>(origin), pixel, row};  // NOLINT(performance-no-int-to-ptr)
}

std::vector<half> ToHalf(std::span<const float> values) {
  std::vector<half> halves(values.size());
  for (size_t i = 0; i < values.size(); ++i) halves[i] = half(std::clamp(values[i], -kHalfMax, kHalfMax));
  return halves;
}

Result<void> CheckPicture(const FrameSpec& spec, const FramePicture& picture) {
  if (picture.bounds != spec.crop) return Failed("the picture is not of the frame's crop");
  const size_t count = static_cast<size_t>(picture.bounds.area()) * picture.channels.size();
  if (picture.values.size() != count) return Failed("the picture's values do not fill its window");
  if (!std::ranges::equal(picture.channels, spec.PictureChannels(), {}, {}, &PictureChannel::name))
    return Failed("the picture's channels are not those that the frame writes");
  return spec.Check();
}

Result<void> CheckLoaded(const LoadedPicture& picture) {
  const PixelBounds& bounds = picture.bounds;
  if (bounds.width() < 1 || bounds.height() < 1 || picture.width < 1 || picture.height < 1 ||
      picture.channels.empty())
    return Failed("the picture is empty");
  if (picture.values.size() != static_cast<size_t>(bounds.area()) * picture.channels.size())
    return Failed("the picture's values do not fill its window");
  for (const auto& [name, value] : picture.attributes) {
    if (!IsAttributeValue(name, value))
      return Failed(fmt::format("attribute \"{}\" has a value that is not of its type", name));
  }
  return {};
}

// A picture as it goes into a file.
struct FilePicture {
  int width = 0, height = 0;  // display window
  PixelBounds bounds;         // data window
  std::span<const std::string> channels;
  std::vector<ExrType> types;
  std::span<const float> values;
  const std::map<std::string, std::string>& attributes;
};

Imf::Header HeaderOf(const FilePicture& picture, const ExrFormat& format) {
  const Imath::Box2i display(Imath::V2i(0, 0), Imath::V2i(picture.width - 1, picture.height - 1));
  Imf::Header header(display, ToBox(picture.bounds));
  header.compression() = static_cast<Imf::Compression>(format.compression);
  for (const auto& [name, value] : picture.attributes) AddAttribute(name, value, header);
  if (format.is_tiled) header.setTileDescription(Imf::TileDescription(kExrTileSize, kExrTileSize));
  if (format.has_preview) {
    const auto preview = MakePreviewImage(picture.bounds, picture.channels, picture.values);
    if (preview) header.setPreviewImage(*preview);
  }
  for (size_t c = 0; c < picture.channels.size(); ++c) {
    const bool is_half = picture.types[c] == ExrType::kHalf;
    header.channels().insert(picture.channels[c], Imf::Channel(is_half ? Imf::HALF : Imf::FLOAT));
  }
  return header;
}

std::string EncodeChecked(const FilePicture& picture, const ExrFormat& format) {
  const Imf::Header header = HeaderOf(picture, format);
  const bool has_halves = std::ranges::find(picture.types, ExrType::kHalf) != picture.types.end();
  const std::vector<half> halves = has_halves ? ToHalf(picture.values) : std::vector<half>();
  Imf::FrameBuffer buffer;
  for (size_t c = 0; c < picture.channels.size(); ++c) {
    const bool is_half = picture.types[c] == ExrType::kHalf;
    const void* first = is_half ? static_cast<const void*>(&halves[c]) : &picture.values[c];
    // OpenEXR only reads when it writes a file.
    char* const base = const_cast<char*>(static_cast<const char*>(first));
    buffer.insert(picture.channels[c],
                  ValueSlice(is_half ? Imf::HALF : Imf::FLOAT, base, is_half ? sizeof(half) : sizeof(float),
                             picture.bounds, picture.channels.size()));
  }
  MemoryOutput output;
  if (format.is_tiled) {
    Imf::TiledOutputFile file(output, header);
    file.setFrameBuffer(buffer);
    file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
  } else {
    Imf::OutputFile file(output, header);
    file.setFrameBuffer(buffer);
    file.writePixels(picture.bounds.height());
  }
  return output.Take();
}

Result<std::string> EncodeGuarded(const FilePicture& picture, const ExrFormat& format) {
  try {
    return EncodeChecked(picture, format);
  } catch (const std::exception& e) {
    return Failed(fmt::format("the picture cannot be encoded as OpenEXR: {}", e.what()));
  }
}

// Whether a file of `file_size` bytes may hold a picture, or a tile of one, of this size.
Result<void> CheckLoadedSize(const std::string& name, int64_t width, int64_t height, int64_t channels,
                             size_t file_size) {
  if (width < 1 || height < 1 || channels < 1 || width > kResolutionMax || height > kResolutionMax ||
      channels > kChannelsMax) {
    return BadInput(
        fmt::format("{}: {} channels of {}x{} pixels are beyond the limits", name, channels, width, height));
  }
  const int64_t values = width * height * channels;
  const auto plausible = std::max(kValuesFloor, static_cast<int64_t>(file_size) * kValuesPerByteMax);
  if (values > kLoadedValuesMax) {
    return BadInput(fmt::format("{}: {} channels of {}x{} pixels are {} values, more than the limit of {}",
                                name, channels, width, height, values, kLoadedValuesMax));
  }
  if (values > plausible) {
    return BadInput(
        fmt::format("{}: damaged OpenEXR picture: {} bytes cannot hold {} channels of {}x{} pixels", name,
                    file_size, channels, width, height));
  }
  return {};
}

// What CheckExr leaves to the library to read.
Result<void> CheckLoadable(const Imf::Header& header, const std::string& path) {
  const Imath::Box2i& display = header.displayWindow();
  const int64_t width = int64_t{display.max.x} - display.min.x + 1;
  const int64_t height = int64_t{display.max.y} - display.min.y + 1;
  if (width < 1 || height < 1 || width > kResolutionMax || height > kResolutionMax) {
    return BadInput(
        fmt::format("{}: its display window of {}x{} pixels is beyond the limits", path, width, height));
  }
  return {};
}

// Those that EncodeExr writes as they were: text, and what FrameSpec::attributes may hold.
std::map<std::string, std::string> WritableAttributes(const Imf::Header& header) {
  std::map<std::string, std::string> attributes;
  for (auto it = header.begin(); it != header.end(); ++it) {
    const std::string name = it.name();
    const auto text = AttributeText(it.attribute());
    if (!text || IsReservedAttribute(name) || !IsAttributeValue(name, *text)) continue;
    const bool is_default = name == "pixelAspectRatio" && *text == "1";
    const bool is_text = it.attribute().typeName() == std::string_view("string");
    if (is_text != IsTypedAttribute(name) && !is_default) attributes[name] = *text;
  }
  return attributes;
}

ExrFormat FormatOf(const Imf::Header& header) {
  return {static_cast<ExrCompression>(header.compression()), header.hasTileDescription(),
          header.hasPreviewImage()};
}

// Sets the size and the bounds of a LoadedPicture or PictureHeader.
template <typename Picture>
void ReadWindows(const Imf::Header& header, Picture& picture) {
  const Imath::Box2i& data = header.dataWindow();
  const Imath::Box2i& display = header.displayWindow();
  picture.width = display.max.x - display.min.x + 1;
  picture.height = display.max.y - display.min.y + 1;
  picture.bounds = {data.min.x, data.min.y, data.max.x + 1, data.max.y + 1};
}

Result<LoadedPicture> LoadChecked(Imf::InputFile& file, const std::string& path) {
  const Imf::Header& header = file.header();
  if (auto ok = CheckLoadable(header, path); !ok) return ok.error();
  LoadedPicture picture;
  ReadWindows(header, picture);
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it) {
    picture.channels.emplace_back(it.name());
    picture.types.push_back(it.channel().type == Imf::HALF ? ExrType::kHalf : ExrType::kFloat);
  }
  const size_t channels = picture.channels.size();
  picture.values.resize(static_cast<size_t>(picture.bounds.area()) * channels);
  Imf::FrameBuffer buffer;
  for (size_t c = 0; c < channels; ++c) {
    char* first = reinterpret_cast<char*>(picture.values.data() + c);
    buffer.insert(picture.channels[c],
                  ValueSlice(Imf::FLOAT, first, sizeof(float), picture.bounds, channels));
  }
  file.setFrameBuffer(buffer);
  file.readPixels(picture.bounds.y0, picture.bounds.y1 - 1);
  picture.attributes = WritableAttributes(header);
  picture.format = FormatOf(header);
  return picture;
}

const char* NameOf(Imf::PixelType type) {
  return type == Imf::HALF ? "half" : type == Imf::FLOAT ? "float" : "uint";
}

Result<PictureHeader> HeaderOf(const Imf::Header& header, const std::string& path) {
  if (auto ok = CheckLoadable(header, path); !ok) return ok.error();
  PictureHeader read;
  ReadWindows(header, read);
  read.format = FormatOf(header);
  if (header.hasPreviewImage()) {
    read.preview_width = static_cast<int>(header.previewImage().width());
    read.preview_height = static_cast<int>(header.previewImage().height());
  }
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it)
    read.channels.push_back({it.name(), NameOf(it.channel().type)});
  for (auto it = header.begin(); it != header.end(); ++it) {
    const std::string name = it.name();
    if (const auto text = AttributeText(it.attribute()))
      read.attributes.push_back({name, it.attribute().typeName(), *text});
  }
  return read;
}

Error CannotBeRead(const std::string& name, const std::exception& e) {
  std::string reason = e.what();
  std::ranges::replace(reason, '\n', ' ');
  return BadInput(fmt::format("{}: cannot be read as OpenEXR: {}", name, OneLine(reason)));
}

}  // namespace

Result<std::string> EncodeExr(const FrameSpec& spec, const FramePicture& picture) {
  if (auto ok = CheckPicture(spec, picture); !ok) return ok.error();
  std::vector<ExrType> types;
  for (const PictureChannel& channel : spec.PictureChannels())
    types.push_back(channel.is_exact ? ExrType::kFloat : spec.exr_type);
  return EncodeGuarded({spec.width, spec.height, picture.bounds, picture.channels, std::move(types),
                        picture.values, spec.attributes},
                       ExrFormat());
}

Result<std::string> EncodeExr(const LoadedPicture& picture, const ExrFormat& format) {
  if (auto ok = CheckLoaded(picture); !ok) return ok.error();
  std::vector<ExrType> types = picture.types;
  types.resize(picture.channels.size(), ExrType::kFloat);
  return EncodeGuarded({picture.width, picture.height, picture.bounds, picture.channels, std::move(types),
                        picture.values, picture.attributes},
                       format);
}

void UseThreadsForPictures(int threads) {
  Imf::setGlobalThreadCount(threads > 1 ? threads : 0);  // threads beside that of the caller, which waits
}

Result<LoadedPicture> LoadExr(const std::string& path) {
  const Result<std::string> bytes = ReadFile(path, kExrFileSizeMax);
  if (!bytes) return bytes.error();
  return DecodeExr(*bytes, path);
}

namespace {

// Opens a file whose structure can be read, and gives it to `read`.
template <typename Read>
auto ReadChecked(std::string_view bytes, const std::string& name, Read read)
    -> decltype(read(std::declval<Imf::InputFile&>())) {
  const Result<void> checked = CheckExr(bytes, name, [&](int64_t width, int64_t height, int64_t channels) {
    return CheckLoadedSize(name, width, height, channels, bytes.size());
  });
  if (!checked) return checked.error();
  try {
    MemoryInput input(bytes);
    Imf::InputFile file(input);
    return read(file);
  } catch (const std::exception& e) {
    return CannotBeRead(name, e);
  }
}

}  // namespace

Result<LoadedPicture> DecodeExr(std::string_view bytes, const std::string& name) {
  return ReadChecked(bytes, name, [&](Imf::InputFile& file) { return LoadChecked(file, name); });
}

Result<PictureHeader> ReadExrHeader(std::string_view bytes, const std::string& name) {
  return ReadChecked(bytes, name, [&](const Imf::InputFile& file) { return HeaderOf(file.header(), name); });
}

bool IsExr(std::string_view bytes) {
  return bytes.starts_with("\x76\x2f\x31\x01");
}

}  // namespace tessera
