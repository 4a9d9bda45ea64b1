// From codes to points, with the whole lens of cameras and projector: nothing is rectified.
//
// Camera and projector: a point lies on the ray of the camera's pixel, whose place is exact, at the depth z where the
// projector shows the column (and the row) that was decoded; a Newton iteration in z, weighted by the codes' variances.
// Its variance lies along the ray: (dp/dz)^2 over the information of column and row.
// Several cameras, and the projector beside them where it is calibrated: pixels of each camera that show one pixel of
// the projector are brought to one place each, its middle (code_places.h), and the point is where the rays of those
// that see it pass with the least distance in pixels from these places (Gauss-Newton on three numbers; Hartley & Sturm
// 1997). A place's variance is what is left of its pixels over their number; the projector's own pixel is exact. What
// devices contradict each other by, of two cameras across the epipolar line, has 2 n - 3 degrees of freedom and is no
// part of the point: its median over all points says how true these variances are, and where it is larger than they
// say, all are multiplied by it.
//
// One pixel of the projector lights one place. Where pixels of a camera that tell the same one lie apart, those are
// kept whose neighbours tell its neighbours, if they are clearly more; the others are ambiguous. So what the left
// camera finds in the right one is found back.
#pragma once
#include <array>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "camera/camera_model.h"
#include "geom/rigid.h"
#include "scan/decode.h"

namespace gonio::scan {

struct Station {  // a camera or a projector of a rig
  camera::CameraModel lens;
  Rigid<frame::Rig, frame::Camera> rig_from_camera;
};

struct ScanPoint {
  Vec3 position_m;                     // rig frame
  std::array<double, 6> covariance{};  // xx, xy, xz, yy, yz, zz, m^2
  Vec2 pixel;                          // of the first camera that saw it
  double reprojection_px = 0;          // root mean square over its pictures
  float across_px = 0;                 // the same with a sign, of two pictures; 0: nothing could contradict
  std::uint8_t camera = 0;             // whose `pixel` it is, the first that saw it
  double sigma_m = 0;                  // the largest standard deviation, in whatever direction
  float reflected = 0;                 // what the projector's white adds there
};

struct Cloud {
  std::vector<ScanPoint> points;
  std::vector<std::array<float, 3>> colours;   // of each point, linear; or empty
  std::size_t matched = 0;                     // pixels of the projector that two devices and more know of
  double epipolar_chi_square = 0;              // by medians; 0: not told
  std::map<std::string, std::size_t> refused;  // pixels of the first camera without a point, by reason
};

// `most_px`: points whose pictures lie farther than that from where they were seen are refused ("contradictory").
Cloud points_of_projector(const Codes& codes, const Station& camera, const Station& projector, double most_px = 2);
struct Look {
  const Codes* codes = nullptr;
  Station camera;
};
inline constexpr std::size_t most_devices = 8;
// Two cameras and more, or one with the projector. Refused are pixels of the first. Error(usage) for more devices.
Cloud points_of_rig(std::span<const Look> cameras, const Station* projector, int projector_width_px,
                    double most_px = 2);
Cloud points_of_cameras(const Codes& first, const Station& first_camera, const Codes& second,
                        const Station& second_camera, int projector_width_px, double most_px = 2);

}  // namespace gonio::scan
