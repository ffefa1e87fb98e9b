// A spectrum at the four wavelengths of one path.
#pragma once

#include "renderer/math/float4.h"

namespace tessera {

// Values at SampledWavelengths::lambda. Radiance, reflectance, throughput or density, as the name of the
// variable says.
using SampledSpectrum = Float4;

}  // namespace tessera
