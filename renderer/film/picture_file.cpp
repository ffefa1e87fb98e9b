#include "renderer/film/picture_file.h"

#include <ImathBox.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <stdexcept>

#include "renderer/exr/exr_header.h"
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
// Floats that are not compressed, headers and tables.
constexpr uint64_t kExrFileSizeMax = sizeof(float) * uint64_t{kLoadedValuesMax} + (uint64_t{64} << 20);

// Collects what OpenEXR writes.
class MemoryOutput : public Imf::OStream {
 public:
  MemoryOutput() : Imf::OStream("picture in memory") {}
  void write(const char bytes[], int count) override {
    const size_t end = position_ + static_cast<size_t>(count);
    if (end > bytes_.size()) bytes_.resize(end);
    std::memcpy(bytes_.data() + position_, bytes, static_cast<size_t>(count));
    position_ = end;
  }
  uint64_t tellp() override { return position_; }
  void seekp(uint64_t position) override { position_ = position; }
  std::string Take() { return std::move(bytes_); }

 private:
  std::string bytes_;
  size_t position_ = 0;
};

// Gives OpenEXR bytes in memory to read.
class MemoryInput : public Imf::IStream {
 public:
  explicit MemoryInput(std::string_view bytes) : Imf::IStream("picture in memory"), bytes_(bytes) {}
  bool read(char bytes[], int count) override {
    const auto wanted = static_cast<size_t>(count);
    if (position_ > bytes_.size() || wanted > bytes_.size() - position_)
      throw std::runtime_error("unexpected end of file");
    std::memcpy(bytes, bytes_.data() + position_, wanted);
    position_ += wanted;
    return position_ < bytes_.size();
  }
  uint64_t tellg() override { return position_; }
  void seekg(uint64_t position) override { position_ = position; }

 private:
  std::string_view bytes_;
  size_t position_ = 0;
};

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

std::vector<half> ToHalf(const std::vector<float>& values) {
  std::vector<half> halves(values.size());
  for (size_t i = 0; i < values.size(); ++i) halves[i] = half(std::clamp(values[i], -kHalfMax, kHalfMax));
  return halves;
}

Result<void> CheckPicture(const FrameSpec& spec, const FramePicture& picture) {
  if (picture.bounds != spec.crop) return Failed("the picture is not of the frame's crop");
  const size_t count = static_cast<size_t>(picture.bounds.area()) * picture.channels.size();
  if (picture.values.size() != count) return Failed("the picture's values do not fill its window");
  if (!std::ranges::equal(picture.channels, PictureChannels(spec.channels), {}, {}, &PictureChannel::name))
    return Failed("the picture's channels are not those that the frame writes");
  return spec.Check();
}

std::string EncodeChecked(const FrameSpec& spec, const FramePicture& picture) {
  const Imath::Box2i display(Imath::V2i(0, 0), Imath::V2i(spec.width - 1, spec.height - 1));
  Imf::Header header(display, ToBox(picture.bounds));
  header.compression() = Imf::ZIP_COMPRESSION;
  for (const auto& [name, value] : spec.attributes) header.insert(name, Imf::StringAttribute(value));
  const std::vector<half> halves =
      spec.exr_type == ExrType::kHalf ? ToHalf(picture.values) : std::vector<half>();
  Imf::FrameBuffer buffer;
  const std::vector<PictureChannel> channels = PictureChannels(spec.channels);
  for (size_t c = 0; c < channels.size(); ++c) {
    const bool is_half = spec.exr_type == ExrType::kHalf && !channels[c].is_exact;
    const Imf::PixelType type = is_half ? Imf::HALF : Imf::FLOAT;
    const void* first = is_half ? static_cast<const void*>(&halves[c]) : &picture.values[c];
    // OpenEXR only reads when it writes a file.
    char* const base = const_cast<char*>(static_cast<const char*>(first));
    header.channels().insert(channels[c].name, Imf::Channel(type));
    buffer.insert(channels[c].name, ValueSlice(type, base, is_half ? sizeof(half) : sizeof(float),
                                               picture.bounds, channels.size()));
  }
  MemoryOutput output;
  {
    Imf::OutputFile file(output, header);
    file.setFrameBuffer(buffer);
    file.writePixels(picture.bounds.height());
  }
  return output.Take();
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
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it) {
    if (it.channel().xSampling != 1 || it.channel().ySampling != 1) {
      return BadInput(
          fmt::format("{}: channel {} is subsampled, which is not supported", path, OneLine(it.name())));
    }
  }
  return {};
}

Result<LoadedPicture> LoadChecked(Imf::InputFile& file, const std::string& path) {
  const Imf::Header& header = file.header();
  if (auto ok = CheckLoadable(header, path); !ok) return ok.error();
  LoadedPicture picture;
  const Imath::Box2i& data = header.dataWindow();
  const Imath::Box2i& display = header.displayWindow();
  picture.width = display.max.x - display.min.x + 1;
  picture.height = display.max.y - display.min.y + 1;
  picture.bounds = {data.min.x, data.min.y, data.max.x + 1, data.max.y + 1};
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it) {
    picture.channels.emplace_back(it.name());
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
  file.readPixels(data.min.y, data.max.y);
  for (auto it = header.begin(); it != header.end(); ++it) {
    const auto* text = dynamic_cast<const Imf::StringAttribute*>(&it.attribute());
    if (text != nullptr) picture.attributes[it.name()] = text->value();
  }
  return picture;
}

Error CannotBeRead(const std::string& name, const std::exception& e) {
  std::string reason = e.what();
  std::ranges::replace(reason, '\n', ' ');
  return BadInput(fmt::format("{}: cannot be read as OpenEXR: {}", name, OneLine(reason)));
}

}  // namespace

Result<std::string> EncodeExr(const FrameSpec& spec, const FramePicture& picture) {
  if (auto ok = CheckPicture(spec, picture); !ok) return ok.error();
  try {
    return EncodeChecked(spec, picture);
  } catch (const std::exception& e) {
    return Failed(fmt::format("the picture cannot be encoded as OpenEXR: {}", e.what()));
  }
}

Result<LoadedPicture> LoadExr(const std::string& path) {
  const Result<std::string> bytes = ReadFile(path, kExrFileSizeMax);
  if (!bytes) return bytes.error();
  return DecodeExr(*bytes, path);
}

Result<LoadedPicture> DecodeExr(std::string_view bytes, const std::string& name) {
  const Result<void> checked = CheckExr(bytes, name, [&](int64_t width, int64_t height, int64_t channels) {
    return CheckLoadedSize(name, width, height, channels, bytes.size());
  });
  if (!checked) return checked.error();
  try {
    MemoryInput input(bytes);
    Imf::InputFile file(input);
    return LoadChecked(file, name);
  } catch (const std::exception& e) {
    return CannotBeRead(name, e);
  }
}

}  // namespace tessera
