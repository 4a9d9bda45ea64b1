// From codes to points, with the whole lens of cameras and projector: nothing is rectified.
//
// Camera and projector: a point lies on the ray of the camera's pixel, whose place is exact, at the depth z where the
// projector shows the column (and the row) that was decoded; a Newton iteration in z, weighted by the codes' variances.
// Its variance lies along the ray: (dp/dz)^2 over the information of column and row.
// Two cameras: pixels of each that show one pixel of the projector are brought to one place each, its middle
// (code_places.h), and the point is where both rays pass with
// the least distance in pixels from these places (Gauss-Newton on three numbers; Hartley & Sturm 1997). A place's
// variance is what is left of its pixels over their number. What two cameras contradict each other by, across the
// epipolar line, has one degree of freedom and is no part of the point: its median over all points says how true these
// variances are, and where it is larger than they say, all are multiplied by it.
#pragma once
#include <array>
#include <map>
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
  Vec2 pixel;                          // of the first camera
  double reprojection_px = 0;          // root mean square over its pictures
  double sigma_m = 0;                  // the largest standard deviation, in whatever direction
  float reflected = 0;                 // what the projector's white adds there
};

struct Cloud {
  std::vector<ScanPoint> points;
  std::size_t matched = 0;                     // two cameras: pixels of the projector that both saw
  double epipolar_chi_square = 0;              // by medians; 0: not told
  std::map<std::string, std::size_t> refused;  // pixels of the first camera without a point, by reason
};

// `most_px`: points whose pictures lie farther than that from where they were seen are refused ("contradictory").
Cloud points_of_projector(const Codes& codes, const Station& camera, const Station& projector, double most_px = 2);
Cloud points_of_cameras(const Codes& first, const Station& first_camera, const Codes& second,
                        const Station& second_camera, int projector_width_px, double most_px = 2);

}  // namespace gonio::scan
