// Pictures that are shown while they are rendered.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <filesystem>

#include "renderer/film/picture_file.h"
#include "tests/client/live/fake_tev.h"
#include "tests/end_to_end/farm_fixture.h"

namespace tessera {
namespace {

using testing::HasSubstr;

class Live : public EndToEnd {
 protected:
  // tev shows the pixels of the file.
  bool Shows(FakeTev& tev, const std::string& name, const std::string& file) {
    const auto picture = LoadExr(Path(file));
    const auto images = tev.images();
    const auto found = images.find(name);
    if (!picture || found == images.end() || found->second.channels.size() != picture->channels.size())
      return false;
    for (size_t c = 0; c < picture->channels.size(); ++c) {
      const std::vector<float>& shown = found->second.channels.at(picture->channels[c]);
      for (size_t i = 0; i < shown.size(); ++i) {
        if (shown[i] != picture->values[i * picture->channels.size() + c]) return false;
      }
    }
    return true;
  }
};

TEST_F(Live, APreviewIsThereWhileAFarmOfProcessesRendersAndIsTheFinishedPictureAtTheEnd) {
  Process render(folder(), "tessera",
                 {"render", BoxScene(), kLongRender[0], kLongRender[1], "--preview", "preview.png", "-o",
                  "a.exr", "--png", "a.png"});
  EXPECT_TRUE(Eventually([&] { return Exists("preview.png"); }));
  EXPECT_FALSE(Exists("a.exr")) << "it is still being rendered";
  EXPECT_EQ(Bytes("preview.png").substr(1, 3), "PNG");
  EXPECT_EQ(render.Wait(), 0) << render.Errors();
  EXPECT_EQ(Bytes("preview.png"), Bytes("a.png"));
  EXPECT_EQ(Bytes("a.exr"), Oracle(BoxScene(), kLongRender));
}

TEST_F(Live, APreviewOfARenderInOneProcessIsTheFinishedPictureAtTheEnd) {
  const Outcome outcome = Tessera({"render", BoxScene(), "--spp", "64", "--in-process", "--preview",
                                   "preview.png", "-o", "a.exr", "--png", "a.png"});
  EXPECT_EQ(outcome.code, 0) << outcome.errors;
  EXPECT_EQ(Bytes("preview.png"), Bytes("a.png"));
  EXPECT_EQ(Bytes("a.exr"), Oracle(BoxScene(), {"--spp", "64"}));
}

TEST_F(Live, ViewsThatFailAreWarningsAndThePictureIsRendered) {
  for (const bool in_process : {false, true}) {
    std::vector<std::string> words{
        "render",    BoxScene(),          "--spp", "16",   "--preview", "not-there/preview.png",
        "--display", "tev://127.0.0.1:1", "-o",    "a.exr"};
    if (in_process) words.push_back("--in-process");
    const Outcome outcome = Tessera(words);
    EXPECT_EQ(outcome.code, 0) << outcome.errors;
    EXPECT_THAT(outcome.errors, HasSubstr("not-there/preview.png"));
    EXPECT_THAT(outcome.errors,
                HasSubstr("tev://127.0.0.1:1: no program listens there; start tev; the render "
                          "continues"));
    EXPECT_EQ(Bytes("a.exr"), Oracle(BoxScene(), {"--spp", "16"}));
  }
}

TEST_F(Live, TevShowsTheLayersOfTheFinishedPicture) {
  FakeTev tev;
  const std::string display = fmt::format("tev://127.0.0.1:{}", tev.port());
  const std::vector<std::string> words{"render",    BoxScene(),     "--spp",      "32",
                                       "--aov",     "albedo,depth", "-o",         "a.exr",
                                       "--display", display,        "--exr-type", "float"};
  EXPECT_EQ(Tessera(words).code, 0);
  EXPECT_TRUE(Eventually([&] { return Shows(tev, "box", "a.exr"); }));
  std::filesystem::remove(Path("a.exr"));
  std::vector<std::string> here = words;
  here.push_back("--in-process");
  EXPECT_EQ(Tessera(here).code, 0);
  EXPECT_TRUE(Eventually([&] { return Shows(tev, "box", "a.exr"); }));
}

TEST_F(Live, AJobOfAFarmIsShownToThoseWhoWatchIt) {
  StartCoordinator();
  StartWorker("only");
  FakeTev tev;
  const std::string job = Submit(BoxScene(), {"--spp", "64"});
  const Outcome watched = Ask({"watch", job, "--picture", "--preview", "preview.png", "--display",
                               fmt::format("tev://127.0.0.1:{}", tev.port())});
  EXPECT_EQ(watched.code, 0) << watched.errors;
  EXPECT_THAT(watched.errors, HasSubstr("there is no terminal for --picture"));
  ASSERT_EQ(Ask({"fetch", job, "-o", "a.exr", "--png", "a.png"}).code, 0);
  EXPECT_EQ(Bytes("preview.png"), Bytes("a.png"));
  EXPECT_TRUE(Eventually([&] { return Shows(tev, "job 1", "a.exr"); }));
  const Outcome submitted =
      Ask({"submit", BoxScene(), "--spp", "64", "--watch", "--preview", "submitted.png"});
  EXPECT_EQ(submitted.code, 0) << submitted.errors;
  EXPECT_EQ(Bytes("submitted.png"), Bytes("a.png"));
}

TEST_F(Live, WhatCannotBeShownIsRefusedBeforeAnythingStarts) {
  const auto refused = [&](std::vector<std::string> words) {
    const Outcome outcome = Tessera(words);
    EXPECT_EQ(outcome.code, 2) << outcome.errors;
    return outcome.errors;
  };
  EXPECT_THAT(refused({"render", BoxScene(), "--preview", "a.exr"}), HasSubstr("must end in .png or .jpg"));
  EXPECT_THAT(refused({"render", BoxScene(), "--preview", "a.png", "--png", "a.png"}), HasSubstr("a.png"));
  EXPECT_THAT(refused({"render", BoxScene(), "--display", "localhost"}), HasSubstr("is not tev://HOST:PORT"));
  EXPECT_THAT(refused({"submit", BoxScene(), "--preview", "a.png"}), HasSubstr("--preview needs --watch"));
  EXPECT_THAT(refused({"submit", BoxScene(), "--display", "tev://localhost"}),
              HasSubstr("--display needs --watch"));
  EXPECT_THAT(refused({"watch", "1", "2", "--picture"}), HasSubstr("show the picture of one job"));
}

// On a terminal of 80 x 24 cells that answers nothing. A key is pressed every second.
TEST_F(Live, ThePictureIsDrawnIntoATerminalAndLeftThereAtTheEnd) {
  StartCoordinator();
  const std::string job = Submit(BoxScene(), {"--spp", "64"});
  const std::string watch = "$tessera watch " + job + " --picture --coordinator " + address();
  const auto on_terminal = [&](const std::string& variables, char key) {
    return RunShell(folder(), std::string("(exec 2>/dev/null; for i in {1..100}; do sleep 1; printf ") + key +
                                  "; done) | " + variables +
                                  " script --quiet --return --log-out terminal --command \"stty cols 80 "
                                  "rows 24; " +
                                  watch + "\" >shown");
  };
  const std::string colors = "TERM=xterm-256color COLORTERM=truecolor LC_ALL=C.UTF-8";
  EXPECT_EQ(on_terminal(colors, 'q').code, 0);
  EXPECT_THAT(Bytes("shown"), HasSubstr("job " + job + " continues"));
  StartWorker("only");
  EXPECT_EQ(on_terminal(colors, 'x').code, 0);
  const std::string shown = Bytes("shown");
  EXPECT_THAT(shown, HasSubstr("\x1b[?1049h"));
  EXPECT_THAT(shown, HasSubstr("\x1b[38;2;"));
  EXPECT_THAT(shown, HasSubstr("\xe2\x96\x80"));
  const size_t closed = shown.rfind("\x1b[?1049l");
  ASSERT_NE(closed, std::string::npos);
  EXPECT_THAT(shown.substr(closed), HasSubstr("\xe2\x96\x80")) << "the last picture";
  EXPECT_THAT(shown.substr(closed), HasSubstr("finished"));
  EXPECT_EQ(on_terminal("TERM=xterm-256color LC_ALL=C.UTF-8 NO_COLOR=1", 'x').code, 0);
  EXPECT_EQ(Bytes("shown").find("\x1b[38;"), std::string::npos);
}

}  // namespace
}  // namespace tessera
