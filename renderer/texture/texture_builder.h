// Turns the Texture directives of a scene into a TextureTable, and the texture parameters of materials,
// lights and shapes into inputs.
#pragma once

#include <optional>
#include <string_view>

#include "renderer/color/spectrum_parameter.h"
#include "renderer/description/diagnostics.h"
#include "renderer/description/scene_description.h"
#include "renderer/image/image.h"
#include "renderer/math/transform.h"
#include "renderer/texture/texture.h"

namespace tessera {

class TextureBuilder {
 public:
  // `files`, `images` and `diagnostics`, which takes the warnings, must outlive the builder.
  // `render_from_world` is applied after the transform of each texture.
  TextureBuilder(FileSource& files, ImageCache& images, Diagnostics& diagnostics,
                 const Transform& render_from_world);
  ~TextureBuilder();

  // From now on textures of images are their mean everywhere. For drafts.
  void AverageImages() { averages_images_ = true; }
  bool averages_images() const { return averages_images_; }

  // Adds every texture of a scene, in order. Fails at the first that is invalid, missing or not supported.
  Result<void> Add(const SceneDescription& scene);

  // Reads `float name`, or `texture name` of a float texture, else returns the default. The reader remembers
  // errors.
  FloatInput Float(ParameterReader& reader, std::string_view name, float default_value);
  std::optional<FloatInput> FindFloat(ParameterReader& reader, std::string_view name);
  // The same for `rgb`, `spectrum`, `blackbody` or `texture name` of a spectrum texture.
  SpectrumInput SpectrumOf(ParameterReader& reader, std::string_view name, SpectrumUse use,
                           const Spectrum& default_value);
  std::optional<SpectrumInput> FindSpectrum(ParameterReader& reader, std::string_view name, SpectrumUse use);

  FileSource& files() { return files_; }
  ImageCache& images() { return images_; }
  Diagnostics& diagnostics() { return diagnostics_; }

  // The textures so far, for those who look them up before all is built.
  TextureTable Snapshot() const;
  // Must be called once, last: the builder is empty afterwards.
  TextureTable Finish();

 private:
  struct State;
  FileSource& files_;
  ImageCache& images_;
  Diagnostics& diagnostics_;
  std::unique_ptr<State> state_;
  bool averages_images_ = false;
};

}  // namespace tessera
