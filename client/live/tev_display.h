// The picture in a window of tev: --display tev://HOST:PORT. The program may be absent, slow, or end and come
// back; then it gets the next picture as a whole.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "client/live/picture_view.h"
#include "proto/wire/probe_socket.h"

namespace tessera {

struct TevAddress {
  std::string host;
  int port = 0;
  std::string Text() const;  // "tev://HOST:PORT"
};
// Reads tev://HOST[:PORT]; a numeric IPv6 host is in brackets. The port is 14158 by default, as tev's.
Result<TevAddress> ParseTevAddress(std::string_view flag, std::string_view word);

class TevDisplay : public PictureView {
 public:
  // `name` of the picture in tev. A frame with a number has it in its name if `is_sequence`.
  TevDisplay(TevAddress address, std::string name, bool is_sequence);
  ~TevDisplay() override;
  Result<void> Show(const LivePicture& picture, const std::stop_token& stop) override;

 private:
  struct Lookup;  // of the host's addresses; may outlive this
  Result<void> Connect(const std::stop_token& stop);
  bool IsClosed() const;
  void Disconnect();
  Result<void> Send(std::string_view bytes, const std::stop_token& stop);
  Result<void> SendTiles(const std::string& name, const LoadedPicture& picture, const std::stop_token& stop);
  std::string NameOf(int frame) const;

  const TevAddress address_;
  const std::string name_;
  const bool is_sequence_;
  std::shared_ptr<Lookup> lookup_;
  Interruption interruption_;
  std::unique_ptr<ProbeSocket> socket_;
  std::string open_;                   // name of the image that tev has from this connection, or empty
  std::optional<LoadedPicture> sent_;  // what it shows
};

}  // namespace tessera
