// A program that takes pictures as tev does, and checks each packet.
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <cstring>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace tessera {

class FakeTev {
 public:
  struct Image {
    int width = 0, height = 0;
    std::map<std::string, std::vector<float>> channels;
    int updates = 0;
  };

  // Listens on `port`, or on any free port if it is 0. If `is_stuck`, accepts connections but reads nothing.
  explicit FakeTev(int port = 0, bool is_stuck = false) : is_stuck_(is_stuck) {
    listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const int one = 1;
    ::setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &one, sizeof one);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<uint16_t>(port));
    EXPECT_EQ(::bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    socklen_t size = sizeof address;
    ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
    EXPECT_EQ(::listen(listener_, 4), 0);
    thread_ = std::thread([this] { Run(); });
  }
  ~FakeTev() {
    stop_ = true;
    thread_.join();
    ::close(listener_);
  }
  int port() const { return port_; }
  std::map<std::string, Image> images() {
    const std::lock_guard lock(mutex_);
    return images_;
  }
  int connections() const { return connections_; }

 private:
  bool IsReadable(int socket) {
    pollfd event{socket, POLLIN, 0};
    return ::poll(&event, 1, 20) > 0;
  }
  void Run() {
    while (!stop_) {
      if (!IsReadable(listener_)) continue;
      const int socket = ::accept(listener_, nullptr, nullptr);
      ++connections_;
      Serve(socket);
      ::close(socket);
    }
  }
  void Serve(int socket) {
    std::string bytes;
    while (!stop_) {
      char part[1 << 16];
      if (is_stuck_ || !IsReadable(socket)) {
        if (is_stuck_) std::this_thread::sleep_for(std::chrono::milliseconds(20));
        continue;
      }
      const ssize_t count = ::read(socket, part, sizeof part);
      if (count <= 0) break;
      bytes.append(part, static_cast<size_t>(count));
      while (TakePacket(bytes)) {
      }
    }
    EXPECT_TRUE(stop_ || bytes.empty()) << "a packet is cut off";
  }
  bool TakePacket(std::string& bytes) {
    uint32_t size = 0;
    if (bytes.size() < sizeof size) return false;
    std::memcpy(&size, bytes.data(), sizeof size);
    if (bytes.size() < size) return false;
    Reader in{bytes.substr(4, size - 4)};
    bytes.erase(0, size);
    Apply(in);
    return true;
  }

  struct Reader {
    std::string bytes;
    size_t at = 0;
    char Byte() { return bytes.at(at++); }
    int Number() {
      int32_t value = 0;
      std::memcpy(&value, bytes.substr(at, 4).data(), 4);
      at += 4;
      return value;
    }
    std::string Text() {
      const std::string text = bytes.c_str() + at;
      at += text.size() + 1;
      return text;
    }
    std::vector<std::string> Texts() {
      std::vector<std::string> texts(static_cast<size_t>(Number()));
      for (std::string& text : texts) text = Text();
      return texts;
    }
    float Float() {
      float value = 0;
      std::memcpy(&value, bytes.substr(at, 4).data(), 4);
      at += 4;
      return value;
    }
  };

  void Apply(Reader& in) {
    const std::lock_guard lock(mutex_);
    const char kind = in.Byte();
    EXPECT_EQ(in.Byte(), 0) << "it does not take the focus";
    const std::string name = in.Text();
    if (kind == 4) {
      Image& image = images_[name] = {};
      image.width = in.Number();
      image.height = in.Number();
      for (const std::string& channel : in.Texts())
        image.channels[channel].assign(static_cast<size_t>(image.width * image.height), 0);
    } else {
      ASSERT_EQ(kind, 5);
      Image& image = images_.at(name);
      ++image.updates;
      const auto channels = in.Texts();
      const int x0 = in.Number(), y0 = in.Number(), width = in.Number(), height = in.Number();
      ASSERT_LE(x0 + width, image.width);
      ASSERT_LE(y0 + height, image.height);
      for (const std::string& channel : channels) {
        std::vector<float>& values = image.channels.at(channel);
        for (int y = y0; y < y0 + height; ++y)
          for (int x = x0; x < x0 + width; ++x) values[static_cast<size_t>(y * image.width + x)] = in.Float();
      }
    }
    EXPECT_EQ(in.at, in.bytes.size()) << "the length of the packet";
  }

  const bool is_stuck_;
  int listener_ = -1, port_ = 0;
  std::atomic<bool> stop_{false};
  std::atomic<int> connections_{0};
  std::mutex mutex_;
  std::map<std::string, Image> images_;
  std::thread thread_;
};

}  // namespace tessera
