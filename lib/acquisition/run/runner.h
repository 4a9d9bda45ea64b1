// A plan is carried out: motions, lamps, photographs, each checked, each in the journal before the next.
//
// The order of one frame: "intent" in the journal; arms, turntables, screens and lamps as the step asks, read back; the
// photograph; its figures against what was asked (frame_check.h), arms and lamps read back again; the file, flushed
// to the disk; "frame" in the journal. A frame that disagrees is taken again; after any disagreement the next good
// frame is only believed once a second one like it was taken. What stays wrong is "refused" with its reason. So a file
// without its line is worth nothing, a line without its file is seen by the file's hash, and a run that was killed at
// any moment goes on with the first frame that has not both.
//
// Every camera takes, before its first lit frame at an exposure, one with all lamps off: a lit frame as dark as that is
// a lamp that does not light. Where several lamps are lit and not all of them say what they truly do, they are lit one
// by one in every step, and each has to make the picture brighter.
//
// Poses that were measured at the plan's steps ("plans": measured) take the place of those that joints and mountings
// say. Views of a board that the plan comes back to are held against each other (board_checks.h); of a run that stops
// for one that has moved, what was taken is entered, and resumed it takes the frames in question again.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/laboratory/laboratory.h"
#include "acquisition/motion/way.h"
#include "acquisition/run/board_checks.h"
#include "acquisition/run/frame_record.h"
#include "acquisition/run/instrument.h"
#include "manifest/sections/forward.h"

namespace gonio::acquisition {

struct RunReport {
  std::int64_t frames = 0, retaken = 0, refused = 0;
  std::int64_t measured = 0;  // frames that stand where the plan's earlier runs were measured
  std::optional<manifest::Repeatability> repeatability{};
  std::vector<manifest::DriftedFrames> drifted{};
  std::string stopped{};           // why the run ended early: a check view had moved; empty: it did not
  std::vector<std::string> words;  // of what was refused, and of what looks doubtful: saturated, dark, out of focus
  std::map<std::string, FrameRecord> records;  // of what was kept, by image
};

// What is so while the run goes on. The references hold during the call.
struct RunNews {
  const FrameRecord& frame;                           // that was just kept
  const std::map<std::string, FrameRecord>& records;  // all that are kept, those of earlier runs with them
  std::size_t total = 0;                              // that the plan has
  const RunReport& report;                            // of what was taken again and refused so far
};

struct RunOptions {
  std::filesystem::path out;  // frames/IMAGE.png, journal.jsonl
  bool resume = false;
  int retakes = 4;         // of one frame, after which it is refused
  bool lamp_check = true;  // the dark frames above
  std::uint64_t seed = 1;  // of ways back to the plan
  CheckOptions checks{};   // of the board's views that the plan comes back to
  // After every frame that was kept.
  std::function<void(const RunNews&)> on_frame{};
};

// Carries out `plan` and enters images, files, robots and the run into `document`, all of it as the journal has it: a
// resumed run's entries are those of one that was never interrupted, but for times. Interrupted (base/atomic_file.h):
// the arms are stopped first, then Error(try_again). Error(unavailable) where an arm or a device gives up;
// Error(data) where the plan is another laboratory's or breaks a limit.
RunReport run_plan(manifest::Document& document, const Laboratory& laboratory, const manifest::Plan& plan,
                   Instrument& instrument, const RunOptions& options);

}  // namespace gonio::acquisition
