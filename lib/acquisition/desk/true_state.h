// The state that the desk's devices share. Private to desk/.
#pragma once
#include <map>
#include <mutex>
#include <string>

#include "acquisition/desk/faults.h"
#include "acquisition/desk/true_arm.h"
#include "acquisition/desk/true_devices.h"
#include "acquisition/desk/true_laboratory.h"
#include "acquisition/device/unpack.h"
#include "io/image.h"
#include "manifest/document.h"
#include "robot/chain/role.h"

namespace gonio::acquisition {

struct TrueState {
  // `pace`: of its clock (desk_clock.h). Error(data) where the truth names what the description has not, and for a
  // camera whose pictures cannot be made.
  TrueState(const manifest::Document& believed, const manifest::Document* truth, const DeskOptions& options,
            double pace = 0);

  Rigid<frame::World, frame::Tool> world_from_tool(const std::string& arm) const;  // as it really stands
  // The codes of a frame, of the radiance that reaches the camera's pixels through its sensor chain. `format`: what the
  // camera was set to; its description's where nothing is said. Exposures count in microseconds, gains in 0.01 dB, as
  // the simulated camera's registers hold them.
  RawFrame expose(const std::string& camera, const Shot& shot, const PixelFormat* format = nullptr);
  PixelFormat format_of(const std::string& camera) const;
  // What a screen shows from now on; empty: black. It is the scene's light of model "screen" or "projector" with the
  // screen's name.
  // Error(data) where there is none, and for pictures that are not of the screen's size.
  void show(const std::string& screen, const std::string& picture_path);
  const manifest::Laboratory& section() const { return document.laboratory.entry.front(); }

  manifest::Document document;  // as it is: scene, mechanisms, laboratory
  Laboratory laboratory;
  DeskOptions options;
  desk::DeskClock clock;
  desk::Faults faults;
  robot::ChainState chain;  // what the mechanisms of robots move
  std::map<std::string, std::unique_ptr<desk::TrueArm>> arms;
  desk::TrueLamps lamps;
  std::map<std::string, int> lamp_number;
  std::map<std::string, std::unique_ptr<desk::TrueTurntable>> tables;
  std::map<std::string, std::uint64_t> frames;
  std::map<std::string, std::string> shown;  // pictures by screen
  std::string rendered_light;                // whose picture at gain 1 `rendered` is
  io::Image rendered;
  std::mutex busy;  // devices are called from several threads

 private:
  manifest::Document scene_of(const std::string& camera, const Shot& shot) const;
  void place_lamps(manifest::Document& scene) const;
  void turn_objects(manifest::Document& scene) const;
  void light_screens(manifest::Document& scene) const;
};

}  // namespace gonio::acquisition
