// The textures that scale or mix others.
//
// A kind of texture is a struct of its settings. Its Evaluate takes either kind of evaluation (texture.cpp),
// which differ in the type of value, float or spectrum, and in how operands and images are read.
#pragma once

#include "renderer/texture/texture_inputs.h"

namespace tessera {

// Operand `first` for weight 0, the one after it for weight 1. An operand without weight is not evaluated.
template <typename Evaluation>
typename Evaluation::Value Blend(const Evaluation& e, int first, float weight) {
  if (weight == 0) return e.Operand(first);
  if (weight == 1) return e.Operand(first + 1);
  return (1 - weight) * e.Operand(first) + weight * e.Operand(first + 1);
}

struct ScaleTexture {
  FloatInput amount;
  int operand = -1;  // index of the first operand

  template <typename Evaluation>
  typename Evaluation::Value Evaluate(const Evaluation& e) const {
    const float factor = e.Float(amount);
    return factor == 0 ? typename Evaluation::Value{} : e.Operand(operand) * factor;
  }
};

struct MixTexture {
  FloatInput amount;  // 0: the first of two operands
  int operand = -1;

  template <typename Evaluation>
  typename Evaluation::Value Evaluate(const Evaluation& e) const {
    return Blend(e, operand, e.Float(amount));
  }
};

// The second of two operands where the normal is perpendicular to the direction.
struct DirectionMixTexture {
  Vec3 direction;  // unit, in rendering space
  int operand = -1;

  template <typename Evaluation>
  typename Evaluation::Value Evaluate(const Evaluation& e) const {
    return Blend(e, operand, 1 - AbsDot(e.context.n, direction));
  }
};

}  // namespace tessera
