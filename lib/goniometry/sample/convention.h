// Where a table has its mirror direction. Most count azimuths of light and eye from the same axis, so that light from
// phi_i is mirrored to phi_i + pi; some turn the eye's azimuth by half a circle, so that the mirror direction has
// phi_o = phi_i. Nothing in a file says which. The samples do, where the surface has a lobe: rows within 20 degrees of
// the one direction are brighter than rows within 20 degrees of the other, incidence by incidence.
//
// A surface that throws more light back than forward (a retro-reflector) looks like one with the other convention:
// nobody can tell these two from the numbers, and --mirror says it. Matte surfaces and scans at normal incidence have
// no such difference.
#pragma once
#include <cstddef>
#include <string>

#include "goniometry/samples.h"

namespace gonio::goniometry {

enum class Mirror { automatic, opposite, same };  // automatic: from the data; phi_o = phi_i + pi; phi_o = phi_i

struct Convention {
  Mirror mirror = Mirror::opposite;  // of the file; samples are always turned to `opposite`
  enum class From { data, user, format, indifferent } from = From::data;  // indifferent: light from the normal alone
  double brightness_ratio = 0;  // phi_i + pi over phi_i, median over incidences; 0: no incidence has both sides
  std::size_t incidences = 0;   // that have both sides
  bool contradicted = false;    // the data say otherwise than the user or the format
  std::string sentence;         // "mirror direction at phi_o = phi_i + 180 deg: 8.1 times as bright as ..."
};

// How samples look that were read as `opposite`. Error(data) at `place` where `wanted` is automatic, `preset` (what the
// format says) is automatic too, and the data do not tell.
Convention find_convention(const Samples& samples, Mirror wanted, Mirror preset, const std::string& place);

// The eye's azimuths turned by half a circle.
void turn_exitance(Samples& samples);

}  // namespace gonio::goniometry
