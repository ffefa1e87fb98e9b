#include "renderer/integrator/plain_surfaces.h"

namespace tessera {

const PlainSurfaces::Surface PlainSurfaces::kOther;

PlainSurfaces::PlainSurfaces(const World& world) {
  for (const Shape& shape : world.geometry.shapes) {
    const SurfaceProperties& surface = shape.surface;
    const auto* const mesh = std::get_if<TriangleMesh>(&shape.form);
    const Spectrum* const reflectance = world.materials.MatteReflectance(surface.material);
    const bool is_plain = mesh != nullptr && reflectance != nullptr && surface.area_light < 0 &&
                          surface.hidden_from == 0 && !surface.is_interface;
    any_ |= is_plain;
    surfaces_.emplace_back();
    if (!is_plain) continue;
    const bool has_normals = !mesh->N.empty();
    surfaces_.back() = {reflectance,          mesh->P.data(), (has_normals ? mesh->N : mesh->P).data(),
                        mesh->indices.data(), has_normals,    mesh->flip_normals};
  }
  any_ &= !world.links.any();
}

}  // namespace tessera
