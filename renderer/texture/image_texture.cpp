#include "renderer/texture/image_texture.h"

#include <array>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "renderer/description/number.h"
#include "renderer/description/parameter_reader.h"
#include "renderer/image/image_format.h"
#include "renderer/texture/image_color_space.h"

namespace tessera {
namespace {

constexpr std::array<std::string_view, 4> kWrapNames{"repeat", "black", "clamp", "octahedralsphere"};
constexpr std::array<WrapMode, 4> kWraps{WrapMode::kRepeat, WrapMode::kBlack, WrapMode::kClamp,
                                         WrapMode::kOctahedralSphere};
constexpr std::array<std::string_view, 5> kFilterNames{"bilinear", "point", "trilinear", "ewa", "EWA"};
constexpr std::array<ImageFilter, 5> kFilters{ImageFilter::kBilinear, ImageFilter::kPoint,
                                              ImageFilter::kTrilinear, ImageFilter::kEwa, ImageFilter::kEwa};
constexpr float kAnisotropyMax = 64;  // of an ellipse: bounds the texels of one lookup

template <typename T, size_t kCount>
T ReadChoice(ParameterReader& reader, std::string_view name,
             const std::array<std::string_view, kCount>& words, const std::array<T, kCount>& values) {
  const std::string word = reader.Choice(name, words[0], words);
  for (size_t i = 0; i < kCount; ++i) {
    if (words[i] == word) return values[i];
  }
  return values[0];
}

std::optional<ColorEncoding> ParseEncoding(std::string_view text) {
  if (text == "sRGB") return ColorEncoding{ColorEncoding::Kind::kSrgb, 1};
  if (text == "linear") return ColorEncoding{ColorEncoding::Kind::kLinear, 1};
  constexpr std::string_view kGamma = "gamma ";
  if (!text.starts_with(kGamma)) return std::nullopt;
  text.remove_prefix(std::min(text.find_first_not_of(' ', kGamma.size()), text.size()));
  const std::optional<float> gamma = ParseFloat(text);
  if (!gamma || !(*gamma > 0)) return std::nullopt;
  return ColorEncoding{ColorEncoding::Kind::kGamma, *gamma};
}

// The encoding of the 8-bit values of the file. As in pbrt, only that of a PNG can be chosen: others are
// always sRGB or name their encoding themselves.
std::optional<ColorEncoding> ReadEncoding(ParameterReader& reader, const std::string& file) {
  const std::string text = reader.String("encoding", "sRGB");
  const std::optional<ColorEncoding> encoding = ParseEncoding(text);
  if (!encoding) {
    reader.FailAt("encoding",
                  fmt::format("unknown encoding {}, expected \"linear\", \"sRGB\" or \"gamma\" and a number",
                              Quoted(text)));
  }
  return HasEnding(file, ".png") ? encoding : std::nullopt;
}

size_t ValueSize(const Image& image) {
  return image.format == PixelFormat::kUint8 ? 1 : image.format == PixelFormat::kHalf ? 2 : 4;
}

// Whether the three channels are the same everywhere, bit for bit.
bool IsGrey(const Image& image, std::array<int, 3> rgb) {
  const size_t size = ValueSize(image), pixels = static_cast<size_t>(image.width) * image.height;
  for (size_t i = 0; i < pixels; ++i) {
    const uint8_t* pixel = &image.bytes[i * image.channels * size];
    if (std::memcmp(pixel + rgb[0] * size, pixel + rgb[1] * size, size) != 0) return false;
    if (std::memcmp(pixel + rgb[0] * size, pixel + rgb[2] * size, size) != 0) return false;
  }
  return true;
}

bool IsOpaque(const Image& image, int alpha) {
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (image.Get(x, y, alpha) != 1) return false;
    }
  }
  return true;
}

// Which values of an image a texture uses.
struct Selection {
  enum class Kind { kNone, kGrey, kColor, kMean } kind = Kind::kNone;
  int grey = 0;
  std::array<int, 3> rgb{};
};

Selection Select(const Image& image, bool is_float, ImageFilter filter) {
  using Kind = Selection::Kind;
  if (image.channels == 1) return {Kind::kGrey, 0, {}};
  const std::optional<std::array<int, 3>> rgb = image.RgbChannels();
  if (!rgb) {
    const int grey = image.ChannelIndex("Y");
    return grey < 0 ? Selection{} : Selection{Kind::kGrey, grey, {}};
  }
  if (is_float && (filter == ImageFilter::kPoint || filter == ImageFilter::kEwa))
    return {Kind::kGrey, (*rgb)[0], {}};
  const int alpha = image.ChannelIndex("A");
  if (is_float && alpha >= 0 && !IsOpaque(image, alpha)) return {Kind::kGrey, alpha, {}};
  if (IsGrey(image, *rgb)) return {Kind::kGrey, (*rgb)[0], {}};
  return {is_float ? Kind::kMean : Kind::kColor, 0, *rgb};
}

std::shared_ptr<const MipMap> MakeMap(const Image& image, const Selection& selection, WrapMode wrap) {
  switch (selection.kind) {
    case Selection::Kind::kColor:
      return std::make_shared<const MipMap>(MipMap::Color(image, selection.rgb, wrap));
    case Selection::Kind::kMean:
      return std::make_shared<const MipMap>(MipMap::GreyOfColor(image, selection.rgb, wrap));
    default: return std::make_shared<const MipMap>(MipMap::Grey(image, selection.grey, wrap));
  }
}

// What a texture needs of an image: which values, filtered how.
struct MapRequest {
  std::string file;
  std::optional<ColorEncoding> encoding;
  bool is_float = false;
  ImageFilter filter = ImageFilter::kBilinear;
  WrapMode wrap = WrapMode::kRepeat;

  std::string Text() const {
    return fmt::format("map {} {} {} {}", EncodingText(encoding), is_float, static_cast<int>(filter),
                       static_cast<int>(wrap));
  }
};

// A map in the cache of files, with the size of the picture that it was made of.
struct KeptMap {
  std::shared_ptr<const MipMap> map;
  ImageSize image;
};

// The map made for another scene from the same file, or one made now.
Result<const MipMap*> FindMap(ImageCache& images, TextureAssembly& assembly, const MapRequest& request) {
  const std::string what = request.Text();
  const std::string key = fmt::format("{}\n{}", request.file, what);
  if (const auto known = images.files().Recall<KeptMap>(request.file, what)) {
    if (auto counted = images.CountRecalled(request.file, request.encoding, known->image); !counted)
      return counted.error();
    return assembly.AddMap(key, [&] { return known->map; }).get();
  }
  const Result<std::shared_ptr<const Image>> image = images.Get(request.file, request.encoding);
  if (!image) return image.error();
  const Selection selection = Select(**image, request.is_float, request.filter);
  if (selection.kind == Selection::Kind::kNone) {
    return BadInput(fmt::format("{}: the image has neither the channels R, G and B nor Y", request.file));
  }
  // The address stands for file and encoding: the cache keeps the image for as long as the builder lives.
  const std::string selected =
      fmt::format("{} {} {} {} {}", request.file, static_cast<const void*>(image->get()),
                  static_cast<int>(selection.kind), selection.grey, static_cast<int>(request.wrap));
  const auto map = assembly.AddMap(selected, [&] { return MakeMap(**image, selection, request.wrap); });
  images.files().Keep(request.file, what, std::make_shared<const KeptMap>(KeptMap{map, SizeOf(**image)}),
                      map->bytes());
  return map.get();
}

// The mean of a map as a map of one texel.
std::shared_ptr<const MipMap> MakeMean(const MipMap& map) {
  const bool is_color = map.channels() > 1;
  std::array<float, 3> mean{};
  for (int channel = 0; channel < (is_color ? 3 : 1); ++channel) {
    double sum = 0;
    for (int y = 0; y < map.height(); ++y) {
      for (int x = 0; x < map.width(); ++x) sum += static_cast<double>(map.Texel(0, x, y, channel));
    }
    mean[static_cast<size_t>(channel)] = static_cast<float>(sum / map.width() / map.height());
  }
  Image image;
  image.width = image.height = 1;
  image.channels = 3;
  image.channel_names = {"R", "G", "B"};
  image.chromaticities = map.chromaticities();
  image.bytes.resize(sizeof mean);
  std::memcpy(image.bytes.data(), mean.data(), sizeof mean);
  return std::make_shared<const MipMap>(is_color ? MipMap::Color(image, {0, 1, 2}, WrapMode::kRepeat)
                                                 : MipMap::Grey(image, 0, WrapMode::kRepeat));
}

float ReadAnisotropy(ParameterReader& reader) {
  const float anisotropy = reader.Float("maxanisotropy", 8);
  if (anisotropy >= 1) return std::min(anisotropy, kAnisotropyMax);
  reader.FailAt("maxanisotropy", fmt::format("maxanisotropy is {}, expected at least 1", anisotropy));
  return 1;
}

}  // namespace

std::optional<ImageTexture> ReadImageTexture(ParameterReader& reader, ImageCache& images,
                                             TextureAssembly& assembly, Diagnostics& diagnostics,
                                             std::optional<SpectrumUse> use, bool averages) {
  ImageTexture texture;
  texture.filter = {ReadChoice(reader, "filter", kFilterNames, kFilters), ReadAnisotropy(reader)};
  const WrapMode wrap = ReadChoice(reader, "wrap", kWrapNames, kWraps);
  texture.scale = reader.Float("scale", 1);
  texture.invert = reader.Bool("invert", false);
  texture.use = use.value_or(SpectrumUse::kAlbedo);
  const std::string file = reader.String("filename", "");
  const std::optional<ColorEncoding> encoding = ReadEncoding(reader, file);
  if (file.empty()) reader.Fail("texture \"imagemap\" needs a parameter \"string filename\"");
  if (reader.failed()) return std::nullopt;

  const Result<const MipMap*> map =
      FindMap(images, assembly, {file, encoding, !use.has_value(), texture.filter.filter, wrap});
  if (!map) {
    reader.FailAt("filename", map.error().message);
    return std::nullopt;
  }
  texture.map = *map;
  if (averages) {
    const std::string key = fmt::format("mean {}", static_cast<const void*>(*map));
    texture.map = assembly.AddMap(key, [&] { return MakeMean(**map); }).get();
  }
  if (use) texture.color_space = &ColorSpaceOf(texture.map->chromaticities(), reader, diagnostics);
  return texture;
}

}  // namespace tessera
