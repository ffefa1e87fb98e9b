// Collects what a reader finds in the files of one scene, whatever language they are written in: checks that
// names are defined once and used only if they are defined, and bounds how much is described.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>

#include "renderer/description/scene_description.h"
#include "renderer/util/result.h"

namespace tessera {

// Bytes in memory, roughly: bounds for small files that describe much, such as compressed ones, files
// included many times and defaults copied to shapes. Whatever the files, at most kDescriptionSizeMax; per
// byte of them at most kDescriptionExpansionMax, but kDescriptionFloor in any case.
constexpr uint64_t kDescriptionSizeMax = uint64_t{64} << 30;
constexpr uint64_t kDescriptionExpansionMax = 200;
constexpr uint64_t kDescriptionFloor = uint64_t{512} << 20;
// Bytes of defaults that are copied to entities.
constexpr uint64_t kCopiedSizeMax = uint64_t{4} << 30;
// Bytes of the name of a material, medium, kind or parameter.
constexpr size_t kNameLengthMax = 4096;

// Errors and warnings go to the diagnostics of the scene, of which the first error is kept. Functions that
// return bool return false after an error.
class DescriptionBuilder {
 public:
  // `name` is that of the top-level file. The scene starts with defaults for what a file need not name.
  explicit DescriptionBuilder(const std::string& name);

  SceneDescription& scene() { return scene_; }
  Diagnostics& diagnostics() { return scene_.diagnostics; }
  const SourceLocation& top() const { return top_; }  // the first byte of the top-level file
  // Shorthand for diagnostics().Fail: always false.
  bool Fail(const SourceLocation& where, const std::string& message);

  // Counts `size` bytes of a file that describes the scene, as it is stored.
  void CountFile(uint64_t size) { files_size_ += size; }
  // Counts `size` bytes of what is described at `where`; fails beyond what the files counted so far allow.
  bool Charge(const SourceLocation& where, uint64_t size);
  bool Charge(const Entity& entity);
  // The same for bytes that are copied; fails beyond kCopiedSizeMax, too.
  bool ChargeCopy(const SourceLocation& where, uint64_t size);

  // Each fails if its name was defined before. Readers charge entities themselves, before they copy defaults
  // to them.
  bool AddMaterial(MaterialDescription material);
  bool AddMedium(MediumDescription medium);
  bool AddTexture(TextureDescription texture);
  bool AddObject(ObjectDescription object);
  bool AddLight(LightDescription light);
  bool AddInstance(InstanceDescription instance);
  // Adds a shape to an object, given by its index, or to the world.
  bool AddShape(ShapeDescription shape, std::optional<size_t> object);

  // Resolves names, which may be used before they are defined. Returns the first error if there was one. The
  // builder must not be used afterwards.
  Result<SceneDescription> Finish();

 private:
  bool FinishShapes(std::vector<ShapeDescription>& shapes);
  bool ResolveMaterial(ShapeDescription& shape);
  bool CheckMedium(const SourceLocation& where, const std::string& name);
  bool CheckInstances();
  bool ResolveNames();

  SourceLocation top_;
  SceneDescription scene_;
  std::map<std::string, SourceLocation> media_, objects_;
  std::map<std::pair<bool, std::string>, SourceLocation> textures_;  // by (is spectrum, name)
  uint64_t files_size_ = 0;
  uint64_t description_size_ = 0;
  uint64_t copied_size_ = 0;
};

// Size in memory, roughly.
uint64_t SizeOf(const Entity& entity);
uint64_t SizeOf(const Parameter& parameter);
uint64_t SizeOf(const std::vector<Parameter>& parameters);

}  // namespace tessera
