#include "renderer/medium/nanovdb_medium.h"

#include <fmt/format.h>

#include "renderer/math/flat_transform.h"
#include "renderer/medium/medium_parameters.h"
#include "renderer/medium/openvdb_file.h"

namespace tessera {
namespace {

// What is read of a file, for all media and frames that use it.
struct VdbContents {
  std::shared_ptr<const VdbGrid> density, temperature;  // temperature may be null
  MajorantGrid density_max;
};

Result<std::shared_ptr<const VdbContents>> ReadContents(FileSource& files, const std::string& file,
                                                        const std::string& density_name,
                                                        const std::string& temperature_name) {
  const std::string what = fmt::format("nanovdb \"{}\" \"{}\"", density_name, temperature_name);
  if (auto kept = files.Recall<VdbContents>(file, what)) return kept;
  const Result<std::string> bytes = files.Read(file);
  if (!bytes) return bytes.error();
  const auto read_grid = IsOpenVdb(*bytes) ? ReadOpenVdb : ReadNanoVdb;
  auto density = read_grid(*bytes, file, density_name, std::nullopt, false);
  if (!density) return density.error();
  if (!*density) return BadInput(fmt::format("{}: there is no grid \"{}\"", file, density_name));
  auto temperature = read_grid(*bytes, file, temperature_name, (*density)->box, true);
  if (!temperature) return temperature.error();
  if (*temperature && !((*temperature)->world_from_index == (*density)->world_from_index)) {
    return BadInput(fmt::format("{}: the grids \"{}\" and \"{}\" do not have the same voxels", file,
                                density_name, temperature_name));
  }
  auto contents = std::make_shared<VdbContents>();
  contents->density = *density;
  contents->temperature = *temperature;
  contents->density_max = MajorantsOf((*density)->voxels, [](float value) { return value; });
  const uint64_t size =
      contents->density->voxels.Bytes() + (contents->temperature ? contents->temperature->voxels.Bytes() : 0);
  files.Keep<VdbContents>(file, what, contents, size);
  return std::shared_ptr<const VdbContents>(std::move(contents));
}

// Maps the voxels of the density to render space.
GridPlacement PlacementOf(const VdbGrid& grid, const Transform& render_from_medium) {
  Vec3 first;
  Bounds3 box{{1, 1, 1}, {}};
  const GridSize size = grid.box.Size();
  for (int i = 0; i < 3; ++i) {
    first[i] = static_cast<float>(grid.box.min[i]);
    box.max[i] = static_cast<float>(size[i] + 1);
  }
  const Transform position_from_index = Translate(Vec3{1, 1, 1} - first);
  return {position_from_index * grid.world_from_index.Inverse() * render_from_medium.Inverse(), box};
}

}  // namespace

NanoVdbMedium NanoVdbMedium::Read(ParameterReader& reader, const Transform& render_from_medium,
                                  FileSource& files, Diagnostics& /*diagnostics*/) {
  auto grid = std::make_shared<GridContents>();
  const std::string file = reader.String("filename", "");
  const std::string density = reader.String("gridname", "density");
  const std::string temperature = reader.String("temperaturename", "temperature");
  grid->radiance_factor = ReadFactor(reader, "Lescale");
  grid->temperature_scale = TemperatureScale::Read(reader);
  if (file.empty()) reader.Fail("nanovdb needs a filename");
  if (IsFlat(render_from_medium)) reader.Fail("the transformation of the medium has no inverse");
  if (!reader.failed()) {
    const auto contents = ReadContents(files, file, density, temperature);
    if (contents) {
      const std::shared_ptr<const VdbContents>& read = *contents;
      grid->density = {read->density, &read->density->voxels};
      if (read->temperature) grid->temperature = {read->temperature, &read->temperature->voxels};
      grid->density_max = read->density_max;
      grid->placement = PlacementOf(*read->density, render_from_medium);
      grid->is_emissive = grid->temperature != nullptr && grid->radiance_factor > 0;
    } else {
      reader.FailAt("filename", contents.error().message);
    }
  }
  ReadGridCoefficients(reader, files, *grid);
  NanoVdbMedium medium;
  medium.phase_ = PhaseFunction(ReadAsymmetry(reader));
  medium.grid_ = std::move(grid);
  return medium;
}

}  // namespace tessera
