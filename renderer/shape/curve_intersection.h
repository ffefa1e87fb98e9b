// Ray against a piece of a curve.
#pragma once

#include "renderer/shape/curve_set.h"

namespace tessera {

// The nearest crossing with t in (0, t_max]; `ray` is in the space of the control points. The same root of
// the same polynomials for every piece, so that rays do not slip through between pieces, and in double
// precision with the basic operations only, so that every machine finds the same bits. (Embree's own curves
// are tessellated or round, with other normals than pbrt's, and their bits depend on the processor.)
bool IntersectCurvePiece(const CurveSet& curves, const CurveSet::Piece& piece, const DoubleRay& ray,
                         double t_max, Crossing* crossing);

// The width that a ray of unit direction `d` sees.
double SeenCurveWidth(const CurveSet& curves, uint32_t segment, double u, Double3 d);

}  // namespace tessera
