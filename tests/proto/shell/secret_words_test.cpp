#include "proto/shell/secret_words.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <stop_token>
#include <thread>
#include <vector>

namespace tessera {
namespace {

// What is left of these words.
std::vector<std::string> Hidden(std::vector<std::string> words) {
  words.insert(words.begin(), "program");
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  HideTokens(static_cast<int>(pointers.size()), pointers.data());
  return {words.begin() + 1, words.end()};
}

// With this text on standard input, which ends after it or is still open.
Result<std::string> FromInput(const std::string& text, bool is_open = false,
                              const std::stop_token& stop = {}) {
  int ends[2];
  EXPECT_EQ(::pipe(ends), 0);
  EXPECT_EQ(::write(ends[1], text.data(), text.size()), static_cast<ssize_t>(text.size()));
  if (!is_open) ::close(ends[1]);
  const int before = ::dup(STDIN_FILENO);
  ::dup2(ends[0], STDIN_FILENO);
  ::close(ends[0]);
  auto word = WordOrInput("-", stop);
  ::dup2(before, STDIN_FILENO);
  ::close(before);
  if (is_open) ::close(ends[1]);
  return word;
}

TEST(SecretWords, TokensAreOverwrittenAndOtherWordsStay) {
  const std::string secret(80, 'A'), hidden(80, 'x');
  EXPECT_EQ(Hidden({"login", "tessera-" + secret, "--join=tessera-" + secret, "--farm", "studio"}),
            (std::vector<std::string>{"login", "tessera-" + hidden, "--join=tessera-" + hidden, "--farm",
                                      "studio"}));
  const std::vector<std::string> others{"/opt/tessera-0.2/scene.pbrt", "tessera-worker", secret, ""};
  EXPECT_EQ(Hidden(others), others);
}

TEST(SecretWords, ALineOfStandardInputTakesThePlaceOfAHyphen) {
  EXPECT_EQ(*WordOrInput("word", {}), "word");
  EXPECT_EQ(*FromInput(" tessera-x\r\nmore\n"), "tessera-x");
  EXPECT_EQ(*FromInput("tessera-x"), "tessera-x");
  EXPECT_EQ(FromInput("\n").error().message, "there is no token on standard input");
  EXPECT_EQ(FromInput(std::string(5000, 'x')).error().kind, ErrorKind::kBadInput);
}

TEST(SecretWords, AStopEndsTheWaitForALine) {
  std::stop_source stop;
  EXPECT_EQ(*FromInput("tessera-x\n", true, stop.get_token()), "tessera-x");
  const std::jthread stopping([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    stop.request_stop();
  });
  EXPECT_EQ(FromInput("tessera-", true, stop.get_token()).error().kind, ErrorKind::kInterrupted);
}

}  // namespace
}  // namespace tessera
