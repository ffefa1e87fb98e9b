#include "renderer/pbrt/lexer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "renderer/util/text.h"

namespace tessera {
namespace {

using testing::ElementsAre;

// "kind@line:column text" of all tokens up to the end.
std::vector<std::string> Tokens(const std::string& text) {
  Lexer lexer(text, std::make_shared<const std::string>("f"));
  std::vector<std::string> tokens;
  while (true) {
    const Token token = lexer.Next();
    const char kind = "EWS[]B"[static_cast<int>(token.kind)];
    tokens.push_back(kind + std::string("@") + std::to_string(token.line) + ":" +
                     std::to_string(token.column) + " " + std::string(token.text));
    if (token.kind == Token::Kind::kEnd || token.kind == Token::Kind::kBad) return tokens;
  }
}

TEST(Lexer, CutsWordsStringsAndBrackets) {
  EXPECT_THAT(Tokens("Shape \"a b\"[1 -2.5]\n\tX\r\n Y"),
              ElementsAre("W@1:1 Shape", "S@1:7 a b", "[@1:12 [", "W@1:13 1", "W@1:15 -2.5", "]@1:19 ]",
                          "W@2:2 X", "W@3:2 Y", "E@3:3 "));
}

TEST(Lexer, QuotesAndBracketsEndAWord) {
  EXPECT_THAT(Tokens("a\"b\"c[d]e"), ElementsAre("W@1:1 a", "S@1:2 b", "W@1:5 c", "[@1:6 [", "W@1:7 d",
                                                 "]@1:8 ]", "W@1:9 e", "E@1:10 "));
}

TEST(Lexer, CommentsLastToTheEndOfTheLine) {
  EXPECT_THAT(Tokens("# \"x\" [\na # b\r\n#\n\n  c#d"), ElementsAre("W@2:1 a", "W@5:3 c#d", "E@5:6 "));
}

TEST(Lexer, EscapesInStringsAreResolved) {
  EXPECT_THAT(Tokens(R"("a\"\\\'\n\t\r\b\f#[" x)"),
              ElementsAre("S@1:1 a\"\\'\n\t\r\b\f#[", "W@1:23 x", "E@1:24 "));
}

TEST(Lexer, AUtf8MarkIsSkippedAndLettersBeyondAsciiAreKept) {
  EXPECT_THAT(Tokens("\xef\xbb\xbf\"\xc3\xa4\""), ElementsAre("S@1:1 \xc3\xa4", "E@1:5 "));
}

TEST(Lexer, BadTokensStayBad) {
  Lexer lexer("\"a", std::make_shared<const std::string>("f"));
  EXPECT_EQ(lexer.Next().kind, Token::Kind::kBad);
  const Token again = lexer.Next();
  EXPECT_EQ(again.kind, Token::Kind::kBad);
  EXPECT_EQ(again.Location().Text(), "f:1:1");
}

TEST(SourceLocation, MessagesAreOneLineOfUtf8) {
  EXPECT_EQ(OneLine("a\nb\x01\xff\xc3\xa4\xc3"), "a?b??\xc3\xa4?");
  EXPECT_EQ(ErrorAt({}, "x").message, "<scene>:1:1: x");
}

TEST(SourceLocation, QuotedTextIsCutBetweenLetters) {
  EXPECT_EQ(Quoted("abc"), "\"abc\"");
  const std::string text = std::string(59, 'x') + "\xc3\xa4yz";
  EXPECT_EQ(Quoted(text), "\"" + std::string(59, 'x') + "...\"");
}

}  // namespace
}  // namespace tessera
