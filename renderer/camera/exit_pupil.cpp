#include "renderer/camera/exit_pupil.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

constexpr int kSteps = 64;  // of the distance from the centre of the film
constexpr int kColumns = 48, kRows = 24;
constexpr int kDense = 4;  // as many times more of both where the pupil was not found
// Rays that leave the last interface near its edge cross its plane farther out, the more so the more it is
// curved.
constexpr float kPlaneOverOpening = 1.5f;

// Searches the pupil of one range of places on the film.
class PupilSearch {
 public:
  PupilSearch(const LensSystem& lens, const Aperture& aperture, float film_x0, float film_x1)
      : lens_(lens), aperture_(aperture), film_x_{film_x0, (film_x0 + film_x1) / 2, film_x1} {
    const float reach = kPlaneOverOpening * lens.rear_radius();
    limit_ = {-reach, reach, reach};
  }

  std::optional<PupilBox> Find() const {
    PupilBox region = Start();
    std::optional<PupilBox> found = Scan(region, 1);
    while (found && Touches(*found, region)) {
      region = Grown(region);
      found = Scan(region, 1);
    }
    if (!found) found = Scan(limit_, kDense);
    if (!found) return std::nullopt;
    // The cells of a second scan are smaller, and with them the margin.
    const std::optional<PupilBox> tight = Scan(*found, 1);
    return tight ? tight : found;
  }

 private:
  // About where the pupil is, from the approximation for rays near the axis.
  PupilBox Start() const {
    const std::optional<ParaxialPupil> pupil = lens_.FindParaxialPupil();
    if (!pupil) return limit_;
    constexpr float kRoom = 1.6f;
    const float k = lens_.rear_z() / pupil->z;
    const float centre = film_x_[1] * (1 - k);
    const float radius = kRoom * std::abs(pupil->radius * k) * aperture_.radius();
    return Clipped({centre - radius, centre + radius, radius});
  }

  PupilBox Clipped(PupilBox box) const {
    box = {std::max(box.x0, limit_.x0), std::min(box.x1, limit_.x1), std::min(box.y, limit_.y)};
    return box.x0 < box.x1 && box.y > 0 ? box : limit_;
  }
  PupilBox Grown(const PupilBox& box) const {
    const float half = (box.x1 - box.x0) / 2;
    return Clipped({box.x0 - half, box.x1 + half, box.y * 2});
  }
  // Whether the pupil may go on beyond a side of the region that can still be moved.
  bool Touches(const PupilBox& found, const PupilBox& region) const {
    return (found.x0 <= region.x0 && region.x0 > limit_.x0) ||
           (found.x1 >= region.x1 && region.x1 < limit_.x1) || (found.y >= region.y && region.y < limit_.y);
  }

  // The box around all cells of a grid over `region` through which a ray passes, and one more cell on every
  // side. Lens and bounds are symmetric about the x axis, so half of the grid is enough.
  std::optional<PupilBox> Scan(const PupilBox& region, int density) const {
    const int columns = kColumns * density, rows = kRows * density;
    const float width = (region.x1 - region.x0) / static_cast<float>(columns);
    const float height = region.y / static_cast<float>(rows);
    int first = columns, last = -1, top = -1;
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        if (column >= first && column <= last && row <= top) continue;
        const Point2 p{region.x0 + (static_cast<float>(column) + 0.5f) * width,
                       (static_cast<float>(row) + 0.5f) * height};
        if (!Passes(p)) continue;
        first = std::min(first, column);
        last = std::max(last, column);
        top = std::max(top, row);
      }
    }
    if (last < 0) return std::nullopt;
    return PupilBox{region.x0 + static_cast<float>(first - 1) * width,
                    region.x0 + static_cast<float>(last + 2) * width, static_cast<float>(top + 2) * height};
  }

  bool Passes(Point2 p) const {
    return std::ranges::any_of(film_x_, [&](float x) {
      const Vec3 d = Normalize(Vec3{p.x - x, p.y, lens_.rear_z()});
      return lens_.Trace({x, 0, 0}, d, aperture_).has_value();
    });
  }

  const LensSystem& lens_;
  const Aperture& aperture_;
  float film_x_[3];
  PupilBox limit_;
};

}  // namespace

ExitPupil::ExitPupil(const LensSystem& lens, float aperture_radius, float film_radius)
    : film_radius_(film_radius) {
  const Aperture aperture = Aperture::Wide(aperture_radius);
  for (int i = 0; i < kSteps; ++i) {
    const float step = film_radius / kSteps;
    boxes_.push_back(
        PupilSearch(lens, aperture, static_cast<float>(i) * step, static_cast<float>(i + 1) * step).Find());
  }
}

const std::optional<PupilBox>& ExitPupil::BoxAt(float distance) const {
  const float step = std::min(distance / film_radius_ * kSteps, static_cast<float>(kSteps - 1));
  return boxes_[static_cast<size_t>(step)];
}

std::optional<PupilSample> ExitPupil::Sample(Point2 film, Point2 u) const {
  const float distance = std::sqrt(film.x * film.x + film.y * film.y);
  const std::optional<PupilBox>& box = BoxAt(distance);
  if (!box) return std::nullopt;
  const Point2 p{Lerp(u.x, box->x0, box->x1), Lerp(u.y, -box->y, box->y)};
  // Turned from the x axis to the place on the film.
  const float cosine = distance > 0 ? film.x / distance : 1, sine = distance > 0 ? film.y / distance : 0;
  return PupilSample{{cosine * p.x - sine * p.y, sine * p.x + cosine * p.y}, box->Area()};
}

}  // namespace tessera
