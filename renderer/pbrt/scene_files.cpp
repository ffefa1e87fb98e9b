#include "renderer/pbrt/scene_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "renderer/util/file.h"
#include "renderer/util/text.h"

namespace tessera {

Result<std::string> SceneFiles::Read(const std::string& name) {
  Result<std::string> text = source_->Read(name);
  if (text && names_.insert(name).second) {
    stored_size_ += text->size();
    builder_->CountFile(text->size());
  }
  if (text && (name.ends_with(".gz") || IsGzip(*text))) return Gunzip(*text, name, kSceneFileSizeMax);
  return text;
}

std::unique_ptr<Lexer> SceneFiles::Lex(const SourceLocation& where, const std::string& name, std::string text,
                                       Diagnostics& diagnostics) {
  text_size_ += text.size();
  const uint64_t allowed =
      std::clamp(stored_size_ * kSceneTextExpansionMax, kSceneTextFloor, kSceneTextSizeMax);
  if (text_size_ > allowed) {
    diagnostics.Fail(
        where, fmt::format("the scene's files of {} bytes hold more than {} bytes of text, as often as they "
                           "are included",
                           stored_size_, allowed));
    return nullptr;
  }
  auto file = *top_.file == name ? top_.file : std::make_shared<const std::string>(name);
  return std::make_unique<Lexer>(std::move(text), std::move(file));
}

std::unique_ptr<Lexer> SceneFiles::OpenTop(Diagnostics& diagnostics) {
  Result<std::string> text = Read(*top_.file);
  if (!text) {
    diagnostics.Fail(Error{text.error().kind, OneLine(text.error().message)});
    return nullptr;
  }
  return Lex(top_, *top_.file, *std::move(text), diagnostics);
}

std::unique_ptr<Lexer> SceneFiles::Open(const SourceLocation& where, const std::string& statement,
                                        const std::string& name, Diagnostics& diagnostics) {
  if (++files_opened_ > kFilesOpenedMax) {
    diagnostics.Fail(where, fmt::format("{} opens more than {} files", statement, kFilesOpenedMax));
    return nullptr;
  }
  Result<std::string> text = Read(name);
  if (!text) {
    const std::string message = fmt::format("{} {}: {}", statement, Quoted(name), text.error().message);
    diagnostics.Fail(Error{text.error().kind, ErrorAt(where, message).message});
    return nullptr;
  }
  return Lex(where, name, *std::move(text), diagnostics);
}

}  // namespace tessera
