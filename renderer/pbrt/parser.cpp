#include "renderer/pbrt/parser.h"

#include "renderer/pbrt/scene_parser.h"

namespace tessera {
namespace {

Result<SceneDescription> Parse(SceneBuilder& builder, std::unique_ptr<Lexer> lexer) {
  if (lexer) {
    SceneParser parser(builder, std::move(lexer));
    if (parser.Run() && builder.Finish()) return std::move(builder.scene());
  }
  return *builder.error();
}

}  // namespace

Result<SceneDescription> ParseScene(FileSource& files, const std::string& name) {
  SceneBuilder builder(files, name);
  return Parse(builder, builder.Open(builder.top(), "", name));
}

Result<SceneDescription> ParseSceneText(FileSource& files, const std::string& name, std::string text) {
  SceneBuilder builder(files, name);
  return Parse(builder, builder.OpenText(name, std::move(text)));
}

}  // namespace tessera
