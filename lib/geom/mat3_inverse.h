// The inverse of a matrix of three rows and columns.
#pragma once
#include "geom/vector.h"

namespace gonio {

// By the adjugate, whose rows are products of the matrix's own. Not finite where `a` is singular.
constexpr Mat3 inverse(const Mat3& a) {
  const Vec3 p{a.m[0], a.m[1], a.m[2]}, q{a.m[3], a.m[4], a.m[5]}, r{a.m[6], a.m[7], a.m[8]};
  const Vec3 qr = cross(q, r), rp = cross(r, p), pq = cross(p, q);
  const double over = 1 / dot(p, qr);
  return {{qr.x * over, rp.x * over, pq.x * over, qr.y * over, rp.y * over, pq.y * over, qr.z * over, rp.z * over,
           pq.z * over}};
}

}  // namespace gonio
