// Makes nodes from the parameters of one Texture directive.
#pragma once

#include "renderer/description/kind_table.h"
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

// Makes the texture of the kind that the entity of the reader names. After an error the value has no meaning.
FloatInput MakeFloatTexture(TextureKindContext& context);
SpectrumInput MakeSpectrumTexture(TextureKindContext& context, SpectrumUse use);

// What scenes may ask for.
KindList FloatTextureKinds();
KindList SpectrumTextureKinds();

}  // namespace tessera
