#include "coordinator/web/api/picture_board.h"

#include <algorithm>
#include <map>
#include <utility>

namespace tessera {
// Regions that are being changed. Those that readers hold stay as they are.
class PictureBoard::Painting {
 public:
  explicit Painting(PictureBoard& board) : board_(board) {}

  void Set(int x, int y, const float* values) {
    const int region = y / kRegionSize * board_.columns_ + x / kRegionSize;
    const auto index = static_cast<size_t>(region);
    const PixelBounds& bounds = board_.regions_[index].bounds;
    if (index != last_) message_ = &MessageOf(index);
    last_ = index;
    SetPixel(board_.shape_, bounds, x, y, {values, board_.shape_.channels}, *message_);
  }
  void Publish() {
    const std::lock_guard lock(board_.mutex_);
    ++board_.version_;
    for (auto& [index, message] : changed_) {
      board_.regions_[index].message = std::make_shared<const std::string>(std::move(message));
      board_.regions_[index].version = board_.version_;
    }
  }

 private:
  std::string& MessageOf(size_t index) {
    const auto [place, is_new] = changed_.try_emplace(index);
    if (!is_new) return place->second;
    const Region& region = board_.regions_[index];
    place->second = region.message != nullptr ? *region.message : RegionMessage(board_.shape_, region.bounds);
    return place->second;
  }

  PictureBoard& board_;
  std::map<size_t, std::string> changed_;
  size_t last_ = SIZE_MAX;
  std::string* message_ = nullptr;
};

void PictureBoard::Begin(const PictureShape& shape) {
  std::vector<Region> regions;
  for (int y = 0; y < shape.height; y += kRegionSize) {
    for (int x = 0; x < shape.width; x += kRegionSize) {
      regions.push_back(
          {{x, y, std::min(x + kRegionSize, shape.width), std::min(y + kRegionSize, shape.height)},
           nullptr,
           0});
    }
  }
  auto frame = std::make_shared<const std::string>(FrameMessage(shape));
  // Nothing below fails, so the regions always fit the shape.
  const std::lock_guard lock(mutex_);
  shape_ = shape;
  columns_ = (shape.width + kRegionSize - 1) / kRegionSize;
  regions_ = std::move(regions);
  frame_ = std::move(frame);
  ++pictures_;
}

LayerPainter PictureBoard::PainterOf(const FrameSpec& spec) const {
  if (auto layer = FindLayer(spec, layer_)) return LayerPainter(std::move(*layer));
  return LayerPainter(LayersOf(spec).front());
}

void PictureBoard::Paint(const FramePicture& picture, Painting& painting) const {
  const float* values = picture.values.data();
  for (int y = picture.bounds.y0; y < picture.bounds.y1; ++y) {
    for (int x = picture.bounds.x0; x < picture.bounds.x1; ++x, values += picture.channels.size())
      painting.Set(x, y, values);
  }
}

void PictureBoard::Show(const FrameSnapshot& snapshot) {
  const FrameSpec& spec = snapshot.spec();
  const LayerPainter painter = PainterOf(spec);
  const PictureShape shape = ShapeOf(spec, painter.layer(), kLiveValuesMax);
  const bool is_same_frame = shape == shape_ && spec.TileCount() == shown_.spec().TileCount() &&
                             spec.tile_size == shown_.spec().tile_size;
  if (!is_same_frame) {
    Begin(shape);
    shown_ = {};
  }
  Painting painting(*this);
  for (int tile = 0; tile < spec.TileCount(); ++tile) {
    if (snapshot.IsSameTile(tile, shown_)) continue;
    if (const auto picture = painter.Tile(snapshot, tile, shape.step)) Paint(*picture, painting);
  }
  painting.Publish();
  shown_ = snapshot;
}

void PictureBoard::Show(const FrameSpec& spec, const LoadedPicture& picture) {
  if (picture.bounds != spec.crop || picture.channels.empty()) return;
  const LayerPainter painter = PainterOf(spec);
  const PictureShape shape = ShapeOf(spec, painter.layer(), kLiveValuesMax);
  if (shape != shape_) Begin(shape);
  shown_ = {};
  Painting painting(*this);
  if (const auto shown = painter.File(spec, picture, shape.step)) Paint(*shown, painting);
  painting.Publish();
}

void PictureBoard::SetState(uint64_t samples_done, uint64_t samples_total, bool is_finished) {
  std::string message = StateMessage(samples_done, samples_total, is_finished);
  const std::lock_guard lock(mutex_);
  if (state_ != nullptr && *state_ == message) return;
  state_ = std::make_shared<const std::string>(std::move(message));
  ++states_;
}

void PictureBoard::SetProblem(std::string_view reason) {
  const std::lock_guard lock(mutex_);
  if (problem_ == nullptr && reason.empty()) return;
  std::string message = ProblemMessage(reason);
  if (problem_ != nullptr && *problem_ == message) return;
  problem_ = std::make_shared<const std::string>(std::move(message));
  ++problems_;
}

void PictureBoard::End() {
  const std::lock_guard lock(mutex_);
  has_ended_ = true;
}

size_t PictureBoard::Collect(size_t bytes_max, Cursor& cursor, std::vector<BodyStream::Part>& parts) const {
  const std::lock_guard lock(mutex_);
  size_t bytes = 0;
  const auto add = [&](const BodyStream::Part& part) {
    parts.push_back(part);
    bytes += part->size();
  };
  if (cursor.problem != problems_) {
    cursor.problem = problems_;
    add(problem_);
  }
  if (frame_ == nullptr) return bytes;
  if (cursor.picture != pictures_) {
    cursor = {pictures_, 0, problems_, std::vector<uint64_t>(regions_.size(), 0), 0};
    add(frame_);
  }
  for (size_t visited = 0; visited < regions_.size(); ++visited, ++cursor.next) {
    if (bytes >= bytes_max) return bytes;
    if (cursor.next >= regions_.size()) cursor.next = 0;
    const Region& region = regions_[cursor.next];
    if (region.version == cursor.regions[cursor.next]) continue;
    cursor.regions[cursor.next] = region.version;
    add(region.message);
  }
  if (cursor.state != states_ && state_ != nullptr) {
    cursor.state = states_;
    add(state_);
  }
  return bytes;
}

bool PictureBoard::HasEnded() const {
  const std::lock_guard lock(mutex_);
  return has_ended_;
}

size_t PictureBoard::bytes() const {
  const std::lock_guard lock(mutex_);
  size_t bytes = 0;
  for (const Region& region : regions_) bytes += region.message != nullptr ? region.message->size() : 0;
  return bytes;
}

}  // namespace tessera
