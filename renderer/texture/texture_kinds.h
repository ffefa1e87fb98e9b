// Makes nodes from the parameters of one Texture directive.
#pragma once

#include "renderer/description/parameter_reader.h"
#include "renderer/texture/texture_assembly.h"
#include "renderer/texture/texture_builder.h"

namespace tessera {

// What a kind needs to read its parameters.
struct TextureKindContext {
  TextureBuilder& builder;    // resolves the textures it refers to
  TextureAssembly& assembly;  // takes its nodes
  ParameterReader& reader;    // remembers errors
  Transform render_from_texture;
};

// The kind is the reader's entity's. After an error the value means nothing.
FloatInput MakeFloatTexture(TextureKindContext& context);
SpectrumInput MakeSpectrumTexture(TextureKindContext& context, SpectrumUse use);

}  // namespace tessera
