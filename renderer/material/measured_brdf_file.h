// Reads measured BRDFs from the files of RGL (https://rgl.epfl.ch/materials; Dupuy and Jakob 2018).
#pragma once

#include <string_view>

#include "renderer/bxdf/measured_bxdf.h"
#include "renderer/util/result.h"

namespace tessera {

// `bytes` of a tensor file (tensor_file.h) with the arrays theta_i, phi_i, wavelengths, ndf, sigma, vndf,
// luminance, spectra, description and jacobian. Checks that their shapes belong together and their values can
// be interpolated. As in pbrt-v4, anisotropic measurements must cover all azimuths.
Result<MeasuredBrdf> ReadMeasuredBrdf(std::string_view bytes);

}  // namespace tessera
