// Functions that read foreign bytes: what libFuzzer calls (driver.cpp, tests/fuzz/run) and a test over the
// files in tests/fuzz/corpus. Each takes any bytes, checks what must hold of what it read, and returns
// whether the bytes were accepted.
#pragma once

#include <span>
#include <string_view>

namespace tessera {

struct FuzzTarget {
  const char* name;  // also that of its folder in the corpus and of its dictionary, NAME.dict
  bool (*read)(std::string_view bytes);
  // Called once before, so that the time it takes is not that of the first input. May be null.
  void (*prepare)() = nullptr;
};

std::span<const FuzzTarget> FuzzTargets();

// Loads the library of picture formats.
void PrepareImages();

bool FuzzAnswer(std::string_view bytes);
bool FuzzBmp(std::string_view bytes);
bool FuzzExr(std::string_view bytes);
bool FuzzFact(std::string_view bytes);
bool FuzzGzip(std::string_view bytes);
bool FuzzHdr(std::string_view bytes);
bool FuzzHttpRequest(std::string_view bytes);
bool FuzzIes(std::string_view bytes);
bool FuzzJobMessage(std::string_view bytes);
bool FuzzJoinToken(std::string_view bytes);
bool FuzzJournal(std::string_view bytes);
bool FuzzJpeg(std::string_view bytes);
bool FuzzManifest(std::string_view bytes);
bool FuzzMeasuredBrdf(std::string_view bytes);
bool FuzzNanoVdb(std::string_view bytes);
bool FuzzOpenVdb(std::string_view bytes);
bool FuzzPfm(std::string_view bytes);
bool FuzzPicture(std::string_view bytes);
bool FuzzPly(std::string_view bytes);
bool FuzzPng(std::string_view bytes);
bool FuzzQoi(std::string_view bytes);
bool FuzzRadianceTile(std::string_view bytes);
bool FuzzRenderOptions(std::string_view bytes);
bool FuzzRequest(std::string_view bytes);
bool FuzzSceneText(std::string_view bytes);
bool FuzzSpool(std::string_view bytes);
bool FuzzText(std::string_view bytes);
bool FuzzTga(std::string_view bytes);
bool FuzzTiff(std::string_view bytes);
bool FuzzWebCall(std::string_view bytes);
bool FuzzWebForm(std::string_view bytes);
bool FuzzWebp(std::string_view bytes);

}  // namespace tessera
