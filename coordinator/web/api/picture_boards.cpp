#include "coordinator/web/api/picture_boards.h"

#include <algorithm>

#include "coordinator/core/guarded_result.h"
#include "coordinator/web/api/color_picture.h"
#include "renderer/film/picture_file.h"

namespace tessera {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr milliseconds kTick{100};
constexpr milliseconds kRefreshInterval{500};
// Pauses after a piece of work, in multiples of its time: 2.5 % of a core for all pictures that are watched,
// and as much for small ones.
constexpr int kPauses = 40;
constexpr seconds kUnwatchedKept{10};
constexpr seconds kSmallInterval{20};
// Of all boards: some 20 frames of 1920 x 1080 pixels in halves. A board that begins counts with its full
// size.
constexpr size_t kBoardBytesMax = size_t{256} << 20;
constexpr size_t kBoardBytesAssumed = size_t{12} << 20;
// Of a file that is decoded for a preview, all channels together: 200 MB of floats.
constexpr int64_t kDecodedValuesMax = 50'000'000;
constexpr size_t kSmallMax = 2000;
constexpr size_t kSmallBytesMax = size_t{64} << 20;  // some 20 KB each, or 300 KB
constexpr size_t kSmallWantedMax = 256;
// Of all streams together. A first picture of 1920 x 1080 halves has 12 MB.
constexpr double kBytesPerSecond = 16 << 20;
constexpr double kBurstBytes = 16 << 20;
constexpr size_t kBytesPerTake = 192 << 10;

class PictureBody final : public BodyStream {
 public:
  PictureBody(PictureBoards& boards, std::shared_ptr<PictureBoard> board)
      : boards_(boards), board_(std::move(board)) {}
  Next Take(std::vector<Part>& parts) override {
    const size_t allowed = boards_.TakeBudget(kBytesPerTake);
    if (allowed == 0) return Next::kLater;
    const size_t used = board_->Collect(allowed, cursor_, parts);
    // The last part may exceed what was allowed, by a region.
    boards_.GiveBudgetBack(allowed - std::min(allowed, used));
    if (used > 0) return Next::kParts;
    return board_->HasEnded() ? Next::kEnd : Next::kLater;
  }

 private:
  PictureBoards& boards_;
  const std::shared_ptr<PictureBoard> board_;
  PictureBoard::Cursor cursor_;
};

}  // namespace

PictureBoards::PictureBoards(const WebFarm& farm)
    : farm_(farm), budget_(kBurstBytes), budget_at_(Clock::now()), thread_([this] { Run(); }) {}

PictureBoards::~PictureBoards() {
  Stop();
}

void PictureBoards::Stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

WebResult<std::shared_ptr<BodyStream>> PictureBoards::Watch(FrameId frame, const std::string& layer) {
  const std::lock_guard lock(mutex_);
  auto found = boards_.find({frame, layer});
  if (found == boards_.end()) {
    size_t bytes = kBoardBytesAssumed;
    for (const auto& [id, watched] : boards_) bytes += std::max(watched.board->bytes(), kBoardBytesAssumed);
    if (bytes > kBoardBytesMax) return WebError{503, "too many pictures are being watched at the moment"};
    found =
        boards_
            .emplace(BoardId{frame, layer}, Watched{std::make_shared<PictureBoard>(layer), {}, {}, {}, false})
            .first;
  }
  found->second.used = Clock::now();
  changed_.notify_all();
  return std::shared_ptr<BodyStream>(std::make_shared<PictureBody>(*this, found->second.board));
}

std::shared_ptr<const std::string> PictureBoards::Thumbnail(FrameId frame, int size) {
  const SmallId id{frame, size};
  const std::lock_guard lock(mutex_);
  const auto now = Clock::now();
  SmallPicture& small = small_[id];
  small.used = now;
  const bool is_wanted = std::ranges::find(small_wanted_, id) != small_wanted_.end();
  if (now >= small.due && !is_wanted && small_wanted_.size() < kSmallWantedMax) {
    small_wanted_.push_back(id);
    changed_.notify_all();
  }
  const auto png = small.png;
  ForgetSmall();
  return png;
}

// Those that were used longest ago, with the mutex held.
void PictureBoards::ForgetSmall() {
  size_t bytes = 0;
  for (const auto& [id, small] : small_) bytes += small.png != nullptr ? small.png->size() : 0;
  while (small_.size() > kSmallMax || bytes > kSmallBytesMax) {
    const auto oldest =
        std::ranges::min_element(small_, {}, [](const auto& each) { return each.second.used; });
    bytes -= oldest->second.png != nullptr ? oldest->second.png->size() : 0;
    small_.erase(oldest);
  }
}

size_t PictureBoards::TakeBudget(size_t wanted) {
  const std::lock_guard lock(mutex_);
  const auto now = Clock::now();
  budget_ = std::min(kBurstBytes,
                     budget_ + std::chrono::duration<double>(now - budget_at_).count() * kBytesPerSecond);
  budget_at_ = now;
  if (budget_ < static_cast<double>(wanted)) return 0;
  budget_ -= static_cast<double>(wanted);
  return wanted;
}

void PictureBoards::GiveBudgetBack(size_t unused) {
  const std::lock_guard lock(mutex_);
  budget_ += static_cast<double>(unused);
}

void PictureBoards::Run() {
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    RefreshDue(lock);
    if (!stopping_ && !small_wanted_.empty() && Clock::now() >= small_due_) MakeSmall(lock);
    if (stopping_) break;
    if (boards_.empty() && small_wanted_.empty()) {
      changed_.wait(lock);
    } else {
      changed_.wait_for(lock, kTick);
    }
  }
  for (auto& [id, watched] : boards_) watched.board->End();
}

// Without the mutex while it works on a board.
void PictureBoards::RefreshDue(std::unique_lock<std::mutex>& lock) {
  for (auto each = boards_.begin(); each != boards_.end() && !stopping_;) {
    Watched& watched = each->second;
    const auto now = Clock::now();
    if (watched.board.use_count() > 1) watched.used = now;
    if (now - watched.used > kUnwatchedKept || watched.board->HasEnded()) {
      each = boards_.erase(each);
      continue;
    }
    if (now >= watched.due && watched.board.use_count() > 1) {
      const size_t count = boards_.size();
      lock.unlock();
      watched.due = now + kRefreshInterval;
      const auto refresh = [&]() -> Result<void> {
        Refresh(each->first.first, count, watched);
        return {};
      };
      // Without the memory to say why it fails, it is tried again.
      static_cast<void>(GuardedResult(refresh));
      lock.lock();
    }
    ++each;
  }
}

void PictureBoards::Refresh(FrameId frame, size_t count, Watched& watched) {
  const auto start = Clock::now();
  const auto asked = farm_.frame(frame.job, frame.frame);
  const FrameState* const state = std::get_if<FrameState>(&asked);
  Clock::duration cost{};
  if (state != nullptr) {
    const auto begun = Clock::now();
    const auto updated = GuardedResult([&] { return Update(frame, *state, watched); });
    watched.board->SetProblem(updated ? "" : updated.error().message);
    const JobStatus& status = state->status;
    watched.board->SetState(status.samples_done, status.samples_total, state->file.has_value());
    cost = Clock::now() - begun + state->cost;
  } else if (std::get<WebError>(asked).status == 404) {
    watched.board->End();
  }
  watched.due = start + std::max<Clock::duration>(kRefreshInterval, kPauses * static_cast<int>(count) * cost);
}

// A picture that could not be shown is tried again: a damaged file that is made again has the same digest.
Result<void> PictureBoards::Update(FrameId frame, const FrameState& state, Watched& watched) const {
  if (state.snapshot) {
    watched.board->Show(*state.snapshot);
    watched.file.reset();
    return {};
  }
  const bool is_shown =
      state.file ? watched.file == state.file->digest : !state.IsOver() || watched.has_partial;
  if (is_shown) return {};
  const auto picture = Load(frame, state);
  if (!picture) return picture.error();
  watched.board->Show(state.spec->frames[frame.frame].spec, *picture);
  if (state.file) watched.file = state.file->digest;
  watched.has_partial = !state.file;
  return {};
}

Result<LoadedPicture> PictureBoards::Load(FrameId frame, const FrameState& state) const {
  const FrameSpec& spec = state.spec->frames[frame.frame].spec;
  if (spec.crop.area() * static_cast<int64_t>(spec.PictureChannels().size()) > kDecodedValuesMax)
    return Failed("the picture is too large to be shown here; download the EXR file");
  const auto bytes = farm_.read(frame.job, frame.frame, state.file);
  if (const auto* const error = std::get_if<WebError>(&bytes)) return Failed(error->reason);
  return DecodeExr(std::get<std::string>(bytes), "the picture");
}

void PictureBoards::MakeSmall(std::unique_lock<std::mutex>& lock) {
  const SmallId id = small_wanted_.front();
  SmallPicture small = small_[id];
  lock.unlock();
  const auto start = Clock::now();
  using Png = std::shared_ptr<const std::string>;
  const auto png = GuardedResult([&]() -> Result<Png> { return SmallPng(id, small); });
  const auto cost = Clock::now() - start;
  lock.lock();
  small_wanted_.pop_front();
  SmallPicture& kept = small_[id];
  if (png && *png != nullptr) kept.png = *png;
  kept.samples_done = small.samples_done;
  kept.due = start + kSmallInterval;
  small_due_ = start + kPauses / 2 * cost;
}

// Returns null if there is nothing new.
std::shared_ptr<const std::string> PictureBoards::SmallPng(SmallId id, SmallPicture& small) const {
  const FrameId frame = id.first;
  const auto asked = farm_.frame(frame.job, frame.frame);
  const FrameState* const state = std::get_if<FrameState>(&asked);
  if (state == nullptr || state->status.samples_done == small.samples_done) return nullptr;
  const FrameSpec& spec = state->spec->frames[frame.frame].spec;
  const int step = StepFor(spec, id.second);
  ColorPicture picture(spec, step);
  if (state->snapshot) {
    for (int tile = 0; tile < spec.TileCount(); ++tile)
      picture.Paint(state->snapshot->TilePicture(tile, step));
  } else {
    if (!state->file && !state->IsOver()) return nullptr;
    const auto file = Load(frame, *state);
    if (!file || file->bounds != spec.crop) return nullptr;
    picture.Paint(*file, step);
  }
  small.samples_done = state->status.samples_done;
  return std::make_shared<const std::string>(picture.Png());
}

}  // namespace tessera
