#include "renderer/pbrt/parser.h"

#include <utility>

#include "renderer/pbrt/scene_parser.h"

namespace tessera {

Result<SceneDescription> ParseScene(FileSource& files, const std::string& name) {
  DescriptionBuilder builder(name);
  SceneFiles scene_files(files, builder);
  if (std::unique_ptr<Lexer> lexer = scene_files.OpenTop(builder.diagnostics()))
    SceneParser(builder, scene_files, std::move(lexer)).Run();
  return builder.Finish();
}

Result<SceneDescription> ParseSceneText(FileSource& files, const std::string& name, std::string text) {
  DescriptionBuilder builder(name);
  SceneFiles scene_files(files, builder);
  builder.CountFile(text.size());
  SceneParser(builder, scene_files, std::make_unique<Lexer>(std::move(text), builder.top().file)).Run();
  return builder.Finish();
}

}  // namespace tessera
