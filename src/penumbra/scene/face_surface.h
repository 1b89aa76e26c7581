#pragma once

#include <cstdint>
#include <string>

namespace penumbra {

/// What a face does in radiative exchange: View3D's kinds of surface (Walton, NISTIR 6925, 2002).
enum class SurfaceKind {
  radiating,    ///< S: exchanges from its front and blocks
  masking,      ///< M: lies on its base, facing it; hides that part of the base and sees nothing else
  null,         ///< N: takes its area out of its base and has no row of its own
  obstruction,  ///< O: blocks and has no row
};

/// A face's part in the surfaces that its author meant, where the format says so (.vs3).
struct FaceSurface {
  static constexpr std::uint32_t no_face = 0xFFFFFFFFU;

  std::string name;
  SurfaceKind kind = SurfaceKind::radiating;
  std::uint32_t base = no_face;           ///< the earlier face of this mesh, in whose plane and within which this one lies
  std::uint32_t combined_with = no_face;  ///< the earlier face of this mesh, with which this one makes one surface
};

}  // namespace penumbra
