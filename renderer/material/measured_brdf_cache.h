// The measured BRDFs of a scene, each read once however many materials name its file.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "renderer/bxdf/measured_bxdf.h"
#include "renderer/description/file_source.h"

namespace tessera {

// For one thread.
class MeasuredBrdfCache {
 public:
  // The BRDF of a file (measured_brdf_file.h), also kept with `files` for the other frames of a sequence.
  Result<std::shared_ptr<const MeasuredBrdf>> Get(FileSource& files, const std::string& name);

 private:
  std::map<std::string, std::shared_ptr<const MeasuredBrdf>> brdfs_;
};

}  // namespace tessera
