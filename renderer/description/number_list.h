// Side files of scenes that are lists of numbers: spectra and lenses.
#pragma once

#include <string>
#include <vector>

#include "renderer/util/result.h"

namespace tessera {

// Reads numbers that are separated by white space; "#" starts a comment that ends with the line. The error
// names the line of the first word that is not a number.
Result<std::vector<float>> ParseNumberList(const std::string& text);

}  // namespace tessera
