#include "renderer/shape/shape_builder.h"

#include <fmt/format.h>

#include <utility>

#include "renderer/math/flat_transform.h"
#include "renderer/shape/reach.h"
#include "renderer/shape/shape_kinds.h"

namespace tessera {
namespace {

// Whether what a transform made of the vertices is still in the range of rays.
bool IsWithinReach(const Shape& shape) {
  const auto* const curves = std::get_if<CurveSet>(&shape.form);
  const Bounds3 bounds = curves != nullptr ? curves->HullBounds() : shape.Bounds();
  const Vec3 most = Max(Abs(bounds.min), Abs(bounds.max));
  return most.x <= kCoordinateMax && most.y <= kCoordinateMax && most.z <= kCoordinateMax;
}

// Quadrics and curves are intersected in their own space. Returns whether there were any.
bool RemoveFormsInOwnSpace(std::vector<Form>& forms) {
  return std::erase_if(forms, [](const Form& form) {
           return std::holds_alternative<Quadric>(form) || std::holds_alternative<CurveSet>(form);
         }) > 0;
}

uint8_t ReadHiddenFrom(ParameterReader& reader) {
  uint8_t hidden = 0;
  if (!reader.Bool("visible_camera", true)) hidden |= kHiddenFromCamera;
  if (!reader.Bool("visible_shadow", true)) hidden |= kHiddenFromShadowRays;
  if (!reader.Bool("visible_indirect", true)) hidden |= kHiddenFromIndirect;
  return hidden;
}

}  // namespace

Result<std::vector<Shape>> BuildShape(const ShapeDescription& description, SurfaceProperties surface,
                                      const Transform& render_from_world, FileSource& files,
                                      TextureBuilder& textures, Diagnostics& diagnostics) {
  const Entity& entity = description.entity;
  const Kind<ShapeReader>* kind = ShapeKinds().Find(entity.kind);
  if (kind == nullptr) return ErrorAt(entity.location, ShapeKinds().Refusal(entity.kind));
  const bool is_mesh = kind->reader == ReadTriangleMesh || kind->reader == ReadBilinearMesh;
  if (description.mesh && !is_mesh)
    return ErrorAt(entity.location, fmt::format("shape \"{}\" does not take a mesh", kind->name));
  ParameterReader reader(entity);
  const AnimatedTransform& world_from_object = description.world_from_object;
  const Transform render_from_object = world_from_object.IsAnimated()
                                           ? Transform()
                                           : WithExactInverse(render_from_world * world_from_object.Fixed());
  surface.alpha = textures.Float(reader, "alpha", 1);
  const uint8_t hidden_from = ReadHiddenFrom(reader);
  surface.hidden_from = surface.is_interface ? 0 : hidden_from;
  // The names of mattes and light links, which are not of the shape itself.
  for (const char* name : {"name", "asset"}) reader.FindString(name);
  std::vector<Form> forms = kind->reader({reader,
                                          {render_from_object, description.reverse_orientation},
                                          files,
                                          diagnostics,
                                          textures,
                                          description.mesh.get()});
  if (Result<void> done = reader.Finish(); !done) return done.error();
  std::vector<Shape> shapes;
  if (IsFlat(render_from_object) && RemoveFormsInOwnSpace(forms))
    diagnostics.Warn(entity.location, "the shape is not shown: its transformation has no inverse");
  for (Form& form : forms) {
    Shape shape{surface, std::move(form)};
    if (!IsWithinReach(shape)) {
      return ErrorAt(entity.location,
                     fmt::format("the shape is not within +-{:g} in rendering space", kCoordinateMax));
    }
    shapes.push_back(std::move(shape));
  }
  return shapes;
}

bool MergeCurves(const Shape& curves, Shape* shape) {
  const auto* more = std::get_if<CurveSet>(&curves.form);
  auto* present = std::get_if<CurveSet>(&shape->form);
  if (more == nullptr || present == nullptr || !present->CanTake(*more)) return false;
  if (shape->surface != curves.surface) return false;
  present->Take(*more);
  return true;
}

}  // namespace tessera
