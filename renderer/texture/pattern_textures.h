// The textures that arrange others, or constants, over the surface.
#pragma once

#include "renderer/texture/blend_textures.h"
#include "renderer/texture/patterns.h"

namespace tessera {

struct BilerpTexture {
  int mapping = -1;
  int operand = -1;  // the first of four: at (0,0), (0,1), (1,0), (1,1)

  template <typename Evaluation>
  typename Evaluation::Value Evaluate(const Evaluation& e) const {
    const Point2 st = e.Map2(mapping).st;
    return (1 - st.x) * (1 - st.y) * e.Operand(operand) + (1 - st.x) * st.y * e.Operand(operand + 1) +
           st.x * (1 - st.y) * e.Operand(operand + 2) + st.x * st.y * e.Operand(operand + 3);
  }
};

struct CheckerboardTexture {
  int mapping = -1;
  bool is_solid = false;  // of cubes instead of squares
  int operand = -1;       // the first of two

  template <typename Evaluation>
  typename Evaluation::Value Evaluate(const Evaluation& e) const {
    return Blend(e, operand,
                 is_solid ? CheckerboardWeight(e.Map3(mapping)) : CheckerboardWeight(e.Map2(mapping)));
  }
};

struct DotsTexture {
  int mapping = -1;
  int operand = -1;  // between the dots; the next one is inside them

  template <typename Evaluation>
  typename Evaluation::Value Evaluate(const Evaluation& e) const {
    return e.Operand(operand + (InsideDot(e.Map2(mapping).st) ? 1 : 0));
  }
};

}  // namespace tessera
