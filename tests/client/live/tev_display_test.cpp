#include "client/live/tev_display.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <optional>

#include "tests/client/live/fake_tev.h"
#include "tests/client/live/live_pictures.h"

namespace tessera {
namespace {

using testing::HasSubstr;

bool Becomes(const std::function<bool()>& condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return true;
}

// What tev should show of a channel.
std::vector<float> ValuesOf(const LoadedPicture& picture, size_t channel) {
  std::vector<float> values(static_cast<size_t>(picture.width * picture.height), 0);
  size_t at = 0;
  for (int y = picture.bounds.y0; y < picture.bounds.y1; ++y) {
    for (int x = picture.bounds.x0; x < picture.bounds.x1; ++x, at += picture.channels.size())
      values[static_cast<size_t>(y * picture.width + x)] = picture.values[at + channel];
  }
  return values;
}

bool Shows(FakeTev& tev, const std::string& name, const LoadedPicture& picture) {
  const auto images = tev.images();
  const auto found = images.find(name);
  if (found == images.end() || found->second.channels.size() != picture.channels.size()) return false;
  for (size_t c = 0; c < picture.channels.size(); ++c) {
    const auto channel = found->second.channels.find(picture.channels[c]);
    if (channel == found->second.channels.end() || channel->second != ValuesOf(picture, c)) return false;
  }
  return true;
}

TEST(TevDisplay, ShowsEveryPixelOfEveryChannelAndThenTheTilesThatChange) {
  FakeTev tev;
  TevDisplay display({"127.0.0.1", tev.port()}, "scene", false);
  LoadedPicture picture = PictureOf(600, 300, 0.5f, {"R", "G", "B", "albedo.R"});
  ASSERT_TRUE(display.Show({0, picture}, {}));
  EXPECT_TRUE(Becomes([&] { return Shows(tev, "scene", picture); }));
  EXPECT_EQ(tev.images().at("scene").updates, 6) << "3 x 2 tiles of 256 pixels";
  picture.values[(299 * 600 + 599) * 4 + 2] = 77;
  ASSERT_TRUE(display.Show({0, picture}, {}));
  EXPECT_TRUE(Becomes([&] { return Shows(tev, "scene", picture); }));
  EXPECT_EQ(tev.images().at("scene").updates, 7);
  EXPECT_EQ(tev.connections(), 1);
}

TEST(TevDisplay, ShowsACropInItsPlaceAndEachFrameOfASequenceByItself) {
  FakeTev tev;
  TevDisplay display({"127.0.0.1", tev.port()}, "shot", true);
  LoadedPicture picture = PictureOf(8, 4, 1);
  picture.width = 20;
  picture.height = 10;
  picture.bounds = {5, 3, 13, 7};
  ASSERT_TRUE(display.Show({7, picture}, {}));
  ASSERT_TRUE(display.Show({8, PictureOf(3, 2, 2)}, {}));
  EXPECT_TRUE(Becomes([&] { return Shows(tev, "shot, frame 7", picture); }));
  EXPECT_TRUE(Becomes([&] { return Shows(tev, "shot, frame 8", PictureOf(3, 2, 2)); }));
}

TEST(TevDisplay, AViewerThatStartsLaterOrAgainGetsTheWholePicture) {
  std::optional<FakeTev> tev(std::in_place);
  const int port = tev->port();
  tev.reset();
  TevDisplay display({"127.0.0.1", port}, "scene", false);
  const auto refused = display.Show({0, PictureOf(10, 10, 1)}, {});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("no program listens there; start tev"));
  for (const float seed : {2.0f, 3.0f}) {
    tev.emplace(port);
    const LoadedPicture picture = PictureOf(10, 10, seed);
    // The first attempt may find out that the other one is gone.
    EXPECT_TRUE(Becomes([&] { return display.Show({0, picture}, {}).has_value(); }));
    EXPECT_TRUE(Becomes([&] { return Shows(*tev, "scene", picture); })) << seed;
    tev.reset();
  }
}

TEST(TevDisplay, AViewerThatTakesNothingIsGivenUpAndAStopEndsTheAttempt) {
  FakeTev tev(0, true);
  const LoadedPicture picture = PictureOf(3000, 1000, 1);  // more than the buffers of the connection
  TevDisplay display({"127.0.0.1", tev.port()}, "scene", false);
  const auto shown = display.Show({0, picture}, {});
  ASSERT_FALSE(shown);
  EXPECT_THAT(shown.error().message, HasSubstr("tev does not take the picture"));
  std::stop_source stop;
  stop.request_stop();
  const auto stopped = display.Show({0, picture}, stop.get_token());
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::kInterrupted);
}

TEST(TevDisplay, AHostThatIsUnknownIsNamed) {
  TevDisplay display({"no-such-host.invalid", 1}, "scene", false);
  const auto shown = display.Show({0, PictureOf(2, 2, 1)}, {});
  ASSERT_FALSE(shown);
  EXPECT_THAT(shown.error().message, HasSubstr("--display tev://no-such-host.invalid:1: "));
}

TEST(TevAddress, IsAHostWithOrWithoutAPort) {
  const auto text = [](const char* word) -> std::string {
    const auto address = ParseTevAddress("--display", word);
    return address ? address->Text() : "refused: " + address.error().message;
  };
  EXPECT_EQ(text("tev://localhost:14159"), "tev://localhost:14159");
  EXPECT_EQ(text("tev://localhost"), "tev://localhost:14158");
  EXPECT_EQ(text("tev://10.0.0.7/"), "tev://10.0.0.7:14158");
  EXPECT_EQ(text("tev://[::1]:99"), "tev://[::1]:99");
  EXPECT_EQ(text("tev://[::1]"), "tev://[::1]:14158");
  for (const char* bad : {"", "localhost:1", "tev://", "tev://:1", "tev://a:0", "tev://a:65536", "tev://a:x",
                          "tev://a:", "tev://[::1", "tev://[::1]x", "http://a:1"})
    EXPECT_THAT(text(bad), HasSubstr("is not tev://HOST:PORT")) << bad;
}

}  // namespace
}  // namespace tessera
