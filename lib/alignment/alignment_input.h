// What a manifest says of an alignment, as align() takes it: meshes, cameras, lamps, the ground, and rims from masks.
#pragma once
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "alignment/question.h"
#include "camera/camera_model.h"
#include "manifest/pose.h"
#include "manifest/sections/forward.h"

namespace gonio::alignment {

struct InputWish {
  std::vector<std::string> objects{};  // to align; empty: all of which outlines show something
  std::set<std::string> freed{};       // "scale", "size", "camera", "focal", "ground", beside the pose and lamps
  std::set<std::string> held{};        // "pose", "light"
  std::set<std::string> carried{};     // lamps on a robot's tool: each has a place at every base_from_tool
  double scale_sigma = 0.05;           // priors, where something is known of what is freed
  double contact_m = 1e-4;             // 0: nothing is known of where it stands
  double smooth_px = 1.2;              // of binary masks
  bool penumbrae = true;               // measure shadows' edges in the photographs
  bool any_start = true;               // the stated poses need not be near: masks have to be whole
};

// One rim: where it comes from, and its points as the picture has them (Sighting has them straightened).
struct SeenRim {
  std::size_t outline = 0;  // place in document.outlines
  std::string image;
  double smooth_px = 0;  // by which its mask was smoothed
  std::vector<RimPoint> in_picture;
  std::vector<double> spread_px{};  // of a shadow's points, where the photograph is there (edge_spread.h); else empty
};
// A lamp's place while the robot whose tool carries it stood at one pose.
struct CarriedPlace {
  std::string robot;
  manifest::Pose<frame::Base, frame::Tool> base_from_tool{};
  std::vector<std::string> images{};
};
struct AlignmentInput {
  std::deque<Shape> shapes;
  Setting stated;
  Question question;  // sightings in the order of `rims`
  std::vector<SeenRim> rims;
  std::vector<std::string> bodies, lamps, cameras;  // names, as the setting numbers them
  std::vector<std::vector<std::string>> images_of_station;
  std::vector<camera::CameraModel> models;  // of the lenses
  std::vector<bool> lamp_stated;
  // By lamp of the setting, as far as it is carried: one name then stands in `lamps` once for every pose.
  std::map<std::size_t, CarriedPlace> carried{};
  std::string lamp_words(std::size_t lamp) const;  // its name, and of a carried one the images
  std::string ground;                              // its object; empty: none
  Rigid<frame::World, frame::Object> world_from_ground{};
  // Position in the straightened picture of a pixel of lens `lens`, and back.
  Vec2 straight(std::size_t lens, Vec2 pixel) const;
  Vec2 bent(std::size_t lens, Vec2 straight) const;
};

// Their cameras stand there.
void move_images(manifest::Document& document, const std::vector<std::string>& images,
                 const manifest::Pose<frame::World, frame::Camera>& pose);

using NoteFile = std::function<void(const std::filesystem::path&)>;
// Error(data) at the place for what is missing, empty, cut off or of the wrong size.
AlignmentInput read_alignment(const manifest::Document& document, const InputWish& wish, const NoteFile& note);

}  // namespace gonio::alignment
