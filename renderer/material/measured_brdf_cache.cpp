#include "renderer/material/measured_brdf_cache.h"

#include "renderer/material/measured_brdf_file.h"

namespace tessera {
namespace {

constexpr const char* kBrdfKind = "measured BRDF";  // what is kept with files
// Bytes in memory per byte of the file: the tables that are sampled hold their integrals too.
constexpr uint64_t kMemoryPerByte = 3;

Result<std::shared_ptr<const MeasuredBrdf>> LoadBrdf(FileSource& files, const std::string& name) {
  if (auto kept = files.Recall<MeasuredBrdf>(name, kBrdfKind)) return kept;
  const Result<std::string> bytes = files.Read(name);
  if (!bytes) return bytes.error();
  Result<MeasuredBrdf> brdf = ReadMeasuredBrdf(*bytes);
  if (!brdf) return brdf.error();
  auto made = std::make_shared<const MeasuredBrdf>(std::move(*brdf));
  files.Keep(name, kBrdfKind, made, kMemoryPerByte * bytes->size());
  return made;
}

}  // namespace

Result<std::shared_ptr<const MeasuredBrdf>> MeasuredBrdfCache::Get(FileSource& files,
                                                                   const std::string& name) {
  const auto found = brdfs_.find(name);
  if (found != brdfs_.end()) return found->second;
  Result<std::shared_ptr<const MeasuredBrdf>> brdf = LoadBrdf(files, name);
  if (brdf) brdfs_[name] = *brdf;
  return brdf;
}

}  // namespace tessera
