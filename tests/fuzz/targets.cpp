#include "tests/fuzz/targets.h"

namespace tessera {
namespace {

constexpr FuzzTarget kTargets[] = {
    {"answer", FuzzAnswer},
    {"bmp", FuzzBmp, PrepareImages},
    {"exr", FuzzExr, PrepareImages},
    {"fact", FuzzFact},
    {"gzip", FuzzGzip},
    {"hdr", FuzzHdr, PrepareImages},
    {"http_request", FuzzHttpRequest},
    {"ies", FuzzIes},
    {"job_message", FuzzJobMessage},
    {"join_token", FuzzJoinToken},
    {"journal", FuzzJournal},
    {"jpeg", FuzzJpeg, PrepareImages},
    {"manifest", FuzzManifest},
    {"measured_brdf", FuzzMeasuredBrdf},
    {"nanovdb", FuzzNanoVdb},
    {"openvdb", FuzzOpenVdb},
    {"pfm", FuzzPfm},
    {"picture", FuzzPicture},
    {"ply", FuzzPly},
    {"png", FuzzPng, PrepareImages},
    {"qoi", FuzzQoi},
    {"radiance_tile", FuzzRadianceTile},
    {"render_options", FuzzRenderOptions},
    {"request", FuzzRequest},
    {"scene_text", FuzzSceneText},
    {"spool", FuzzSpool},
    {"text", FuzzText},
    {"tga", FuzzTga, PrepareImages},
    {"tiff", FuzzTiff, PrepareImages},
    {"web_call", FuzzWebCall},
    {"web_form", FuzzWebForm},
    {"webp", FuzzWebp, PrepareImages},
};

}  // namespace

std::span<const FuzzTarget> FuzzTargets() {
  return kTargets;
}

}  // namespace tessera
