// How far what the camera sees moves over the picture.
#pragma once

#include "renderer/integrator/world.h"

namespace tessera {

// From where the point of a hit is on the film at the start of `times` to where it is at their end, in pixels
// to the right and down. `film`: where the ray that found it left the film, in pixels. Where the
// camera cannot see the point at one of the two times, that end is where the ray left the film.
Vec2 ScreenMotion(const World& world, const Hit& hit, const SurfaceInteraction& interaction, Point2 film,
                  const TimeRange& times);
// The same of what is infinitely far away and rests, where the ray that left `film` at `time_s` leads.
Vec2 ScreenMotionOfSky(const Camera& camera, Point2 film, float time_s, const TimeRange& times);

}  // namespace tessera
