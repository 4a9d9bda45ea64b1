// Tracks out of photographs: points are chosen where a picture has corners (Shi & Tomasi 1994) and followed from
// picture to picture (tracker.h); where it is known what really deformed there, also the truth of those very points.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "manifest/sections/forward.h"
#include "nrsfm/make/pictures.h"

namespace gonio::nrsfm {

struct FollowOptions {
  Eigen::Index points = 100;  // are followed at once; lost ones are replaced
  Eigen::Index every = 1;     // of the pictures one makes a frame; all are followed through
};

struct FollowedPoints {
  Tracks tracks_px;                // 2F x P, places from the upper left corner, the first pixel's centre at 0.5
  Eigen::MatrixXd sigma_px;        // F x P
  std::vector<Eigen::Index> born;  // of each point: the frame in which it was chosen
};
// Of pictures 0 to count - 1. A new point keeps a tracker's patch away from those that are followed already.
FollowedPoints follow(std::size_t count, const std::function<GreyPicture(std::size_t)>& picture,
                      const FollowOptions& options);

// The manifest's photographs from a camera that is known, in the order of their names. Their noise is made even, so
// that nothing stands out in the dark that is none: codes go as sqrt(g v + 3/8 + (g r)^2) of radiance v (Anscombe 1948;
// with read noise: Murtagh, Starck & Bijaoui 1995), g and r the image's noise; as sqrt(v) where it states none. Full
// scale is the brightest of the first, a middle and the last one but for 0.2 % of its pixels. Error(data) where fewer
// than two say where their camera stood, or they are mosaics.
class Photographs {
 public:
  explicit Photographs(const manifest::Document& document);
  std::size_t count() const { return images_.size(); }
  GreyPicture picture(std::size_t k) const;
  const manifest::ImageEntry& image(std::size_t k) const;
  CameraFromObject camera_from_world(std::size_t k) const;
  std::vector<std::filesystem::path> files() const;
  // The sequence of every `every`-th: tracks less the lens's distortion, pixels of `pinhole`, whose centres lie at
  // integers as the manifest's do.
  Sequence sequence(const FollowedPoints& followed, Eigen::Index every) const;

 private:
  const manifest::Document& document_;
  std::vector<std::size_t> images_;  // places in the document's
  double full_ = 1;
};

// The truth of followed points: where the ray of each met object `id` of `truth` when it was chosen, and where that
// point of the material went. Points that met something else are left out of both. `tracks`: what was followed;
// `ideal`: the same points as geometry sees them, all that the surface does not hide.
struct KnownTracks {
  Sequence tracks, ideal;
  Eigen::Index elsewhere = 0;  // points that began beside the object
};
KnownTracks with_truth(const Photographs& photographs, const FollowedPoints& followed, Sequence tracks,
                       Eigen::Index every, const manifest::Document& truth, const std::string& id);

}  // namespace gonio::nrsfm
