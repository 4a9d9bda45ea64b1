// What counts where neither the laboratory's description nor a plan says.
#pragma once

namespace gonio::acquisition {

inline constexpr double usual_exposure_s = 0.01;  // of a step
inline constexpr double usual_table_speed_rad_per_s = 0.5, usual_table_acceleration_rad_per_s2 = 1;

}  // namespace gonio::acquisition
