// A pose by ViSP's model-based tracker of moving edges, for scripts/proofs/align-peers, which compiles this by itself:
// the project does not need ViSP.
//
//   visp-align RANGE SAMPLE_STEP < views
//
// `views` has a line for each: the file of its mask, its model (.cao), fx fy cx cy in pixels, and camera_from_object,
// three rows of four, where the tracker begins. Several views are one tracker of several cameras, the first being the
// reference. Masks become grey pictures, smoothed a little, so that edges have a direction. Prints the first view's
// camera_from_object after one call of track(), twelve numbers, and the seconds with the reading of the model; "lost"
// where the tracker gives up.
#include <visp3/core/vpImageFilter.h>
#include <visp3/io/vpImageIo.h>
#include <visp3/mbt/vpMbGenericTracker.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace {

struct Views {
  std::vector<std::string> names;
  std::map<std::string, std::string> models;
  std::map<std::string, vpImage<unsigned char>> pictures;
  std::map<std::string, vpCameraParameters> cameras;
  std::map<std::string, vpHomogeneousMatrix> poses, from_first;
};

vpImage<unsigned char> smoothed(const std::string& file) {
  vpImage<unsigned char> mask;
  vpImageIo::read(mask, file);
  vpImage<double> soft;
  vpImageFilter::gaussianBlur(mask, soft, 7, 1.0);
  vpImage<unsigned char> out(mask.getHeight(), mask.getWidth());
  for (unsigned int i = 0; i < out.getSize(); ++i)
    out.bitmap[i] = static_cast<unsigned char>(40 + 175 * soft.bitmap[i] / 255 + 0.5);
  return out;
}

Views read_views(const std::vector<std::string>& lines, const std::string& first) {
  Views views;
  for (const std::string& line : lines) {
    std::istringstream in(line);
    std::string file, model;
    in >> file >> model;
    const std::string name = views.names.empty() ? first : "Camera" + std::to_string(views.names.size() + 1);
    double fx = 0, fy = 0, cx = 0, cy = 0;
    in >> fx >> fy >> cx >> cy;
    vpHomogeneousMatrix pose;
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int k = 0; k < 4; ++k) in >> pose[i][k];
    views.names.push_back(name);
    views.models[name] = model;
    views.pictures[name] = smoothed(file);
    views.cameras[name] = vpCameraParameters(fx, fy, cx, cy);
    views.poses[name] = pose;
    views.from_first[name] = pose * views.poses[first].inverse();
  }
  return views;
}

vpMe moving_edges(unsigned int range, double sample_step) {
  vpMe edges;
  edges.setMaskSize(5);
  edges.setMaskNumber(180);
  edges.setRange(range);
  edges.setThreshold(5000);
  edges.setMu1(0.5);
  edges.setMu2(0.5);
  edges.setSampleStep(sample_step);
  return edges;
}

// Everything that is not told of moving edges, for all cameras.
void prepare(vpMbGenericTracker& tracker, const Views& views, const vpMe& edges) {
  std::map<std::string, vpMe> edges_of;
  for (const std::string& name : views.names) edges_of[name] = edges;
  tracker.setMovingEdge(edges_of);
  tracker.setCameraParameters(views.cameras);
  tracker.setAngleAppear(vpMath::rad(89.9));
  tracker.setAngleDisappear(vpMath::rad(89.9));
  tracker.setNearClippingDistance(0.05);
  tracker.setFarClippingDistance(5);
  tracker.loadModel(views.models);
  if (views.names.size() > 1) tracker.setCameraTransformationMatrix(views.from_first);
  tracker.setScanLineVisibilityTest(true);
  tracker.setGoodMovingEdgesRatioThreshold(0.01);
  tracker.setDisplayFeatures(false);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return std::fprintf(stderr, "usage: visp-align RANGE SAMPLE_STEP < views\n"), 64;
  const auto range = static_cast<unsigned int>(std::atoi(argv[1]));
  const double sample_step = std::atof(argv[2]);
  try {
    // The tracker names its cameras itself, one alone otherwise than the first of several.
    std::vector<std::string> lines;
    for (std::string line; std::getline(std::cin, line);) lines.push_back(line);
    const std::string first = lines.size() > 1 ? "Camera1" : "Camera";
    const Views views = read_views(lines, first);
    const auto begun = std::chrono::steady_clock::now();
    vpMbGenericTracker tracker(static_cast<unsigned int>(views.names.size()), vpMbGenericTracker::EDGE_TRACKER);
    prepare(tracker, views, moving_edges(range, sample_step));
    std::map<std::string, const vpImage<unsigned char>*> pictures;
    for (const auto& [name, picture] : views.pictures) pictures[name] = &picture;
    tracker.initFromPose(pictures, views.poses);
    tracker.track(pictures);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    std::map<std::string, vpHomogeneousMatrix> found;
    tracker.getPose(found);
    const vpHomogeneousMatrix& pose = found[first];
    for (unsigned int i = 0; i < 12; ++i) std::printf("%.12g ", pose[i / 4][i % 4]);
    std::printf("%g\n", seconds);
  } catch (const vpException& error) {
    std::printf("lost: %s\n", error.what());
  } catch (const std::exception& error) {
    std::printf("lost: %s\n", error.what());
  }
  return 0;
}
