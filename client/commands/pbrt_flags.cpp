#include "client/commands/pbrt_flags.h"

#include <algorithm>
#include <iterator>

namespace tessera {
namespace {

struct PbrtFlag {
  std::string_view flag, hint;
};

constexpr std::string_view kNotNeeded = "is not needed here: it changes how pbrt works, not its picture";
constexpr std::string_view kComparison =
    "is not needed here: \"tessera compare\" measures the error of a picture";
constexpr std::string_view kRewriting = "has no counterpart here: scene files are not rewritten";

// pbrt-v4's src/pbrt/cmd/pbrt.cpp, without the flags that have the same name here.
constexpr PbrtFlag kPbrtFlags[] = {
    {"--cropwindow", "is --crop x0,x1,y0,y1 here"},
    {"--debugstart", "has no counterpart here: errors do not end a render within a pixel"},
    {"--display-server", "is \"tessera watch\" here"},
    {"--format", kRewriting},
    {"--fullscreen", "has no counterpart here"},
    {"--gpu", kNotNeeded},
    {"--gpu-device", kNotNeeded},
    {"--interactive", "has no counterpart here"},
    {"--log-file", "has no counterpart here: messages are written to stderr"},
    {"--log-level", "has no counterpart here: messages are written to stderr"},
    {"--log-utilization", "has no counterpart here"},
    {"--mse-reference-image", kComparison},
    {"--mse-reference-out", kComparison},
    {"--nthreads", "is --threads N here"},
    {"--outfile", "is -o FILE here"},
    {"--pixel", "is --pixelbounds x,x+1,y,y+1 here"},
    {"--pixelmaterial", "is --aov crypto_material here, which names the material in every pixel"},
    {"--pixelstats", kNotNeeded},
    {"--quiet", "has no counterpart here"},
    {"--render-coord-sys", kNotNeeded},
    {"--stats", "is \"tessera info SCENE\" here"},
    {"--toply", kRewriting},
    {"--upgrade", kRewriting},
    {"--wavefront", kNotNeeded},
    {"--write-partial-images", "is \"tessera fetch --preview\" here"},
};

}  // namespace

std::optional<std::string_view> PbrtFlagHint(std::string_view flag) {
  const auto* const found = std::ranges::find(kPbrtFlags, flag, &PbrtFlag::flag);
  return found == std::end(kPbrtFlags) ? std::nullopt : std::optional(found->hint);
}

}  // namespace tessera
