// Collects what all the files of one scene define: the description, the names in use, the first error, the
// warnings, and how much has been described so far.
#pragma once

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "renderer/description/file_source.h"
#include "renderer/description/scene_description.h"
#include "renderer/pbrt/lexer.h"

namespace tessera {

constexpr int kIncludeDepthMax = 64;      // files within files: deeper is a file within itself
constexpr int kFilesOpenedMax = 1 << 16;  // Include and Import: real scenes have a few hundred
constexpr uint64_t kSceneTextSizeMax = uint64_t{16}
                                       << 30;  // bytes of all files as often as they are included
constexpr uint64_t kDescriptionSizeMax = uint64_t{64}
                                         << 30;         // bytes in memory, about: a cap on small text that
                                                        // describes much, such as defaults copied to shapes
constexpr uint64_t kCopiedSizeMax = uint64_t{4} << 30;  // bytes of defaults and area lights copied to shapes
constexpr uint64_t kDefaultsSizeMax =
    1 << 16;                             // bytes of the Attribute defaults of one target: real ones are few
constexpr size_t kNameLengthMax = 4096;  // bytes of the name of a material, medium, kind, ...
constexpr size_t kStateDepthMax = 1 << 16;  // open AttributeBegin: real scenes stay below 20

class SceneBuilder {
 public:
  SceneBuilder(FileSource& files, const std::string& name);

  SceneDescription& scene() { return scene_; }
  const std::optional<Error>& error() const { return scene_.diagnostics.error(); }
  const SourceLocation& top() const { return top_; }  // the first byte of the top-level file

  // Remembers the first error. Always false, to be returned.
  bool Fail(const SourceLocation& where, const std::string& message);
  void Warn(const SourceLocation& where, const std::string& message);
  // Like Warn, but only the first time for the same `topic`.
  void WarnOnce(const std::string& topic, const SourceLocation& where, const std::string& message);

  // Opens a scene file, unpacked if its name ends in ".gz". `statement` says which directive asks for it,
  // empty for the top-level file. Null after an error.
  std::unique_ptr<Lexer> Open(const SourceLocation& where, const std::string& statement,
                              const std::string& name);
  // The same for text that is already in memory.
  std::unique_ptr<Lexer> OpenText(const std::string& name, std::string text);

  // Accounts for something of `size` bytes; an error when that is too much.
  bool Charge(const SourceLocation& where, uint64_t size);
  bool Charge(const Entity& entity);
  // The same for something of which a copy is made.
  bool ChargeCopy(const SourceLocation& where, uint64_t size);

  // Each takes a name once and fails at the second definition.
  bool DefineMaterial(MaterialDescription material);
  bool DefineMedium(MediumDescription medium);
  bool DefineTexture(TextureDescription texture);
  bool DefineObject(ObjectDescription object);

  // Resolves names that may be used before they are defined, and checks that all names used are defined.
  bool Finish();

 private:
  bool ResolveMaterial(ShapeDescription& shape);
  bool FinishShape(ShapeDescription& shape);
  bool CheckMedium(const SourceLocation& where, const std::string& name);
  bool CheckInstances();

  FileSource* files_;
  SourceLocation top_;
  SceneDescription scene_;
  std::map<std::string, SourceLocation> media_, objects_;
  std::map<std::pair<bool, std::string>, SourceLocation> textures_;  // by (is spectrum, name)
  int files_opened_ = 0;
  uint64_t text_size_ = 0;
  uint64_t description_size_ = 0;
  uint64_t copied_size_ = 0;
};

// Size in memory, about.
uint64_t SizeOf(const Entity& entity);
uint64_t SizeOf(const Parameter& parameter);
uint64_t SizeOf(const std::vector<Parameter>& parameters);

}  // namespace tessera
