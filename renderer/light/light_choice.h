// Ways to choose one light of many, and the outcome of a choice.
#pragma once

#include "renderer/description/kind_table.h"

namespace tessera {

enum class LightSamplerKind {
  kUniform,  // all lights alike
  kPower,
  kTree,  // by what arrives at the point: LightTree
};

// The light samplers that an Integrator may name.
KindTable<LightSamplerKind> LightSamplers();

struct ChosenLight {
  int light = 0;  // index into the LightTable
  float pmf = 0;
};

}  // namespace tessera
