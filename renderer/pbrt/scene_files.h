// Opens the files of one scene, and bounds how many and how large they are.
#pragma once

#include <memory>
#include <string>

#include "renderer/description/diagnostics.h"
#include "renderer/description/file_source.h"
#include "renderer/pbrt/lexer.h"

namespace tessera {

constexpr int kIncludeDepthMax = 64;      // files within files: deeper is a file within itself
constexpr int kFilesOpenedMax = 1 << 16;  // Include and Import: real scenes have a few hundred
// Bytes of all files, each counted as often as it is included.
constexpr uint64_t kSceneTextSizeMax = uint64_t{16} << 30;

class SceneFiles {
 public:
  // `files` must outlive this. `top` is the location of the top-level file.
  SceneFiles(FileSource& files, const SourceLocation& top) : source_(&files), top_(top) {}

  // Opens the top-level file. Returns null after an error, which is in `diagnostics`, as do the other
  // functions.
  std::unique_ptr<Lexer> OpenTop(Diagnostics& diagnostics);
  // Opens the file that directive `statement` at `where` asks for.
  std::unique_ptr<Lexer> Open(const SourceLocation& where, const std::string& statement,
                              const std::string& name, Diagnostics& diagnostics);

 private:
  // The text of a file, unpacked if its name ends in ".gz".
  Result<std::string> Read(const std::string& name);
  std::unique_ptr<Lexer> Lex(const SourceLocation& where, const std::string& name, std::string text,
                             Diagnostics& diagnostics);

  FileSource* source_;
  SourceLocation top_;
  int files_opened_ = 0;
  uint64_t text_size_ = 0;
};

}  // namespace tessera
