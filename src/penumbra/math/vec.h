#pragma once

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace penumbra {

// Geometry is double precision; images, colours and texture coordinates are float.
using Vec2d = glm::dvec2;
using Vec3d = glm::dvec3;
using Vec4d = glm::dvec4;
using Vec2f = glm::vec2;
using Vec3f = glm::vec3;
using Vec4f = glm::vec4;
using Mat3d = glm::dmat3;
using Mat4d = glm::dmat4;
using Mat3f = glm::mat3;

using glm::cross;
using glm::dot;
using glm::length;
using glm::normalize;

/// Squared Euclidean length.
[[nodiscard]] inline double length_squared(const Vec3d& v) { return glm::dot(v, v); }

}  // namespace penumbra
