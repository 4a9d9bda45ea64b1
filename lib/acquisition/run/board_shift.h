// How far a camera has moved between two views of a board that does not: the arithmetic of a run's check views.
//
// Both views show the same corners. Their differences, put onto what the lens predicts of the first view, are fitted by
// one change of pose (robot/chain: measured_pose): what the lens model does wrong is in both views alike and cancels to
// first order, as do the corners' own places on the board. Corners' noise is what their detection states, and more
// where the fit's residuals show more (Birge's ratio; Birge, Phys. Rev. 40, 1932). Frames: the board's; metres,
// radians.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "camera/board.h"
#include "camera/board_projection.h"
#include "camera/corner_detection.h"
#include "geom/vector.h"

namespace gonio::acquisition {

struct Moved {  // a vector and its covariance
  Vec3 by;
  Mat3 covariance;
};
struct BoardShift {
  // Of the board's middle before the camera, of the camera's attitude, and of the mean corner in the picture (z is 0).
  // The covariances are of the difference; `own_share` of them is the second view's.
  std::optional<Moved> position_m{}, rotation_rad{};  // where the lens is known
  Moved picture_px;
  double own_share = 0.5;
  double freedom = 0;  // residuals that the noise was judged by
};

inline constexpr std::size_t least_check_corners = 8;
inline constexpr double usual_sigma_px = 0.1;  // of a corner whose detection states none

// Nothing where the views have fewer corners in common. `lens`: of the camera; left out where it is not known.
std::optional<BoardShift> shift_between(std::span<const camera::Corner> before, std::span<const camera::Corner> now,
                                        const camera::Board& board, const std::optional<camera::Intrinsics>& lens);

enum class DriftUnit { metres, radians, pixels };
struct DriftLimit {
  double value = 0;
  DriftUnit unit = DriftUnit::metres;
};
// "0.3mm", "0.1deg", "0.5px"; a bare number is refused. Error(usage) at `place`.
DriftLimit parse_drift_limit(const std::string& text, const std::string& place);
std::string unit_name(DriftUnit unit);  // "m", "rad", "px"

struct DriftVerdict {
  double value = 0, sigma = 0;  // of the change's length, in the limit's unit
  bool beyond = false;          // significantly
};
// Is the change longer than the limit? The smallest (d - x)' C^-1 (d - x) over all changes x within the limit is, where
// the true change is one of them, no larger than Hotelling's statistic of dim(d) and the noise's freedom: it exceeds
// that one's quantile with a probability of at most `level`, whatever the limit and the shape of C.
// Error(data) where the limit is one of pose and the lens is not known.
DriftVerdict judge_drift(const BoardShift& shift, const DriftLimit& limit, double level);

// The standard deviation r of one coordinate over takes of the same view, beyond their own noise: y_k = m + e_k, e_k ~
// N(0, r^2 I + C_k). T(r) = sum (y_k - m(r))' (r^2 I + C_k)^-1 (y_k - m(r)), m(r) the weighted mean, is chi-square
// distributed with 3 (n - 1) degrees, and falls with r: r with T = their number (Paule & Mandel, J. Res. NBS 87, 1982),
// bounds with T at the quantiles of 2.5 and 97.5 % (Viechtbauer, Stat. Med. 26, 2007). Several views share one r.
struct Scatter {
  double sigma = 0, lower = 0, upper = 0;
  double noise = 0;  // of one coordinate, root mean square of the C_k
};
// Nothing where no view was taken twice. Covariances are the takes' own.
std::optional<Scatter> scatter_of(std::span<const std::vector<Moved>> views);

}  // namespace gonio::acquisition
