// The state that the desk's devices share. Private to desk/.
#pragma once
#include <map>
#include <mutex>
#include <string>

#include "acquisition/desk/true_laboratory.h"
#include "manifest/document.h"
#include "robot/chain/role.h"

namespace gonio::acquisition {

struct TrueState {
  TrueState(const manifest::Document& believed, const manifest::Document* truth, const DeskOptions& options);

  Rigid<frame::World, frame::Tool> world_from_tool(const std::string& arm) const;  // as it really stands
  // Radiance that reaches the camera's pixels as its sensor chain gives it, and the codes of a frame.
  RawFrame expose(const std::string& camera, const Shot& shot);

  manifest::Document document;  // as it is: scene, mechanisms, laboratory
  Laboratory laboratory;
  DeskOptions options;
  robot::ChainState chain;                                // what the mechanisms of robots move
  State joints;                                           // as sent, and as reported
  std::map<std::string, std::array<double, 6>> approach;  // how every joint last turned
  std::map<std::string, bool> lit;
  std::map<std::string, double> angle_rad;
  double time_s = 0;
  std::map<std::string, std::uint64_t> frames;
  std::mutex busy;  // devices are called from several threads

 private:
  manifest::Document scene_of(const std::string& camera, const Shot& shot) const;
  void place_lamps(manifest::Document& scene) const;
  void turn_objects(manifest::Document& scene) const;
};

double warmth_K(double time_s);  // of arms and cameras above the room's: 10 K, reached with a time constant of 30 min

}  // namespace gonio::acquisition
