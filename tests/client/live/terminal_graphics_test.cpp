#include "client/live/terminal_graphics.h"

#include <gtest/gtest.h>

#include <map>

namespace tessera {
namespace {

Graphics KindOf(std::map<std::string, std::string> variables) {
  return GraphicsOf([&](const char* name) { return variables[name]; });
}

TEST(TerminalGraphics, FollowTheEnvironmentWhereTheTerminalIsNotAsked) {
  const std::string utf8 = "en_GB.UTF-8";
  EXPECT_EQ(KindOf({{"TERM", "xterm-256color"}, {"LANG", utf8}, {"COLORTERM", "truecolor"}}),
            Graphics::kTrueColor);
  EXPECT_EQ(KindOf({{"TERM", "xterm-direct"}, {"LANG", utf8}}), Graphics::kTrueColor);
  EXPECT_EQ(KindOf({{"TERM", "tmux-256color"}, {"LC_ALL", "C.utf8"}}), Graphics::kColors256);
  EXPECT_EQ(KindOf({{"TERM", "xterm-256color"}, {"LC_ALL", "C"}, {"LANG", utf8}}), Graphics::kShades)
      << "half blocks need UTF-8";
  EXPECT_EQ(KindOf({{"TERM", "vt100"}, {"LANG", utf8}}), Graphics::kShades);
  EXPECT_EQ(KindOf({{"LANG", utf8}, {"COLORTERM", "truecolor"}}), Graphics::kShades);
  EXPECT_EQ(
      KindOf({{"TERM", "xterm-256color"}, {"LANG", utf8}, {"COLORTERM", "truecolor"}, {"NO_COLOR", "1"}}),
      Graphics::kShades);
}

TEST(TerminalGraphics, AreReadFromTheAnswerOfTheTerminal) {
  const GraphicsAnswer kitty = ReadGraphicsAnswer("\x1b_Gi=4711;OK\x1b\\\x1b[6;18;9t\x1b[?62;c");
  EXPECT_TRUE(kitty.is_complete);
  EXPECT_TRUE(kitty.has_kitty);
  EXPECT_FALSE(kitty.has_sixel);
  EXPECT_EQ(kitty.cell_width, 9);
  EXPECT_EQ(kitty.cell_height, 18);
  const GraphicsAnswer sixel = ReadGraphicsAnswer("q\x1b[?63;1;2;4;6;9;15c");
  EXPECT_TRUE(sixel.is_complete);
  EXPECT_TRUE(sixel.has_sixel);
  EXPECT_FALSE(sixel.has_kitty);
  EXPECT_EQ(sixel.cell_width, 0);
  const GraphicsAnswer plain = ReadGraphicsAnswer("\x1b[?1;2c");
  EXPECT_TRUE(plain.is_complete);
  EXPECT_FALSE(plain.has_sixel);
  EXPECT_FALSE(ReadGraphicsAnswer("\x1b[?4c").has_sixel) << "the first number is the kind of terminal";
  EXPECT_FALSE(ReadGraphicsAnswer("\x1b_Gi=4711;ENOTSUP\x1b\\\x1b[?62c").has_kitty);
}

TEST(TerminalGraphics, AnAnswerThatIsCutOrHostileIsNone) {
  const std::string whole = "\x1b_Gi=4711;OK\x1b\\\x1b[6;18;9t\x1b[?62;4c";
  for (size_t size = 0; size < whole.size(); ++size)
    EXPECT_FALSE(ReadGraphicsAnswer(whole.substr(0, size)).is_complete) << size;
  EXPECT_EQ(ReadGraphicsAnswer("\x1b[6;99999999999;0t").cell_width, 0);
  EXPECT_EQ(ReadGraphicsAnswer("\x1b[6;5000;9t").cell_width, 0);
  EXPECT_FALSE(ReadGraphicsAnswer("\x1b[?;;;;c\x1b[?").has_sixel);
}

TEST(TerminalGraphics, TheQuestionEndsWithOneThatAllTerminalsAnswer) {
  EXPECT_TRUE(GraphicsQuestion().ends_with("\x1b[c"));
}

}  // namespace
}  // namespace tessera
