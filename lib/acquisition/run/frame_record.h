// A frame as the journal has it: everything that the manifest will say of it.
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/laboratory/laboratory.h"
#include "acquisition/run/frame_check.h"
#include "manifest/sections/forward.h"
#include "manifest/value.h"

namespace gonio::acquisition {

struct FrameRecord {
  std::string image, group;  // group: the step
  std::string camera, file;  // relative to --out
  std::string sha256;
  std::uint64_t bytes = 0;
  std::vector<std::string> lamps;  // that were read back as on
  double exposure_s = 0;           // as the camera says, else as asked
  std::optional<double> gain_db, temperature_K;
  double time_s = 0;  // since the run began
  std::string robot;  // that holds the camera
  State joints;       // of all arms, as read back
  std::map<std::string, double> turntables;
  std::uint64_t frame_id = 0;
  FrameFigures figures;
  int bits = 16;  // used ones of a sample
  int tries = 1;
};

// Writes the frame's file below `out` and what it is into the record: file (as the image's id says), bytes, sha256.
std::filesystem::path write_frame_file(const std::filesystem::path& out, const RawFrame& frame, FrameRecord& record);
// Is a kept frame's file what the journal says of it?
bool file_stands(const std::filesystem::path& out, const FrameRecord& record);

manifest::Value to_event(const FrameRecord& record);  // {"what": "frame", ...}
FrameRecord frame_of(const manifest::Value& event);   // of such an event
std::string words_of(const FrameRecord& record);      // "v017: 8 ms, 0.2 % saturated"
// Is a kept frame's file what the journal says of it? `out`: that of the run.
bool file_stands(const std::filesystem::path& out, const FrameRecord& record);

// Enters images, files and robots of the records, in the order of the plan. `folder`: of --out. Cameras stand where the
// plan's `measured` says of the step, or of another in the same joints, else where joints and mountings say. How many
// frames stand where it was measured.
std::int64_t enter_frames(manifest::Document& document, const Laboratory& laboratory, const manifest::Plan& plan,
                          const std::map<std::string, FrameRecord>& records, const std::filesystem::path& folder);

// The pictures that a step makes, one an exposure: their ids.
std::vector<std::string> images_of(const manifest::PlanStep& step);
double amplification(std::optional<double> gain_db);  // of voltages: 10^(dB / 20), as cameras count their gain
// Id of the light that a held lamp is at one step: "lamp@hemisphere-0007". What a run enters for its frames is no light
// of the scene that the next run finds.
std::string light_at_step(const std::string& light, const std::string& step);
bool is_light_at_step(const std::string& id, const std::string& light);

}  // namespace gonio::acquisition
