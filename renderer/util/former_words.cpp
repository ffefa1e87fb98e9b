#include "renderer/util/former_words.h"

#include <algorithm>

namespace tessera {
namespace {

struct FormerWord {
  std::string_view word, successor;
};

// What `pbrt --upgrade` rewrites where one word has replaced another. Of several successors, the first that
// is a candidate counts.
constexpr FormerWord kFormerWords[] = {
    // Kinds
    {"matte", "diffuse"},
    {"plastic", "coateddiffuse"},
    {"substrate", "coateddiffuse"},
    {"uber", "coateddiffuse"},
    {"glass", "dielectric"},
    {"metal", "conductor"},
    {"mirror", "conductor"},
    {"translucent", "diffusetransmission"},
    {"kdsubsurface", "subsurface"},
    {"disney", "diffuse"},
    {"fourier", "measured"},
    {"environment", "spherical"},
    {"image", "rgb"},
    {"lowdiscrepancy", "paddedsobol"},
    {"02sequence", "paddedsobol"},
    {"maxmindist", "pmj02bn"},
    {"random", "independent"},
    {"directlighting", "path"},
    {"whitted", "path"},
    {"area", "diffuse"},
    {"heightfield", "plymesh"},
    {"nurbs", "bilinearmesh"},
    {"heterogeneous", "uniformgrid"},
    // Parameters
    {"mapname", "filename"},
    {"Kd", "reflectance"},
    {"Kr", "reflectance"},
    {"Kt", "transmittance"},
    {"bumpmap", "displacement"},
    {"index", "eta"},
    {"namedmaterial1", "materials"},
    {"namedmaterial2", "materials"},
    {"xwidth", "xradius"},
    {"ywidth", "yradius"},
    {"maxsampleluminance", "maxcomponentvalue"},
    {"trilinear", "filter"},
    {"gamma", "encoding"},
    {"st", "uv"},
    {"nlevels", "levels"},
    {"tex1", "tex"},
    {"tex2", "scale"},
    {"shadowalpha", "alpha"},
    {"strategy", "lightsampler"},
    {"lightsamplestrategy", "lightsampler"},
    // Type words
    {"color", "rgb"},
    {"color", "spectrum"},
    {"xyz", "rgb"},
    {"point", "point3"},
    {"vector", "vector3"},
    {"normal3", "normal"},
    // Directives
    {"Renderer", "Integrator"},
    {"SurfaceIntegrator", "Integrator"},
    {"VolumeIntegrator", "Integrator"},
    {"Volume", "MakeNamedMedium"},
    {"Filter", "PixelFilter"},
};

}  // namespace

std::string_view SuccessorOf(std::string_view word, std::span<const std::string_view> candidates) {
  for (const FormerWord& former : kFormerWords) {
    if (former.word != word) continue;
    if (std::ranges::find(candidates, former.successor) != candidates.end()) return former.successor;
  }
  return {};
}

}  // namespace tessera
