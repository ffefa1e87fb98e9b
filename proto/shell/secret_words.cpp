#include "proto/shell/secret_words.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <string_view>

namespace tessera {
namespace {

// How tokens begin (JoinToken), and the least number of characters that follow: a secret and a fingerprint.
constexpr std::string_view kTokenStart = "tessera-";
constexpr size_t kTokenRestMin = 64;
// A token has some hundred.
constexpr size_t kLineBytesMax = 4096;
constexpr int kStopProbe_ms = 100;

bool IsTokenCharacter(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_';
}

// Reads no byte after the line, which may be for somebody else.
Result<std::string> ReadLine(int file, const std::stop_token& stop) {
  std::string line;
  while (line.size() < kLineBytesMax) {
    if (stop.stop_requested()) return Error{ErrorKind::kInterrupted, "interrupted"};
    pollfd event{file, POLLIN, 0};
    if (::poll(&event, 1, kStopProbe_ms) == 0) continue;
    char c = 0;
    const ssize_t count = ::read(file, &c, 1);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return Failed(fmt::format("standard input cannot be read: {}", std::strerror(errno)));
    if (count == 0 || c == '\n') return line;
    line += c;
  }
  return BadInput(fmt::format("the first line of standard input is longer than {} bytes", kLineBytesMax));
}

}  // namespace

void HideTokens(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    char* const start = std::strstr(argv[i], kTokenStart.data());
    if (start == nullptr) continue;
    char* const rest = start + kTokenStart.size();
    char* const end = std::find_if_not(rest, rest + std::strlen(rest), IsTokenCharacter);
    if (static_cast<size_t>(end - rest) >= kTokenRestMin) std::fill(rest, end, 'x');
  }
}

Result<std::string> WordOrInput(const std::string& word, const std::stop_token& stop) {
  if (word != "-") return word;
  const auto line = ReadLine(STDIN_FILENO, stop);
  if (!line) return line.error();
  constexpr const char* kSpace = " \t\r";
  const size_t begin = line->find_first_not_of(kSpace);
  if (begin == std::string::npos) return BadInput("there is no token on standard input");
  return line->substr(begin, line->find_last_not_of(kSpace) + 1 - begin);
}

}  // namespace tessera
