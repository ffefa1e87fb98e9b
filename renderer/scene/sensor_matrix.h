// The colours that a camera sees, as a standard observer would see them.
#pragma once

#include <array>

#include "renderer/color/spectrum.h"
#include "renderer/math/matrix3.h"

namespace tessera {

// The matrix that maps what the sensor sees of the patches of a ColorChecker chart under `illuminant` as
// nearly as possible (least squares) to their XYZ under `output_illuminant`: white balance included. A white
// surface keeps the luminance that it has under `illuminant` (Langlands and Fascione 2020, PhysLight; Pharr,
// Jakob, Humphreys 2023, section 5.4.2).
Matrix3 XyzFromSensor(const std::array<const DenseTable*, 3>& responses, const DenseTable& illuminant,
                      const DenseTable& output_illuminant);

}  // namespace tessera
