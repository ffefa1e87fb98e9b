#include "renderer/text/unicode.h"

#include <gtest/gtest.h>

#include <random>

namespace tessera {
namespace {

constexpr size_t kMany = 1000;  // bytes

TEST(CleanText, LeavesOrdinaryTextAlone) {
  for (const char* text : {"", "plain", "h\xc3\xa9 \xe6\xbc\xa2 \xf0\x9f\x98\x80 \"quoted\" \\ <b>&amp;",
                           "e\xcc\x81", "\xd7\xa9\xd7\x9c\xd7\x95\xd7\x9d"}) {
    EXPECT_EQ(CleanText(text, kMany), text);
  }
}

TEST(CleanText, TurnsControlCharactersAndLineSeparatorsIntoSpaces) {
  EXPECT_EQ(CleanText(std::string_view("a\0b\x1f\x7f"
                                       "c\nd\te\r",
                                       11),
                      kMany),
            "a b  c d e ");
  EXPECT_EQ(CleanText("a\xc2\x80z\xc2\x9b"
                      "31m\xc2\x85.",
                      kMany),
            "a z 31m .");
  EXPECT_EQ(CleanText("a\xe2\x80\xa8"
                      "b\xe2\x80\xa9"
                      "c",
                      kMany),
            "a b c");
}

TEST(CleanText, ReplacesWhatChangesTheDirectionOfWriting) {
  for (const char* mark : {"\xd8\x9c", "\xe2\x80\x8e", "\xe2\x80\x8f", "\xe2\x80\xaa", "\xe2\x80\xae",
                           "\xe2\x81\xa6", "\xe2\x81\xa9"}) {
    EXPECT_EQ(CleanText(std::string("a") + mark + "b", kMany),
              "a\xef\xbf\xbd"
              "b");
  }
}

TEST(IsUtf8, RefusesWhatIsCutOverlongOrNoCodePoint) {
  EXPECT_TRUE(IsUtf8("a\xc3\xa4\xe2\x82\xac\xf0\x9f\x98\x80"));
  for (const char* text : {"\x80", "\xc0\x80", "\xc1\xbf", "\xe0\x80\x80", "\xed\xa0\x80", "\xf0\x80\x80\x80",
                           "\xf4\x90\x80\x80", "\xf8\x88\x80\x80\x80", "\xc3", "\xe2\x82"}) {
    EXPECT_FALSE(IsUtf8(text));
  }
}

TEST(CleanText, ReplacesBytesThatAreNotUtf8) {
  EXPECT_EQ(CleanText("a\xff"
                      "b",
                      kMany),
            "a\xef\xbf\xbd"
            "b");
  EXPECT_EQ(CleanText("caf\xe9", kMany), "caf\xef\xbf\xbd");
  for (const char* bad : {"\xc3", "\xe2\x82", "\xed\xa0\x80", "\xc0\xaf", "\xf4\x90\x80\x80", "\x80"}) {
    EXPECT_FALSE(IsUtf8(bad));
    EXPECT_TRUE(IsUtf8(CleanText(bad, kMany)));
  }
}

TEST(CleanText, IsCutBetweenCodePoints) {
  EXPECT_EQ(CleanText("abcdef", 4), "abcd");
  EXPECT_EQ(CleanText("abc\xc3\xa9", 4), "abc");
  EXPECT_EQ(CleanText("abc\xc3\xa9", 5), "abc\xc3\xa9");
  EXPECT_EQ(CleanText("ab\xff", 4), "ab");
  std::string accents;
  for (int i = 0; i < 3000; ++i) accents += "\xc3\xa9";
  for (size_t limit = 4090; limit < 4100; ++limit) {
    const std::string cut = CleanText("x" + accents, limit);
    EXPECT_TRUE(IsUtf8(cut));
    EXPECT_LE(cut.size(), limit);
    EXPECT_GE(cut.size() + 1, limit);
  }
}

TEST(CleanText, MakesAnyBytesValidBoundedAndFinal) {
  std::mt19937 random(7);
  for (int round = 0; round < 2000; ++round) {
    std::string bytes(random() % 64, '\0');
    for (char& c : bytes) c = static_cast<char>(round % 2 == 0 ? random() : 0x80 + random() % 0x80);
    const size_t limit = random() % 96;
    const std::string clean = CleanText(bytes, limit);
    EXPECT_LE(clean.size(), limit);
    EXPECT_TRUE(IsUtf8(clean));
    EXPECT_EQ(CleanText(clean, limit), clean);
    for (const char c : clean) EXPECT_GE(static_cast<unsigned char>(c), 0x20);
  }
}

TEST(LogText, CannotEndItsFieldOrItsLine) {
  EXPECT_EQ(LogText("plain"), "\"plain\"");
  EXPECT_EQ(LogText("x\" state=finished reason=\""), "\"x\\\" state=finished reason=\\\"\"");
  EXPECT_EQ(LogText("back\\"), "\"back\\\\\"");
  EXPECT_EQ(LogText("a\njob_ended job=7"), "\"a job_ended job=7\"");
  EXPECT_EQ(LogText("\xff"), "\"\xef\xbf\xbd\"");
}

TEST(Normalize, MakesComposedAndDecomposedSpellingsEqual) {
  EXPECT_EQ(Normalize("e\xcc\x81"), "\xc3\xa9");
  EXPECT_EQ(Normalize("\xc3\xa9"), "\xc3\xa9");
  EXPECT_EQ(Normalize("A\xcc\x8a"), Normalize("\xe2\x84\xab"));                  // Angstrom
  EXPECT_EQ(Normalize("\xe1\x84\x92\xe1\x85\xa1\xe1\x86\xab"), "\xed\x95\x9c");  // Hangul
  EXPECT_EQ(Normalize("a\xcc\xa3\xcc\x82"), Normalize("a\xcc\x82\xcc\xa3"));     // order of marks
  EXPECT_NE(Normalize("\xef\xac\x81"), "fi") << "compatibility characters stay";
  EXPECT_EQ(Normalize("plain"), "plain");
  EXPECT_EQ(Normalize("bad\xff"
                      "e\xcc\x81"),
            "bad\xff"
            "e\xcc\x81");
}

}  // namespace
}  // namespace tessera
