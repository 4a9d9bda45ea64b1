// The page of a run: what it did so far, its last picture, and the laboratory as it stood there. It is written again
// and again while the run goes on, and a browser that shows it loads it anew.
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/plan/plan_page.h"
#include "acquisition/run/frame_record.h"

namespace gonio::acquisition {

struct RunState {
  const std::map<std::string, FrameRecord>* records = nullptr;  // of the frames that are kept, by image
  std::int64_t retaken = 0, refused = 0;
  std::vector<std::string> words{};  // what was refused or looks doubtful
  bool running = true;
  std::string stopped{};           // why it came to no end
  std::optional<double> left_s{};  // the time that it will still take
};

class RunPage {
 public:
  // `out`: the folder of the frames. Keeps pointers to document and laboratory.
  RunPage(const manifest::Document& document, const Laboratory& laboratory, const manifest::Plan& plan,
          std::filesystem::path out);
  std::string html(const RunState& state) const;

 private:
  const manifest::Document& document_;
  const Laboratory& laboratory_;
  const manifest::Plan& plan_;
  std::filesystem::path out_;
  PlanDrawing drawing_;
  std::size_t total_ = 0;
};

// A frame's codes for the eye: not wider than `widest` pixels (each the mean of a square of them, which also hides the
// filters of a mosaic), as bright as its brightest percent allows, by at most a factor of 50; 8 bits.
std::string shown_frame(const std::filesystem::path& path, int widest);

}  // namespace gonio::acquisition
