#include "renderer/denoise/finished_picture.h"

#include <fmt/format.h>

#include <utility>

#include "renderer/denoise/denoise.h"
#include "renderer/denoise/input_layers.h"
#include "renderer/denoise/oidn_library.h"
#include "renderer/film/picture_file.h"

namespace tessera {
namespace {

// The picture as its file would be read, before its colours are rounded to those of the file.
LoadedPicture AsLoaded(const FrameSpec& spec, FramePicture picture) {
  LoadedPicture loaded;
  loaded.width = spec.width;
  loaded.height = spec.height;
  loaded.bounds = picture.bounds;
  loaded.channels = std::move(picture.channels);
  loaded.values = std::move(picture.values);
  loaded.attributes = spec.attributes;
  for (const PictureChannel& channel : spec.PictureChannels())
    loaded.types.push_back(channel.is_exact ? ExrType::kFloat : spec.exr_type);
  return loaded;
}

LoadedPicture WithoutPixels(const FrameSpec& spec) {
  FramePicture empty;
  for (const PictureChannel& channel : spec.PictureChannels()) empty.channels.push_back(channel.name);
  return AsLoaded(spec, std::move(empty));
}

}  // namespace

std::vector<std::string> LayersOfDenoising(const FrameSpec& spec) {
  if (spec.denoiser == Denoiser::kNone) return {};
  return AddedLayers(WithoutPixels(spec));
}

Result<void> CheckDenoiser(const FrameSpec& spec, const std::string& name) {
  if (spec.denoiser == Denoiser::kNone) return {};
  const LoadedPicture picture = WithoutPixels(spec);
  if (auto ok = CheckDenoisable(picture, name, spec.denoiser); !ok) return ok;
  const size_t channels = picture.channels.size() + kColors * AddedLayers(picture).size();
  if (channels <= static_cast<size_t>(kChannelsMax)) return {};
  return BadInput(fmt::format("{}: the denoised picture would have {} channels, more than the limit of {}",
                              name, channels, kChannelsMax));
}

Result<void> CheckInstalled(Denoiser denoiser) {
  if (denoiser != Denoiser::kOidn) return {};
  const auto library = oidn::Load();
  return library ? Result<void>() : library.error();
}

Result<EncodedPicture> EncodeFinished(const FrameSpec& spec, FramePicture picture, int threads,
                                      const std::stop_token& stop) {
  const auto encoded = [](Result<std::string> exr, std::string failure) -> Result<EncodedPicture> {
    if (!exr) return exr.error();
    return EncodedPicture{std::move(exr).value(), std::move(failure)};
  };
  if (spec.denoiser == Denoiser::kNone) return encoded(EncodeExr(spec, picture), "");
  LoadedPicture loaded = AsLoaded(spec, std::move(picture));
  const auto denoised = Denoise(loaded, "the picture", threads, stop, spec.denoiser);
  if (denoised) return encoded(EncodeExr(*denoised, denoised->format), "");
  if (denoised.error().kind == ErrorKind::kInterrupted) return denoised.error();
  loaded.attributes[kDenoiseFailedAttribute] = denoised.error().message;
  return encoded(EncodeExr(loaded, loaded.format), denoised.error().message);
}

}  // namespace tessera
