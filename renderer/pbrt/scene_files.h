// Opens the files of one scene, and bounds how many and how large they are.
#pragma once

#include <memory>
#include <set>
#include <string>

#include "renderer/description/description_builder.h"
#include "renderer/description/file_source.h"
#include "renderer/pbrt/lexer.h"

namespace tessera {

constexpr int kIncludeDepthMax = 64;      // files within files: deeper is a file within itself
constexpr int kFilesOpenedMax = 1 << 16;  // Include and Import: real scenes have a few hundred
// Bytes of text of all files, each counted as often as it is included: at most kSceneTextSizeMax, and per
// byte of the files as they are stored at most kSceneTextExpansionMax, but kSceneTextFloor in any case.
constexpr uint64_t kSceneTextSizeMax = uint64_t{16} << 30;
constexpr uint64_t kSceneTextExpansionMax = 128;
constexpr uint64_t kSceneTextFloor = uint64_t{1} << 30;

class SceneFiles {
 public:
  // `files` and `builder` must outlive this.
  // `builder` learns the sizes of the files.
  SceneFiles(FileSource& files, DescriptionBuilder& builder)
      : source_(&files), builder_(&builder), top_(builder.top()) {}

  // Opens the top-level file. Returns null after an error, which is in `diagnostics`, as do the other
  // functions.
  std::unique_ptr<Lexer> OpenTop(Diagnostics& diagnostics);
  // Opens the file that directive `statement` at `where` asks for.
  std::unique_ptr<Lexer> Open(const SourceLocation& where, const std::string& statement,
                              const std::string& name, Diagnostics& diagnostics);

 private:
  // The text of a file, unpacked if its name ends in ".gz" or it begins as gzip files do.
  Result<std::string> Read(const std::string& name);
  std::unique_ptr<Lexer> Lex(const SourceLocation& where, const std::string& name, std::string text,
                             Diagnostics& diagnostics);

  FileSource* source_;
  DescriptionBuilder* builder_;
  SourceLocation top_;
  int files_opened_ = 0;
  std::set<std::string> names_;  // of the files read
  uint64_t stored_size_ = 0;     // of these files
  uint64_t text_size_ = 0;
};

}  // namespace tessera
