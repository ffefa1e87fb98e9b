// Makes a scene of its description, for Scene::Build.
#pragma once

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "renderer/image/image.h"
#include "renderer/scene/film_settings.h"
#include "renderer/scene/integrator_choice.h"
#include "renderer/scene/scene_data.h"
#include "renderer/scene/scene_options.h"
#include "renderer/scene/world_builder.h"

namespace tessera {

// Builds a scene from its description step by step; each step uses what the ones before it made.
class SceneBuilder {
 public:
  SceneBuilder(SceneDescription description, FileSource& files, const RenderOptions& options)
      : options_(options), scene_(std::move(description)), files_(files, scene_.embedded_files) {}

  // `name` is that of the scene file.
  Result<std::unique_ptr<Scene::Data>> Build(const std::string& name, Scene::Depth depth);

 private:
  Result<void> SettleMotion(const std::string& name);
  Result<void> ReadSettings(const std::string& name);
  Result<void> ReadCamera(const FilmSettings& film);
  Result<void> ReadSampling(const FilmSettings& film, const SceneOptions& scene_options);
  void SetEstimator(const IntegratorChoice& integrator, const SceneOptions& scene_options);
  Result<void> BuildLitWorld(const IntegratorChoice& integrator, const std::string& name);
  Result<void> DescribeFrame(const FilmSettings& film, const IntegratorChoice& integrator);
  Result<std::vector<EmittingShape>> BuildNamedWorld(const IntegratorChoice& integrator,
                                                     const std::string& name);
  void LimitTileSize();
  void WarnOfEmptyLayers(const std::set<std::string>& layers, const IntegratorChoice& integrator,
                         bool counts_levels);
  Result<void> BuildAccelerator();
  void SurveyAccelerators();
  Result<void> CheckLights(const std::string& name);

  const RenderOptions& options_;
  SceneDescription scene_;
  SceneFileSource files_;
  ImageCache images_{files_};
  const Kind<AcceleratorMaker>* accelerator_ = nullptr;
  bool moves_ = false;      // whether anything does while the shutter is open
  bool wavefront_ = false;  // the scene asks for pbrt's wavefront renderer
  std::unique_ptr<Scene::Data> data_ = std::make_unique<Scene::Data>();
};

}  // namespace tessera
