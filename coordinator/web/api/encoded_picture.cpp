#include "coordinator/web/api/encoded_picture.h"

#include "coordinator/core/preview_limit.h"
#include "coordinator/web/api/color_picture.h"
#include "renderer/film/picture_file.h"

namespace tessera {
namespace {

constexpr int64_t kPngValuesMax = 50'000'000;  // of the file: 200 MB of floats

WebResult<std::string> ExrOf(const WebFarm& farm, FrameId frame, const FrameState& state) {
  if (!state.snapshot) return farm.read(frame.job, frame.frame, state.file);
  const FrameSnapshot::Preview preview = state.snapshot->MakePreview(kPreviewValuesMax);
  auto bytes = EncodeExr(preview.spec, preview.picture);
  if (!bytes) return WebError{503, bytes.error().message};
  return std::move(*bytes);
}

}  // namespace

WebResult<std::string> EncodedPicture(const WebFarm& farm, FrameId frame, const FrameState& state,
                                      bool is_png) {
  if (!state.snapshot && !state.file && !state.IsOver()) return WebError{409, "the picture is being written"};
  const FrameSpec& spec = state.spec->frames[frame.frame].spec;
  const auto channels = static_cast<int64_t>(spec.PictureChannels().size());
  if (is_png && spec.crop.area() * channels > kPngValuesMax)
    return WebError{409, "the picture is too large to be made a PNG file here; download the EXR file"};
  auto exr = ExrOf(farm, frame, state);
  if (!is_png || std::holds_alternative<WebError>(exr)) return exr;
  const auto picture = DecodeExr(std::get<std::string>(exr), "the picture");
  if (!picture) return WebError{503, picture.error().message};
  FrameSpec shown = spec;
  shown.crop = picture->bounds;
  ColorPicture colors(shown, 1);
  colors.Paint(*picture, 1);
  return colors.Png();
}

WebResult<ReadableFile> OpenPicture(const WebFarm& farm, FrameId frame, const FrameState& state,
                                    bool is_png) {
  const bool is_written = !state.snapshot && (state.file || state.IsOver());
  if (!is_png && is_written) return farm.open(frame.job, frame.frame, state.file);
  const auto bytes = EncodedPicture(farm, frame, state, is_png);
  if (const auto* const error = std::get_if<WebError>(&bytes)) return *error;
  auto kept = farm.keep(std::get<std::string>(bytes));
  if (!kept) return WebError{503, kept.error().message};
  return std::move(*kept);
}

}  // namespace tessera
