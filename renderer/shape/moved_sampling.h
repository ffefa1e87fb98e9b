// Points on emitting shapes that lie in a space of their own, such as one that moves: as shape_sampling.h, in
// rendering space.
#pragma once

#include "renderer/shape/shape_sampling.h"

namespace tessera {

// A reference point in the space that `space_from_render` leads to.
ReferencePoint MoveReference(const Transform& render_from_space, const ReferencePoint& reference);

// The factor from a density over directions in a space to one in rendering space, along unit `wi` there.
float SolidAngleRatio(const Transform& render_from_space, Vec3 wi);

// SampleShape and ShapePdf of a shape whose space `render_from_shape` leaves; it must have an inverse.
std::optional<ShapeSample> SampleMovedShape(const Shape& shape, uint32_t primitive,
                                            const Transform& render_from_shape,
                                            const ReferencePoint& reference, Point2 u);
float MovedShapePdf(const Shape& shape, uint32_t primitive, const Transform& render_from_shape,
                    const ReferencePoint& reference, Vec3 wi, const SurfaceInteraction& on_light);

// The area of a primitive in rendering space. Returns nullopt if it depends on the place, as that of a
// stretched sphere.
std::optional<float> MovedShapeArea(const Shape& shape, uint32_t primitive,
                                    const Transform& render_from_shape);

}  // namespace tessera
