#include "renderer/formats/openimageio/webp_frame.h"

#include <webp/decode.h>
#include <webp/demux.h>

#include <algorithm>
#include <memory>

namespace tessera::image_module {
namespace {

struct DemuxerDeleter {
  void operator()(WebPDemuxer* demuxer) const { WebPDemuxDelete(demuxer); }
};
using Demuxer = std::unique_ptr<WebPDemuxer, DemuxerDeleter>;

// The first frame of a file.
class FirstFrame {
 public:
  explicit FirstFrame(const WebPDemuxer* demuxer) : exists_(WebPDemuxGetFrame(demuxer, 1, &frame_) != 0) {}
  ~FirstFrame() { WebPDemuxReleaseIterator(&frame_); }
  FirstFrame(const FirstFrame&) = delete;
  FirstFrame& operator=(const FirstFrame&) = delete;

  bool LiesOn(const WebpCanvas& canvas) const {
    return exists_ && frame_.x_offset >= 0 && frame_.y_offset >= 0 && frame_.width >= 1 &&
           frame_.height >= 1 && frame_.width <= canvas.width - frame_.x_offset &&
           frame_.height <= canvas.height - frame_.y_offset;
  }

  // Requires that the frame lies on the canvas.
  bool DecodeInto(const WebpCanvas& canvas, uint8_t* values, size_t size) const {
    const auto decode = canvas.channels == 4 ? WebPDecodeRGBAInto : WebPDecodeRGBInto;
    const size_t first = (static_cast<size_t>(frame_.y_offset) * static_cast<size_t>(canvas.width) +
                          static_cast<size_t>(frame_.x_offset)) *
                         static_cast<size_t>(canvas.channels);
    return decode(frame_.fragment.bytes, frame_.fragment.size, values + first, size - first,
                  canvas.width * canvas.channels) != nullptr;
  }

 private:
  WebPIterator frame_{};
  bool exists_;
};

}  // namespace

bool DecodeWebpFrame(std::string_view file, const WebpCanvas& canvas, uint8_t* values) {
  if (canvas.channels != 3 && canvas.channels != 4) return false;
  const WebPData data{reinterpret_cast<const uint8_t*>(file.data()), file.size()};
  const Demuxer demuxer(WebPDemux(&data));
  if (!demuxer) return false;
  const FirstFrame frame(demuxer.get());
  if (!frame.LiesOn(canvas)) return false;
  const size_t size = static_cast<size_t>(canvas.width) * static_cast<size_t>(canvas.height) *
                      static_cast<size_t>(canvas.channels);
  std::fill_n(values, size, uint8_t{0});
  return frame.DecodeInto(canvas, values, size);
}

}  // namespace tessera::image_module
