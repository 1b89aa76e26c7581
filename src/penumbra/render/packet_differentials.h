#pragma once

#include "penumbra/render/packet_shading.h"

namespace penumbra {

/// RayDifferential (tracing/ray_differential.h) of sixteen rays, in single precision.
struct alignas(64) DifferentialLanes {
  VectorLanes origin_x, origin_y, direction_x, direction_y;
};

/// Two steps for each of sixteen samples: over the surface, to where the neighbours' rays meet it, m; or of what
/// changes along those.
struct alignas(64) FootprintLanes {
  VectorLanes x, y;
};

/// Of rays of a perspective camera. @param spacing of the samples, pixels.
void aim_differentials(const RasterDirections& camera, float spacing, const RayPacket& rays,
                       DifferentialLanes& differentials);

/// footprint_of, lane by lane.
void find_footprints(const RayPacket& rays, const DifferentialLanes& differentials, const PointLanes& points,
                     FootprintLanes& footprints);

/// How the normal towards the eye changes over the footprint of a surface that is flat or a sphere.
/// @param curvature 1/m, of the front's normal; 0 of flat ones.
void bend_normals(const PointLanes& points, const Lanes& curvature, const FootprintLanes& footprints,
                  FootprintLanes& changes);

/// `reflected` and `refracted`, lane by lane. @param changes of the normal towards the eye.
void reflect_differentials(const RayPacket& rays, const PointLanes& points, const DifferentialLanes& differentials,
                           const FootprintLanes& footprints, const FootprintLanes& changes,
                           DifferentialLanes& reflected);
/// @param beyond the refracted rays. @param ior of the solid behind the front.
void refract_differentials(const RayPacket& rays, const PointLanes& points, const DifferentialLanes& differentials,
                           const FootprintLanes& footprints, const FootprintLanes& changes, const BounceLanes& beyond,
                           const Lanes& ior, DifferentialLanes& refracted);

/// second_colour_share (tracing/shading/checker.h) over footprints, lane by lane.
/// @param inverse_size of the squares, 1/m.
void average_checkers(const PointLanes& points, const Lanes& inverse_size, const FootprintLanes& footprints,
                      Lanes& shares);

}  // namespace penumbra
