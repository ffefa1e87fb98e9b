#include "client/live/tev_display.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <system_error>
#include <thread>

#include "client/live/tev_packets.h"
#include "renderer/util/threads.h"

namespace tessera {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr std::string_view kScheme = "tev://";
constexpr int kPortDefault = 14158;
constexpr int kPortMax = 65535;
constexpr milliseconds kConnectPatience{2000};
constexpr milliseconds kSendPatience{3000};  // without taking a byte
constexpr milliseconds kSlice{100};          // how long a stop may go unnoticed
constexpr int kTileSize = 256;               // pixels

// Whether the pixels of the tile are the same, to the last bit.
bool IsSame(const LoadedPicture& a, const LoadedPicture& b, const PixelBounds& tile) {
  const size_t channels = a.channels.size();
  const auto width = static_cast<size_t>(a.bounds.width());
  const size_t row = static_cast<size_t>(tile.width()) * channels;
  for (int y = tile.y0; y < tile.y1; ++y) {
    const size_t at =
        (static_cast<size_t>(y - a.bounds.y0) * width + static_cast<size_t>(tile.x0 - a.bounds.x0)) *
        channels;
    if (std::memcmp(&a.values[at], &b.values[at], row * sizeof(float)) != 0) return false;
  }
  return true;
}

// The tile's values, one channel after another.
std::vector<float> ValuesOf(const LoadedPicture& picture, const PixelBounds& tile) {
  const size_t channels = picture.channels.size();
  const auto width = static_cast<size_t>(picture.bounds.width());
  std::vector<float> values;
  values.reserve(static_cast<size_t>(tile.area()) * channels);
  for (size_t c = 0; c < channels; ++c) {
    for (int y = tile.y0; y < tile.y1; ++y) {
      const size_t row = static_cast<size_t>(y - picture.bounds.y0) * width;
      for (int x = tile.x0; x < tile.x1; ++x)
        values.push_back(picture.values[(row + static_cast<size_t>(x - picture.bounds.x0)) * channels + c]);
    }
  }
  return values;
}

// The part of the data window that the display window shows, cut into tiles.
std::vector<PixelBounds> TilesOf(const LoadedPicture& picture) {
  const PixelBounds shown{std::max(picture.bounds.x0, 0), std::max(picture.bounds.y0, 0),
                          std::min(picture.bounds.x1, picture.width),
                          std::min(picture.bounds.y1, picture.height)};
  std::vector<PixelBounds> tiles;
  for (int y = shown.y0; y < shown.y1; y += kTileSize) {
    for (int x = shown.x0; x < shown.x1; x += kTileSize)
      tiles.push_back({x, y, std::min(x + kTileSize, shown.x1), std::min(y + kTileSize, shown.y1)});
  }
  return tiles;
}

bool HasSameShape(const LoadedPicture& a, const LoadedPicture& b) {
  return a.width == b.width && a.height == b.height && a.bounds == b.bounds && a.channels == b.channels;
}

}  // namespace

std::string TevAddress::Text() const {
  const bool is_v6 = host.find(':') != std::string::npos;
  return is_v6 ? fmt::format("{}[{}]:{}", kScheme, host, port) : fmt::format("{}{}:{}", kScheme, host, port);
}

Result<TevAddress> ParseTevAddress(std::string_view flag, std::string_view word) {
  const auto bad = [&] { return BadInput(fmt::format("{}: \"{}\" is not tev://HOST:PORT", flag, word)); };
  if (!word.starts_with(kScheme)) return bad();
  std::string_view rest = word.substr(kScheme.size());
  if (rest.ends_with('/')) rest.remove_suffix(1);
  TevAddress address{"", kPortDefault};
  const size_t bracket = rest.starts_with('[') ? rest.find(']') : 0;
  if (bracket == std::string_view::npos) return bad();
  const size_t colon = rest.find(':', bracket);
  address.host = rest.substr(0, colon);
  if (bracket > 0) address.host = rest.substr(1, bracket - 1);
  if (bracket > 0 && rest.size() > bracket + 1 && rest[bracket + 1] != ':') return bad();
  if (colon != std::string_view::npos) {
    const std::string_view port = rest.substr(colon + 1);
    const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), address.port);
    if (error != std::errc() || end != port.data() + port.size()) return bad();
  }
  if (address.host.empty() || address.port < 1 || address.port > kPortMax) return bad();
  return address;
}

// A name server that does not answer cannot be interrupted, so its answer is waited for on a thread that is
// left behind if need be.
struct TevDisplay::Lookup {
  std::mutex mutex;
  std::condition_variable answered;
  std::optional<ResolvedHost> host;  // guarded by mutex
  Interruption interruption;
};

TevDisplay::TevDisplay(TevAddress address, std::string name, bool is_sequence)
    : address_(std::move(address)), name_(std::move(name)), is_sequence_(is_sequence) {}

TevDisplay::~TevDisplay() = default;

std::string TevDisplay::NameOf(int frame) const {
  return is_sequence_ ? fmt::format("{}, frame {}", name_, frame) : name_;
}

Result<void> TevDisplay::Connect(const std::stop_token& stop) {
  const auto fail = [&](const std::string& why) {
    return Failed(fmt::format("--display {}: {}", address_.Text(), why));
  };
  if (lookup_ == nullptr) {
    lookup_ = std::make_shared<Lookup>();
    try {
      std::thread([lookup = lookup_, address = address_] {
        auto host = Resolve(address.host, address.port, lookup->interruption);
        const std::lock_guard lock(lookup->mutex);
        lookup->host = std::move(host);
        lookup->answered.notify_all();
      }).detach();
    } catch (const std::system_error& why) {
      lookup_ = nullptr;
      return CannotStartThread(why);
    }
  }
  std::unique_lock lock(lookup_->mutex);
  lookup_->answered.wait_for(lock, kConnectPatience, [this] { return lookup_->host.has_value(); });
  if (!lookup_->host) return fail("no name server answers");
  if (lookup_->host->error != 0) {
    const int error = lookup_->host->error;
    lock.unlock();
    lookup_ = nullptr;  // asks again next time
    return fail(::gai_strerror(error));
  }
  int error = 0;
  for (const addrinfo* each = lookup_->host->addresses.get(); each != nullptr; each = each->ai_next) {
    if (stop.stop_requested()) return Error{ErrorKind::kInterrupted, "interrupted"};
    auto socket = std::make_unique<ProbeSocket>(each->ai_family, interruption_);
    error = socket->Connect(each->ai_addr, each->ai_addrlen, Clock::now() + kConnectPatience);
    if (error != 0) continue;
    socket_ = std::move(socket);
    return {};
  }
  return fail(error == ECONNREFUSED ? "no program listens there; start tev"
                                    : std::error_code(error, std::generic_category()).message());
}

// tev sends nothing, so what can be read is the end of the connection.
bool TevDisplay::IsClosed() const {
  char byte = 0;
  const ssize_t count = ::recv(socket_->fd(), &byte, 1, MSG_PEEK | MSG_DONTWAIT);
  return count == 0 || (count < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR);
}

void TevDisplay::Disconnect() {
  socket_ = nullptr;
  open_.clear();
  sent_.reset();
}

Result<void> TevDisplay::Send(std::string_view bytes, const std::stop_token& stop) {
  auto deadline = Clock::now() + kSendPatience;
  while (!bytes.empty()) {
    if (stop.stop_requested()) return Error{ErrorKind::kInterrupted, "interrupted"};
    if (!socket_->Await(POLLOUT, std::min(deadline, Clock::now() + kSlice))) {
      if (Clock::now() < deadline) continue;
      return Failed(fmt::format("--display {}: tev does not take the picture", address_.Text()));
    }
    const ssize_t count = ::send(socket_->fd(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (count < 0 && (errno == EAGAIN || errno == EINTR)) continue;
    if (count <= 0) {
      return Failed(fmt::format("--display {}: the connection broke: {}", address_.Text(),
                                std::error_code(errno, std::generic_category()).message()));
    }
    bytes.remove_prefix(static_cast<size_t>(count));
    deadline = Clock::now() + kSendPatience;
  }
  return {};
}

Result<void> TevDisplay::SendTiles(const std::string& name, const LoadedPicture& picture,
                                   const std::stop_token& stop) {
  for (const PixelBounds& tile : TilesOf(picture)) {
    if (sent_ && IsSame(*sent_, picture, tile)) continue;
    const auto sent = Send(TevUpdateImage(name, picture.channels, tile, ValuesOf(picture, tile)), stop);
    if (!sent) return sent;
  }
  return {};
}

Result<void> TevDisplay::Show(const LivePicture& shown, const std::stop_token& stop) {
  const LoadedPicture& picture = shown.picture;
  const std::string name = NameOf(shown.frame);
  if (socket_ != nullptr && IsClosed()) Disconnect();
  if (socket_ == nullptr) {
    if (auto connected = Connect(stop); !connected) return connected;
  }
  if (open_ != name || !sent_ || !HasSameShape(*sent_, picture)) {
    sent_.reset();
    open_ = name;
    const auto created = Send(TevCreateImage(name, picture.width, picture.height, picture.channels), stop);
    if (!created) {
      Disconnect();
      return created;
    }
  }
  if (auto sent = SendTiles(name, picture, stop); !sent) {
    Disconnect();
    return sent;
  }
  sent_ = picture;
  return {};
}

}  // namespace tessera
